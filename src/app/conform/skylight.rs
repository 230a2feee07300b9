//! Skylight through the leaf-area field: sweep, sum and interpolation.

use glam::DVec3;

use super::{Case, Outcome};
use crate::Result;
use crate::abi::{SKY_GROUP, SkyDepth, SkyGather, SkyLight};
use crate::gpu::shaders::foliage as shaders;
use crate::gpu::{Binding, BufferInfo, Gpu, QueueKind};
use crate::math::sampling::{fibonacci_directions, uniform};
use crate::reference::density::{Field, Grid};
use crate::reference::generators::Generator;
use crate::reference::skylight::{light_at, sky_depth, sky_light};

const EXTINCTION: f32 = 0.5;

pub(super) fn cases() -> Vec<Case> {
    vec![
        Case {
            name: "foliage.sky_depth",
            run: |gpu| Ok(Setting::new().run(gpu)?[0].clone()),
        },
        Case {
            name: "foliage.sky_light.batches",
            run: |gpu| Ok(Setting::new().run(gpu)?[1].clone()),
        },
        Case {
            name: "foliage.sky_gather",
            run: |gpu| Ok(Setting::new().run(gpu)?[2].clone()),
        },
        Case {
            name: "foliage.sky_depth.no_leaves",
            run: |gpu| Ok(Setting::bare().run(gpu)?[0].clone()),
        },
        Case {
            name: "foliage.sky_light.no_leaves",
            run: |gpu| Ok(Setting::bare().run(gpu)?[1].clone()),
        },
        Case {
            name: "foliage.sky_gather.no_leaves",
            run: |gpu| Ok(Setting::bare().run(gpu)?[2].clone()),
        },
    ]
}

/// A cloud of leaves with a mean optical depth of about 1, and what is asked of it.
struct Setting {
    grid: Grid,
    leaf_area: Vec<f32>,
    directions: Vec<[f32; 4]>,
    points: Vec<[f32; 4]>,
}

