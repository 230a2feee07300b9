//! Pictures of drawings on paper are of the same sheet as vectors; what a file does not have is told.

use std::fs;

use crate::place::{Place, stderr, stdout};
use crate::small_model::small_tree;

fn prepared() -> Place {
    let place = Place::new();
    place.write("tree.glb", small_tree().glb());
    place
}

/// Standard output and the warnings of a drawing that succeeds, those of the model left out.
fn drawn(place: &Place, more: &[&str]) -> (String, String) {
    let line = [&["render", "tree.glb", "--style", "ds00-fig3a"], more].concat();
    let output = place.umbrage(&line);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{more:?}: {said}");
    // Of the model itself: it has no normals, and two leaves.
    let of_model = |l: &&str| l.contains("normal") || l.contains("too few for a crown");
    let own = said.lines().filter(|l| !of_model(l));
    (stdout(&output), own.collect())
}

/// Type and content of every chunk.
fn chunks(bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
    let mut at = 8;
    let mut out = Vec::new();
    while at + 8 <= bytes.len() {
        let number = |k: usize| u32::from_be_bytes(bytes[k..k + 4].try_into().unwrap());
        let length = number(at) as usize;
        let kind = String::from_utf8_lossy(&bytes[at + 4..at + 8]).into_owned();
        out.push((kind, bytes[at + 8..at + 8 + length].to_vec()));
        at += 12 + length;
    }
    out
}

#[test]
fn a_picture_is_the_sheets_free_area_at_its_resolution() {
    let place = prepared();
    let picture = |more: &[&str]| {
        drawn(&place, &[&["-o", "a.png"], more].concat());
        let chunks = chunks(&fs::read(place.path("a.png")).unwrap());
        let of = |kind: &str| {
            let found = chunks.iter().find(|c| c.0 == kind);
            found.unwrap_or_else(|| panic!("{kind}")).1.clone()
        };
        let number = |bytes: &[u8]| u32::from_be_bytes(bytes[..4].try_into().unwrap());
        let (head, dims) = (of("IHDR"), of("pHYs"));
        let text = String::from_utf8_lossy(&of("iTXt")).into_owned();
        let size = [number(&head), number(&head[4..])];
        (size, [number(&dims), number(&dims[4..])], dims[8], text)
    };
    // Margins of 12 mm, six pixels a millimetre.
    let (size, metre, unit, text) = picture(&["--paper", "60x80"]);
    assert_eq!((size, metre, unit), ([216, 336], [6000; 2], 1));
    for word in [
        "umbrage",
        "\"60x80\"",
        "tree.glb",
        "format_version",
        "\"eye\"",
    ] {
        assert!(text.contains(word), "{word}: {text:.300}");
    }
    let (size, metre, ..) = picture(&["--paper", "60x80", "--size", "72x112"]);
    assert_eq!((size, metre), ([72, 112], [2000; 2]));
    // The camera sees the same through both.
    let eye = |name: &str| {
        let (line, _) = drawn(&place, &["-o", name, "--paper", "60x80", "--json"]);
        let text = fs::read(place.path(name)).unwrap();
        let text = String::from_utf8_lossy(&text).replace("&quot;", "\"");
        let start = text.find("\"camera\"").unwrap_or_else(|| panic!("{line}"));
        text[start..start + 120].to_owned()
    };
    assert_eq!(eye("a.png"), eye("a.svg"));
    let way = ["--camera-path", "orbit:frames=8", "--frames", "0..1"];
    let (said, _) = drawn(
        &place,
        &[&["-o", "f%d.png", "--paper", "60x80"], &way[..]].concat(),
    );
    assert!(said.contains("2 frames, 216x336"), "{said}");
    let (said, _) = drawn(
        &place,
        &[&["-o", "f%d.svg", "--paper", "60x80"], &way[..]].concat(),
    );
    assert!(said.contains("2 frames, 60 x 80 mm"), "{said}");
}

#[test]
fn options_that_change_nothing_are_told_in_one_line() {
    let place = prepared();
    let paper = ["--paper", "60x80", "--camera", "40,10"];
    let told = |more: &[&str]| drawn(&place, &[&paper, more].concat()).1;
    assert_eq!(told(&["-o", "a.svg", "--profile", "edit"]), "");
    assert_eq!(told(&["-o", "a.png", "--ink-supersample", "1"]), "");
    assert_eq!(
        told(&["-o", "a.svg", "--size", "60x80", "--exposure", "2"]),
        "warning: --size, --exposure: without effect on vectors on paper"
    );
    assert_eq!(
        told(&["-o", "a.png", "--profile", "edit"]),
        "warning: --profile: without effect on pictures of drawings on paper"
    );
    let line = [
        "render", "tree.glb", "-o", "b.png", "--style", "outline", "--paper", "a5",
    ];
    let said = stderr(&place.umbrage(&line));
    assert!(said.contains("warning: --paper: without effect"), "{said}");
}

#[test]
fn sheets_beyond_the_device_are_refused_with_what_makes_them_smaller() {
    let place = prepared();
    for (file, word) in [
        ("x.png", "--ink-supersample"),
        ("x.svg", "sheet.resolution"),
    ] {
        let line = ["render", "tree.glb", "-o", file, "--style", "ds00-fig3a"];
        let line = [&line[..], &["--paper", "5000x5000"]].concat();
        place.assert_refused(&line, &["pixels", word, "--paper"]);
    }
}

#[test]
fn blank_drawings_are_told() {
    let place = prepared();
    for file in ["a.svg", "a.png"] {
        let away = ["-o", file, "--paper", "60x80", "--camera", "0,1,9/0,1,99"];
        let (_, said) = drawn(&place, &away);
        assert!(said.contains(file) && said.contains("is blank"), "{said}");
        let (_, said) = drawn(&place, &["-o", file, "--paper", "60x80"]);
        assert_eq!(said, "");
    }
    place.write(
        "one.toml",
        "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n[primitive]\ncount = 1\n",
    );
    let line = [
        "render",
        "grow:shrub:1:40",
        "-o",
        "a.svg",
        "--style",
        "one.toml",
    ];
    let said = stdout(&place.umbrage(&line));
    assert!(said.contains(" 1 primitive,"), "{said}");
}

#[test]
fn vectors_of_what_has_none_name_the_styles_that_do() {
    let place = prepared();
    for more in [
        &[][..],
        &["--style", "toon"],
        &["--style", "toon", "--camera-path", "orbit"],
    ] {
        let line = [&["render", "tree.glb", "-o", "x.svg"], more].concat();
        place.assert_refused(&line, &["x.svg", "ds00-fig3a", "kind = \"paper\"", ".png"]);
    }
    let style = "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n";
    let long = "x + ".repeat(1250);
    place.write(
        "own.toml",
        format!("{style}[foliage]\nthreshold_by = \"{long}\"\n"),
    );
    let line = ["render", "tree.glb", "-o", "x.svg", "--style", "own.toml"];
    place.assert_refused(&line, &["own.toml", "foliage.threshold_by", "x + x + .."]);
    assert!(stderr(&place.umbrage(&line)).len() < 250);
}
