//! The measures as a Markdown document.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::sweep::{Record, Topic};

/// One table: a measure by variant and model, then means of other measures over the models.
struct Section {
    topic: Topic,
    title: &'static str,
    text: &'static str,
    /// Measure of the model columns and its decimals.
    measure: (&'static str, usize),
    /// Measures of which the mean over the models is shown: name, heading, decimals.
    means: &'static [(&'static str, &'static str, usize)],
}

const SECTIONS: &[Section] = &[
    Section {
        topic: Topic::Model,
        title: "Models",
        text: "Foliage vertices of each model; the means are generators (leaves) and the traced \
               ambient coefficient.",
        measure: ("vertices", 0),
        means: &[
            ("generators", "generators", 0),
            ("ambient", "traced ambient", 3),
        ],
    },
    Section {
        topic: Topic::Ambient,
        title: "Ambient coefficient",
        text: "Spearman's rank correlation with ray-traced visibility. `eq4` is the paper's transfer \
               function; with one radius it uses the normals' field. The row of `traced` is the \
               noise that 64 rays leave, the most that any mode could reach.",
        measure: ("spearman", 3),
        means: &[
            ("mean", "mean k_a", 3),
            ("milliseconds", "ms", 1),
            ("MiB", "MiB", 1),
        ],
    },
    Section {
        topic: Topic::AmbientRadius,
        title: "Radius of the ambient field",
        text: "The same correlation against `rho_ambient`, in diagonals of the foliage box.",
        measure: ("spearman", 3),
        means: &[("mean", "mean k_a", 3), ("milliseconds", "ms", 1)],
    },
    Section {
        topic: Topic::Normals,
        title: "Normals: meaning",
        text: "Area under the curve of N.w as a guess of whether direction w is visible (0.5 knows \
               nothing); the last row is what one vector per vertex can reach.",
        measure: ("auc", 3),
        means: &[("milliseconds", "ms", 1), ("MiB", "MiB", 1)],
    },
    Section {
        topic: Topic::Normals,
        title: "Normals: calm",
        text: "Roughness: mean angle in degrees to the mean normal of the 12 nearest foliage \
               vertices; and the mean angle to the normal of F = 0 at its nearest point.",
        measure: ("roughness", 1),
        means: &[("exact", "degrees to `exact`", 1)],
    },
    Section {
        topic: Topic::Radius,
        title: "Radius of the normals' field",
        text: "Area under the curve against `rho`, in diagonals of the foliage box.",
        measure: ("auc", 3),
        means: &[("roughness", "roughness", 1), ("milliseconds", "ms", 1)],
    },
    Section {
        topic: Topic::Threshold,
        title: "Threshold of the surface",
        text: "Area under the curve against `tau`, a quantile of the density at the foliage's \
               vertices.",
        measure: ("auc", 3),
        means: &[("roughness", "roughness", 1), ("milliseconds", "ms", 1)],
    },
    Section {
        topic: Topic::Primitive,
        title: "What makes one generator: meaning",
        text: "Area under the curve by `primitive`: `auto` takes `leaf` or `triangle` by the number of \
               leaves.",
        measure: ("auc", 3),
        means: &[("roughness", "roughness", 1), ("milliseconds", "ms", 1)],
    },
    Section {
        topic: Topic::Primitive,
        title: "What makes one generator: ambient coefficient",
        text: "Spearman's rank correlation of `eq4` with ray-traced visibility.",
        measure: ("spearman", 3),
        means: &[],
    },
    Section {
        topic: Topic::Primitive,
        title: "What makes one generator: how many",
        text: "Generators that are left under the bound of `most_generators`.",
        measure: ("generators", 0),
        means: &[],
    },
    Section {
        topic: Topic::Cells,
        title: "Grid size",
        text: "Mean angle in degrees between the normals found on the grid and those of F = 0 itself.",
        measure: ("exact", 2),
        means: &[
            ("p95", "95 % quantile", 1),
            ("roughness", "roughness", 1),
            ("milliseconds", "ms", 1),
            ("MiB", "MiB", 1),
        ],
    },
    Section {
        topic: Topic::Fraction,
        title: "Share of the generators",
        text: "Mean angle in degrees by which the gradient normal turns when only a share of the \
               generators is used.",
        measure: ("angle", 1),
        means: &[
            ("p95", "95 % quantile", 1),
            ("ambient", "change of k_a", 3),
            ("milliseconds", "ms", 1),
        ],
    },
    Section {
        topic: Topic::Encoding,
        title: "Encodings",
        text: "Largest angle in degrees of a round trip.",
        measure: ("angle", 6),
        means: &[
            ("ambient", "largest error of k_a", 6),
            ("bytes", "bytes per vertex", 0),
        ],
    },
    Section {
        topic: Topic::Stages,
        title: "Device time per pass",
        text: "Milliseconds of every pass of two bakes: with the default settings, and with normals \
               from the nearest surface vertex.",
        measure: ("milliseconds", 2),
        means: &[],
    },
];

/// All tables in order.
#[must_use]
pub fn markdown(records: &[Record], device: &str, command: &str) -> String {
    let mut out = format!(
        "# Measures of the foliage bake\n\nMade by `{command}` on {device}. Device times are sums \
         over the passes of one bake; all other columns do not depend on the device beyond rounding.\n"
    );
    for section in SECTIONS {
        write_section(&mut out, section, records);
    }
    out
}

fn write_section(out: &mut String, section: &Section, records: &[Record]) {
    let rows: Vec<&Record> = records
        .iter()
        .filter(|r| r.topic == section.topic)
        .filter(|r| r.values.contains_key(section.measure.0))
        .collect();
    if rows.is_empty() {
        return;
    }
    let models = unique(rows.iter().map(|r| r.model.as_str()));
    let variants = unique(rows.iter().map(|r| r.variant.as_str()));
    let one = models.len() == 1;
    let mut heading = vec!["".to_owned()];
    heading.extend(models.iter().map(ToString::to_string));
    if !one {
        heading.push("mean".to_owned());
    }
    heading.extend(section.means.iter().map(|m| m.1.to_owned()));
    let _ = write!(out, "\n## {}\n\n{}\n\n", section.title, section.text);
    let _ = writeln!(out, "| {} |", heading.join(" | "));
    let _ = writeln!(out, "|---|{}", "--:|".repeat(heading.len() - 1));
    for variant in variants {
        let of_variant: Vec<&Record> = rows
            .iter()
            .copied()
            .filter(|r| r.variant == variant)
            .collect();
        let mut cells = vec![variant.to_owned()];
        for model in &models {
            let record = of_variant.iter().find(|r| r.model == *model);
            let value = record.map(|r| r.values[section.measure.0]);
            cells.push(number(value, section.measure.1));
        }
        if !one {
            cells.push(number(
                mean(&of_variant, section.measure.0),
                section.measure.1,
            ));
        }
        for &(name, _, decimals) in section.means {
            cells.push(number(mean(&of_variant, name), decimals));
        }
        let _ = writeln!(out, "| {} |", cells.join(" | "));
    }
}

/// Values in the order of their first appearance.
fn unique<'a>(values: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = BTreeSet::new();
    values.filter(|v| seen.insert(*v)).collect()
}