impl Setting {
    fn new() -> Self {
        let random = |i: u32| DVec3::from([0, 1, 2].map(|k| uniform(5, 3 * i + k) - 0.5));
        let stretch = DVec3::new(1.0, 0.6, 0.4);
        let leaves: Vec<Generator> = (0..400)
            .map(|i| Generator {
                position: stretch * random(i),
                weight: 1.0,
                area: 3e-3,
            })
            .collect();
        let radius = 0.08;
        let grid = Grid::around(-0.5 * stretch, 0.5 * stretch, radius, 28);
        let leaf_area = Field::leaf_area(&leaves, radius)
            .density_grid(&grid)
            .iter()
            .map(|&v| v as f32)
            .collect();
        let mut directions: Vec<[f32; 4]> = fibonacci_directions(9)
            .iter()
            .map(|w| w.as_vec3().extend(0.0).to_array())
            .collect();
        // Along axes and diagonals the largest axis ties or the rays meet nodes exactly.
        directions.extend([
            [1.0, 0.0, 0.0, 0.0],
            [0.0, -1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
            [0.577_350_26, 0.577_350_26, -0.577_350_26, 0.0],
        ]);
        let points = (0..200)
            .map(|i: u32| {
                let q = (1.3 * random(1000 + i)).as_vec3();
                // The fourth component is the bits of the point's number.
                q.extend(f32::from_bits(i)).to_array()
            })
            .collect();
        Self {
            grid,
            leaf_area,
            directions,
            points,
        }
    }

    /// No leaves at all.
    fn bare() -> Self {
        let mut setting = Self::new();
        setting.leaf_area.fill(0.0);
        setting
    }

    /// Runs the three kernels, the directions in two batches, and compares each with its twin.
    fn run(&self, gpu: &Gpu) -> Result<[Outcome; 3]> {
        let nodes = self.grid.node_count();
        let count = self.directions.len();
        let leaf_area = gpu.upload("leaf area", &self.leaf_area)?;
        let directions = gpu.upload("directions", &self.directions)?;
        let points = gpu.upload("points", &self.points)?;
        let depth = gpu.buffer(BufferInfo::device("sky depth", (4 * nodes * count) as u64))?;
        let light = gpu.buffer(BufferInfo::device("sky light", (16 * nodes) as u64))?;
        let found = gpu.buffer(BufferInfo::device("open", (16 * self.points.len()) as u64))?;
        let ambient = gpu.buffer(BufferInfo::device(
            "ambient",
            (4 * self.points.len()) as u64,
        ))?;
        let missing = gpu.upload("missing", &[0u32])?;
        let sweep = gpu.compute_pipeline(shaders::SKY_DEPTH_COMP)?;
        let sum = gpu.compute_pipeline(shaders::SKY_LIGHT_COMP)?;
        let gather = gpu.compute_pipeline(shaders::SKY_GATHER_COMP)?;
        let mut work = gpu.work(QueueKind::Compute, "skylight")?;
        for (first, count) in [(0, 5), (5, count as u32 - 5), (0, count as u32)] {
            work.compute(
                "sky depth",
                &sweep,
                &[
                    Binding::Read(&leaf_area),
                    Binding::Read(&directions),
                    Binding::ReadWrite(&depth),
                ],
                &SkyDepth {
                    nodes: self.grid.nodes,
                    cell: self.grid.cell,
                    first,
                    count,
                },
                [SKY_GROUP * count, 1, 1],
            )?;
            // The last sweep is for the comparison of the depths of all directions.
            if first == 0 && count as usize == self.directions.len() {
                break;
            }
            work.compute(
                "sky light",
                &sum,
                &[
                    Binding::Read(&directions),
                    Binding::Read(&depth),
                    Binding::Read(&leaf_area),
                    Binding::ReadWrite(&light),
                ],
                &SkyLight {
                    node_count: nodes as u32,
                    first,
                    count,
                    share: 1.0 / self.directions.len() as f32,
                    extinction: EXTINCTION,
                    cell: self.grid.cell,
                },
                [nodes as u32, 1, 1],
            )?;
        }
        work.compute(
            "gather light",
            &gather,
            &[
                Binding::Read(&points),
                Binding::Read(&light),
                Binding::Write(&found),
                Binding::Write(&ambient),
                Binding::ReadWrite(&missing),
            ],
            &SkyGather {
                origin: self.grid.origin,
                cell: self.grid.cell,
                nodes: self.grid.nodes,
                count: self.points.len() as u32,
            },
            [self.points.len() as u32, 1, 1],
        )?;
        let depth = work.read::<f32>("depth", &depth)?;
        let light = work.read::<[f32; 4]>("light", &light)?;
        let found = work.read::<[f32; 4]>("open", &found)?;
        let ambient = work.read::<f32>("ambient", &ambient)?;
        let mut done = work.submit()?.wait()?;
        let gathered: Vec<[f32; 4]> = done
            .take(found)
            .iter()
            .zip(done.take(ambient))
            .map(|(open, ambient)| [open[0], open[1], open[2], ambient])
            .collect();
        Ok(self.compare(&done.take(depth), &done.take(light), &gathered))
    }

    fn compare(&self, depth: &[f32], light: &[[f32; 4]], gathered: &[[f32; 4]]) -> [Outcome; 3] {
        let leaf_area: Vec<f64> = self.leaf_area.iter().map(|&v| f64::from(v)).collect();
        let directions: Vec<DVec3> = self.directions.iter().map(|w| xyz(*w)).collect();
        let depths: Vec<f64> = directions
            .iter()
            .flat_map(|&w| {
                // The kernel's form: with the node's own half of the trapezoid; 0 at the far side.
                let own = 0.5 * f64::from(self.grid.cell) / w.abs().max_element();
                let depth = sky_depth(&self.grid, &leaf_area, w);
                depth
                    .into_iter()
                    .zip(leaf_area.clone())
                    .map(move |(d, l)| d + own * l)
            })
            .collect();
        let expected = sky_light(&self.grid, &leaf_area, &directions, f64::from(EXTINCTION));
        let deepest = depths.iter().copied().fold(0.0, f64::max);
        let errors = depths
            .iter()
            .zip(depth)
            .map(|(a, &b)| (a - f64::from(b)).abs());
        let at_points = self
            .points
            .iter()
            .map(|&q| light_at(&self.grid, &expected, xyz(q)))
            .map(|(open, mean)| (open.normalize(), mean));
        [
            Outcome {
                // Without leaves all depths are zero.
                error: largest(errors) / if deepest > 0.0 { deepest } else { 1.0 },
                limit: 1e-5,
                measure: "depth relative to the deepest",
            },
            Outcome {
                error: light_error(expected.iter().copied(), light),
                limit: 1e-5,
                measure: "light",
            },
            Outcome {
                error: light_error(at_points, gathered),
                limit: 1e-4,
                measure: "direction and transmittance",
            },
        ]
    }
}

fn light_error(expected: impl Iterator<Item = (DVec3, f64)>, found: &[[f32; 4]]) -> f64 {
    largest(expected.zip(found).map(|((open, mean), &f)| {
        let difference = (open - xyz(f)).abs().max_element();
        difference.max((mean - f64::from(f[3])).abs())
    }))
}

fn xyz(v: [f32; 4]) -> DVec3 {
    DVec3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]))
}

/// The largest value; NaN where one is.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |a, b| if b.is_nan() || b > a { b } else { a })
}
