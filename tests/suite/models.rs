//! Reading models: real ones with known counts, and every feature in a small document.

use glam::{DVec3, Vec3};
use serde_json::json;
use umbrage::scene::import::{LoadOptions, load};
use umbrage::scene::{AlphaMode, Geometry, LightKind, Model, Wrap, textures};

use crate::model_fixture::{add, data_uri, floats, read, shared, triangle};

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
    assert!(told.contains("1 texture coordinates or colours"), "{told}");
    assert!(
        !told.contains("normal"),
        "counted once, where it is repaired: {told}"
    );
    let g = Geometry::flatten(&model);
    let told = g.warnings.join("; ");
    assert!(
        told.contains("2 vertices without a usable normal"),
        "{told}"
    );
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
fn quantized_meshes_old_materials_transforms_and_visibility_are_honoured() {
    let mut doc = triangle();
    doc["extensionsRequired"] = json!(["KHR_mesh_quantization", "KHR_texture_transform"]);
    let words = |v: &[i16]| v.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    // Elements of 8 bytes: three components and padding.
    let p = words(&[0, 0, 0, 0, 32767, 0, 0, 0, 0, -32768, 0, 0]);
    let p = add(&mut doc, &p, 5122, "VEC3", 3);
    doc["accessors"][p]["normalized"] = json!(true);
    let n = add(
        &mut doc,
        &[0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 0x81, 0],
        5120,
        "VEC3",
        3,
    );
    doc["accessors"][n]["normalized"] = json!(true);
    for (accessor, stride) in [(p, 8), (n, 4)] {
        let view = doc["accessors"][accessor]["bufferView"].as_u64().unwrap() as usize;
        doc["bufferViews"][view]["byteStride"] = json!(stride);
    }
    let primitive = &mut doc["meshes"][0]["primitives"][0];
    primitive["attributes"] = json!({"POSITION": p, "NORMAL": n});
    primitive["material"] = json!(0);
    let png = textures::encode_png(1, 1, &[1, 2, 3, 4]).unwrap();
    let uri = data_uri(&png).replace("application/octet-stream", "image/png");
    doc["images"] = json!([{"uri": uri}]);
    doc["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
    doc["textures"] = json!([{"source": 0, "sampler": 0}, {"sampler": 0}]);
    let transform = json!({"KHR_texture_transform": {"offset": [0.5, 0.25], "texCoord": 1}});
    doc["materials"] = json!([{
        "emissiveTexture": {"index": 1},
        "extensions": {"KHR_materials_pbrSpecularGlossiness": {
            "diffuseFactor": [0.5, 0.25, 1, 1], "glossinessFactor": 0.25,
            "diffuseTexture": {"index": 0, "extensions": transform}}}}]);
    doc["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": false}}}]);
    doc["scenes"] = json!([{"nodes": [0, 1]}]);
    let model = read(&doc).unwrap();
    let p = &model.meshes[0].primitives[0];
    assert_eq!(p.positions, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]);
    assert_eq!(p.normals[2], [0.0, 0.0, -1.0]);
    assert_eq!(model.instances.len(), 1);
    let m = &model.materials[0];
    assert_eq!(
        (m.base_color, m.roughness, m.metallic),
        ([0.5, 0.25, 1.0, 1.0], 0.75, 0.0)
    );
    let t = m.base_color_texture.unwrap();
    assert_eq!(
        (t.texcoord, t.transform),
        (1, [[1.0, 0.0, 0.5], [0.0, 1.0, 0.25]])
    );
    let texture = model.textures[t.texture];
    assert_eq!(
        (texture.wrap_u, texture.wrap_v, texture.nearest),
        (Wrap::Clamp, Wrap::Mirror, true)
    );
    let told = model.warnings.join("; ");
    assert!(
        told.contains("1 textures without") && told.contains("1 hidden"),
        "{told}"
    );
}

