//! `umbrage leaf` as a user runs it.

use umbrage::leaf::Face;
use umbrage::leaf::species::LeafSpecies;
use umbrage::scene::float_image::FloatImage;

use crate::place::{Place, stdout};

#[test]
fn leaf_slab_prints_what_the_solver_finds() {
    let place = Place::new();
    let json = place.json(&["leaf", "slab", "--omega", "0.9", "--delta", "1"]);
    let near = |key: &str, value: f64| {
        let found = json[key].as_f64().unwrap();
        assert!((found - value).abs() < 1e-6, "{key}: {found}");
    };
    near("rho_d", 0.267_410);
    near("t_diff", 0.223_746);
    near("t_dir", (-1.0_f64).exp());
    near("A", 2.0 * 0.267_410_3 / 0.9);
    let diffuse = place.json(&["leaf", "slab", "--omega", "1", "--delta", "10", "--diffuse"]);
    assert_eq!(diffuse["incidence"], "diffuse");
    for (bad, word) in [
        (["--omega", "1.5", "--delta", "1"], "1.5"),
        (["--omega", "-1", "--delta", "1"], "-1"),
        (["--omega", "0.5", "--delta", "-2"], "-2"),
    ] {
        place.assert_refused(&[&["leaf", "slab"], &bad[..]].concat(), &[word]);
    }
}

#[test]
fn leaf_species_shows_and_edits() {
    let place = Place::new();
    let list = place.json(&["leaf", "species"]);
    assert!(list["species"].as_array().unwrap().len() >= 10);
    let json = place.json(&[
        "leaf", "show", "birch", "-o", "b.png", "--sheet", "front", "--size", "64",
    ]);
    assert_eq!((&json["width"], &json["height"]), (&64.into(), &64.into()));
    let json = place.json(&[
        "leaf",
        "edit",
        "birch",
        "--size",
        "32x24",
        "--thickness",
        "2x",
        "--sigma-a",
        "1x,2x,1x",
        "-o",
        "thick.toml",
    ]);
    assert_eq!(json["thickness_mm"], 0.34);
    assert_eq!(json["redo"]["visibility"], false);
    assert!(place.path("thick.lower.specular.png").exists());
    let green =
        |json: &serde_json::Value, which: &str| json[which][0]["rho_t"][1].as_f64().unwrap();
    assert!(green(&json, "is") < 0.3 * green(&json, "was"));
    // What was written is read again.
    let json = place.json(&[
        "leaf",
        "edit",
        "thick.toml",
        "--maps",
        "exr",
        "-o",
        "again.toml",
    ]);
    let change = green(&json, "is") / green(&json, "was");
    assert!((change - 1.0).abs() < 1e-3, "{change}");
    place.assert_refused(
        &["leaf", "edit", "birch", "-o", "x.txt"],
        &["x.txt", ".toml"],
    );
    place.assert_refused(
        &["leaf", "edit", "cactus", "-o", "x.toml"],
        &["cactus", "birch"],
    );
    place.assert_refused(
        &["leaf", "edit", "birch", "--thickness", "-1", "-o", "x.toml"],
        &["-1", ">= 0"],
    );
    place.assert_refused(
        &["leaf", "edit", "birch", "--size", "0x4", "-o", "x.toml"],
        &["0x4"],
    );
    place.assert_refused(
        &["leaf", "show", "grow:lime", "-o", "x.png"],
        &["--material", "bark"],
    );
}

#[test]
fn leaf_edit_writes_a_model() {
    let place = Place::new();
    place.json(&[
        "leaf",
        "edit",
        "maple",
        "--size",
        "32x32",
        "-o",
        "maple.glb",
    ]);
    let info = place.umbrage(&["info", "maple.glb"]);
    assert_eq!(info.status.code(), Some(0), "{}", stdout(&info));
    place.json(&[
        "leaf",
        "show",
        "maple.glb",
        "--material",
        "maple",
        "--sheet",
        "back",
        "--size",
        "32",
        "-o",
        "m.png",
    ]);
}

/// Images of a known leaf on disk, fitted by the program.
#[test]
fn leaf_fit_finds_a_leaf_in_images() {
    let place = Place::new();
    let leaf = LeafSpecies::parse("goldenrod").unwrap().drawn([48, 48]);
    let sampler = leaf.sampler(Face::Upper);
    let image = |value: &dyn Fn(usize) -> [f32; 3]| FloatImage {
        width: 48,
        height: 48,
        pixels: (0..48 * 48)
            .map(|i| {
                let [r, g, b] = value(i);
                [r, g, b, leaf.coverage(i)]
            })
            .collect(),
    };
    let reflectance = image(&|i| sampler.of(i).rho_d);
    let r = place.write("r.exr", reflectance.to_exr().unwrap());
    let t = place.write("t.exr", image(&|i| sampler.of(i).rho_t).to_exr().unwrap());
    let m = place.write(
        "m.png",
        image(&|i| [leaf.coverage(i); 3]).to_png16().unwrap(),
    );
    let arguments = [
        "leaf",
        "fit",
        "--reflectance-upper",
        &r,
        "--transmittance",
        &t,
        "--mask",
        &m,
        "--thickness",
        "0.2",
        "-o",
        "leaf.toml",
        "--residuals",
        "left.png",
        "--maps",
        "exr",
    ];
    let json = place.json(&arguments);
    let omega = json["tissue"]["upper"]["omega"][1].as_f64().unwrap();
    assert!((omega - leaf.upper.omega(1)).abs() < 0.03, "{omega}");
    let rms = json["sides"][0]["rms_transmittance"][1].as_f64().unwrap();
    assert!(rms < 0.004, "{rms}");
    assert!(place.path("left.png").exists() && place.path("leaf.upper.gamma_delta.exr").exists());
    place.json(&[
        "leaf",
        "show",
        "leaf.toml",
        "-o",
        "s.png",
        "--sheet",
        "back",
        "--size",
        "48",
    ]);
    // The alpha of the reflectance serves as the mask.
    let without: Vec<&str> = arguments
        .iter()
        .copied()
        .filter(|a| *a != "--mask" && *a != m)
        .collect();
    place.json(&without);
    let small = FloatImage {
        width: 4,
        height: 4,
        pixels: vec![[0.1, 0.1, 0.1, 1.0]; 16],
    };
    let s = place.write("small.png", small.to_png16().unwrap());
    let refused = |change: &[(&str, &str)], words: &[&str]| {
        let mut arguments = arguments.to_vec();
        arguments[11] = "other.toml";
        arguments[13] = "other.png";
        for (option, value) in change {
            let at = arguments.iter().position(|a| a == option).unwrap();
            arguments[at + 1] = value;
        }
        place.assert_refused(&arguments, words);
    };
    refused(&[("--transmittance", &s)], &["small.png", "4x4", "48x48"]);
    refused(&[("--thickness", "-1")], &["thickness", "-1"]);
    refused(&[("--transmittance", "none.png")], &["none.png"]);
    place.assert_refused(
        &[
            "leaf",
            "fit",
            "--reflectance-upper",
            &s,
            "--transmittance",
            &s,
            "-o",
            "x.toml",
        ],
        &["--mask"],
    );
}
