//! Compiles every shader under `shaders/` to SPIR-V and writes a Rust module that names them.
//!
//! `shaders/foliage/density.comp` becomes `shaders::foliage::DENSITY_COMP`; a missing shader is
//! a compile error where it is used. `#include "abi.glsl"` is served from `src/abi.rs`, every
//! other include is looked for in `shaders/include/` and then beside the including file.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

#[expect(
    dead_code,
    unreachable_pub,
    unused_imports,
    reason = "the build script uses only the GLSL half of the shared file"
)]
#[path = "src/abi.rs"]
mod abi;

// Debian's libshaderc and glslang are under-linked: name the static parts they leave out.
#[allow(
    clippy::duplicated_attributes,
    reason = "every library is static: the lint takes the repeated kind for a mistake"
)]
#[cfg(feature = "system-shaderc")]
#[allow(
    clippy::duplicated_attributes,
    reason = "one link attribute per library"
)]
#[link(name = "glslang", kind = "static")]
#[link(name = "MachineIndependent", kind = "static")]
#[link(name = "GenericCodeGen", kind = "static")]
#[link(name = "OSDependent", kind = "static")]
#[link(name = "OGLCompiler", kind = "static")]
#[link(name = "HLSL", kind = "static")]
#[link(name = "SPIRV", kind = "static")]
#[link(name = "SPIRV-Tools-opt", kind = "static")]
#[link(name = "SPIRV-Tools", kind = "static")]
unsafe extern "C" {}

fn main() {
    println!("cargo:rerun-if-changed=shaders");
    println!("cargo:rerun-if-changed=src/abi.rs");
    println!("cargo:rerun-if-changed=src/abi");
    println!("cargo:rerun-if-changed=build.rs");
    let root = PathBuf::from(env::var("CARGO_MANIFEST_DIR").expect("set by cargo")).join("shaders");
    let out = PathBuf::from(env::var("OUT_DIR").expect("set by cargo"));
    let spirv_dir = out.join("spirv");
    let _ = fs::remove_dir_all(&spirv_dir);

    let mut sources = Vec::new();
    collect(&root, &mut sources);
    sources.sort();

    let compiler = shaderc::Compiler::new().expect("the shader compiler starts");
    let mut modules: BTreeMap<String, String> = BTreeMap::new();
    let mut failures = Vec::new();
    let mut all = String::new();
    for source in &sources {
        let relative = source
            .strip_prefix(&root)
            .expect("collected below the root");
        match compile(&compiler, &root, source) {
            Ok(words) => {
                let binary = spirv_dir.join(relative).with_added_extension("spv");
                fs::create_dir_all(binary.parent().expect("has a folder"))
                    .expect("OUT_DIR is writable");
                fs::write(&binary, words).expect("OUT_DIR is writable");
                let module = relative
                    .parent()
                    .expect("has a folder")
                    .to_string_lossy()
                    .replace('/', "_");
                let name = relative.to_string_lossy().into_owned();
                let file = relative
                    .file_name()
                    .expect("is a file")
                    .to_string_lossy()
                    .into_owned();
                let constant = file.replace(['.', '-'], "_").to_uppercase();
                let _ = write!(all, "{module}::{constant}, ");
                let _ = writeln!(
                    modules.entry(module).or_default(),
                    "    /// `shaders/{name}`\n    pub const {constant}: Shader = Shader {{ name: {name:?}, spirv: include_bytes!({binary:?}) }};"
                );
            }
            Err(message) => failures.push(message),
        }
    }
    if !failures.is_empty() {
        for line in failures.join("\n").lines().filter(|l| !l.trim().is_empty()) {
            println!("cargo:error={line}");
        }
        std::process::exit(1);
    }
    let mut text = String::new();
    for (module, body) in modules {
        let _ = writeln!(
            text,
            "/// Shaders of `shaders/{module}`.\npub mod {module} {{\n    use super::Shader;\n{body}}}"
        );
    }
    let _ = writeln!(
        text,
        "/// All of them.\npub const ALL: &[Shader] = &[{all}];"
    );
    fs::write(out.join("shaders.rs"), text).expect("OUT_DIR is writable");
}

/// Every `.comp`, `.vert` and `.frag` below `folder`.
fn collect(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder)
        .expect("shaders/ is readable")
        .flatten()
    {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, out);
        } else if matches!(extension(&path), "comp" | "vert" | "frag") {
            out.push(path);
        }
    }
}

fn extension(path: &Path) -> &str {
    path.extension().and_then(|e| e.to_str()).unwrap_or("")
}

/// SPIR-V bytes of one file, or the compiler's message with file and line.
fn compile(compiler: &shaderc::Compiler, root: &Path, source: &Path) -> Result<Vec<u8>, String> {
    let kind = match extension(source) {
        "comp" => shaderc::ShaderKind::Compute,
        "vert" => shaderc::ShaderKind::Vertex,
        _ => shaderc::ShaderKind::Fragment,
    };
    let text = fs::read_to_string(source).map_err(|e| format!("{}: {e}", source.display()))?;
    let mut options = shaderc::CompileOptions::new().expect("options are allocated");
    options.set_target_env(
        shaderc::TargetEnv::Vulkan,
        shaderc::EnvVersion::Vulkan1_3 as u32,
    );
    // SPIR-V 1.6 would give group sizes by id, which older tools do not read.
    options.set_target_spirv(shaderc::SpirvVersion::V1_5);
    options.set_optimization_level(shaderc::OptimizationLevel::Performance);
    options.set_warnings_as_errors();
    // Names stay in the SPIR-V, so that reflection and the layout test can speak of them.
    options.set_generate_debug_info();
    let include_root = root.join("include");
    options.set_include_callback(move |name, _, from, _| {
        if name == "abi.glsl" {
            return Ok(shaderc::ResolvedInclude {
                resolved_name: name.into(),
                content: abi::glsl(),
            });
        }
        let beside = Path::new(from)
            .parent()
            .map(|p| p.join(name))
            .unwrap_or_default();
        for candidate in [include_root.join(name), beside] {
            if let Ok(content) = fs::read_to_string(&candidate) {
                let resolved_name = candidate.to_string_lossy().into_owned();
                return Ok(shaderc::ResolvedInclude {
                    resolved_name,
                    content,
                });
            }
        }
        Err(format!(
            "{name} is neither in shaders/include nor beside {from}"
        ))
    });
    compiler
        .compile_into_spirv(
            &text,
            kind,
            &source.to_string_lossy(),
            "main",
            Some(&options),
        )
        .map(|binary| binary.as_binary_u8().to_vec())
        .map_err(|e| e.to_string())
}
