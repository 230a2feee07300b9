//! What bad input of the light of leaves gets: one line, exit code 2, no file.

use std::process::Command;

use crate::place::{Place, stderr};
use crate::small_model::small_tree;

/// Values that no option with a range of numbers takes.
const NO_NUMBERS: [&str; 5] = ["nan", "inf", "-inf", "x", ""];

#[test]
fn numbers_of_light_outside_their_range_are_refused_by_name() {
    let place = Place::new();
    let base = ["light", "none.glb", "-o", "a.light"];
    for (option, outside) in [
        ("--paths", &["-1", "16777217"][..]),
        ("--bounces", &["0", "-1"]),
        ("--lod", &["-0.1", "1.1"]),
        ("--cube-side", &["0", "257"]),
        ("--latitude", &["-91", "100"]),
        ("--day", &["0", "367"]),
        ("--minutes", &["0", "-5", "1e-9", "721"]),
        ("--splits", &["-1", "5"]),
        ("--samples", &["0", "256"]),
        ("--offset", &["-1e-5", "1"]),
        ("--seed", &["-1"]),
        ("--max-bytes", &["-1"]),
        ("--checkpoint", &["-1", "1e9"]),
        ("--sun-radius", &["-1", "45", "90"]),
        ("--sun-direction", &["1,2", "0,nan,0"]),
        ("--reflectance", &["-0.1", "1.1", "0.1,0.2", "0,0,2"]),
        ("--reflectance-below", &["-0.1", "1.1"]),
        ("--transmittance", &["-0.1", "0,1.1,0"]),
        ("--gloss", &["-0.1", "1.1"]),
        ("--roughness", &["0", "-1", "1.1"]),
    ] {
        for value in outside.iter().chain(&NO_NUMBERS) {
            let told = format!("{option}={value}");
            place.assert_refused(&[&base[..], &[&told]].concat(), &[option]);
        }
    }
}

#[test]
fn numbers_of_lit_pictures_outside_their_range_are_refused_by_name() {
    let place = Place::new();
    let base = [
        "render",
        "none.glb",
        "-o",
        "a.png",
        "--lighting",
        "leaf",
        "--light",
        "a.light",
    ];
    for (option, outside) in [
        ("--sun-irradiance", &["-1", "1e7", "1,2"][..]),
        ("--order", &["0", "7"]),
        ("--window", &["-1", "1.1"]),
        ("--splits", &["-1", "5"]),
        ("--supersample", &["0", "9"]),
        ("--truth-samples", &["0", "65537"]),
        ("--light-exposure", &["0", "-1", "1e10"]),
        ("--difference", &["0", "-1"]),
        ("--lamp-samples", &["0", "4097"]),
        ("--lamp-points", &["0", "65"]),
        ("--repeat", &["0", "-1"]),
        ("--sun-radius", &["-1", "45"]),
    ] {
        for value in outside.iter().chain(&NO_NUMBERS) {
            let told = format!("{option}={value}");
            place.assert_refused(&[&base[..], &[&told]].concat(), &[option]);
        }
    }
}

#[test]
fn numbers_of_leaves_outside_their_range_are_refused_by_name() {
    let place = Place::new();
    let edit = ["leaf", "edit", "birch", "-o", "a.toml"];
    for (option, outside) in [
        ("--thickness", &["-1", "-2x", "nanx"][..]),
        ("--sigma-a", &["-1", "1x,2x", "1,nan,1"]),
        ("--sigma-s", &["-1", "infx"]),
        ("--gloss", &["-1", "2x"]),
        ("--roughness", &["-1"]),
        ("--size", &["0x4", "4", "-1x4", "99999999999x4"]),
    ] {
        for value in outside.iter().chain(&NO_NUMBERS) {
            let told = format!("{option}={value}");
            place.assert_refused(&[&edit[..], &[&told]].concat(), &[]);
        }
    }
    let fit = [
        "leaf",
        "fit",
        "--reflectance-upper",
        "r.png",
        "--transmittance",
        "t.png",
        "-o",
        "a.toml",
    ];
    for (option, outside) in [
        ("--thickness", &["-1", "0"][..]),
        ("--surface", &["-0.1", "0.6"]),
    ] {
        for value in outside.iter().chain(&NO_NUMBERS) {
            let told = format!("{option}={value}");
            place.assert_refused(&[&fit[..], &[&told]].concat(), &[option]);
        }
    }
    let slab = ["leaf", "slab"];
    for (omega, delta, mu0) in [
        ("1.01", "1", "1"),
        ("-0.01", "1", "1"),
        ("nan", "1", "1"),
        ("0.5", "-1", "1"),
        ("0.5", "inf", "1"),
        ("0.5", "1", "0"),
        ("0.5", "1", "1.1"),
        ("0.5", "1", "nan"),
    ] {
        let told = ["--omega", omega, "--delta", delta, "--mu0", mu0];
        place.assert_refused(&[&slab[..], &told].concat(), &[]);
    }
}