/// Mean over the records that have the measure.
fn mean(records: &[&Record], name: &str) -> Option<f64> {
    let values: Vec<f64> = records
        .iter()
        .filter_map(|r| r.values.get(name).copied())
        .collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn number(value: Option<f64>, decimals: usize) -> String {
    match value {
        Some(v) if v.is_finite() => format!("{v:.decimals$}"),
        _ => "-".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_have_models_as_columns_and_means_behind() {
        let record = |model: &str, variant: &str, spearman, ms| Record {
            model: model.into(),
            topic: Topic::Ambient,
            variant: variant.into(),
            values: [("spearman", spearman), ("milliseconds", ms)].into(),
        };
        let text = markdown(
            &[
                record("oak", "eq4", 0.5, 1.0),
                record("ash", "eq4", 0.75, 3.0),
                record("oak", "traced", 1.0, 9.0),
            ],
            "a device",
            "umbrage tradeoff",
        );
        assert!(
            text.contains("|  | oak | ash | mean | mean k_a | ms | MiB |"),
            "{text}"
        );
        assert!(
            text.contains("| eq4 | 0.500 | 0.750 | 0.625 | - | 2.0 | - |"),
            "{text}"
        );
        assert!(
            text.contains("| traced | 1.000 | - | 1.000 | - | 9.0 | - |"),
            "{text}"
        );
    }
}
