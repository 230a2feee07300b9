//! `umbrage bench rays`: rays a second, from the vertices of the leaves into all directions.

use glam::{DVec2, Vec3};
use serde_json::{Value, json};

use crate::app::cli::BenchArgs;
use crate::app::input::Input;
use crate::app::report::Table;
use crate::app::{Context, Report, console};
use crate::gpu::Gpu;
use crate::leaf::rays::{Occluders, RayScene};
use crate::leaf::trace::{Query, Ray, Tracer};
use crate::math::sampling::{uniform, uniform_sphere};
use crate::math::stats::median;
use crate::scene::Geometry;
use crate::{Error, Result};

/// Rays of a run.
const RAYS: u32 = 1 << 18;
/// A ray starts so far from its vertex, in extents of the model.
const OFFSET: f32 = 1e-3;

/// What one way of tracing took.
struct Row {
    query: Query,
    scene: &'static str,
    rate: f64,
    share: f64,
}

/// Times any-hit and nearest-hit rays, on solid triangles and with alpha.
///
/// # Errors
/// A model without triangles, or a failing device.
pub fn run(context: &Context, args: &BenchArgs) -> Result<Report> {
    let input = Input::load(&args.input.input, &args.input.model.textures)?;
    let geometry = Geometry::flatten(&input.model);
    let gpu = context.gpu()?;
    let rays = rays(&geometry)
        .ok_or_else(|| Error::usage(format!("{}: has no triangles", args.input.input)))?;
    let start = std::time::Instant::now();
    let solid = Occluders::solid(&geometry);
    let build = start.elapsed().as_secs_f64();
    let masked = Occluders::new(&input.model, &geometry)?;
    let mut rows = Vec::new();
    let _working = console::working("tracing");
    for (name, occluders) in [("solid", &solid), ("masked", &masked)] {
        if name == "masked" && !masked.masked() {
            continue;
        }
        let scene = RayScene::new(gpu, occluders)?;
        for query in [Query::Any, Query::Nearest] {
            rows.push(measure(gpu, args, &scene, &rays, (name, query))?);
        }
    }
    Ok(report(gpu, args, &solid, build, &rows))
}

/// From vertices of the last part (leaves, in most models) into uniform directions.
fn rays(geometry: &Geometry) -> Option<Vec<Ray>> {
    let part = geometry.parts.iter().rfind(|p| p.index_count > 0)?;
    let occluders = geometry.diagonal();
    let scale = if occluders > 0.0 {
        occluders.recip()
    } else {
        1.0
    };
    let extent = (geometry.max - geometry.min).max_element() * scale;
    let ray = |i: u32| {
        let vertex = (uniform(1, i) * part.vertex_count as f64) as usize;
        let u = DVec2::new(uniform(2, i), uniform(3, i));
        let direction = uniform_sphere(u).as_vec3();
        let origin: Vec3 =
            scale * geometry.positions[part.first_vertex + vertex] + OFFSET * extent * direction;
        Ray {
            origin: origin.to_array(),
            t_max: f32::INFINITY,
            direction: direction.to_array(),
            tag: 0.0,
        }
    };
    Some((0..RAYS).map(ray).collect())
}

fn measure(
    gpu: &Gpu,
    args: &BenchArgs,
    scene: &RayScene,
    rays: &[Ray],
    (name, query): (&'static str, Query),
) -> Result<Row> {
    let mut tracer = Tracer::new(gpu)?;
    let mut times = Vec::new();
    let mut hits = 0;
    for run in 0..args.warm_up + args.runs {
        tracer.times.clear();
        hits = match query {
            Query::Any => tracer.any(scene, rays)?.iter().filter(|&&h| h).count(),
            Query::Nearest => tracer.nearest(scene, rays)?.iter().flatten().count(),
        };
        let traces = tracer.times.iter().filter(|t| t.label == "trace");
        if run >= args.warm_up {
            times.push(traces.map(|t| t.nanoseconds as f64 * 1e-9).sum::<f64>());
        }
    }
    Ok(Row {
        query,
        scene: name,
        rate: rays.len() as f64 / median(&times),
        share: hits as f64 / rays.len() as f64,
    })
}

fn report(gpu: &Gpu, args: &BenchArgs, solid: &Occluders, build: f64, rows: &[Row]) -> Report {
    let triangles = solid.indices.len() / 3;
    let (nodes, pairs) = (solid.bvh.nodes.len() / 5, solid.bvh.order.len());
    let mut table = Table::new(&["query", "triangles", "Mrays/s", "hits"]);
    let mut json_rows: Vec<Value> = Vec::new();
    for row in rows {
        let query = match row.query {
            Query::Any => "any",
            Query::Nearest => "nearest",
        };
        let rate = format!("{:.3}", row.rate * 1e-6);
        table.row(&[&query, &row.scene, &rate, &format!("{:.3}", row.share)]);
        json_rows.push(json!({
            "query": query, "triangles": row.scene, "rays_per_second": row.rate,
            "hit_share": row.share,
        }));
    }
    let text = format!(
        "rays through {}: {triangles} triangles in {pairs} pairs, {nodes} nodes on {} levels, built in {build:.2} s\n\
         {RAYS} rays a run on {}, median of {} runs\n\n{table}",
        args.input.input,
        solid.bvh.depth,
        gpu.info().name,
        args.runs,
    );
    let json = json!({
        "bench": "rays", "model": args.input.input.to_string(), "triangles": triangles,
        "pairs": pairs, "nodes": nodes, "levels": solid.bvh.depth, "build_seconds": build, "rays": RAYS,
        "device": gpu.info().name, "rows": json_rows,
    });
    Report::new(text, json)
}
