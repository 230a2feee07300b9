//! The variants that are measured by their normals.

use glam::Vec3;

use super::sweep::{MIB, Sweep, Topic, milliseconds};
use crate::Result;
use crate::foliage::{AmbientMode, Baked, Encoding, NormalsMode, Primitive, Settings, Threshold};
use crate::math::stats;

impl Sweep<'_> {
    /// Measures the modes; returns the exact normals.
    pub(super) fn normals(&mut self) -> Result<Vec<Vec3>> {
        let base = Settings {
            ambient: AmbientMode::None,
            encoding: Encoding::None,
            ..Settings::default()
        };
        let exact = self
            .bake(&Settings {
                normals: NormalsMode::Exact,
                ..base
            })?
            .bake
            .normals;
        self.measure_normals(
            Topic::Normals,
            "the model's own",
            &self.geometry.normals,
            &exact,
            None,
        );
        let centre = {
            let (min, max) = self.split.bounds(self.geometry);
            (0.5 * (min + max)).as_vec3()
        };
        let sphere: Vec<Vec3> = self
            .geometry
            .positions
            .iter()
            .map(|p| (p - centre).normalize_or(Vec3::Y))
            .collect();
        self.measure_normals(Topic::Normals, "from the centre", &sphere, &exact, None);
        for normals in [
            NormalsMode::Vertex,
            NormalsMode::Face,
            NormalsMode::Exact,
            NormalsMode::Gradient,
            NormalsMode::Multiscale,
            NormalsMode::Open,
        ] {
            let baked = self.bake(&Settings { normals, ..base })?;
            self.measure_normals(
                Topic::Normals,
                normals.name(),
                &baked.bake.normals,
                &exact,
                Some(&baked),
            );
        }
        let limit = self.truth.open_directions(self.geometry.positions.len());
        let auc = self.truth.auc(&limit);
        self.add(
            Topic::Normals,
            "mean visible direction, traced",
            &[("auc", auc)],
        );
        Ok(exact)
    }

    fn measure_normals(
        &mut self,
        topic: Topic,
        name: &str,
        normals: &[Vec3],
        exact: &[Vec3],
        baked: Option<&Baked>,
    ) {
        let mut values = vec![
            ("auc", self.truth.auc(normals)),
            ("roughness", self.truth.roughness(self.geometry, normals)),
        ];
        if !exact.is_empty() {
            values.push(("exact", stats::mean(&self.truth.angles(normals, exact))));
        }
        if let Some(baked) = baked {
            values.push(("milliseconds", milliseconds(baked)));
            values.push(("MiB", baked.recipe.bytes() as f64 / MIB));
        }
        self.add(topic, name, &values);
    }

    pub(super) fn radius(&mut self) -> Result<()> {
        let base = Settings {
            ambient: AmbientMode::None,
            encoding: Encoding::None,
            ..Settings::default()
        };
        for normals in [
            NormalsMode::Vertex,
            NormalsMode::Gradient,
            NormalsMode::Multiscale,
        ] {
            for rho in [0.06, 0.08, 0.1, 0.12, 0.16] {
                let baked = self.bake(&Settings {
                    normals,
                    rho,
                    ..base
                })?;
                let name = format!("{normals}, rho {rho}");
                let found = &baked.bake.normals;
                self.measure_normals(Topic::Radius, &name, found, &[], Some(&baked));
            }
        }
        for percent in [1.0, 4.0, 10.0, 25.0] {
            let baked = self.bake(&Settings {
                normals: NormalsMode::Vertex,
                tau: Threshold::Quantile(percent / 100.0),
                ..base
            })?;
            let name = format!("vertex, tau {percent}%");
            let found = &baked.bake.normals;
            self.measure_normals(Topic::Threshold, &name, found, &[], Some(&baked));
        }
        Ok(())
    }

    pub(super) fn cells(&mut self, exact: &[Vec3]) -> Result<()> {
        for normals in [NormalsMode::Vertex, NormalsMode::Face] {
            for cells in [32, 64, 96, 128] {
                let baked = self.bake(&Settings {
                    normals,
                    cells,
                    ambient: AmbientMode::None,
                    encoding: Encoding::None,
                    ..Settings::default()
                })?;
                let angles = self.truth.angles(&baked.bake.normals, exact);
                let values = [
                    ("exact", stats::mean(&angles)),
                    ("p95", stats::quantile(&angles, 0.95)),
                    (
                        "roughness",
                        self.truth.roughness(self.geometry, &baked.bake.normals),
                    ),
                    ("milliseconds", milliseconds(&baked)),
                    ("MiB", baked.recipe.bytes() as f64 / MIB),
                ];
                self.add(Topic::Cells, &format!("{normals}, {cells} cells"), &values);
            }
        }
        Ok(())
    }

    /// What makes one generator, by the normals and by the paper's ambient coefficient.
    pub(super) fn primitive(&mut self) -> Result<()> {
        let base = Settings {
            ambient: AmbientMode::Eq4,
            encoding: Encoding::None,
            ..Settings::default()
        };
        for normals in [NormalsMode::Gradient, NormalsMode::Multiscale] {
            for &primitive in Primitive::ALL {
                let baked = self.bake(&Settings {
                    normals,
                    primitive,
                    ..base
                })?;
                let values = [
                    ("auc", self.truth.auc(&baked.bake.normals)),
                    (
                        "roughness",
                        self.truth.roughness(self.geometry, &baked.bake.normals),
                    ),
                    ("spearman", self.truth.spearman(&baked.bake.ambient)),
                    ("generators", baked.bake.stats.generators as f64),
                    ("milliseconds", milliseconds(&baked)),
                ];
                self.add(
                    Topic::Primitive,
                    &format!("{normals}, {primitive}"),
                    &values,
                );
            }
        }
        Ok(())
    }
}
