//! What umbrage does with each glTF extension.
//!
//! Unknown or refused extensions that a file merely *uses* are a warning; those that it
//! *requires* are an error that names the extension. Extensions survive an export either way.

use super::import::json::{Check, array};
use serde_json::Value;

/// What happens to an extension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Support {
    /// Read and honoured.
    Full,
    /// Known to change nothing that umbrage draws or bakes, or only details of shading; kept on
    /// export.
    Ignored,
    /// Cannot be read; the reason says what to do instead.
    Refused(&'static str),
}

/// Every extension umbrage knows.
pub const EXTENSIONS: &[(&str, Support)] = &[
    ("EXT_lights_image_based", Support::Ignored),
    ("EXT_mesh_gpu_instancing", Support::Full),
    ("EXT_meshopt_compression", Support::Full),
    (
        "EXT_texture_avif",
        Support::Refused("convert its images to PNG or JPEG"),
    ),
    (
        "EXT_texture_webp",
        Support::Refused("convert its images to PNG or JPEG"),
    ),
    ("KHR_animation_pointer", Support::Ignored),
    (
        "KHR_draco_mesh_compression",
        Support::Refused("decompress it first (gltf-transform copy, or export without Draco)"),
    ),
    ("KHR_lights_punctual", Support::Full),
    ("KHR_materials_anisotropy", Support::Ignored),
    ("KHR_materials_clearcoat", Support::Ignored),
    ("KHR_materials_diffuse_transmission", Support::Full),
    ("KHR_materials_dispersion", Support::Ignored),
    ("KHR_materials_emissive_strength", Support::Full),
    ("KHR_materials_ior", Support::Ignored),
    ("KHR_materials_iridescence", Support::Ignored),
    ("KHR_materials_pbrSpecularGlossiness", Support::Full),
    ("KHR_materials_sheen", Support::Ignored),
    ("KHR_materials_specular", Support::Ignored),
    ("KHR_materials_transmission", Support::Ignored),
    ("KHR_materials_unlit", Support::Full),
    ("KHR_materials_variants", Support::Ignored),
    ("KHR_materials_volume", Support::Ignored),
    ("KHR_mesh_quantization", Support::Full),
    (
        "KHR_meshopt_compression",
        Support::Refused("decompress it first (gltfpack without -cc)"),
    ),
    ("KHR_node_visibility", Support::Full),
    (
        "KHR_texture_basisu",
        Support::Refused("convert its KTX2 images to PNG or JPEG"),
    ),
    ("KHR_texture_transform", Support::Full),
    ("KHR_xmp_json_ld", Support::Ignored),
    ("MSFT_lod", Support::Ignored),
    (
        "MSFT_texture_dds",
        Support::Refused("convert its DDS images to PNG or JPEG"),
    ),
];

/// What umbrage does with `name`; `None` when it does not know it.
#[must_use]
pub fn support(name: &str) -> Option<Support> {
    EXTENSIONS
        .iter()
        .find(|(known, _)| *known == name)
        .map(|&(_, support)| support)
}

/// Checks `extensionsRequired` and `extensionsUsed`; returns warnings.
pub(super) fn check(json: &Value) -> Check<Vec<String>> {
    let names = |key: &str| -> Check<Vec<String>> {
        Ok(array(json, key)?
            .iter()
            .map(|v| v.as_str().map_or_else(|| v.to_string(), str::to_owned))
            .collect())
    };
    for name in names("extensionsRequired")? {
        match support(&name) {
            Some(Support::Full | Support::Ignored) => {}
            Some(Support::Refused(instead)) => {
                return Err(format!(
                    "requires the extension {name}, which cannot be read: {instead}"
                ));
            }
            None => return Err(format!("requires the unknown extension {name}")),
        }
    }
    let mut warnings = Vec::new();
    for name in names("extensionsUsed")? {
        match support(&name) {
            Some(Support::Full | Support::Ignored) => {}
            Some(Support::Refused(instead)) => warnings.push(format!(
                "extension {name} is not read, its fallback is used: {instead}"
            )),
            None => warnings.push(format!("unknown extension {name} is kept but not read")),
        }
    }
    Ok(warnings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_table_is_sorted_and_every_row_behaves_as_it_says() {
        assert!(
            EXTENSIONS.is_sorted_by(|a, b| a.0 < b.0),
            "sorted, no duplicates"
        );
        for &(name, support) in EXTENSIONS {
            let used = check(&json!({"extensionsUsed": [name]})).unwrap();
            let required = check(&json!({"extensionsUsed": [name], "extensionsRequired": [name]}));
            if let Support::Refused(instead) = support {
                assert!(used[0].contains(name) && used[0].contains(instead));
                assert!(required.unwrap_err().contains(name));
            } else {
                assert!(used.is_empty() && required.unwrap().is_empty(), "{name}");
            }
        }
        let e = check(&json!({"extensionsRequired": ["ACME_x"]})).unwrap_err();
        assert!(e.contains("ACME_x"), "{e}");
        assert_eq!(
            check(&json!({"extensionsUsed": ["ACME_x"]})).unwrap().len(),
            1
        );
    }

    #[test]
    fn the_documentation_lists_every_row() {
        let page = include_str!("../../docs/models.md");
        for (name, support) in EXTENSIONS {
            let what = match support {
                Support::Full => "read".to_owned(),
                Support::Ignored => "kept, not read".to_owned(),
                Support::Refused(instead) => format!("refused: {instead}"),
            };
            let row = format!("| `{name}` | {what} |");
            assert!(page.contains(&row), "docs/models.md lacks: {row}");
        }
    }
}
