//! Vulkan mechanism.
#![allow(unsafe_code, reason = "the one room that talks to Vulkan")]
/// A shader compiled by `build.rs`.
#[derive(Debug, Clone, Copy)]
pub struct Shader {
    /// Path below `shaders/`.
    pub name: &'static str,
    /// SPIR-V bytes.
    pub spirv: &'static [u8],
}
/// Every shader of the program.
pub mod shaders {
    use super::Shader;
    include!(concat!(env!("OUT_DIR"), "/shaders.rs"));
}
/// A device and its queues.
#[derive(Debug, Clone)]
pub struct Gpu {}
