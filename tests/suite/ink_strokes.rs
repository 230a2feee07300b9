//! Strokes of styles as files: written, painted over, read back, refused.

use umbrage::ink::strokes::{band_of, tile_of};
use umbrage::ink::style::Style;
use umbrage::scene::textures::encode_png;

use crate::place::Place;

const HEAD: &str = "format_version = 1\ndescription = \"x\"\n";

fn grey(width: u32, height: u32, value: impl Fn(u32, u32) -> u8) -> Vec<u8> {
    let pixels: Vec<u8> = (0..width * height)
        .flat_map(|i| {
            let v = value(i % width, i / width);
            [v, v, v, 255]
        })
        .collect();
    encode_png(width, height, &pixels).unwrap()
}

#[test]
fn strokes_are_written_and_read_back() {
    let place = Place::new();
    let style = "silhouette-hatching";
    for (output, what) in [
        ("tile.png", "tile"),
        ("band.png", "band"),
        ("tones.png", "tones"),
    ] {
        let said = place.json(&["ink", "strokes", style, "-o", output, "--what", what]);
        let errors = said["tone_errors"].as_array().unwrap();
        let largest = errors
            .iter()
            .map(|e| e.as_f64().unwrap())
            .fold(0.0, f64::max);
        assert!(largest < 0.02, "{said}");
    }
    place.json(&["ink", "strokes", style, "-o", "own.toml"]);
    let own = Style::named(place.path("own.toml").to_str().unwrap()).unwrap();
    assert!(own.hatching.strokes.len() > 1000, "listed");
    let (listed, made) = (
        tile_of(&own).unwrap(),
        tile_of(&Style::named(style).unwrap()).unwrap(),
    );
    assert!(listed.levels == made.levels, "the list draws the tile");
    let bands = [&own, &Style::named(style).unwrap()].map(|s| band_of(s).unwrap());
    assert!(own.silhouette.strokes.len() > 10 && own.silhouette.ticks.len() > 20);
    assert_eq!(bands[0], bands[1], "and the band, bit for bit");
    let mut fewer = own.clone();
    fewer.silhouette.ticks.clear();
    assert_ne!(
        band_of(&fewer).unwrap(),
        bands[1],
        "what is not listed is not drawn"
    );
    // Files are relative to the style's folder.
    place.write(
        "styles/painted.toml",
        format!(
            "{HEAD}[hatching]\nstrength = 1.0\ntile = \"../tile.png\"\n\
                 [silhouette]\nstrength = 1.0\nband = \"../band.png\"\n"
        ),
    );
    let painted = Style::named(place.path("styles/painted.toml").to_str().unwrap()).unwrap();
    assert_eq!(
        tile_of(&painted).unwrap().levels[0],
        made.levels[0],
        "the picture is the tile"
    );
}

#[test]
fn wrong_pictures_are_told_by_file_and_reason() {
    let place = Place::new();
    place.write("small.png", grey(64, 64, |_, _| 0));
    place.write(
        "light.png",
        grey(512, 512, |x, _| if x % 8 == 0 { 0 } else { 255 }),
    );
    place.write(
        "dark.png",
        grey(512, 512, |x, _| if x % 4 == 0 { 0 } else { 255 }),
    );
    place.write("white.png", grey(64, 64, |_, _| 255));
    place.write("text.png", "no picture");
    for (keys, words) in [
        ("[hatching]\ntile = \"small.png\"", ["small.png", "64 x 64"]),
        (
            "[hatching]\ntile = \"none.png\"",
            ["none.png", "style.toml"],
        ),
        (
            "[hatching]\ntile = \"text.png\"",
            ["text.png", "style.toml"],
        ),
        (
            "[hatching]\ntile = [\"dark.png\", \"light.png\"]",
            ["light.png", "light to dark"],
        ),
        (
            "[silhouette]\nband = \"small.png\"",
            ["small.png", "64 x 64"],
        ),
        (
            "[leaves]\noutline = \"white.png\"",
            ["white.png", "no shape"],
        ),
        (
            "[hatching]\nstrokes = [[0.5, 0.5, 0.2, 0, 0, 1, 2.0, 0]]",
            ["strokes[0]", "tone 2"],
        ),
        (
            "[silhouette]\nstrokes = [[0, 0.5, 0.2, 1, 99, 0.5, 1, 1]]",
            ["silhouette.strokes[0]", "width 99"],
        ),
        (
            "[silhouette]\nticks = [[4, 0.5, 9, 1, 0, 1]]",
            ["silhouette.ticks[0]", "channel 4"],
        ),
        (
            "[silhouette]\nticks = [[3, 0.5, 9, 1, 0, 1]]",
            ["silhouette.strokes", "no ink"],
        ),
        (
            "[silhouette]\nband = \"small.png\"\nticks = [[0, 0.5, 9, 1, 0, 1]]",
            ["silhouette.band", "only one"],
        ),
        (
            "[hatching]\nstroke_length = [0.5, 0.2]",
            ["stroke_length", "shortest"],
        ),
    ] {
        place.write("style.toml", format!("{HEAD}{keys}\n"));
        place.assert_refused(&["ink", "strokes", "style.toml", "-o", "out.png"], &words);
    }
    place.write(
        "style.toml",
        format!("{HEAD}[hatching]\ntile = [\"light.png\", \"dark.png\"]\n"),
    );
    let tile = tile_of(&Style::named(place.path("style.toml").to_str().unwrap()).unwrap()).unwrap();
    assert!((tile.darkness(0, 0.25) - 0.25).abs() < 0.01, "two tones");
    place.assert_refused(
        &["ink", "strokes", "style.toml", "-o", "out.toml"],
        &["painted"],
    );
}
