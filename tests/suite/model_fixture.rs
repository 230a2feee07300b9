//! Small documents for the tests of reading models.

use std::path::PathBuf;

use base64::Engine as _;
use serde_json::{Value, json};
use umbrage::scene::Model;
use umbrage::scene::import::{LoadOptions, load};

/// A file of the shared models; missing ones fail by name.
pub(crate) fn shared(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/models")
        .join(name);
    assert!(path.is_file(), "{} is missing", path.display());
    path
}

/// A document of one triangle; tests change a member and look what happens.
pub(crate) fn triangle() -> Value {
    let mut bytes = Vec::new();
    for v in [0.0f32, 0., 0., 1., 0., 0., 0., 1., 0.] {
        bytes.extend(v.to_le_bytes());
    }
    bytes.extend([0u8, 1, 2, 0]);
    json!({
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": 40, "uri": data_uri(&bytes)}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 3}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3},
            {"bufferView": 1, "componentType": 5121, "type": "SCALAR", "count": 3}],
        "meshes": [{"name": "card", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [{"name": "leaf", "mesh": 0}],
        "scenes": [{"nodes": [0]}]
    })
}

pub(crate) fn data_uri(bytes: &[u8]) -> String {
    let text = base64::engine::general_purpose::STANDARD.encode(bytes);
    format!("data:application/octet-stream;base64,{text}")
}

/// Adds a buffer with `bytes`, a view and an accessor over it; the accessor's index.
pub(crate) fn add(
    doc: &mut Value,
    bytes: &[u8],
    component: u32,
    kind: &str,
    count: usize,
) -> usize {
    let push = |list: &mut Value, v: Value| {
        list.as_array_mut().unwrap().push(v);
        list.as_array().unwrap().len() - 1
    };
    let buffer = json!({"byteLength": bytes.len(), "uri": data_uri(bytes)});
    let buffer = push(&mut doc["buffers"], buffer);
    let view = json!({"buffer": buffer, "byteLength": bytes.len()});
    let view = push(&mut doc["bufferViews"], view);
    let accessor =
        json!({"bufferView": view, "componentType": component, "type": kind, "count": count});
    push(&mut doc["accessors"], accessor)
}

pub(crate) fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

pub(crate) fn read(doc: &Value) -> Result<Model, String> {
    read_bytes("plant.gltf", &serde_json::to_vec(doc).unwrap())
}

pub(crate) fn read_bytes(name: &str, bytes: &[u8]) -> Result<Model, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    load(&path, &LoadOptions::default()).map_err(|e| {
        assert_eq!(e.exit_code(), 2);
        let text = e.to_string();
        let prefix = format!("{}: ", path.display());
        text.strip_prefix(&prefix)
            .expect("the message begins with the file")
            .to_owned()
    })
}