/// Told before the models are read: none of the inputs exists.
#[test]
fn outputs_of_leaves_and_light_are_checked_before_the_work() {
    let place = Place::new();
    let images = ["--reflectance-upper", "r.png", "--transmittance", "t.png"];
    place.write("folder.light/x", "");
    for (arguments, words) in [
        (
            &["light", "none.glb", "-o", "a.glb"][..],
            ["a.glb", ".light"],
        ),
        (
            &["light", "none.glb", "-o", "no/a.light"],
            ["no/a.light", "written"],
        ),
        (
            &["light", "none.glb", "-o", "folder.light"],
            ["folder.light", "is a folder"],
        ),
        (
            &["leaf", "show", "none.toml", "-o", "a.bmp"],
            ["a.bmp", ".png"],
        ),
        (
            &["leaf", "show", "none.toml", "-o", "no/a.png"],
            ["no/a.png", "written"],
        ),
        (
            &["leaf", "edit", "none.toml", "-o", "a.txt"],
            ["a.txt", ".toml"],
        ),
        (
            &["leaf", "edit", "none.toml", "-o", "no/a.toml"],
            ["no/a.toml", "written"],
        ),
        (
            &[&["leaf", "fit", "-o", "a.png"], &images[..]].concat(),
            ["a.png", ".toml"],
        ),
        (
            &[&["leaf", "fit", "-o", "no/a.toml"], &images[..]].concat(),
            ["no/a.toml", "written"],
        ),
        (
            &[
                &["leaf", "fit", "-o", "a.toml", "--residuals", "a.jpg"],
                &images[..],
            ]
            .concat(),
            ["a.jpg", ".png"],
        ),
        (
            &["render", "none.glb", "-o", "a.bmp", "--lighting", "truth"],
            ["a.bmp", ".png"],
        ),
        (
            &[
                "render",
                "none.glb",
                "-o",
                "no/a.png",
                "--lighting",
                "truth",
            ],
            ["no/a.png", "written"],
        ),
        (
            &[
                "render",
                "none.glb",
                "-o",
                "a.png",
                "--lighting",
                "truth",
                "--reference",
                "no",
            ],
            ["no_full.exr", "No such file"],
        ),
    ] {
        place.assert_refused(arguments, &words);
    }
    let residuals = ["leaf", "fit", "-o", "a.toml", "--residuals", "r.png"];
    place.write("r.png", "");
    place.assert_refused(&[&residuals[..], &images].concat(), &["r.png", "input"]);
    place.write("a.toml", "");
    let over = ["leaf", "edit", "a.toml", "-o", "a.toml"];
    place.assert_refused(&over, &["a.toml", "input"]);
}

#[test]
fn skies_that_cannot_be_are_refused() {
    use umbrage::scene::float_image::FloatImage;
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let sky = |name: &str, bad: f32| {
        let mut pixels = vec![[0.5, 0.5, 0.5, 1.0]; 8];
        pixels[3][1] = bad;
        let image = FloatImage {
            width: 4,
            height: 2,
            pixels,
        };
        place.write(name, image.to_exr().unwrap())
    };
    let (nan, negative) = (sky("nan.exr", f32::NAN), sky("negative.exr", -1.0));
    let whole = std::fs::read(sky("good.exr", 1.0)).unwrap();
    place.write("short.exr", &whole[..whole.len() / 2]);
    for (sky, words) in [
        ("constant:-1", ["constant:-1", "below 0"]),
        ("constant:nan", ["constant:nan", "three numbers or one"]),
        ("linear:1,1,1", ["linear:1,1,1", "linear:R,G,B/R,G,B"]),
        ("linear:1/2", ["linear:1/2", "below 0"]),
        ("clear:1", ["clear:1", "1.7 to 10"]),
        ("clear:nan", ["clear:nan", "1.7 to 10"]),
        ("clear:", ["clear:", "1.7 to 10"]),
        ("blue", ["blue", "environment"]),
        (&nan, ["nan.exr", "1 texels are negative or not finite"]),
        (
            &negative,
            ["negative.exr", "1 texels are negative or not finite"],
        ),
        ("short.exr", ["short.exr", "decoded"]),
        (&tree, ["tree.glb", "neither PNG, JPEG, EXR nor HDR"]),
    ] {
        let arguments = [
            "render",
            &tree,
            "-o",
            "a.png",
            "--lighting",
            "ambient",
            "--environment",
            sky,
        ];
        place.assert_refused(&arguments, &words);
    }
}

