//! Every struct and constant shared with shaders, once.
//!
//! `build.rs` includes this file and serves [`glsl`] to the shader compiler as
//! `#include "abi.glsl"`; the tests compare the offsets in the SPIR-V with `offset_of!`. The
//! device uses scalar block layout, so `#[repr(C)]` of these field types is the same layout.

// The paths are written out because build.rs includes this file from another folder's module tree.
#[path = "abi/glsl.rs"]
mod glsl_text;

pub use glsl_text::GlslType;

/// A struct's layout as the host sees it, for the comparison with SPIR-V.
#[derive(Debug, Clone)]
pub struct StructLayout {
    /// Name in both languages.
    pub name: &'static str,
    /// `size_of`.
    pub size: usize,
    /// (field, offset) in order.
    pub fields: Vec<(&'static str, usize)>,
}

/// Declares structs and constants for Rust and GLSL at once.
///
/// Constants are `u32`, `i32` or `f32`; structs hold [`GlslType`] fields only.
macro_rules! abi {
    (
        constants { $( $(#[$cdoc:meta])* $cname:ident: $cty:ident = $cval:expr; )* }
        structs { $( $(#[$sdoc:meta])* $sname:ident { $( $(#[$fdoc:meta])* $field:ident: $fty:ty ),* $(,)? } )* }
    ) => {
        $( $(#[$cdoc])* pub const $cname: $cty = $cval; )*
        $(
            $(#[$sdoc])*
            #[repr(C)]
            #[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
            pub struct $sname { $( $(#[$fdoc])* pub $field: $fty ),* }
        )*

        /// The GLSL text of every constant and struct above.
        pub(super) fn glsl() -> String {
            let mut out = String::new();
            $( out.push_str(&format!("const {} {} = {};\n",
                <$cty as GlslType>::GLSL, stringify!($cname), GlslLiteral::literal(&$cname))); )*
            $(
                out.push_str(concat!("struct ", stringify!($sname), " {\n"));
                $( out.push_str(&format!("    {} {};\n", <$fty as GlslType>::GLSL, stringify!($field))); )*
                out.push_str("};\n");
            )*
            out
        }

        /// Host layouts of every struct above.
        pub(super) fn layouts() -> Vec<StructLayout> {
            vec![$( StructLayout {
                name: stringify!($sname),
                size: size_of::<$sname>(),
                fields: vec![$( (stringify!($field), std::mem::offset_of!($sname, $field)) ),*],
            } ),*]
        }
    };
}

#[path = "abi/foliage.rs"]
mod foliage;
#[path = "abi/gpu.rs"]
mod gpu;
#[path = "abi/ink.rs"]
mod ink;
#[path = "abi/ink_looks.rs"]
mod ink_looks;
#[path = "abi/lamps.rs"]
mod lamps;
#[path = "abi/leaf.rs"]
mod leaf;
#[path = "abi/light.rs"]
mod light;
#[path = "abi/paper.rs"]
mod paper;
#[path = "abi/render.rs"]
mod render;

pub use foliage::*;
pub use gpu::*;
pub use ink::*;
pub use ink_looks::*;
pub use lamps::*;
pub use leaf::*;
pub use light::*;
pub use paper::*;
pub use render::*;

/// The GLSL text of every shared constant and struct.
#[must_use]
pub fn glsl() -> String {
    let parts = [
        gpu::glsl(),
        foliage::glsl(),
        ink::glsl(),
        ink_looks::glsl(),
        leaf::glsl(),
        light::glsl(),
        lamps::glsl(),
        paper::glsl(),
        render::glsl(),
    ]
    .concat();
    format!("#ifndef ABI_GLSL\n#define ABI_GLSL\n{parts}#endif\n")
}

/// Host layouts of every shared struct.
#[must_use]
pub fn layouts() -> Vec<StructLayout> {
    [
        gpu::layouts(),
        foliage::layouts(),
        ink::layouts(),
        ink_looks::layouts(),
        leaf::layouts(),
        light::layouts(),
        lamps::layouts(),
        paper::layouts(),
        render::layouts(),
    ]
    .concat()
}
