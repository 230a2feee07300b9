//! A fraction of the generators (Luft, Balzer, Deussen 2007, section 3.1: "randomly selecting just
//! a fraction"), chosen on the host between two device passes: it is a search for a voxel size.

use std::collections::HashMap;

use glam::DVec3;

use super::generators::Generators;
use super::recorder::Recorder;
use super::settings::{Sampling, Settings};
use crate::Result;
use crate::math::sampling;

/// A generator on the host.
#[derive(Debug, Clone, Copy)]
struct Point {
    position: DVec3,
    weight: f64,
    area: f64,
}

/// About `fraction` of the generators and at most `most_generators`, never none.
pub(super) fn subset(
    r: &mut Recorder<'_>,
    all: Generators,
    settings: &Settings,
) -> Result<Generators> {
    let bound = f64::from(settings.most_generators) / all.count.max(1) as f64;
    let fraction = f64::from(settings.fraction).min(bound);
    if fraction >= 1.0 || all.count < 2 {
        return Ok(all);
    }
    let target = ((fraction * all.count as f64).round() as usize).max(1);
    let planned = |n: usize| vec![0.0; n];
    let centres: Vec<f32> = r.fetch("generator centres", &all.centres, || planned(4 * target))?;
    let areas: Vec<f32> = r.fetch("generator areas", &all.areas, || planned(target))?;
    let points: Vec<Point> = centres
        .chunks_exact(4)
        .zip(&areas)
        .take(all.count)
        .map(|(c, &area)| Point {
            position: DVec3::new(f64::from(c[0]), f64::from(c[1]), f64::from(c[2])),
            weight: f64::from(c[3]),
            area: f64::from(area),
        })
        .collect();
    let kept = match settings.sampling {
        _ if r.is_plan() => points,
        Sampling::Plain => plain(&points, fraction, settings.seed),
        Sampling::Stratified => stratified(&points, target, settings.seed),
    };
    let centres: Vec<[f32; 4]> = kept
        .iter()
        .map(|g| g.position.as_vec3().extend(g.weight as f32).to_array())
        .collect();
    let areas: Vec<f32> = kept.iter().map(|g| g.area as f32).collect();
    Ok(Generators {
        count: kept.len(),
        centres: r.upload("subset centres", &centres)?,
        areas: r.upload("subset areas", &areas)?,
    })
}

fn plain(all: &[Point], fraction: f64, seed: u32) -> Vec<Point> {
    let number = |i: usize| sampling::uniform(seed, i as u32);
    let mut kept: Vec<usize> = (0..all.len()).filter(|&i| number(i) < fraction).collect();
    if kept.is_empty() {
        kept.extend((0..all.len()).min_by(|&a, &b| number(a).total_cmp(&number(b))));
    }
    let scaled = |&i: &usize| Point {
        weight: all[i].weight / fraction,
        area: all[i].area / fraction,
        ..all[i]
    };
    kept.iter().map(scaled).collect()
}

/// Merges voxels of the size that leaves at most `target` generators, by bisection.
fn stratified(all: &[Point], target: usize, seed: u32) -> Vec<Point> {
    let (min, max) = all
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), g| {
            (low.min(g.position), high.max(g.position))
        });
    let extent = (max - min).max_element();
    if extent == 0.0 {
        return merge(all, |_| [0; 3]);
    }
    let shift = DVec3::from([0, 1, 2].map(|axis| sampling::uniform(seed, axis)));
    let voxel = |cell: f64| {
        move |g: &Point| {
            ((g.position - min) / cell + shift)
                .to_array()
                .map(|c| c as i64)
        }
    };
    let (mut fine, mut coarse) = (extent / 4096.0, 2.0 * extent);
    for _ in 0..32 {
        let middle = (fine * coarse).sqrt();
        if merge(all, voxel(middle)).len() > target {
            fine = middle;
        } else {
            coarse = middle;
        }
    }
    merge(all, voxel(coarse))
}

/// Weighted means per voxel, in the order of each voxel's first generator.
fn merge(all: &[Point], voxel: impl Fn(&Point) -> [i64; 3]) -> Vec<Point> {
    let mut slot = HashMap::new();
    let mut merged: Vec<Point> = Vec::new();
    for g in all {
        let k = *slot.entry(voxel(g)).or_insert(merged.len());
        if k == merged.len() {
            merged.push(Point {
                position: DVec3::ZERO,
                weight: 0.0,
                area: 0.0,
            });
        }
        merged[k].position += g.weight * g.position;
        merged[k].weight += g.weight;
        merged[k].area += g.area;
    }
    for g in &mut merged {
        g.position /= g.weight;
    }
    merged
}
