//! Last checks of a model that has been read: it has triangles, and they fit.

use glam::{DVec3, Vec3};

use super::json::Check;
use crate::scene::model::Model;

/// Most vertices and most indices that all placements together may have.
const PLACED_LIMIT: usize = 1 << 28;
/// Largest extent and offset in metres: squares of lengths must stay finite in f32.
const EXTENT_LIMIT: f64 = 1e18;

pub(super) fn check(model: &Model) -> Check<()> {
    let (mut vertices, mut indices) = (0usize, 0usize);
    let boxes: Vec<_> = model
        .meshes
        .iter()
        .map(|m| {
            let points = m.primitives.iter().flat_map(|p| &p.positions);
            points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), &q| {
                (lo.min(q.into()), hi.max(q.into()))
            })
        })
        .collect();
    for instance in &model.instances {
        for p in &model.meshes[instance.mesh].primitives {
            vertices = vertices.saturating_add(p.positions.len());
            indices = indices.saturating_add(p.indices.len());
        }
        let (lo, hi) = boxes[instance.mesh];
        if lo.x > hi.x {
            continue;
        }
        for corner in 0..8u8 {
            let pick =
                |bit: u8, lo: f32, hi: f32| f64::from(if corner & bit == 0 { lo } else { hi });
            let local = DVec3::new(
                pick(1, lo.x, hi.x),
                pick(2, lo.y, hi.y),
                pick(4, lo.z, hi.z),
            );
            let world = instance.local_to_world.transform_point3(local);
            if world.abs().max_element() > EXTENT_LIMIT || !world.is_finite() {
                return Err(format!(
                    "\"{}\" reaches to {world}, beyond {EXTENT_LIMIT:e} m",
                    instance.name
                ));
            }
        }
    }
    if vertices.max(indices) > PLACED_LIMIT {
        return Err(format!(
            "its placements have {vertices} vertices and {indices} indices in all, more than {PLACED_LIMIT}"
        ));
    }
    if indices == 0 {
        return Err("there are no triangles to draw".into());
    }
    Ok(())
}