/// A sun below the horizon lights leaves from below, and that is told.
#[test]
fn a_sun_below_the_horizon_is_told() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    for lighting in ["lvc", "ambient", "truth"] {
        let output = place.umbrage(&[
            "render",
            &tree,
            "-o",
            "a.png",
            "--size",
            "32x32",
            "--lighting",
            lighting,
            "--environment",
            "clear:3",
            "--sun-direction=0.2,-1,0.1",
            "--truth-samples",
            "1",
            "--validate",
        ]);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(0), "{lighting}: {text}");
        assert!(text.contains("below the horizon"), "{lighting}: {text}");
    }
}

/// What gives back more than falls on it is scaled, and that is told.
#[test]
fn leaves_brighter_than_light_are_told() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let light = |more: &[&str]| {
        let base = ["light", &tree, "-o", "a.light", "--paths", "4"];
        let output = place.umbrage(&[&base[..], &["--directions", "none"], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        stderr(&output)
    };
    let told = light(&["--reflectance", "0.8,0.2,0.9", "--transmittance", "0.5"]);
    assert!(
        told.contains("Leaves") && told.contains("2 of 3 channels"),
        "{told}"
    );
    let told = light(&["--reflectance", "0.5", "--transmittance", "0.5"]);
    assert!(!told.contains("above 1"), "{told}");
}

/// Every number in the header of a light file made as large as can be, the checksum put right: the
/// file is refused, and nothing of that size is reserved.
#[cfg(unix)]
#[test]
fn huge_counts_in_light_files_reserve_nothing() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    place.json(&[
        "light",
        &tree,
        "-o",
        "a.light",
        "--paths",
        "4",
        "--minutes",
        "240",
        "--storage",
        "8bit",
        "--transfer",
        "both",
    ]);
    let bytes = std::fs::read(place.path("a.light")).unwrap();
    let length = u64::from_le_bytes(bytes[12..20].try_into().unwrap()) as usize;
    let header: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let blocks = &bytes[20 + length..bytes.len() - 32];
    let mut refused = 0;
    for path in numbers(&header, "") {
        for huge in [u64::from(u32::MAX), 1 << 40, u64::MAX] {
            let mut changed = header.clone();
            *changed.pointer_mut(&path).unwrap() = huge.into();
            let text = serde_json::to_vec(&changed).unwrap();
            let mut file = bytes[..12].to_vec();
            file.extend((text.len() as u64).to_le_bytes());
            file.extend(text);
            file.extend(blocks);
            let sum = blake3::hash(&file);
            file.extend(sum.as_bytes());
            place.write("huge.light", file);
            // The bound of the new light is checked after the file was read.
            let run = "ulimit -v 1000000; exec \"$0\" light tree.glb -o b.light --max-bytes 0 --keep huge.light";
            let output = Command::new("sh")
                .args(["-c", run, env!("CARGO_BIN_EXE_umbrage")])
                .current_dir(place.path(""))
                .output()
                .unwrap();
            let text = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{path} {huge}: {text}");
            refused += usize::from(text.contains("huge.light"));
        }
    }
    assert!(refused > 10, "{refused}");
}

/// Pointers to all numbers of a document, the first of each array.
#[cfg(unix)]
fn numbers(value: &serde_json::Value, at: &str) -> Vec<String> {
    use serde_json::Value;
    match value {
        Value::Number(_) => vec![at.to_owned()],
        Value::Array(a) => a
            .iter()
            .take(1)
            .flat_map(|v| numbers(v, &format!("{at}/0")))
            .collect(),
        Value::Object(o) => o
            .iter()
            .flat_map(|(k, v)| numbers(v, &format!("{at}/{k}")))
            .collect(),
        _ => Vec::new(),
    }
}

/// A bit turned or the end cut off anywhere: refused, in words.
#[test]
fn damage_anywhere_in_a_light_file_is_refused() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    place.json(&[
        "light",
        &tree,
        "-o",
        "a.light",
        "--paths",
        "4",
        "--minutes",
        "240",
        "--transfer",
        "both",
    ]);
    let bytes = std::fs::read(place.path("a.light")).unwrap();
    let step = (bytes.len() / 400).max(1);
    for at in (0..bytes.len()).step_by(step) {
        let mut turned = bytes.clone();
        turned[at] ^= 1 << (at % 8);
        let error = umbrage::leaf::light_file::decode(&turned).unwrap_err();
        assert!(error.starts_with("light: "), "{at}: {error}");
        let error = umbrage::leaf::light_file::decode(&bytes[..at]).unwrap_err();
        assert!(
            error.contains("cut short") || error.contains("checksum"),
            "{at}: {error}"
        );
    }
    assert!(umbrage::leaf::light_file::decode(&bytes).is_ok());
}
