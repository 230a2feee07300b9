//! Small documents for the tests of reading models.

use std::path::PathBuf;

use base64::Engine as _;
use serde_json::{Value, json};
use umbrage::scene::Model;
use umbrage::scene::import::{LoadOptions, from_bytes};

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
    // No file of a test's own: damaged names must find nothing.
    let path = PathBuf::from("/nowhere").join(name);
    from_bytes(bytes, &path, &LoadOptions::default()).map_err(|e| {
        assert_eq!(e.exit_code(), 2);
        let text = e.to_string();
        let prefix = format!("{}: ", path.display());
        text.strip_prefix(&prefix)
            .expect("the message begins with the file")
            .to_owned()
    })
}

/// A document that uses every feature the reader knows, for tests that break it at random.
pub(crate) fn everything() -> Value {
    let mut doc = triangle();
    let normals = add(
        &mut doc,
        &floats(&[0., 0., 1., 0., 0., 1., 0., 0., 1.]),
        5126,
        "VEC3",
        3,
    );
    let bytes: Vec<u8> = [1u16, 2, 3, 4, 5, 6]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let uv = add(&mut doc, &bytes, 5123, "VEC2", 3);
    doc["accessors"][uv]["normalized"] = json!(true);
    let colors = add(&mut doc, &[255; 12], 5121, "VEC4", 3);
    doc["accessors"][colors]["normalized"] = json!(true);
    let ambient = add(&mut doc, &floats(&[0.1, 0.2, 0.3]), 5126, "SCALAR", 3);
    let places = add(
        &mut doc,
        &floats(&[0., 1., 2., 3., 4., 5.]),
        5126,
        "VEC3",
        2,
    );
    let turns = add(&mut doc, &[0, 0, 0, 127, 0, 127, 0, 0], 5120, "VEC4", 2);
    doc["accessors"][turns]["normalized"] = json!(true);
    let at = add(&mut doc, &[1, 0, 0, 0], 5121, "SCALAR", 1);
    let view = |doc: &Value, a: usize| doc["accessors"][a]["bufferView"].clone();
    doc["accessors"][0]["sparse"] = json!({
        "count": 1, "indices": {"bufferView": view(&doc, at), "componentType": 5121},
        "values": {"bufferView": view(&doc, normals)}});
    let png = umbrage::scene::textures::encode_png(1, 1, &[1, 2, 3, 4]).unwrap();
    let uri = data_uri(&png).replace("application/octet-stream", "image/png");
    doc["images"] = json!([{"uri": uri}, {"bufferView": 0, "mimeType": "image/png"}]);
    doc["samplers"] = json!([{"wrapS": 33071, "magFilter": 9728}]);
    doc["textures"] = json!([{"source": 0, "sampler": 0}, {"source": 1}]);
    let info = json!({"index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform":
        {"offset": [0, 1], "rotation": 0.5, "scale": [1, 2], "texCoord": 0}}});
    doc["materials"] = json!([
        {"name": "leaf", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.5,
         "pbrMetallicRoughness": {"baseColorTexture": info, "baseColorFactor": [1, 1, 1, 1]},
         "occlusionTexture": {"index": 1, "strength": 0.5}, "extras": {"a": 1},
         "extensions": {"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.5,
             "diffuseTransmissionColorTexture": {"index": 0}}}},
        {"emissiveFactor": [1, 0, 0], "extensions": {
             "KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [1, 1, 1, 1]},
             "KHR_materials_emissive_strength": {"emissiveStrength": 2}}}]);
    doc["meshes"] = json!([{"primitives": [
        {"attributes": {"POSITION": 0, "NORMAL": normals, "TEXCOORD_0": uv, "TEXCOORD_1": uv,
             "COLOR_0": colors, "_AMBIENT": ambient}, "indices": 1, "material": 0,
         "targets": [{"POSITION": normals}]},
        {"attributes": {"POSITION": 0}, "mode": 5, "material": 1},
        {"attributes": {"POSITION": 0}, "mode": 1}]}]);
    doc["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing", "KHR_lights_punctual"]);
    doc["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "color": [1, 1, 1], "spot": {"innerConeAngle": 0.1}}]}});
    doc["nodes"] = json!([
        {"children": [1, 2, 3], "rotation": [0, 0, 0, 1], "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]},
        {"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places, "ROTATION": turns}}}},
        {"mesh": 0, "scale": [1, 2, 3], "extensions": {"KHR_node_visibility": {"visible": true}}}]);
    doc["scene"] = json!(0);
    doc
}
