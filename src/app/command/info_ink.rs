//! What a drawing takes: the plan of a style or a mix of them.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::app::report::Table;
use crate::ink::mix::{Mix, MixPlan};
use crate::render::plan::human_bytes;

/// Adds passes and images of a drawing of `size` pixels, with `factor` along each axis drawn for
/// one, to `text`.
pub(super) fn describe(
    text: &mut String,
    name: &str,
    mix: &Mix,
    size: [u32; 2],
    factor: u32,
) -> Value {
    let plan = MixPlan::new(mix);
    let [width, height] = size.map(|s| s * factor);
    let pixels = u64::from(width) * u64::from(height);
    let total = plan.bytes([width, height]);
    let _ = writeln!(
        text,
        "plan of style {name}: {} of images at {width}x{height}\n",
        human_bytes(total)
    );
    let mut table = Table::new(&["pass"]);
    let passes = plan.passes();
    for pass in &passes {
        table.row(&[pass]);
    }
    let _ = writeln!(text, "{table}");
    let mut table = Table::new(&["image", "written by", "bytes"]);
    let mut images = Vec::new();
    for image in plan.images() {
        let bytes = pixels * image.bytes;
        table.row(&[&image.name, &image.pass, &human_bytes(bytes)]);
        images.push(json!({ "name": image.name, "pass": image.pass, "bytes": bytes }));
    }
    let _ = write!(text, "{table}");
    json!({
        "style": name, "styles": mix.names, "bytes": total, "passes": passes, "resources": images,
        "size": [width, height], "bake": plan.any(|s| s.crown),
    })
}
