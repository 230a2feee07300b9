//! Damaged models: every kind of damage has a message, none is a panic.

use base64::Engine as _;
use proptest::prelude::*;
use serde_json::{Value, json};
use umbrage::scene::export::{BackFaces, BakedPart, Channel, ExportOptions, gltf};
use umbrage::scene::import::{LoadOptions, load};
use umbrage::scene::{Geometry, Model};

use crate::model_fixture::{add, everything, floats, read, read_bytes, triangle};
use crate::properties::repeatable;

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
        ("accessor 0: \"count\" is -1, not a whole number", |d| {
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
        ("node 0 \"leaf\": \"mesh\" is 4294967296, not a", |d| {
            d["nodes"][0]["mesh"] = json!(1u64 << 32); // Its low 32 bits are 0.
        }),
        (
            "node 0 \"leaf\": \"scale[1]\": invalid type: string \"x\"",
            |d| d["nodes"][0]["scale"] = json!([1, "x", 1]),
        ),
        (
            "mesh 0 \"card\": \"primitives[0].indices\": invalid type",
            |d| d["meshes"][0]["primitives"][0]["indices"] = json!("x"),
        ),
        ("node 0 \"leaf\": \"children\" is 9", |d| {
            d["nodes"][0]["children"] = json!([9]);
        }),
        ("cycle", |d| d["nodes"][0]["children"] = json!([0])),
        ("\"rotation\" has length zero", |d| {
            d["nodes"][0]["rotation"] = json!([0, 0, 0, 0]);
        }),
        (
            "\"matrix\": invalid length 1, expected an array of length 16",
            |d| {
                d["nodes"][0]["matrix"] = json!([1]);
            },
        ),
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
        (
            "material 0 \"bark\": alphaMode \"CUT\" does not exist",
            |d| {
                d["materials"] = json!([{"name": "bark", "alphaMode": "CUT"}]);
            },
        ),
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
        (b"glTF\x02\0\0\0\x00\0\0\0", "no JSON chunk"),
        (b"glTF\x02\0\0\0\xff\0\0\0", "truncated"),
        (
            b"glTF\x02\0\0\0\x18\0\0\0\xff\0\0\0JSON{}  ",
            "truncated GLB: its Json chunk has 255 bytes, and 4 are left",
        ),
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

/// What is kept without being read cannot make a file unreadable.
#[test]
fn unread_members_may_be_anything() {
    let mut doc = everything();
    doc["animations"] = json!([{"channels": [{"target": {"path": "pointer"}}]}, 7]);
    doc["cameras"] = json!(["none"]);
    doc["skins"] = json!({"x": 1e300});
    doc["extras"] = json!([1e300]);
    doc["extensions"]["ACME_wind"] = json!({"index": -1, "scale": 1e300});
    doc["accessors"][0]["min"] = json!([1e300, -1, 0]);
    let odd = [json!(5), json!("x"), json!([1, 2]), json!(null)];
    let lists = ["nodes", "meshes", "materials", "textures", "accessors"];
    for (list, extras) in lists.iter().zip(odd.iter().cycle()) {
        doc[list][0]["extras"] = extras.clone();
    }
    let model = read(&doc).unwrap();
    bake_and_read_again(&model).unwrap();
    assert_eq!(
        model.source.unwrap().json["materials"][0]["extras"],
        odd[2],
        "kept as it was"
    );
}

#[test]
fn the_document_of_the_properties_is_whole() {
    let model = read(&everything()).unwrap();
    assert_eq!((model.instances.len(), model.lights.len()), (4, 1));
    assert_eq!(model.meshes[0].primitives.len(), 2);
    bake_and_read_again(&model).unwrap();
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

/// JSON pointers to every value in `v` but the root.
fn pointers(v: &Value, at: String, out: &mut Vec<String>) {
    match v {
        Value::Object(members) => {
            for (k, member) in members {
                pointers(member, format!("{at}/{}", k.replace('/', "~1")), out);
            }
        }
        Value::Array(list) => {
            for (i, member) in list.iter().enumerate() {
                pointers(member, format!("{at}/{i}"), out);
            }
        }
        _ => {}
    }
    if !at.is_empty() {
        out.push(at);
    }
}

/// Whatever was read can be written with every encoding, and read again.
fn bake_and_read_again(model: &Model) -> Result<(), TestCaseError> {
    let g = Geometry::flatten(model);
    let foliage = vec![true; g.parts.len()];
    let parts = BakedPart::split(&g, &g.normals, &g.ambient, &foliage);
    let options = ExportOptions {
        color_channel: Some(Channel::G),
        occlusion_texture: true,
        back_faces: BackFaces::Duplicate,
        ..ExportOptions::default()
    };
    let glb = gltf(model, &parts, &options).unwrap();
    let again = read_bytes("again.glb", &glb);
    prop_assert!(again.is_ok(), "{:?}", again.err());
    Ok(())
}

/// Values that no member expects everywhere.
fn wrong_values() -> [Value; 26] {
    [
        json!(null),
        json!(true),
        json!(-1),
        json!(0),
        json!(1),
        json!(2),
        json!(3.0),
        json!(0.5),
        json!(7),
        json!(255),
        json!(65535),
        json!(4_294_967_295u64),
        json!(u64::MAX),
        json!(1e300),
        json!("x"),
        json!([]),
        json!([0]),
        json!([0, 0, 0, 0]),
        json!({}),
        json!({"index": 0}),
        json!(5120),
        json!(5123),
        json!(5125),
        json!(5126),
        json!("VEC3"),
        json!("MAT4"),
    ]
}

/// Every wrong value in every place, one at a time.
#[test]
fn no_single_wrong_value_makes_a_file_that_cannot_be_read_again() {
    let whole = everything();
    let mut places = Vec::new();
    pointers(&whole, String::new(), &mut places);
    let (mut tried, mut readable) = (0, 0);
    for place in &places {
        for value in wrong_values() {
            let mut doc = whole.clone();
            *doc.pointer_mut(place).unwrap() = value.clone();
            tried += 1;
            if let Ok(model) = read(&doc) {
                readable += 1;
                bake_and_read_again(&model).unwrap_or_else(|e| panic!("{place} = {value}: {e}"));
            }
        }
    }
    assert!(readable > tried / 10, "{readable} of {tried} were read");
}

proptest! {
    #![proptest_config(repeatable(600))]

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
            bake_and_read_again(&model)?;
        }
    }

    /// Wrong values in the JSON reach every check; whatever is still read can be baked.
    #[test]
    fn no_wrong_value_makes_reader_or_writer_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>()), 1..4),
    ) {
        let mut doc = everything();
        for (place, value) in changes {
            let mut places = Vec::new();
            pointers(&doc, String::new(), &mut places);
            let place = &places[place.index(places.len())];
            let values = wrong_values();
            *doc.pointer_mut(place).unwrap() = values[value.index(values.len())].clone();
        }
        if let Ok(model) = read(&doc) {
            bake_and_read_again(&model)?;
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
