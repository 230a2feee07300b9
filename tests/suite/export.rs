//! Writing models: what a bake does not change stays, what it changes comes back.

use std::path::{Path, PathBuf};

use glam::{DAffine3, DMat3, DVec3, Vec3};
use serde_json::{Value, json};
use umbrage::scene::export::{
    BackFaces, BakedPart, Channel, ExportOptions, SurfaceMesh, gltf, surface,
};
use umbrage::scene::grow::{GrowOptions, Species, grow};
use umbrage::scene::import::{LoadOptions, load};
use umbrage::scene::{AlphaMode, Geometry, ImageSource, Model, textures};

use crate::model_fixture::shared;

fn open(path: impl AsRef<Path>) -> Model {
    load(path, &LoadOptions::default()).unwrap()
}

/// Reads a GLB from memory, and its JSON.
fn reopen(glb: &[u8]) -> (Model, Value) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("baked.glb");
    std::fs::write(&path, glb).unwrap();
    let model = open(&path);
    let json = model.source.as_ref().unwrap().json.clone();
    (model, json)
}

/// A stand-in for a bake: radial normals, ambient from the height.
fn stand_in(model: &Model) -> (Geometry, Vec<Vec3>, Vec<f32>, Vec<BakedPart>) {
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
fn encodings() -> Vec<(&'static str, ExportOptions)> {
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

/// Asserts that everything of `old` is in `new`, but for the members that `may_change` allows
/// (by JSON pointer).
fn assert_kept(old: &Value, new: &Value, at: &str, may_change: &dyn Fn(&str) -> bool) {
    if may_change(at) {
        return;
    }
    match (old, new) {
        (Value::Object(a), Value::Object(b)) => {
            for (k, v) in a {
                let at = format!("{at}/{k}");
                if !may_change(&at) {
                    let other = b.get(k).unwrap_or_else(|| panic!("{at} is gone"));
                    assert_kept(v, other, &at, may_change);
                }
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            assert!(b.len() >= a.len(), "{at} is shorter");
            for (i, (x, y)) in a.iter().zip(b).enumerate() {
                assert_kept(x, y, &format!("{at}/{i}"), may_change);
            }
        }
        _ => assert_eq!(old, new, "{at}"),
    }
}

#[test]
fn a_baked_tree_keeps_everything_else_and_gives_the_bake_back() {
    for name in [
        "eztree/oak_medium.glb",
        "polyhaven/fern_02.glb",
        "coffee/coffee.glb",
    ] {
        let model = open(shared(name));
        let (g, normals, ambient, parts) = stand_in(&model);
        let glb = gltf(&model, &parts, &ExportOptions::default()).unwrap();
        let (again, json) = reopen(&glb);
        let old = &model.source.as_ref().unwrap().json;
        assert_kept(old, &json, "", &|at| at == "/buffers/0/byteLength");
        // Normals are written over the old ones; only `_AMBIENT` is new.
        let added = json["accessors"].as_array().unwrap().len()
            - old["accessors"].as_array().unwrap().len();
        assert_eq!(added, g.parts.len(), "{name}");
        for (a, b) in model.images.iter().zip(&again.images) {
            let (ImageSource::Encoded { bytes: a, .. }, ImageSource::Encoded { bytes: b, .. }) =
                (a, b)
            else {
                panic!("images stay encoded")
            };
            assert!(a == b, "{name}: an image changed");
        }
        let h = Geometry::flatten(&again);
        assert_eq!(
            (&h.positions, &h.indices, &h.texcoords),
            (&g.positions, &g.indices, &g.texcoords)
        );
        assert_eq!(h.ambient, ambient);
        for (part, baked) in g.parts.iter().zip(&parts) {
            for i in part.vertices() {
                let wanted = if baked.foliage {
                    normals[i]
                } else {
                    g.normals[i]
                };
                assert!(
                    (h.normals[i] - wanted).length() < 1e-5,
                    "{name}: normal {i}"
                );
            }
            let mark = again.materials[part.material].unflipped_back_faces;
            assert_eq!(mark, baked.foliage, "{name}");
        }
        assert!(again.warnings.is_empty(), "{:?}", again.warnings);
        assert_eq!(
            glb,
            gltf(&model, &parts, &ExportOptions::default()).unwrap()
        );
    }
}

#[test]
fn a_second_bake_replaces_the_first_without_growing_the_file() {
    let model = open(shared("eztree/oak_medium.glb"));
    for (name, options) in encodings() {
        let (_, _, _, parts) = stand_in(&model);
        let first = gltf(&model, &parts, &options).unwrap();
        let (again, _) = reopen(&first);
        let (_, _, _, mut parts) = stand_in(&again);
        for p in &mut parts {
            p.ambient = p
                .ambient
                .take()
                .map(|a| a.iter().map(|v| 1.0 - v).collect());
        }
        let second = gltf(&again, &parts, &options).unwrap();
        let (third, _) = reopen(&second);
        let reversed = Geometry::flatten(&third).ambient;
        if options.ambient_attribute {
            assert_eq!(
                &reversed[..2780],
                parts[0].ambient.as_ref().unwrap(),
                "{name}"
            );
        }
        assert_eq!(first.len(), second.len(), "{name}");
    }
}

#[test]
fn colours_occlusion_and_doubled_faces_say_what_they_should() {
    let model = open(shared("eztree/oak_medium.glb"));
    let (g, normals, ambient, parts) = stand_in(&model);
    let (_, options) = encodings().pop().unwrap();
    let (again, json) = reopen(&gltf(&model, &parts, &options).unwrap());
    let leaves = &again.meshes[1].primitives[0];
    let part = &g.parts[1];
    for (k, i) in part.vertices().enumerate() {
        assert!((leaves.colors[k][3] - ambient[i]).abs() < 1e-5);
        assert_eq!(leaves.colors[k][..3], [1.0; 3]);
        // The ramp at this coordinate, as a sampler with linear filtering reads it.
        let texel = f64::from(leaves.texcoords1[k][0]) * 256.0 - 0.5;
        assert!((texel / 255.0 - f64::from(ambient[i])).abs() < 1e-6);
    }
    let leaf = &again.materials[leaves.material];
    let (ramp, strength) = leaf.occlusion_texture.unwrap();
    assert_eq!((ramp.texcoord, strength), (1, 1.0));
    let image = textures::decode(&again.images[again.textures[ramp.texture].image]).unwrap();
    assert!((0..256).all(|x| usize::from(image.pixels[4 * x]) == x));
    assert!(!leaf.double_sided && !leaf.unflipped_back_faces);
    assert_eq!(leaf.alpha_mode, AlphaMode::Mask { cutoff: 0.5 });
    assert_eq!(leaves.indices.len(), 2 * part.index_count);
    assert_eq!(
        leaves.positions.len(),
        part.vertex_count,
        "vertices are shared"
    );
    // A doubled leaf shows a front to both sides, and both have the realigned normal.
    let (front, back) = leaves.indices.split_at(part.index_count);
    assert_eq!([front[0], front[1], front[2]], [back[0], back[2], back[1]]);
    let n = Vec3::from(leaves.normals[front[0] as usize]);
    assert!((n - normals[part.first_vertex + front[0] as usize]).length() < 1e-6);
    // The bark keeps its own material settings, with the ramp.
    assert!(json["materials"][0].get("extras").is_none());
    assert_eq!(json["materials"][0]["occlusionTexture"]["texCoord"], 1);
}

/// A leaf card used by two nodes and by three GPU instances, beside things a bake must keep.
fn crowded() -> Model {
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

#[test]
fn every_placement_gets_its_own_bake_and_shares_the_rest() {
    let model = crowded();
    assert_eq!(model.instances.len(), 5);
    let (g, normals, ambient, parts) = stand_in(&model);
    let (again, json) = reopen(&gltf(&model, &parts, &ExportOptions::default()).unwrap());
    assert_eq!(again.instances.len(), 5);
    let h = Geometry::flatten(&again);
    for i in 0..g.positions.len() {
        let world = |g: &Geometry| g.origin + g.positions[i].as_dvec3();
        assert!((world(&g) - world(&h)).length() < 1e-6);
        assert!((h.normals[i] - normals[i]).length() < 1e-5, "normal {i}");
        assert!((h.ambient[i] - ambient[i]).abs() < 1e-6);
    }
    assert_eq!(json["meshes"].as_array().unwrap().len(), 5);
    for mesh in json["meshes"].as_array().unwrap() {
        assert_eq!(
            mesh["primitives"][0]["attributes"]["POSITION"], 0,
            "positions are shared"
        );
    }
    assert_eq!(json["extensionsUsed"], json!(["ACME_wind"]));
    assert!(json.get("extensionsRequired").is_none());
    assert_eq!(json["nodes"][2]["children"], json!([3, 4, 5]));
    let kept_elsewhere = |at: &str| {
        [
            "/buffers",
            "/extensionsUsed",
            "/extensionsRequired",
            "/images/0",
            "/nodes/2",
        ]
        .iter()
        .any(|p| at.starts_with(p))
            || at.ends_with("/mesh")
            || at.ends_with("/attributes/NORMAL")
    };
    assert_kept(
        &model.source.as_ref().unwrap().json,
        &json,
        "",
        &kept_elsewhere,
    );
    assert_eq!(json["images"][0]["name"], "leaf.png");
    assert_eq!(json["images"][0]["mimeType"], "image/png");
    let bytes = |m: &Model| match &m.images[0] {
        ImageSource::Encoded { bytes, .. } => bytes.clone(),
        ImageSource::Rgba8 { .. } => panic!("still encoded"),
    };
    assert_eq!(bytes(&model), bytes(&again));
}

#[test]
fn a_model_without_a_document_is_written_whole() {
    let mut model = open(shared("quaternius/Tree_3.obj"));
    // Far away, turned, sheared: what scene files and populations can ask for.
    let shear = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 2.0]);
    let places = [
        DAffine3::from_scale_rotation_translation(
            DVec3::splat(2.0),
            glam::DQuat::from_rotation_y(1.0),
            DVec3::new(500_000.25, 0.0, 5_000_000.5),
        ),
        DAffine3::from_mat3_translation(shear, DVec3::new(500_010.0, 0.0, 5_000_000.0)),
    ];
    let original = model.instances.remove(0);
    for to_world in places {
        let mut instance = original.clone();
        instance.local_to_world = to_world;
        model.instances.push(instance);
    }
    let (g, normals, ambient, parts) = stand_in(&model);
    for (name, options) in encodings() {
        let (again, _) = reopen(&gltf(&model, &parts, &options).unwrap());
        let h = Geometry::flatten(&again);
        assert!((g.origin - h.origin).length() < 1e-3, "{name}");
        for (a, b) in g.parts.iter().zip(&h.parts) {
            let (old, new) = (&model.materials[a.material], &again.materials[b.material]);
            assert_eq!((&old.name, old.alpha_mode), (&new.name, new.alpha_mode));
            for (i, j) in a.vertices().zip(b.vertices()) {
                let apart =
                    g.origin + g.positions[i].as_dvec3() - h.origin - h.positions[j].as_dvec3();
                assert!(apart.length() < 1e-5, "{name}");
                if old.name.contains("Leaves") {
                    assert!((h.normals[j] - normals[i]).length() < 1e-5, "{name}");
                }
                if options.ambient_attribute {
                    assert!((h.ambient[j] - ambient[i]).abs() < 1e-6, "{name}");
                }
            }
        }
    }
}

#[test]
fn a_grown_plant_keeps_its_material_and_tells_its_branching_order() {
    let options = GrowOptions {
        leaves: Some(500),
        ..GrowOptions::default()
    };
    let plant = grow(Species::ALL[0], &options).unwrap();
    let (again, json) = reopen(&gltf(&plant, &[], &ExportOptions::default()).unwrap());
    assert_eq!(again.materials.len(), plant.materials.len());
    for (a, b) in plant.materials.iter().zip(&again.materials) {
        assert_eq!(
            (&a.name, a.alpha_mode, a.double_sided),
            (&b.name, b.alpha_mode, b.double_sided)
        );
        let factor =
            |m: &umbrage::scene::Material| m.diffuse_transmission.as_ref().map(|d| d.factor);
        assert_eq!(factor(a), factor(b));
        let image = |model: &Model, m: &umbrage::scene::Material| {
            let t = m.base_color_texture?.texture;
            Some(textures::decode(&model.images[model.textures[t].image]).unwrap())
        };
        assert_eq!(image(&plant, a), image(&again, b));
    }
    let (g, h) = (Geometry::flatten(&plant), Geometry::flatten(&again));
    assert_eq!((&g.indices, &g.texcoords), (&h.indices, &h.texcoords));
    for mesh in json["meshes"].as_array().unwrap() {
        for p in mesh["primitives"].as_array().unwrap() {
            assert!(p["attributes"].get("_BRANCH_ORDER").is_some());
        }
    }
}

#[test]
fn a_surface_is_a_file_of_its_own_and_bad_ones_are_refused() {
    let (positions, indices) = octahedron();
    let mesh = SurfaceMesh {
        name: "shell",
        origin: DVec3::new(1.0, 2.0, 5e6),
        positions: &positions,
        normals: &positions,
        indices: &indices,
    };
    let (model, _) = reopen(&surface(&mesh).unwrap());
    let g = Geometry::flatten(&model);
    assert_eq!(
        (g.origin, g.positions.len(), g.indices.len()),
        (mesh.origin, 6, 24)
    );
    assert!(
        surface(&SurfaceMesh {
            indices: &[],
            ..mesh
        })
        .is_err()
    );
    assert!(
        surface(&SurfaceMesh {
            indices: &[0, 1, 6],
            ..mesh
        })
        .is_err()
    );
    let bad = [Vec3::NAN; 6];
    assert!(
        surface(&SurfaceMesh {
            positions: &bad,
            ..mesh
        })
        .is_err()
    );
}

fn octahedron() -> (Vec<Vec3>, Vec<u32>) {
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

/// Files for the Khronos validator: every model with every encoding. `tests/validator/run`
/// names a folder and validates them; without it the test only checks that they are written.
#[test]
fn exports_for_the_validator() {
    let scratch = tempfile::tempdir().unwrap();
    let folder =
        std::env::var_os("UMBRAGE_EXPORTS").map_or(scratch.path().to_owned(), PathBuf::from);
    let mut models: Vec<(String, Model)> = Vec::new();
    for name in [
        "eztree/oak_medium.glb",
        "polyhaven/fern_02.glb",
        "coffee/coffee.glb",
        "cesium/tree-beech.glb",
        "quaternius/Tree_3.obj",
        "quaternius/Pine_2.obj",
    ] {
        models.push((name.replace('/', "_"), open(shared(name))));
    }
    models.push(("crowd".into(), crowded()));
    for species in Species::ALL {
        let options = GrowOptions {
            leaves: Some(1000),
            ..GrowOptions::default()
        };
        models.push((species.name().to_owned(), grow(species, &options).unwrap()));
    }
    let mut written = 0;
    for (name, model) in &models {
        let (_, _, _, parts) = stand_in(model);
        for (encoding, options) in encodings() {
            let glb = gltf(model, &parts, &options).unwrap();
            std::fs::write(folder.join(format!("{name}.{encoding}.glb")), &glb).unwrap();
            written += 1;
        }
    }
    let (positions, indices) = octahedron();
    let mesh = SurfaceMesh {
        name: "shell",
        origin: DVec3::ZERO,
        positions: &positions,
        normals: &positions,
        indices: &indices,
    };
    std::fs::write(folder.join("surface.glb"), surface(&mesh).unwrap()).unwrap();
    assert_eq!(written, models.len() * encodings().len());
}
