//! Writing models: what a bake does not change stays, what it changes comes back.

use std::path::PathBuf;

use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use umbrage::scene::export::{ExportOptions, SurfaceMesh, gltf, surface};
use umbrage::scene::grow::{GrowOptions, Species, grow};
use umbrage::scene::{AlphaMode, Geometry, ImageSource, Model, textures};

use crate::export_fixture::{crowded, encodings, octahedron, open, reopen, stand_in};
use crate::model_fixture::shared;

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