/// An OBJ of one triangle with `mtl` beside it, and `files` of one pixel each.
fn obj(mtl: &str, files: &[(&str, [u8; 4])], given: &[(&str, &str)]) -> Result<Model, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("Oak_1.obj");
    std::fs::write(
        &path,
        "mtllib my oak.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl Leaf\nf 1 2 3\n",
    )
    .unwrap();
    std::fs::write(folder.path().join("my oak.mtl"), mtl).unwrap();
    for (name, pixel) in files {
        std::fs::write(
            folder.path().join(name),
            textures::encode_png(1, 1, pixel).unwrap(),
        )
        .unwrap();
    }
    let given = given
        .iter()
        .map(|(m, f)| ((*m).to_owned(), folder.path().join(f)));
    let options = LoadOptions {
        textures: given.collect(),
    };
    load(&path, &options).map_err(|e| e.to_string())
}

#[test]
fn faces_made_for_a_texture_and_textures_without_coordinates_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("Oak.obj");
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl Leaf\nf 1/1 2/1 3/1\n";
    std::fs::write(&path, text).unwrap();
    let told = load(&path, &LoadOptions::default())
        .unwrap()
        .warnings
        .join("; ");
    assert!(
        told.contains("no texture is named or found for Leaf"),
        "{told}"
    );
    let bare = obj("newmtl Leaf\nmap_Kd a.png\n", &[("a.png", [9; 4])], &[]).unwrap();
    let told = Geometry::flatten(&bare).warnings.join("; ");
    assert!(
        told.contains("1 part without the texture coordinates"),
        "{told}"
    );
}

#[test]
fn obj_textures_are_given_named_or_found() {
    const OPAQUE: [u8; 4] = [9, 9, 9, 255];
    const HOLE: [u8; 4] = [9, 9, 9, 0];
    let image = |m: &Model| {
        let t = m.materials[0].base_color_texture.unwrap().texture;
        format!("{:?}", m.images[m.textures[t].image])
    };
    let kd = "newmtl Leaf\nKd 0 1 0\nmap_Kd C:\\art\\a.png\n";
    let named = obj(kd, &[("A.png", OPAQUE), ("Oak_Leaf.png", HOLE)], &[]).unwrap();
    assert!(
        image(&named).contains("A.png"),
        "the bare name beside the model, any case"
    );
    assert_eq!(named.materials[0].base_color, [0.0, 1.0, 0.0, 1.0]);
    assert_eq!(named.materials[0].alpha_mode, AlphaMode::Opaque);
    let given = obj(kd, &[("b.png", HOLE)], &[("Leaf", "b.png")]).unwrap();
    assert!(image(&given).contains("b.png"));
    assert_eq!(given.materials[0].base_color, [1.0; 4]);
    assert!(given.materials[0].double_sided);
    let found = obj(
        "newmtl Leaf\n",
        &[("Oak_Leaf.png", HOLE), ("Elm_Leaf.png", OPAQUE)],
        &[],
    )
    .unwrap();
    assert!(image(&found).contains("Oak_Leaf.png"));
    let unsure = obj(
        "newmtl Leaf\n",
        &[("Ash_Leaf.png", HOLE), ("Elm_Leaf.png", OPAQUE)],
        &[],
    )
    .unwrap();
    assert!(
        unsure.warnings[0].contains("choose with --texture"),
        "{:?}",
        unsure.warnings
    );
    let mask = "newmtl Leaf\nmap_Kd a.png\nmap_d m.png\n";
    let cut = obj(mask, &[("a.png", OPAQUE), ("m.png", [0, 0, 0, 255])], &[]).unwrap();
    assert!(image(&cut).contains("Rgba8") && cut.materials[0].double_sided);
    let gone = obj(kd, &[], &[]).unwrap_err();
    assert!(
        gone.contains("material Leaf: the image C:/art/a.png is missing"),
        "{gone}"
    );
    let e = obj(kd, &[("a.png", OPAQUE)], &[("Bark", "a.png")]).unwrap_err();
    assert!(
        e.contains("--texture Bark") && e.contains("only Leaf"),
        "{e}"
    );
    let e = obj("newmtl Leaf\nKd x\n", &[], &[]).unwrap_err();
    assert!(e.contains("my oak.mtl: line 2: Kd"), "{e}");
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
