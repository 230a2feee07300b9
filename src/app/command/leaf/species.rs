//! `umbrage leaf species`: the measured leaves.

use serde_json::json;

use crate::app::Report;
use crate::app::report::Table;
use crate::leaf::Face;
use crate::leaf::species::SPECIES;

pub(super) fn run() -> Report {
    let rgb = |v: [f64; 3]| v.map(|x| format!("{x:.4}")).join(" ");
    let mut table = Table::new(&["leaf", "R upper", "R lower", "T", "omega", "Delta", "what"]);
    let mut list = Vec::new();
    for s in SPECIES {
        let leaf = s.plain();
        let omega = [0, 1, 2].map(|c| leaf.upper.omega(c));
        let delta = [0, 1, 2].map(|c| leaf.upper.sigma_t(c) * leaf.thickness_mm);
        let lower = rgb(s.reflectance(Face::Lower));
        let lower = if s.lower.is_some() {
            lower
        } else {
            format!("({lower})")
        };
        table.row(&[
            &s.name,
            &rgb(s.upper),
            &lower,
            &rgb(s.through),
            &format!("{:.3}", omega[1]),
            &format!("{:.3}", delta[1]),
            &s.what,
        ]);
        list.push(json!({
            "name": s.name, "what": s.what, "reflectance_upper": s.upper,
            "reflectance_lower": s.reflectance(Face::Lower), "lower_measured": s.lower.is_some(),
            "transmittance": s.through, "thickness_mm": s.thickness_mm, "omega": omega,
            "delta": delta, "sigma_a_per_mm": leaf.upper.sigma_a,
            "sigma_s_per_mm": leaf.upper.sigma_s,
        }));
    }
    let text = format!(
        "{table}\nLinear sRGB; R contains the surface's reflection (about 0.035), omega and Delta \
         (green, upper side) are those of the rest. Lower sides in brackets are assumed.\n"
    );
    Report::new(text, json!({ "species": list }))
}
