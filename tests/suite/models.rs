//! Reading models: real ones with known counts, every kind of damage with its message.

use std::path::PathBuf;

use base64::Engine as _;
use glam::{DVec3, Vec3};
use proptest::prelude::*;
use serde_json::{Value, json};
use umbrage::scene::import::{LoadOptions, load};
use umbrage::scene::{AlphaMode, Geometry, LightKind, Model, textures};

fn shared(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/models")
        .join(name);
    assert!(path.is_file(), "{} is missing", path.display());
    path
}

fn real(name: &str) -> Model {
    load(shared(name), &LoadOptions::default()).unwrap()
}

/// Vertices and triangles of the primitives with material `material`.
fn counts(model: &Model, material: &str) -> (usize, usize) {
    let g = Geometry::flatten(model);
    let parts = g.parts.iter();
    let mine = parts.filter(|p| model.materials[p.material].name == material);
    mine.fold((0, 0), |(v, t), p| {
        (v + p.vertex_count, t + p.index_count / 3)
    })
}

#[test]
fn real_trees_have_the_counts_their_makers_wrote() {
    let oak = real("eztree/oak_medium.glb");
    assert_eq!(counts(&oak, "leaf"), (21_280, 10_640));
    assert_eq!(counts(&oak, "bark"), (2_780, 3_166));
    let leaf = oak.materials.iter().find(|m| m.name == "leaf").unwrap();
    assert!(leaf.double_sided && leaf.alpha_mode == AlphaMode::Mask { cutoff: 0.5 });
    let texture = leaf.base_color_texture.unwrap();
    let image = textures::decode(&oak.images[oak.textures[texture.texture].image]).unwrap();
    assert!(
        image.pixels.chunks(4).any(|p| p[3] == 0),
        "leaf images have holes"
    );
    assert_eq!(
        counts(&real("eztree/oak_medium_dense.glb"), "leaf").0,
        162_400
    );
    assert_eq!(counts(&real("coffee/coffee.glb"), "wood"), (92_650, 92_650));
    assert_eq!(counts(&real("coffee/coffee.glb"), "leaf").0, 23_969);
    let fern = real("polyhaven/fern_02.glb");
    assert_eq!((fern.meshes.len(), fern.instances.len()), (4, 4));
    assert_eq!(fern.meshes[0].primitives[0].positions.len(), 1660);
    let moved = fern.instances[3].local_to_world.translation;
    assert!((moved - DVec3::new(1.0, 0.0, 1.0)).length() < 1e-5);
    let beech = real("cesium/tree-beech.glb");
    assert_eq!(beech.meshes[0].primitives[0].positions.len(), 480);
    for m in [&oak, &fern, &beech] {
        assert!(m.warnings.is_empty(), "{:?}", m.warnings);
    }
}

#[test]
fn a_real_obj_is_read_with_its_textures_found_by_name() {
    let tree = real("quaternius/Tree_3.obj");
    let names: Vec<&str> = tree.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["Bark", "Tree_Leaves"]);
    let image = |m: usize| {
        let t = tree.materials[m].base_color_texture.unwrap().texture;
        format!("{:?}", tree.images[tree.textures[t].image])
    };
    assert!(image(0).contains("Tree_Bark.jpg") && image(1).contains("Tree_Leaves.png"));
    assert!(tree.materials[1].double_sided && !tree.materials[0].double_sided);
    assert_eq!(
        tree.materials[1].alpha_mode,
        AlphaMode::Mask { cutoff: 0.5 }
    );
    assert_eq!(tree.materials[0].alpha_mode, AlphaMode::Opaque);
    let text = std::fs::read_to_string(shared("quaternius/Tree_3.obj")).unwrap();
    let faces = text.lines().filter(|l| l.starts_with("f "));
    let triangles: usize = faces.map(|l| l.split_whitespace().count() - 3).sum();
    let bark = counts(&tree, "Bark").1;
    assert_eq!(bark + counts(&tree, "Tree_Leaves").1, triangles);
    for name in ["quaternius/Birch_1.obj", "quaternius/Pine_2.obj"] {
        let m = real(name);
        assert!(
            m.materials.iter().all(|m| m.base_color_texture.is_some()),
            "{name}"
        );
        assert!(m.warnings.is_empty(), "{name}: {:?}", m.warnings);
    }
}

