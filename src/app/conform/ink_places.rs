//! Hatch coordinates of places on smooth bodies and on branches.

use glam::{DVec2, DVec3, Vec3};

use super::{Case, Outcome};
use crate::Result;
use crate::abi::{InkCluster, InkFrame, InkPlaces};
use crate::gpu::shaders::ink as shaders;
use crate::gpu::{Binding, Gpu, QueueKind};
use crate::math::sampling::uniform;
use crate::reference::ink_body::body_hatch;
use crate::reference::ink_wood::wood_hatch;

/// Places.
const COUNT: u32 = 4000;
/// Clusters.
const CLUSTERS: u32 = 37;
/// Tiles per metre on branches.
const TILES: f64 = 5.0;
/// Steps of whole tiles and of the angle so near are left to rounding.
const MARGIN: f64 = 1e-4;

pub(super) fn cases() -> Vec<Case> {
    vec![
        Case {
            name: "ink.places.body",
            run: body,
        },
        Case {
            name: "ink.places.round",
            run: |gpu| wood(gpu, false),
        },
        Case {
            name: "ink.places.along",
            run: |gpu| wood(gpu, true),
        },
    ]
}

struct Places {
    frame: InkFrame,
    places: Vec<[f32; 4]>,
    clusters: Vec<InkCluster>,
}

impl Places {
    fn new() -> Self {
        let u = |seed: u32, i: u32| uniform(seed, i) as f32;
        let signed = |seed: u32, i: u32| 2.0 * u(seed, i) - 1.0;
        let cluster = |i: u32| {
            let turn = std::f32::consts::TAU * u(90, i);
            InkCluster {
                centre: [signed(91, i), signed(92, i), signed(93, i)],
                radius: 0.1 + u(94, i),
                reference: [u(95, i), u(96, i)],
                texture_up: [turn.cos(), turn.sin()],
                tiles: [1.0 + 3.0 * u(97, i), 1.0 + 3.0 * u(98, i)],
                ..InkCluster::default()
            }
        };
        let place = |i: u32| {
            // Every fiftieth is a cluster's centre.
            if i.is_multiple_of(50) {
                let c = cluster(i % CLUSTERS).centre;
                return [c[0], c[1], c[2], signed(99, i)];
            }
            [
                signed(81, i),
                signed(82, i),
                signed(83, i),
                4.0 * signed(84, i),
            ]
        };
        let right = Vec3::new(0.8, 0.0, -0.6);
        Self {
            frame: InkFrame {
                eye: [3.0, 1.5, 4.0],
                right: right.to_array(),
                up: right.cross(Vec3::new(-0.6, 0.0, -0.8)).to_array(),
                ..InkFrame::default()
            },
            places: (0..COUNT).map(place).collect(),
            clusters: (0..CLUSTERS).map(cluster).collect(),
        }
    }

    fn run(&self, gpu: &Gpu, along: bool) -> Result<Vec<[f32; 4]>> {
        let kernel = gpu.compute_pipeline_with(shaders::PLACES_COMP, &[])?;
        let frame = gpu.upload("frame", &[self.frame])?;
        let places = gpu.upload("places", &self.places)?;
        let clusters = gpu.upload("clusters", &self.clusters)?;
        let out = gpu.upload("coordinates", &vec![[0.0_f32; 4]; self.places.len()])?;
        let push = InkPlaces {
            count: COUNT,
            clusters: CLUSTERS,
            tiles: TILES as f32,
            along: u32::from(along),
        };
        let bindings = [
            Binding::Read(&frame),
            Binding::Read(&places),
            Binding::Read(&clusters),
            Binding::Write(&out),
        ];
        let mut work = gpu.work(QueueKind::Compute, "places")?;
        work.compute("places", &kernel, &bindings, &push, [COUNT, 1, 1])?;
        work.submit()?.wait()?;
        gpu.read(&out)
    }
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

fn body(gpu: &Gpu) -> Result<Outcome> {
    let places = Places::new();
    let found = places.run(gpu, false)?;
    let eye = wide(places.frame.eye);
    let axes = [wide(places.frame.right), wide(places.frame.up)];
    let mut worst: f64 = 0.0;
    for (i, got) in found.iter().enumerate() {
        let cluster = &places.clusters[i % CLUSTERS as usize];
        let [x, y, z, _] = places.places[i];
        let place = wide([x, y, z]);
        let centre = wide(cluster.centre);
        let back = (place - centre)
            .normalize_or_zero()
            .dot((eye - centre).normalize());
        // Straight behind the centre the direction is free.
        if back < -0.9999 {
            continue;
        }
        let want = body_hatch(cluster, place, eye, axes);
        let size = 1.0 + want.length();
        let off = (DVec2::new(f64::from(got[0]), f64::from(got[1])) - want).length();
        worst = worst.max(off / size);
    }
    Ok(Outcome::new(worst, 2e-4, "tiles, of their number"))
}

fn wood(gpu: &Gpu, along: bool) -> Result<Outcome> {
    let places = Places::new();
    let found = places.run(gpu, along)?;
    let mut worst: f64 = 0.0;
    for (got, place) in found.iter().zip(&places.places) {
        let hatch = place.map(f64::from);
        let want = wood_hatch(hatch, TILES, along);
        // Where the number of tiles round changes, rounding decides.
        let near = |step: f64| {
            let mut moved = hatch;
            moved[3] += step;
            (wood_hatch(moved, TILES, along) - want).length() > 1e-9
        };
        if near(MARGIN) || near(-MARGIN) || hatch[0].hypot(hatch[1]) < 1e-3 {
            continue;
        }
        let got = DVec2::new(f64::from(got[2]), f64::from(got[3]));
        let off = got - want;
        // Coordinates come wrapped into their tile.
        worst = worst.max((off - off.round()).abs().max_element());
    }
    Ok(Outcome::new(worst, 2e-4, "tiles"))
}
