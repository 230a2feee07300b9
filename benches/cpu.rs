//! What runs on the host for every model: growing, flattening, splitting, exporting.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use glam::Vec3;
use umbrage::foliage::Split;
use umbrage::ink::clusters::{Choice, Clusters};
use umbrage::math::sampling::r2;
use umbrage::scene::export::{self, ExportOptions};
use umbrage::scene::grow::{self, GrowOptions, Species};
use umbrage::scene::{Geometry, Model};

fn plant(leaves: u32) -> Model {
    let options = GrowOptions {
        leaves: Some(leaves),
        ..GrowOptions::default()
    };
    grow::grow(Species::Shrub, &options).expect("the options are in range")
}

/// `count` leaves in a crown, evenly.
fn leaves(count: u32) -> Vec<Vec3> {
    let leaf = |i: u32| {
        let place = r2(i);
        let (z, turn) = (2.0 * place.x - 1.0, std::f64::consts::TAU * place.y);
        let (across, radius) = (
            (1.0 - z * z).sqrt(),
            (f64::from(i) / f64::from(count)).cbrt(),
        );
        (radius * glam::DVec3::new(across * turn.cos(), z, across * turn.sin())).as_vec3()
    };
    (0..count).map(leaf).collect()
}

fn host(criterion: &mut Criterion) {
    let model = plant(2000);
    let geometry = Geometry::flatten(&model);
    criterion.bench_function("grow", |b| b.iter(|| plant(black_box(2000))));
    criterion.bench_function("flatten", |b| {
        b.iter(|| Geometry::flatten(black_box(&model)));
    });
    criterion.bench_function("split", |b| {
        b.iter(|| Split::new(&model, black_box(&geometry), None));
    });
    criterion.bench_function("export", |b| {
        b.iter(|| export::gltf(black_box(&model), &[], &ExportOptions::default()));
    });
    // The radius is the default: 0.06 of the crown's diagonal.
    let crown = leaves(200_000);
    let radius = 0.06 * 12.0_f32.sqrt();
    criterion.bench_function("clusters of 200,000 leaves", |b| {
        b.iter(|| Clusters::new(black_box(&crown), radius, Choice::Smallest));
    });
}

criterion_group!(benches, host);
criterion_main!(benches);
