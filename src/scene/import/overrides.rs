//! `--texture MATERIAL=FILE` for glTF: the JSON is edited as if the file had said so.

use std::path::PathBuf;

use serde_json::{Value, json};

use super::json::{Check, Of, array, name};
use crate::scene::textures;

/// Gives each named material a base colour texture from a file.
pub(super) fn apply(
    json: &mut Value,
    buffers: &mut Vec<Vec<u8>>,
    wanted: &[(String, PathBuf)],
) -> Check<()> {
    for (material, path) in wanted {
        one(json, buffers, material, path).of(|| format!("--texture {material}"))?;
    }
    Ok(())
}

fn one(json: &mut Value, buffers: &mut Vec<Vec<u8>>, material: &str, path: &PathBuf) -> Check<()> {
    let names: Vec<String> = array(json, "materials")?
        .iter()
        .enumerate()
        .map(|(i, m)| name("material", i, m))
        .collect();
    let slots: Vec<usize> = (0..names.len()).filter(|&i| names[i] == material).collect();
    if slots.is_empty() {
        return Err(format!(
            "there is no such material, only {}",
            names.join(", ")
        ));
    }
    let bytes = std::fs::read(path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
    let mime = textures::media_type(&bytes)
        .ok_or_else(|| format!("{} is neither PNG nor JPEG", path.display()))?;
    let title = path.file_name().map(|n| n.to_string_lossy().into_owned());
    let length = bytes.len();
    let buffer = push(json, "buffers", json!({"byteLength": length}))?;
    buffers.push(bytes);
    debug_assert_eq!(
        buffers.len(),
        buffer + 1,
        "one entry per buffer, bytes or not"
    );
    let view = push(
        json,
        "bufferViews",
        json!({"buffer": buffer, "byteLength": length}),
    )?;
    let image = json!({"name": title, "mimeType": mime, "bufferView": view});
    let image = push(json, "images", image)?;
    let texture = push(json, "textures", json!({"source": image}))?;
    for i in slots {
        let m = json["materials"][i]
            .as_object_mut()
            .ok_or("a material is not an object")?;
        let pbr = m.entry("pbrMetallicRoughness").or_insert_with(|| json!({}));
        let pbr = pbr
            .as_object_mut()
            .ok_or("\"pbrMetallicRoughness\" is not an object")?;
        pbr.insert("baseColorTexture".into(), json!({"index": texture}));
    }
    Ok(())
}

/// Appends to the array `key`, making it if need be; the new index.
fn push(json: &mut Value, key: &str, value: Value) -> Check<usize> {
    let root = json.as_object_mut().ok_or("the JSON is not an object")?;
    let list = root
        .entry(key)
        .or_insert_with(|| json!([]))
        .as_array_mut()
        .ok_or_else(|| format!("\"{key}\" is not an array"))?;
    list.push(value);
    Ok(list.len() - 1)
}
