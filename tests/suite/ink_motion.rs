//! Frames along a way of the camera.

use crate::place::Place;

const TREE: &str = "grow:broadleaf:1:300";

/// Arguments of frames of `TREE`, hatched.
fn frames<'a>(way: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let what = ["render", TREE, "-o", "f%02d.png", "--style", "full"];
    let how = ["--ink-supersample", "1", "--size", "96x96", "--cells", "16"];
    let way = ["--camera-path", way, "--validate"];
    [&what[..], &how, &way, more].concat()
}

#[test]
fn a_frame_alone_is_that_of_the_sequence_bit_for_bit() {
    let way = "orbit:turns=0.2,frames=3,rise=20,roll=40";
    for mode in ["replay", "stateless"] {
        let (all, one) = (Place::new(), Place::new());
        let report = all.json(&frames(way, &["--hatch-mode", mode]));
        assert_eq!(report["frames"].as_array().unwrap().len(), 3, "{report}");
        one.json(&frames(way, &["--hatch-mode", mode, "--frames", "2..2"]));
        let file = |place: &Place, name: &str| std::fs::read(place.path(name)).unwrap();
        assert!(file(&all, "f02.png") == file(&one, "f02.png"), "{mode}");
        assert!(file(&all, "f02.png") != file(&all, "f01.png"), "{mode}");
        assert!(!one.path("f01.png").exists(), "{mode}: one frame");
    }
}

#[test]
fn the_photo_like_picture_moves_along_keys_of_a_file() {
    let place = Place::new();
    let keys = "format_version = 1\n[[keys]]\nframe = 0\ncamera = '20,5,1.2'\n\
                [[keys]]\nframe = 4\ncamera = '40,15,0.8'\nroll = 10\n";
    let keys = place.write("way.toml", keys);
    let what = ["render", TREE, "-o", "p%d.png", "--size", "64x48"];
    let how = ["--cells", "16", "--camera-path", &keys, "--frames", "0..1"];
    place.json(&[&what[..], &how, &["--validate"]].concat());
    let size = image::image_dimensions(place.path("p1.png")).unwrap();
    assert_eq!(size, (64, 48));
    let bytes = |f: &str| std::fs::read(place.path(f)).unwrap();
    assert!(bytes("p0.png") != bytes("p1.png"), "the camera moves");
}

#[test]
fn ways_that_are_none_are_refused_before_anything_is_drawn() {
    let place = Place::new();
    let keys = "format_version = 1\n[[keys]]\nframe = 0\ncolour = 1\n";
    let keys = place.write("bad.toml", keys);
    for (way, more, words) in [
        ("spiral", &[][..], &["spiral", "orbit, dolly, walk"][..]),
        ("orbit:frames=5", &["--frames", "3..9"], &["9", "last", "4"]),
        ("orbit", &["--frames", "9..3"], &["--frames", "A..B"]),
        ("orbit", &["-o", "f.png"], &["f.png", "%04d"]),
        (keys.as_str(), &[], &["bad.toml", "colour"]),
        ("missing.toml", &[], &["missing.toml"]),
    ] {
        let mut arguments = frames(way, &[]);
        if let ["-o", name] = more {
            arguments[3] = name;
        } else {
            arguments.extend(more);
        }
        place.assert_refused(&arguments, words);
    }
}
