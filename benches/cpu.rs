//! What runs on the host for every model: growing, flattening, splitting, exporting.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use umbrage::foliage::Split;
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
}

criterion_group!(benches, host);
criterion_main!(benches);
