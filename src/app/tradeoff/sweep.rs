//! The variants that are measured, topic by topic.

use std::collections::BTreeMap;

use serde::Serialize;

use super::truth::Truth;
use crate::Result;
use crate::foliage::{AmbientMode, Bake, Baked, Encoding, NormalsMode, Sampling, Settings, Split};
use crate::gpu::Gpu;
use crate::math::stats;
use crate::reference::encode;
use crate::scene::{Geometry, Model};

/// What is varied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Topic {
    /// The model itself.
    Model,
    /// Modes of the ambient coefficient.
    Ambient,
    /// Radius of the ambient field.
    AmbientRadius,
    /// Modes of the normals.
    Normals,
    /// Radius of the normals' field.
    Radius,
    /// Threshold of the surface.
    Threshold,
    /// What makes one generator.
    Primitive,
    /// Grid size.
    Cells,
    /// Share of the generators.
    Fraction,
    /// Encodings.
    Encoding,
    /// Device time per stage of the default bake.
    Stages,
}

/// One measured variant on one model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Record {
    /// Model name.
    pub model: String,
    /// What is varied.
    pub topic: Topic,
    /// To what.
    pub variant: String,
    /// Measures by name.
    pub values: BTreeMap<&'static str, f64>,
}

/// Everything that the variants of one model share.
#[derive(Debug)]
pub struct Sweep<'a> {
    gpu: &'a Gpu,
    model: &'a Model,
    pub(super) geometry: &'a Geometry,
    pub(super) split: &'a Split,
    pub(super) truth: &'a Truth,
    records: Vec<Record>,
}

pub(super) const MIB: f64 = 1024.0 * 1024.0;

/// Passes with a smaller share of the time are added up.
const SMALL_PASS: f64 = 0.02;

impl<'a> Sweep<'a> {
    /// A sweep over `model`.
    #[must_use]
    pub fn new(
        gpu: &'a Gpu,
        model: &'a Model,
        geometry: &'a Geometry,
        split: &'a Split,
        truth: &'a Truth,
    ) -> Self {
        Self {
            gpu,
            model,
            geometry,
            split,
            truth,
            records: Vec::new(),
        }
    }

    /// Measures all topics.
    ///
    /// # Errors
    /// A bake fails.
    pub fn run(mut self) -> Result<Vec<Record>> {
        self.subject()?;
        self.ambient()?;
        self.ambient_radius()?;
        let exact = self.normals()?;
        self.radius()?;
        self.primitive()?;
        self.cells(&exact)?;
        self.fraction()?;
        self.encodings()?;
        self.stages()?;
        Ok(self.records)
    }

