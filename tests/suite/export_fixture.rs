//! What the tests of writing models share: models to write, and reading back what was written.

use std::path::Path;

use glam::Vec3;
use serde_json::{Value, json};
use umbrage::scene::export::{BackFaces, BakedPart, Channel, ExportOptions};
use umbrage::scene::import::{LoadOptions, from_bytes, load};
use umbrage::scene::{Geometry, Model, textures};

pub(crate) fn open(path: impl AsRef<Path>) -> Model {
    load(path, &LoadOptions::default()).unwrap()
}

/// Reads a GLB from memory, and its JSON.
pub(crate) fn reopen(glb: &[u8]) -> (Model, Value) {
    let model = from_bytes(glb, "baked.glb", &LoadOptions::default()).unwrap();
    let json = model.source.as_ref().unwrap().json.clone();
    (model, json)
}

/// A stand-in for a bake: radial normals, ambient from the height.
pub(crate) fn stand_in(model: &Model) -> (Geometry, Vec<Vec3>, Vec<f32>, Vec<BakedPart>) {
    let g = Geometry::flatten(model);
    let normals: Vec<Vec3> = g
        .positions
        .iter()
        .map(|p| p.normalize_or(Vec3::Y))
        .collect();
    let height = g.max.y - g.min.y;
    let ambient: Vec<f32> = g
        .positions
        .iter()
        .map(|p| (p.y - g.min.y) / height)
        .collect();
    let foliage: Vec<bool> = g
        .parts
        .iter()
        .map(|p| {
            let m = &model.materials[p.material];
            m.double_sided || m.name.contains("Leaves")
        })
        .collect();
    let parts = BakedPart::split(&g, &normals, &ambient, &foliage);
    (g, normals, ambient, parts)
}

/// Every way to write a bake.
pub(crate) fn encodings() -> Vec<(&'static str, ExportOptions)> {
    let plain = ExportOptions::default();
    let all = ExportOptions {
        color_channel: Some(Channel::A),
        occlusion_texture: true,
        back_faces: BackFaces::Duplicate,
        ..plain
    };
    vec![
        ("attribute", plain),
        (
            "red",
            ExportOptions {
                color_channel: Some(Channel::R),
                ambient_attribute: false,
                back_faces: BackFaces::Flipped,
                ..plain
            },
        ),
        (
            "occlusion",
            ExportOptions {
                occlusion_texture: true,
                ..plain
            },
        ),
        (
            "duplicate",
            ExportOptions {
                back_faces: BackFaces::Duplicate,
                ..plain
            },
        ),
        ("all", all),
    ]
}

/// A leaf card used by two nodes and by three GPU instances, beside things a bake must keep.
pub(crate) fn crowded() -> Model {
    let floats = |v: &[f32]| v.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let mut bin = floats(&[
        0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 1., 0., 0., 1.,
    ]);
    bin.extend(floats(&[0., 0., 0., 5., 0., 0., 9., 0., 0.]));
    bin.extend(floats(&[0., 1.]));
    bin.extend(floats(&[0., 0., 0., 0., 1., 0.]));
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("all of it.bin"), &bin).unwrap();
    let png = textures::encode_png(1, 1, &[9, 8, 7, 0]).unwrap();
    std::fs::write(folder.path().join("leaf.png"), &png).unwrap();
    let document = json!({
        "asset": {"version": "2.0", "generator": "a forester", "extras": {"n": 1}},
        "extensionsUsed": ["EXT_mesh_gpu_instancing", "ACME_wind"],
        "extensionsRequired": ["EXT_mesh_gpu_instancing"],
        "extensions": {"ACME_wind": {"speed": 3.5}},
        "buffers": [{"uri": "all%20of%20it.bin", "byteLength": bin.len()}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 36},
            {"buffer": 0, "byteOffset": 72, "byteLength": 36},
            {"buffer": 0, "byteOffset": 108, "byteLength": 8},
            {"buffer": 0, "byteOffset": 116, "byteLength": 24}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3, "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "type": "VEC3", "count": 3},
            {"bufferView": 2, "componentType": 5126, "type": "VEC3", "count": 3},
            {"bufferView": 3, "componentType": 5126, "type": "SCALAR", "count": 2, "min": [0], "max": [1]},
            {"bufferView": 4, "componentType": 5126, "type": "VEC3", "count": 2}],
        "images": [{"uri": "leaf.png"}],
        "textures": [{"source": 0}],
        "materials": [{"name": "leaf", "doubleSided": true, "alphaMode": "MASK", "extras": {"species": "oak"},
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 0}}}],
        "meshes": [
            {"name": "card", "primitives": [{"material": 0, "attributes": {"POSITION": 0, "NORMAL": 1}}]}],
        "nodes": [
            {"name": "one", "mesh": 0, "rotation": [0, 0.6, 0, 0.8], "scale": [1, 2, 3]},
            {"name": "two", "mesh": 0, "translation": [5, 0, 0], "extras": {"tag": [1, 2]}},
            {"name": "many", "mesh": 0, "translation": [0, 0, 7],
             "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 2}}}}],
        "animations": [{"channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}],
                        "samplers": [{"input": 3, "output": 4}]}],
        "scene": 0,
        "scenes": [{"nodes": [0, 1, 2]}]
    });
    // No texture coordinates: the material's texture is legal and samples at (0, 0).
    let mut document = document;
    document["materials"][0]["pbrMetallicRoughness"] = json!({"roughnessFactor": 0.5});
    document["textures"][0]["extras"] = json!("kept");
    let path = folder.path().join("crowd.gltf");
    std::fs::write(&path, document.to_string()).unwrap();
    open(&path)
}

pub(crate) fn octahedron() -> (Vec<Vec3>, Vec<u32>) {
    let positions = [
        Vec3::X,
        Vec3::NEG_X,
        Vec3::Y,
        Vec3::NEG_Y,
        Vec3::Z,
        Vec3::NEG_Z,
    ];
    let indices = [
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    (positions.to_vec(), indices.concat())
}
