//! How Rust types and constants are written in GLSL.

/// A type that may stand in a shared struct.
pub trait GlslType {
    /// Its name in GLSL.
    const GLSL: &'static str;
}

macro_rules! glsl_types {
    ($($t:ty => $name:literal),* $(,)?) => { $(impl GlslType for $t { const GLSL: &'static str = $name; })* };
}
glsl_types! {
    f32 => "float", u32 => "uint", i32 => "int",
    [f32; 2] => "vec2", [f32; 3] => "vec3", [f32; 4] => "vec4",
    [u32; 2] => "uvec2", [u32; 3] => "uvec3", [u32; 4] => "uvec4",
    [i32; 3] => "ivec3", [[f32; 4]; 4] => "mat4", [[f32; 3]; 4] => "mat4x3",
}

/// How a constant is written in GLSL.
pub(super) trait GlslLiteral {
    /// The constant's text.
    fn literal(&self) -> String;
}
impl GlslLiteral for u32 {
    fn literal(&self) -> String {
        format!("{self}u")
    }
}
impl GlslLiteral for i32 {
    fn literal(&self) -> String {
        format!("{self}")
    }
}
impl GlslLiteral for f32 {
    fn literal(&self) -> String {
        format!("{self:?}")
    }
}
