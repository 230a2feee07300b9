//! The last line: three small pictures beside ones that a person has looked at.
//!
//! They say that something changed, not that it is wrong; twins and decoded facts say that. After
//! a wanted change, make them anew, look at them and commit them:
//!
//!     UMBRAGE_GOLDEN=write cargo nextest run --test suite golden
//!
//! The limits leave room for what drivers do differently with leaves of a pixel: lavapipe and
//! SwiftShader differ by 1.8 to 2.3 steps in the mean and in 2 to 3 % of the pixels.

use std::path::Path;

use image::RgbImage;

use crate::place::{Place, stderr};

/// Largest mean difference of a channel, steps of 255.
const MEAN: f64 = 4.0;
/// A pixel with a channel this far off counts.
const FAR: u8 = 32;
/// Largest share of such pixels: leaves of a pixel's size may show or not.
const SHARE: f64 = 0.05;

#[test]
fn small_pictures_look_as_they_did() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let writes = std::env::var("UMBRAGE_GOLDEN").is_ok_and(|v| v == "write");
    let mut failures = Vec::new();
    for view in ["standard", "normals", "shadowed"] {
        let golden = folder.join(format!("shrub.{view}.png"));
        let place = Place::new();
        let picture = place.path("picture.png");
        let output = place.umbrage(&[
            "--validate",
            "render",
            "grow:shrub:1:400",
            "-o",
            "picture.png",
            "--view",
            view,
            "--size",
            "96x72",
            "--cells",
            "24",
        ]);
        assert!(output.status.success(), "{view}: {}", stderr(&output));
        if writes {
            std::fs::copy(&picture, &golden).unwrap();
            continue;
        }
        let [want, got] = [&golden, &picture].map(|p| image::open(p).unwrap().into_rgb8());
        let (mean, share) = difference(&want, &got);
        if mean > MEAN || share > SHARE {
            let kept = std::env::temp_dir().join(format!("umbrage-golden-shrub.{view}.png"));
            sheet(&want, &got).save(&kept).unwrap();
            failures.push(format!(
                "{view}: mean {mean:.2} of at most {MEAN}, {:.1} % of pixels off by {FAR} or more of \
                 at most {:.0} %; expected | difference x4 | actual: {}",
                100.0 * share, 100.0 * SHARE, kept.display()
            ));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Mean difference of a channel, and share of pixels that are far off.
fn difference(want: &RgbImage, got: &RgbImage) -> (f64, f64) {
    assert_eq!(want.dimensions(), got.dimensions(), "size");
    let (mut sum, mut far) = (0u64, 0usize);
    for (a, b) in want.pixels().zip(got.pixels()) {
        let off = [0, 1, 2].map(|c| a.0[c].abs_diff(b.0[c]));
        sum += off.iter().map(|&d| u64::from(d)).sum::<u64>();
        far += usize::from(off.iter().any(|&d| d >= FAR));
    }
    let pixels = f64::from(want.width() * want.height());
    (sum as f64 / (3.0 * pixels), far as f64 / pixels)
}

/// Expected, difference and actual beside each other.
fn sheet(want: &RgbImage, got: &RgbImage) -> RgbImage {
    let (width, height) = want.dimensions();
    RgbImage::from_fn(3 * width, height, |x, y| {
        let at = x % width;
        let (a, b) = (want.get_pixel(at, y), got.get_pixel(at, y));
        match x / width {
            0 => *a,
            1 => image::Rgb([0, 1, 2].map(|c| a.0[c].abs_diff(b.0[c]).saturating_mul(4))),
            _ => *b,
        }
    })
}
