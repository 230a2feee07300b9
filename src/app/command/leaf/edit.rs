//! `umbrage leaf edit`: a leaf changed and written.

use std::path::Path;

use serde_json::{Value, json};

use super::{card, load, map_format, write};
use crate::Result;
use crate::app::cli::leaf::EditArgs;
use crate::app::output::{PendingFile, check_apart, check_ending};
use crate::app::report::Table;
use crate::app::{Report, console};
use crate::leaf::edit::Edit;
use crate::leaf::{Face, LeafMaterial, SideOptics};

pub(super) fn run(args: &EditArgs) -> Result<Report> {
    check_ending(&args.output, &["toml", "glb"])?;
    check_apart(&args.output, [Path::new(&args.input.leaf)])?;
    // A wrong place is told before the work; the leaf's own files follow at the end.
    drop(PendingFile::create(&args.output)?);
    let working = console::working("editing the leaf");
    let mut leaf = load(&args.input)?;
    let before = Face::ALL.map(|face| leaf.optics(face));
    let edit = Edit {
        thickness: args.thickness,
        sigma_a: args.sigma_a,
        sigma_s: args.sigma_s,
        gloss: args.gloss,
        roughness: args.roughness,
        mode: args.mode,
        face: args.side.map(Face::from),
        size: args.size,
    };
    let limited = edit.apply(&mut leaf)?;
    let after = Face::ALL.map(|face| leaf.optics(face));
    let files = if args
        .output
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("glb"))
    {
        vec![card::write(&leaf, &args.output)?]
    } else {
        write(&leaf, &args.output, map_format(args.maps))?
    };
    drop(working);
    let mut table = Table::new(&["side", "", "R", "T"]);
    let rgb = |v: [f32; 3]| v.map(|x| format!("{x:.4}")).join(" ");
    for (i, face) in Face::ALL.into_iter().enumerate() {
        table.row(&[
            &face.name(),
            &"was",
            &rgb(before[i].rho_d),
            &rgb(before[i].rho_t),
        ]);
        table.row(&[&"", &"is", &rgb(after[i].rho_d), &rgb(after[i].rho_t)]);
    }
    let mut text = format!("{}\n{table}", args.output.display());
    if limited > 0 {
        text += &format!(
            "{limited} texels reflect less than gamma asks for: no more may come out than fell in\n"
        );
    }
    text += "Light-visibility maps stay as they are, and direct light follows at once; light that \
             meets several leaves is to be computed again.\n";
    let json = json!({
        "output": args.output, "files": files, "thickness_mm": leaf.thickness_mm,
        "limited_texels": limited, "was": before.map(optics), "is": after.map(optics),
        "redo": { "visibility": false, "direct_transfer": false, "indirect_transfer": true },
        "tissue": tissue(&leaf),
    });
    Ok(Report::new(text, json))
}

fn optics(o: SideOptics) -> Value {
    json!({ "rho_d": o.rho_d, "rho_t": o.rho_t, "rho_s": o.rho_s, "m": o.m })
}

/// Coefficients of both sides.
pub(super) fn tissue(leaf: &LeafMaterial) -> Value {
    let side = |face| {
        let s = leaf.side(face);
        let omega = [0, 1, 2].map(|c| s.omega(c));
        let delta = [0, 1, 2].map(|c| s.sigma_t(c) * leaf.thickness_mm);
        json!({
            "sigma_a_per_mm": s.sigma_a, "sigma_s_per_mm": s.sigma_s,
            "omega": omega, "delta": delta,
        })
    };
    json!({ "upper": side(Face::Upper), "lower": side(Face::Lower) })
}