/// A document of one triangle; tests change a member and look what happens.
fn triangle() -> Value {
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

fn data_uri(bytes: &[u8]) -> String {
    let text = base64::engine::general_purpose::STANDARD.encode(bytes);
    format!("data:application/octet-stream;base64,{text}")
}

/// Adds a buffer with `bytes`, a view and an accessor over it; the accessor's index.
fn add(doc: &mut Value, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
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

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn read(doc: &Value) -> Result<Model, String> {
    read_bytes("plant.gltf", &serde_json::to_vec(doc).unwrap())
}

fn read_bytes(name: &str, bytes: &[u8]) -> Result<Model, String> {
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

#[test]
fn every_damage_has_a_message_that_names_the_object() {
    type Damage = fn(&mut Value);
    let cases: &[(&str, Damage)] = &[
        ("asset.version", |d| d["asset"] = json!({})),
        ("glTF version 1.0", |d| d["asset"]["version"] = json!("1.0")),
        (
            "mesh 0 \"card\" primitive 0: index[2] is 2, but there are 2",
            |d| {
                d["accessors"][0]["count"] = json!(2);
            },
        ),
        (
            "mesh 0 \"card\" primitive 0: POSITION: accessor 0: 9 elements from byte 0 on pass the end",
            |d| {
                d["accessors"][0]["count"] = json!(9);
            },
        ),
        ("pass the end", |d| {
            d["accessors"][0]["count"] = json!(u64::MAX / 6);
        }),
        ("accessor 0: \"count\" is -1", |d| {
            d["accessors"][0]["count"] = json!(-1);
        }),
        (
            "bufferView 0: bytes 36 + 36 pass the end of buffer 0",
            |d| {
                d["bufferViews"][0]["byteOffset"] = json!(36);
            },
        ),
        ("bufferView 0: bytes", |d| {
            d["bufferViews"][0]["byteOffset"] = json!(u64::MAX);
        }),
        ("byteStride 8 is below", |d| {
            d["bufferViews"][0]["byteStride"] = json!(8);
        }),
        ("buffer 0: needs 400 bytes, there are 40", |d| {
            d["buffers"][0]["byteLength"] = json!(400);
        }),
        ("buffer 0: cannot read", |d| {
            d["buffers"][0]["uri"] = json!("gone%20away.bin");
        }),
        ("gone away.bin", |d| {
            d["buffers"][0]["uri"] = json!("gone%20away.bin");
        }),
        ("buffer 0: has no uri", |d| {
            d["buffers"][0] = json!({"byteLength": 40});
        }),
        ("image 0 \"oak\": cannot read", |d| {
            d["images"] = json!([{"name": "oak", "uri": "oak.png"}]);
        }),
        ("image 0: \"bufferView\" is 7, but there are 2", |d| {
            d["images"] = json!([{"bufferView": 7}]);
        }),
        ("node 0 \"leaf\": \"mesh\" is 4, but there are 1", |d| {
            d["nodes"][0]["mesh"] = json!(4);
        }),
        ("node 0 \"leaf\": \"children\" is 9", |d| {
            d["nodes"][0]["children"] = json!([9]);
        }),
        ("cycle", |d| d["nodes"][0]["children"] = json!([0])),
        ("\"rotation\" has length zero", |d| {
            d["nodes"][0]["rotation"] = json!([0, 0, 0, 0]);
        }),
        ("\"matrix\" is not a list of 16", |d| {
            d["nodes"][0]["matrix"] = json!([1]);
        }),
        ("not a number in range", |d| {
            d["nodes"][0]["scale"] = json!([1, 1, 1e300]);
        }),
        ("reaches to", |d| {
            d["nodes"][0]["scale"] = json!([1e30, 1, 1]);
        }),
        ("mode 7 does not exist", |d| {
            d["meshes"][0]["primitives"][0]["mode"] = json!(7);
        }),
        ("no triangles", |d| {
            d["meshes"][0]["primitives"][0]["mode"] = json!(0);
        }),
        ("no triangles", |d| d["nodes"] = json!([{}])),
        ("floats cannot be indices", |d| {
            d["meshes"][0]["primitives"][0]["indices"] = json!(0);
        }),
        (
            "primitive 0: NORMAL: accessor 1: has 1 components, not 3",
            |d| {
                d["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(1);
            },
        ),
        ("componentType 5124", |d| {
            d["accessors"][0]["componentType"] = json!(5124);
        }),
        ("\"meshes\" is not an array", |d| d["meshes"] = json!(3)),
        ("requires the unknown extension ACME_leaf", |d| {
            d["extensionsRequired"] = json!(["ACME_leaf"]);
        }),
        ("KHR_draco_mesh_compression", |d| {
            d["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
        }),
        ("material 0 \"bark\": alphaMode CUT", |d| {
            d["materials"] = json!([{"name": "bark", "alphaMode": "CUT"}]);
        }),
        (
            "material 0: baseColorTexture: \"index\" is 0, but there are 0",
            |d| {
                d["materials"] =
                    json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
            },
        ),
    ];
    for (message, damage) in cases {
        let mut doc = triangle();
        damage(&mut doc);
        let e = read(&doc).expect_err(message);
        assert!(e.contains(message), "wanted \"{message}\", got \"{e}\"");
    }
    for (bytes, message) in [
        (&b""[..], "empty"),
        (b"hello", "neither glTF"),
        (b"{\"asset\":", "the JSON is damaged"),
        (b"glTF\x01\0\0\0\x0c\0\0\0", "container version 1"),
        (b"glTF\x02\0\0\0\x0c\0\0\0", "no JSON chunk"),
        (b"glTF\x02\0\0\0\xff\0\0\0", "truncated"),
    ] {
        let e = read_bytes("plant.glb", bytes).unwrap_err();
        assert!(e.contains(message), "{e}");
    }
    let missing = load("/nowhere/oak.glb", &LoadOptions::default()).unwrap_err();
    assert!(
        missing
            .to_string()
            .starts_with("/nowhere/oak.glb: cannot read")
    );
}

#[test]
fn positions_that_are_not_finite_are_named() {
    for (value, word) in [(f32::NAN, "NaN"), (f32::INFINITY, "infinite")] {
        let mut doc = triangle();
        let bytes = floats(&[0., 0., 0., 1., 0., 0., 0., value, 0.]);
        doc["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
            json!(add(&mut doc, &bytes, 5126, "VEC3", 3));
        let e = read(&doc).unwrap_err();
        assert!(
            e.contains(&format!(
                "mesh 0 \"card\" primitive 0: POSITION[2] is {word}"
            )),
            "{e}"
        );
    }
}

#[test]
fn attributes_of_every_kind_are_read() {
    let mut doc = triangle();
    let normals = add(
        &mut doc,
        &floats(&[0., 0., 0., 0., 0., 9., f32::NAN, 0., 0.]),
        5126,
        "VEC3",
        3,
    );
    let uv: Vec<u8> = [0u16, 65535, 32768, 0, 0, 0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let uv = add(&mut doc, &uv, 5123, "VEC2", 3);
    doc["accessors"][uv]["normalized"] = json!(true);
    let colors = add(
        &mut doc,
        &[255, 0, 51, 0, 255, 255, 0, 0, 0],
        5121,
        "VEC3",
        3,
    );
    doc["accessors"][colors]["normalized"] = json!(true);
    let ambient = add(&mut doc, &floats(&[0.25, 2.0, f32::NAN]), 5126, "SCALAR", 3);
    let attributes = &mut doc["meshes"][0]["primitives"][0]["attributes"];
    attributes["NORMAL"] = json!(normals);
    attributes["TEXCOORD_0"] = json!(uv);
    attributes["TEXCOORD_1"] = json!(uv);
    attributes["COLOR_0"] = json!(colors);
    attributes["_AMBIENT"] = json!(ambient);
    let model = read(&doc).unwrap();
    let p = &model.meshes[0].primitives[0];
    assert_eq!(p.normals, [[0.0; 3], [0.0, 0.0, 1.0], [0.0; 3]]);
    assert_eq!(p.texcoords[0], [0.0, 1.0]);
    assert_eq!(p.texcoords1.len(), 3);
    assert_eq!(p.colors[0], [1.0, 0.0, 0.2, 1.0]);
    assert_eq!(p.ambient, [0.25, 1.0, 1.0]);
    assert_eq!(model.materials.len(), 1, "the default material is appended");
    let told = model.warnings.join("; ");
    assert!(
        told.contains("2 normals") && told.contains("1 texture coordinates or colours"),
        "{told}"
    );
    let g = Geometry::flatten(&model);
    assert!(g.normals.iter().all(|n| n.is_normalized()));
    assert_eq!(g.ambient, [0.25, 1.0, 1.0]);
}

#[test]
fn points_and_lines_are_counted_and_left_out_strips_become_triangles() {
    let mut doc = triangle();
    let strip = add(&mut doc, &[0, 1, 2, 0, 1], 5121, "SCALAR", 5);
    let list = doc["meshes"][0]["primitives"].as_array_mut().unwrap();
    list.insert(0, json!({"attributes": {"POSITION": 0}, "mode": 0}));
    list.push(json!({"attributes": {"POSITION": 0}, "mode": 3}));
    list.push(json!({"attributes": {"POSITION": 0}, "mode": 5, "indices": strip}));
    list.push(json!({"attributes": {"POSITION": 0}, "mode": 6, "indices": strip}));
    list.push(json!({"attributes": {"POSITION": 0}}));
    let model = read(&doc).unwrap();
    let p = &model.meshes[0].primitives;
    let shape: Vec<_> = p
        .iter()
        .map(|p| (p.source.unwrap().1, p.indices.len()))
        .collect();
    assert_eq!(shape, [(1, 3), (3, 9), (4, 9), (5, 3)]);
    assert!(
        model.warnings[0].starts_with("2 primitives of points or lines"),
        "{:?}",
        model.warnings
    );
}

#[test]
fn transforms_multiply_down_the_tree_and_mirrors_keep_fronts() {
    let mut doc = triangle();
    doc["nodes"] = json!([
        {"translation": [1, 2, 3], "children": [1]},
        {"scale": [-2, 2, 2], "children": [2]},
        {"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 10,0,0,1], "mesh": 0}]);
    let model = read(&doc).unwrap();
    let at = model.instances[0]
        .local_to_world
        .transform_point3(DVec3::ZERO);
    assert_eq!(at, DVec3::new(-19.0, 2.0, 3.0));
    let g = Geometry::flatten(&model);
    let [a, b, c] = [0, 1, 2].map(|k| g.positions[g.indices[k] as usize]);
    let face = (b - a).cross(c - a).normalize();
    assert!(
        (face - Vec3::Z).length() < 1e-6,
        "mirrored twice is not turned over: {face}"
    );
}

#[test]
fn gpu_instancing_places_every_instance_below_its_node() {
    let mut doc = triangle();
    let t = add(
        &mut doc,
        &floats(&[0., 0., 0., 5., 0., 0.]),
        5126,
        "VEC3",
        2,
    );
    let r = add(&mut doc, &[0, 0, 0, 127, 0, 127, 0, 0], 5120, "VEC4", 2);
    doc["accessors"][r]["normalized"] = json!(true);
    doc["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    doc["nodes"][0]["translation"] = json!([0, 1, 0]);
    let e = json!({"attributes": {"TRANSLATION": t, "ROTATION": r}});
    doc["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": e});
    let model = read(&doc).unwrap();
    assert_eq!(model.instances.len(), 2);
    assert_eq!(model.instances[1].source, Some((0, Some(1))));
    let tip = model.instances[1].local_to_world.transform_point3(DVec3::X);
    assert!((tip - DVec3::new(4.0, 1.0, 0.0)).length() < 1e-6, "{tip}");
    let short = add(&mut doc, &floats(&[1.0; 3]), 5126, "VEC3", 1);
    doc["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = json!(short);
    assert!(read(&doc).unwrap_err().contains("differ in count"));
}

#[test]
fn lights_and_materials_of_extensions_are_read() {
    let mut doc = triangle();
    doc["extensionsUsed"] = json!(["KHR_lights_punctual", "ACME_other"]);
    doc["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "intensity": 2, "color": [1, 0.5, 0], "range": 9,
         "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.2}}]}});
    doc["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
    doc["nodes"][0]["translation"] = json!([0, 5, 0]);
    doc["materials"] = json!([{
        "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.25, "emissiveFactor": [1, 0, 0],
        "extensions": {
            "KHR_materials_unlit": {},
            "KHR_materials_emissive_strength": {"emissiveStrength": 3},
            "KHR_materials_diffuse_transmission": {
                "diffuseTransmissionFactor": 0.4, "diffuseTransmissionColorFactor": [0.5, 1, 0]}}}]);
    doc["meshes"][0]["primitives"][0]["material"] = json!(0);
    let model = read(&doc).unwrap();
    let light = model.lights[0];
    assert_eq!(
        light.kind,
        LightKind::Spot {
            inner: 0.1,
            outer: 0.2
        }
    );
    assert_eq!((light.color, light.range), ([2.0, 1.0, 0.0], 9.0));
    assert_eq!(
        (light.position, light.direction),
        (DVec3::Y * 5.0, DVec3::NEG_Z)
    );
    let m = &model.materials[0];
    assert!(m.unlit && m.double_sided && m.alpha_mode == AlphaMode::Mask { cutoff: 0.25 });
    assert_eq!(m.emissive, [3.0, 0.0, 0.0]);
    let d = m.diffuse_transmission.as_ref().unwrap();
    assert_eq!((d.factor, d.color), (0.4, [0.5, 1.0, 0.0]));
    assert!(model.warnings[0].contains("ACME_other"));
}

#[test]
fn a_texture_given_by_name_replaces_the_files_own() {
    let folder = tempfile::tempdir().unwrap();
    let png = textures::encode_png(1, 1, &[1, 2, 3, 4]).unwrap();
    let image = folder.path().join("leaf.png");
    std::fs::write(&image, &png).unwrap();
    let mut doc = triangle();
    doc["materials"] = json!([{"name": "Leaf"}]);
    doc["meshes"][0]["primitives"][0]["material"] = json!(0);
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, doc.to_string()).unwrap();
    let with = |material: &str| {
        load(
            &path,
            &LoadOptions {
                textures: vec![(material.into(), image.clone())],
            },
        )
    };
    let model = with("Leaf").unwrap();
    let t = model.materials[0].base_color_texture.unwrap().texture;
    assert!(format!("{:?}", model.images[model.textures[t].image]).contains("leaf.png"));
    let e = with("Bark").unwrap_err().to_string();
    assert!(
        e.contains("--texture Bark") && e.contains("only Leaf"),
        "{e}"
    );
}

fn glb_of_fern() -> Vec<u8> {
    // A small but complete file: interleaved attributes, materials, textures, two nodes.
    let mut doc = triangle();
    let uri = doc["buffers"][0]["uri"].as_str().unwrap().to_owned();
    let bin = base64::engine::general_purpose::STANDARD
        .decode(uri.split_once(',').unwrap().1)
        .unwrap();
    doc["buffers"][0].as_object_mut().unwrap().remove("uri");
    doc["materials"] = json!([{"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1]}}]);
    doc["nodes"] =
        json!([{"children": [1], "scale": [1, 2, 3]}, {"mesh": 0, "rotation": [0, 0, 0, 1]}]);
    let mut text = serde_json::to_vec(&doc).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = b"glTF\x02\0\0\0".to_vec();
    let word = |n: usize| u32::try_from(n).unwrap().to_le_bytes();
    out.extend(word(28 + text.len() + bin.len()));
    out.extend(word(text.len()));
    out.extend(b"JSON");
    out.extend(&text);
    out.extend(word(bin.len()));
    out.extend(b"BIN\0");
    out.extend(&bin);
    out
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Random damage gives a model or a message, never a panic.
    #[test]
    fn no_damage_makes_the_reader_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in prop::option::weighted(0.1, any::<prop::sample::Index>()),
    ) {
        let mut glb = glb_of_fern();
        for (at, value) in changes {
            let at = at.index(glb.len());
            // Digits stay digits half of the time, so that the damage reaches beyond the JSON.
            glb[at] = if glb[at].is_ascii_digit() && value % 2 == 0 { b'0' + value % 10 } else { value };
        }
        if let Some(cut) = cut {
            glb.truncate(cut.index(glb.len()));
        }
        if let Ok(model) = read_bytes("plant.glb", &glb) {
            let g = Geometry::flatten(&model);
            prop_assert!(g.positions.iter().all(|p| p.is_finite()));
            prop_assert!(g.normals.iter().all(|n| n.is_finite()));
        }
    }

    /// The same for OBJ, made of plausible words.
    #[test]
    fn no_text_makes_the_obj_reader_panic(
        words in prop::collection::vec("(v|vt|vn|f|usemtl|o|\n|-?[0-9]{1,2}|[0-9]/-?[0-9]|1e39|nan|\\\\\n)", 0..60)
    ) {
        let _ = read_bytes("plant.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n{}", words.join(" ")).as_bytes());
    }
}
