//! The program as a user runs it: help, exit codes, one-line errors, no half-written files.

use serde_json::json;

use crate::place::{Place, stderr, stdout};
use crate::small_model::{SmallModel, small_tree};

/// Every command of the program.
const COMMANDS: &[&str] = &[
    "render", "bake", "surface", "grow", "info", "leaf", "bench", "conform", "settings",
    "tradeoff", "ink",
];

#[test]
fn help_names_every_command_and_gives_examples() {
    let place = Place::new();
    let help = stdout(&place.umbrage(&["--help"]));
    for command in COMMANDS {
        assert!(
            help.contains(&format!("\n  {command} ")),
            "{command} in {help}"
        );
        let output = place.umbrage(&[command, "--help"]);
        assert_eq!(output.status.code(), Some(0), "{command} --help");
        let text = stdout(&output);
        assert!(
            text.contains("\nExamples:\n"),
            "{command}: examples in {text}"
        );
        assert!(
            text.contains(&format!("\n  umbrage {command}")),
            "{command}: {text}"
        );
        assert!(
            text.contains("--device"),
            "{command}: global options in {text}"
        );
    }
}

#[test]
fn wrong_usage_is_one_line_and_exit_code_2() {
    let place = Place::new();
    place.assert_refused(&["paint"], &["paint"]);
    place.assert_refused(&["conform", "--sizzle"], &["--sizzle"]);
    place.assert_refused(&["conform", "no.such.case"], &["no.such.case"]);
    place.assert_refused(&["settings", "no-such-setting"], &["no-such-setting"]);
    place.assert_refused(&["bake", "tree.glb"], &["--output"]);
    place.assert_refused(&["grow", "cactus", "-o", "x.glb"], &["cactus", "shrub"]);
    place.assert_refused(&["grow", "shrub"], &["--output"]);
    place.assert_refused(
        &["grow", "shrub", "-o", "x.glb", "--leaves", "900000000"],
        &["leaves", "900000000"],
    );
    place.assert_refused(&["render", "grow:cactus", "-o", "x.png"], &["cactus"]);
    place.assert_refused(
        &["render", "-o", "x.png", "--view", "sideways"],
        &["sideways", "standard"],
    );
    place.assert_refused(&["--device", "no such device", "info"], &["no such device"]);
}

#[test]
fn settings_outside_their_range_are_refused_before_any_work() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    for (option, value, words) in [
        ("--rho", "0", ["--rho: ", "must be above 0, not 0"]),
        ("--rho", "-0.1", ["--rho: ", "must be above 0"]),
        ("--rho-ambient", "nan", ["--rho-ambient: ", "above 0"]),
        ("--k-min", "dark", ["--k-min: ", "is not a number"]),
        ("--cells", "1e3", ["--cells: ", "is not a whole number"]),
        ("--tau", "-1", ["tau", "0 or above"]),
        ("--cells", "0", ["cells", "3"]),
        ("--cells", "5000", ["cells", "1024"]),
        ("--normals", "sideways", ["normals", "gradient"]),
    ] {
        place.assert_refused(&["bake", &tree, "-o", "out.glb", option, value], &words);
    }
    place.assert_refused(
        &[
            "bake",
            &tree,
            "-o",
            "out.glb",
            "--cells",
            "1024",
            "--memory",
            "1",
            "--normals",
            "vertex",
        ],
        &["1 MiB"],
    );
    place.assert_refused(
        &["render", &tree, "-o", "out.png", "--size", "0x600"],
        &["size"],
    );
}

#[test]
fn files_that_are_no_models_are_refused() {
    let place = Place::new();
    place.assert_model_refused("text.glb", "this is a text", &["text.glb"]);
    place.assert_model_refused("empty.glb", "", &["empty.glb"]);
    place.assert_model_refused("text.gltf", "{ not json", &["text.gltf"]);
    place.assert_model_refused("text.xyz", "?", &["xyz"]);
    place.assert_refused(
        &["bake", "none.glb", "-o", "out.glb"],
        &["none.glb", "No such file"],
    );
    let whole = small_tree().glb();
    for length in [4, 12, 19, 40, whole.len() / 2, whole.len() - 1] {
        place.assert_model_refused("cut.glb", &whole[..length], &["cut.glb"]);
    }
}

#[test]
fn broken_models_are_refused_by_object() {
    let place = Place::new();
    let refused = |name: &str, words: &[&str], change: fn(&mut SmallModel)| {
        place.assert_model_refused(name, small_tree().with(change).glb(), words);
    };
    refused(
        "index.glb",
        &["mesh 0 primitive 0", "index[3] is 99"],
        |m| m.set_index(3, 99),
    );
    refused("nan.glb", &["POSITION", "NaN"], |m| {
        m.set_position(2, 1, f32::NAN);
    });
    refused("inf.glb", &["POSITION", "inf"], |m| {
        m.set_position(9, 0, f32::INFINITY);
    });
    refused("buffer.glb", &["gone.bin"], |m| {
        m.json["buffers"] = json!([{ "uri": "gone.bin", "byteLength": 4096 }]);
    });
    refused("image.glb", &["gone.png"], |m| {
        m.json["images"] = json!([{ "uri": "gone.png" }]);
        m.json["textures"] = json!([{ "source": 0 }]);
        m.json["materials"][0]["pbrMetallicRoughness"] =
            json!({ "baseColorTexture": { "index": 0 } });
    });
    refused("extension.glb", &["EXT_nobody_knows"], |m| {
        m.json["extensionsUsed"] = json!(["EXT_nobody_knows"]);
        m.json["extensionsRequired"] = json!(["EXT_nobody_knows"]);
    });
    refused("accessor.glb", &["accessor"], |m| {
        m.json["accessors"][0]["count"] = json!(100_000);
    });
    refused("bare.glb", &["Wood", "Bark", "--foliage"], |m| {
        m.json["materials"][0] = json!({ "name": "Wood" });
    });
}

