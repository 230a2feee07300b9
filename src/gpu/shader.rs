//! Shaders as the build made them.

/// A shader compiled by the build.
#[derive(Debug, Clone, Copy)]
pub struct Shader {
    /// Path below `shaders/`.
    pub name: &'static str,
    /// SPIR-V bytes.
    pub spirv: &'static [u8],
}

impl Shader {
    /// SPIR-V words.
    #[must_use]
    pub fn words(&self) -> Vec<u32> {
        let word = |b: &[u8]| u32::from_le_bytes([b[0], b[1], b[2], b[3]]);
        self.spirv.chunks_exact(4).map(word).collect()
    }
}

/// Every shader of the program.
pub mod shaders {
    use super::Shader;
    include!(concat!(env!("OUT_DIR"), "/shaders.rs"));
}
