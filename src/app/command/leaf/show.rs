//! `umbrage leaf show`: figures 3 and 7 of the paper for any leaf.

use serde_json::json;

use super::load;
use crate::Result;
use crate::app::cli::leaf::{Sheet, ShowArgs};
use crate::app::output::{PendingFile, check_ending};
use crate::app::{Report, console};
use crate::leaf::edit::{Change, Channels, Edit};
use crate::leaf::picture::{Lit, MapView, lit, map, over};
use crate::leaf::{Face, LeafMaterial};
use crate::render::{Picture, sheet};

/// Linear grey behind the leaves.
const PAPER: f32 = 0.92;
/// Linear grey behind lit leaves.
const DUSK: f32 = 0.035;

type Labelled = (String, Picture);

pub(super) fn run(args: &ShowArgs) -> Result<Report> {
    check_ending(&args.output, &["png", "jpg", "jpeg"])?;
    let output = PendingFile::create(&args.output)?;
    let leaf = load(&args.input)?;
    let working = console::working("drawing the leaf");
    let [w, h] = leaf.size().unwrap_or([1, 1]);
    let width = (u64::from(args.size) * u64::from(w) / u64::from(h)).clamp(16, 4096) as u32;
    let size = [width, args.size];
    let picture = match args.sheet {
        Sheet::Maps => sheet(&maps(&leaf, size), 6),
        Sheet::Edits => sheet(&edits(&leaf, size)?, 6),
        Sheet::Front => picture(&leaf, &Lit::new(Face::Upper, false), size),
        Sheet::Back => picture(&leaf, &Lit::new(Face::Lower, true), size),
        Sheet::All => {
            let mut all = maps(&leaf, size);
            all.extend(edits(&leaf, size)?);
            sheet(&all, 6)
        }
    };
    let ending = args.output.extension().unwrap_or_default();
    let bytes = if ["jpg", "jpeg"]
        .iter()
        .any(|e| ending.eq_ignore_ascii_case(e))
    {
        picture.to_jpeg()?
    } else {
        picture.to_png()?
    };
    output.commit(&bytes)?;
    drop(working);
    let Picture { width, height, .. } = picture;
    Ok(Report::new(
        format!("{}: {width}x{height}\n", args.output.display()),
        json!({ "output": args.output, "width": width, "height": height, "leaf": leaf.name }),
    ))
}

/// The maps of both sides, a row each.
fn maps(leaf: &LeafMaterial, size: [u32; 2]) -> Vec<Labelled> {
    let views = [
        ("gamma / 2", MapView::Gamma),
        ("thickness", MapView::Thickness),
        ("gloss x10", MapView::Gloss),
        ("roughness", MapView::Roughness),
        ("R x2.5", MapView::Reflectance),
        ("T x2.5", MapView::Transmittance),
    ];
    let mut out = Vec::new();
    for face in Face::ALL {
        for (name, view) in views {
            let pixels = over(&map(leaf, face, view, size), PAPER);
            out.push((format!("{}: {name}", face.name()), of(size, pixels)));
        }
    }
    out
}

/// Thickness and absorption, from the front and from behind: four rows of six.
fn edits(leaf: &LeafMaterial, size: [u32; 2]) -> Result<Vec<Labelled>> {
    const FACTORS: [f64; 6] = [0.25, 0.5, 1.0, 1.5, 2.0, 4.0];
    let mut out = Vec::new();
    for (what, absorption) in [("h", false), ("absorption", true)] {
        for behind in [false, true] {
            for factor in FACTORS {
                let mut edited = leaf.clone();
                let change = Change::Times(factor);
                let edit = if absorption {
                    Edit {
                        sigma_a: Some(Channels([change; 3])),
                        ..Edit::default()
                    }
                } else {
                    Edit {
                        thickness: Some(change),
                        ..Edit::default()
                    }
                };
                edit.apply(&mut edited)?;
                let face = if behind { Face::Lower } else { Face::Upper };
                let label = format!(
                    "{what} x{factor} {}",
                    if behind { "back-lit" } else { "front-lit" }
                );
                out.push((label, picture(&edited, &Lit::new(face, behind), size)));
            }
        }
    }
    Ok(out)
}

fn picture(leaf: &LeafMaterial, light: &Lit, size: [u32; 2]) -> Picture {
    of(size, over(&lit(leaf, light, size), DUSK))
}

fn of(size: [u32; 2], rgba: Vec<u8>) -> Picture {
    Picture {
        width: size[0],
        height: size[1],
        rgba,
    }
}