#[test]
fn scene_files_are_checked_by_line_and_plant() {
    let place = Place::new();
    place.write("tree.glb", small_tree().glb());
    let refused = |text: &str, words: &[&str]| {
        let scene = place.write("scene.toml", text);
        let words = [&["scene.toml"], words].concat();
        place.assert_refused(&["render", &scene, "-o", "out.png"], &words);
    };
    refused("plants = []", &["plants"]);
    refused(
        "[[plants]]\nmodel = 'tree.glb'\nyow = 3",
        &["line 3", "yow"],
    );
    refused("[[plants]]\nmodel = 'none.glb'", &["plant 0", "none.glb"]);
    refused(
        "[[plants]]\nmodel = 'tree.glb'\nscale = -1",
        &["plant 0", "scale"],
    );
}

#[test]
fn unwritable_outputs_are_told_before_the_work() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    place.write("folder/file", "");
    for command in ["bake", "render"] {
        let ending = if command == "bake" { "glb" } else { "png" };
        for output in ["none/out", "folder/file/out"] {
            let output = &format!("{output}.{ending}");
            place.assert_refused(&[command, &tree, "-o", output], &[output, "output"]);
        }
        place.assert_refused(&[command, &tree, "-o", "folder"], &["folder", "output"]);
        // Told before the model is even looked for.
        let output = &format!("none/out.{ending}");
        place.assert_refused(&[command, "none.glb", "-o", output], &[output]);
    }
    place.assert_refused(&["grow", "shrub", "-o", "none/out.glb"], &["none/out.glb"]);
    // A scene goes into a folder, and a file stands in its way.
    let scene = place.write("scene.toml", "[[plants]]\nmodel = 'tree.glb'");
    place.assert_refused(&["bake", &scene, "-o", "folder/file"], &["folder/file"]);
}

#[test]
fn info_tells_what_a_drawing_takes() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let plan = |style: &str| {
        let what = ["info", &tree, "--style", style, "--size", "40x30"];
        let report = place.json(&[&what[..], &["--ink-supersample", "1"]].concat());
        report["plan"].clone()
    };
    let (lines, both) = (plan("outline"), plan("mixed"));
    let images = lines["resources"].as_array().unwrap().iter();
    let bytes: u64 = images.map(|i| i["bytes"].as_u64().unwrap()).sum();
    assert_eq!(lines["bytes"], bytes);
    assert_eq!(lines["bake"], false, "lines need no bake");
    assert_eq!(lines["passes"].as_array().unwrap().len(), 4);
    assert!(both["bytes"].as_u64().unwrap() > bytes, "{both}");
    assert!(both["passes"].as_array().unwrap().len() > 5, "{both}");
    let arguments = ["info", &tree, "--style", "no-such"];
    place.assert_refused(&arguments, &["no-such", "mixed"]);
}

#[test]
fn info_tells_facts_and_plan() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let info = place.json(&["info", &tree]);
    assert_eq!(info["model"]["vertices"], 11, "{info:#}");
    assert_eq!(info["model"]["triangles"], 5, "{info:#}");
    assert_eq!(info["model"]["foliage"]["vertices"], 8, "{info:#}");
    assert_eq!(info["model"]["materials"][0]["foliage"], true, "{info:#}");
    let bytes = |arguments: &[&str]| {
        let plan = place.json(&[&["info", tree.as_str()], arguments].concat());
        plan["plan"]["bytes"].as_u64().unwrap()
    };
    let bake = |arguments: &[&str]| {
        let info = place.json(&[&["info", tree.as_str()], arguments].concat());
        info["bake"]["bytes"].as_u64().unwrap()
    };
    assert!(
        bake(&["--ambient", "none"]) < bake(&[]),
        "no ambient field without ambient coefficients"
    );
    assert_eq!(
        place.json(&["info", &tree, "--view", "standard"])["bake"],
        serde_json::Value::Null,
        "no bake for a view without one"
    );
    let whole = bytes(&[]);
    assert!(
        bytes(&["--shadows", "off"]) < whole,
        "no shadow map without shadows"
    );
    assert!(bytes(&["--samples", "1"]) < whole, "less with one sample");
}