    /// Appends a record.
    pub(super) fn add(&mut self, topic: Topic, variant: &str, values: &[(&'static str, f64)]) {
        self.records.push(Record {
            model: self.model.name.clone(),
            topic,
            variant: variant.to_owned(),
            values: values.iter().copied().collect(),
        });
    }

    pub(super) fn bake(&self, settings: &Settings) -> Result<Baked> {
        log::info!(
            "{}: normals {} ambient {} cells {}",
            self.model.name,
            settings.normals,
            settings.ambient,
            settings.cells
        );
        Bake::compute(
            self.gpu,
            self.model,
            self.geometry,
            self.split,
            settings,
            &mut |_, _| {},
        )
    }

    fn subject(&mut self) -> Result<()> {
        let baked = self.bake(&Settings::default())?;
        let stats = &baked.bake.stats;
        let values = [
            ("vertices", stats.foliage_vertices as f64),
            ("generators", stats.generators as f64),
            ("ambient", self.truth.mean_ambient()),
        ];
        self.add(Topic::Model, "foliage vertices", &values);
        Ok(())
    }

    fn ambient(&mut self) -> Result<()> {
        let base = Settings {
            normals: NormalsMode::Original,
            encoding: Encoding::None,
            ..Settings::default()
        };
        let mut variants = vec![
            (
                "eq4, one radius".to_owned(),
                Settings {
                    ambient: AmbientMode::Eq4,
                    rho_ambient: base.rho,
                    ..base
                },
            ),
            (
                "eq4".to_owned(),
                Settings {
                    ambient: AmbientMode::Eq4,
                    ..base
                },
            ),
        ];
        for directions in [6, 16, 32] {
            variants.push((
                format!("transmittance, {directions} directions"),
                Settings {
                    ambient: AmbientMode::Transmittance,
                    directions,
                    ..base
                },
            ));
        }
        variants.push((
            "traced, 64 rays".to_owned(),
            Settings {
                ambient: AmbientMode::Traced,
                directions: 64,
                ..base
            },
        ));
        for (name, settings) in variants {
            self.measure_ambient(Topic::Ambient, &name, &settings)?;
        }
        Ok(())
    }

    fn ambient_radius(&mut self) -> Result<()> {
        for mode in [AmbientMode::Eq4, AmbientMode::Transmittance] {
            for rho_ambient in [0.015, 0.02, 0.03, 0.04, 0.06] {
                let settings = Settings {
                    normals: NormalsMode::Original,
                    encoding: Encoding::None,
                    ambient: mode,
                    rho_ambient,
                    ..Settings::default()
                };
                let name = format!("{mode}, {rho_ambient}");
                self.measure_ambient(Topic::AmbientRadius, &name, &settings)?;
            }
        }
        Ok(())
    }

    fn measure_ambient(&mut self, topic: Topic, name: &str, settings: &Settings) -> Result<()> {
        let baked = self.bake(settings)?;
        let ambient = &baked.bake.ambient;
        let mean: Vec<f64> = self
            .truth
            .sample
            .iter()
            .map(|&v| f64::from(ambient[v]))
            .collect();
        let values = [
            ("spearman", self.truth.spearman(ambient)),
            ("mean", stats::mean(&mean)),
            ("milliseconds", milliseconds(&baked)),
            ("MiB", baked.recipe.bytes() as f64 / MIB),
        ];
        self.add(topic, name, &values);
        Ok(())
    }

    fn fraction(&mut self) -> Result<()> {
        let base = Settings {
            normals: NormalsMode::Gradient,
            ambient: AmbientMode::Eq4,
            encoding: Encoding::None,
            ..Settings::default()
        };
        let whole = self.bake(&base)?;
        for sampling in [Sampling::Stratified, Sampling::Plain] {
            for fraction in [0.5, 0.25, 0.1] {
                let baked = self.bake(&Settings {
                    sampling,
                    fraction,
                    ..base
                })?;
                let angles = self.truth.angles(&baked.bake.normals, &whole.bake.normals);
                let difference: Vec<f64> = self
                    .truth
                    .sample
                    .iter()
                    .map(|&v| f64::from((baked.bake.ambient[v] - whole.bake.ambient[v]).abs()))
                    .collect();
                let values = [
                    ("angle", stats::mean(&angles)),
                    ("p95", stats::quantile(&angles, 0.95)),
                    ("ambient", stats::mean(&difference)),
                    ("milliseconds", milliseconds(&baked)),
                ];
                self.add(Topic::Fraction, &format!("{sampling}, {fraction}"), &values);
            }
        }
        let cost = milliseconds(&whole);
        self.add(
            Topic::Fraction,
            "all",
            &[
                ("angle", 0.0),
                ("p95", 0.0),
                ("ambient", 0.0),
                ("milliseconds", cost),
            ],
        );
        Ok(())
    }

    /// Round trips of the baked values through the twins' encodings.
    fn encodings(&mut self) -> Result<()> {
        type RoundTrip = fn(glam::DVec3, f64) -> (glam::DVec3, f64);
        let baked = self.bake(&Settings {
            encoding: Encoding::None,
            ..Settings::default()
        })?;
        let forms: [(&str, f64, RoundTrip); 3] = [
            ("length", 12.0, |n, k| {
                encode::decode_length(encode::encode_length(n, k))
            }),
            ("packed16", 8.0, |n, k| {
                encode::decode_packed16(encode::encode_packed16(n, k))
            }),
            ("packed8", 4.0, |n, k| {
                encode::decode_packed8(encode::encode_packed8(n, k))
            }),
        ];
        for (name, bytes, round_trip) in forms {
            let (mut angle, mut ambient) = (0.0_f64, 0.0_f64);
            for &v in &self.truth.sample {
                let (normal, k) = (baked.bake.normals[v], f64::from(baked.bake.ambient[v]));
                let (n, l) = round_trip(normal.as_dvec3().normalize(), k);
                angle = angle.max(stats::angle_degrees(n.as_vec3(), normal));
                ambient = ambient.max((k - l).abs());
            }
            let values = [("bytes", bytes), ("angle", angle), ("ambient", ambient)];
            self.add(Topic::Encoding, name, &values);
        }
        Ok(())
    }

    fn stages(&mut self) -> Result<()> {
        for (name, normals) in [
            ("default", Settings::default().normals),
            ("vertex", NormalsMode::Vertex),
        ] {
            let baked = self.bake(&Settings {
                normals,
                ..Settings::default()
            })?;
            let passes = by_label(&baked);
            let total: f64 = passes.iter().map(|p| p.1).sum();
            let mut others = 0.0;
            for (label, ms) in passes {
                if ms < SMALL_PASS * total {
                    others += ms;
                } else {
                    let variant = format!("{name}: {label}");
                    self.add(Topic::Stages, &variant, &[("milliseconds", ms)]);
                }
            }
            let variant = format!("{name}: passes below 2 %");
            self.add(Topic::Stages, &variant, &[("milliseconds", others)]);
            self.add(
                Topic::Stages,
                &format!("{name}: all"),
                &[("milliseconds", total)],
            );
        }
        Ok(())
    }
}

/// Device time of all passes; not a number where none ran (rays are traced on the CPU).
pub(super) fn milliseconds(baked: &Baked) -> f64 {
    if baked.times.is_empty() {
        return f64::NAN;
    }
    baked
        .times
        .iter()
        .map(|t| t.nanoseconds as f64)
        .sum::<f64>()
        * 1e-6
}

/// Device time per label, in the order of first appearance.
fn by_label(baked: &Baked) -> Vec<(&str, f64)> {
    let mut out: Vec<(&str, f64)> = Vec::new();
    for time in &baked.times {
        let ms = time.nanoseconds as f64 * 1e-6;
        match out.iter_mut().find(|(label, _)| *label == time.label) {
            Some((_, sum)) => *sum += ms,
            None => out.push((&time.label, ms)),
        }
    }
    out
}