#[test]
fn outputs_are_what_their_names_say_and_no_input() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let scene = place.write("scene.toml", "[[plants]]\nmodel = 'tree.glb'");
    for (arguments, words) in [
        (["bake", &tree, "-o", "x.gltf"], ["x.gltf", ".glb"]),
        (["bake", &tree, "-o", "x.obj"], ["x.obj", ".glb"]),
        (["bake", &scene, "-o", "x.glb"], ["x.glb", "folder"]),
        (["surface", &tree, "-o", "x.obj"], ["x.obj", ".glb"]),
        (["grow", "shrub", "-o", "x.png"], ["x.png", ".glb"]),
        (["render", &tree, "-o", "x.bmp"], ["x.bmp", ".png or .jpg"]),
        (["bake", &tree, "-o", "./tree.glb"], ["tree.glb", "input"]),
        (["bake", &scene, "-o", "."], ["tree.glb", "input"]),
    ] {
        place.assert_refused(&arguments, &words);
    }
}

#[test]
fn damaged_images_are_named_with_their_model() {
    let place = Place::new();
    place.write("leaf.png", "no image");
    let tree = small_tree().with(|m| {
        m.json["images"] = json!([{ "uri": "leaf.png" }]);
        m.json["textures"] = json!([{ "source": 0 }]);
        m.json["materials"][0]["pbrMetallicRoughness"] =
            json!({ "baseColorTexture": { "index": 0 } });
    });
    let tree = place.write("tree.glb", tree.glb());
    place.assert_refused(
        &["render", &tree, "-o", "out.png", "--view", "standard"],
        &["tree.glb: image 0 (leaf.png): ", "neither PNG nor JPEG"],
    );
    let scene = place.write("scene.toml", "[[plants]]\nmodel = 'tree.glb'");
    place.assert_refused(
        &["render", &scene, "-o", "out.png", "--view", "standard"],
        &["leaf.png of ", "tree.glb"],
    );
}

#[test]
fn devices_are_checked_before_models_and_missing_drivers_are_told() {
    let place = Place::new();
    place.assert_refused(
        &["--device", "sundial", "bake", "none.glb", "-o", "out.glb"],
        &["--device sundial", "no such Vulkan device"],
    );
    let output = place.umbrage_without_driver(&["bake", "grow:shrub:1:50", "-o", "out.glb"]);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(text.contains("mesa-vulkan-drivers"), "{text}");
    assert!(!place.path("out.glb").exists(), "nothing is written");
}

#[test]
fn grown_plants_are_named_as_they_were_asked_for() {
    let place = Place::new();
    place.assert_refused(
        &["bake", "grow:lime:1:0", "-o", "out.glb"],
        &["grow:lime:1:0: no foliage"],
    );
}

#[test]
fn pictures_larger_than_the_device_holds_name_the_options() {
    let place = Place::new();
    place.assert_refused(
        &[
            "render",
            "grow:shrub:1:50",
            "-o",
            "x.png",
            "--view",
            "standard",
        ]
        .into_iter()
        .chain(["--size", "16384x16384"])
        .collect::<Vec<_>>(),
        &["--size 16384x16384", "--samples 4", "at most"],
    );
}

#[test]
fn cameras_that_cannot_be_say_why() {
    let place = Place::new();
    for (camera, reason) in [
        ("0,0,0/0,0,0", "same point"),
        ("25,95", "elevation 95 is not in -90..90"),
        ("25,7,0", "distance 0 is not above 0"),
        ("25", "expected AZIMUTH,ELEVATION"),
    ] {
        let arguments = ["render", "none.glb", "-o", "x.png", "--camera", camera];
        place.assert_refused(&arguments, &["--camera: ", reason]);
    }
}

#[test]
fn every_setting_has_a_range_and_an_exact_end() {
    let place = Place::new();
    let report = place.json(&["settings"]);
    let settings = report["settings"].as_array().unwrap();
    assert!(settings.len() > 40, "both tables");
    for setting in settings {
        for key in ["name", "default", "range", "help", "exact_end"] {
            let text = setting[key].as_str().unwrap();
            assert!(!text.is_empty(), "{key} of {setting:#}");
        }
        let unused = setting["table"] == "foliage" && setting["name"] == "encoding";
        assert!(!unused, "no command takes it: {setting:#}");
    }
}

#[test]
fn an_unwritable_cache_is_told_once() {
    let place = Place::new();
    let file = place.write("file", "");
    let arguments = [
        "--cache-dir",
        &file,
        "bake",
        "grow:shrub:1:50",
        "-o",
        "out.glb",
    ];
    let output = place.umbrage(&[&arguments[..], &["--cells", "8"]].concat());
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert_eq!(text.matches("cache").count(), 1, "{text}");
}

#[test]
fn a_bake_without_ambient_writes_none() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let arguments = [
        "bake",
        &tree,
        "-o",
        "out.glb",
        "--ambient",
        "none",
        "--cells",
        "8",
    ];
    assert_eq!(place.umbrage(&arguments).status.code(), Some(0), "baked");
    let bytes = std::fs::read(place.path("out.glb")).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    assert!(
        text.contains("NORMAL") && !text.contains("_AMBIENT"),
        "no attribute"
    );
}
