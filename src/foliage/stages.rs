//! The stages of a bake in order: the one path behind [`super::Bake::compute`] and
//! [`super::Recipe::new`].

use glam::{DVec3, Vec3};

use super::bake::{Bake, Stats};
use super::bins::BinGrid;
use super::field::{Field, Queries};
use super::frame::Frame;
use super::generators::{self, SortedGenerators};
use super::recorder::{Kernel, Recorder, Store, Use};
use super::settings::{AmbientMode, Encoding, NormalsMode, Settings, Threshold};
use super::split::{Leaves, Split};
use crate::Result;
use crate::abi;
use crate::gpu::shaders::foliage as shaders;
use crate::scene::Geometry;

/// Normalised positions of some vertices, padded to four floats.
fn normalised(geometry: &Geometry, frame: &Frame, vertices: &[u32]) -> Vec<[f32; 4]> {
    vertices
        .iter()
        .map(|&v| {
            frame
                .normalise(geometry.positions[v as usize])
                .extend(0.0)
                .to_array()
        })
        .collect()
}

/// Foliage triangles with indices into the foliage's own vertices.
fn local_indices(geometry: &Geometry, split: &Split) -> Vec<u32> {
    let mut local = vec![0; geometry.positions.len()];
    for (i, &v) in (0u32..).zip(&split.foliage_vertices) {
        local[v as usize] = i;
    }
    split
        .foliage_indices
        .iter()
        .map(|&v| local[v as usize])
        .collect()
}

/// Value of a threshold: as given, or the quantile of `values`.
pub(super) fn threshold(t: Threshold, values: &mut [f32]) -> f32 {
    match t {
        Threshold::Absolute(v) => v,
        Threshold::Quantile(q) => quantile(values, f64::from(q)),
    }
}

/// Quantile with linear interpolation between order statistics; 0 when empty.
fn quantile(values: &mut [f32], p: f64) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let at = p * (values.len() - 1) as f64;
    let low = at.floor() as usize;
    let (_, &mut below, above) = values.select_nth_unstable_by(low, f32::total_cmp);
    let next = above.iter().copied().min_by(f32::total_cmp).unwrap_or(below);
    let t = at - low as f64;
    (f64::from(below) + t * (f64::from(next) - f64::from(below))) as f32
}

/// Everything that the stages share.
struct Scene<'a> {
    geometry: &'a Geometry,
    split: &'a Split,
    settings: &'a Settings,
    frame: Frame,
}

/// One set of vertices on the device.
struct Vertices {
    queries: Queries,
    /// Positions in the order of the split.
    count: usize,
}

pub(super) fn bake(
    r: &mut Recorder<'_>,
    geometry: &Geometry,
    split: &Split,
    settings: &Settings,
) -> Result<Bake> {
    settings.check()?;
    let (min, max) = split.bounds(geometry);
    let scene = Scene {
        geometry,
        split,
        settings,
        frame: Frame::new(min, max),
    };
    let mut stats = Stats {
        foliage_vertices: split.foliage_vertices.len(),
        covered_vertices: split.covered_vertices.len(),
        diagonal: scene.frame.diagonal,
        ..Stats::default()
    };
    let mut bake = Bake {
        normals: geometry.normals.clone(),
        ambient: vec![1.0; geometry.positions.len()],
        foliage_parts: split.foliage_parts.clone(),
        ..Bake::default()
    };
    let needs_normals = settings.normals != NormalsMode::Original && settings.blend > 0.0;
    let needs_ambient = matches!(
        settings.ambient,
        AmbientMode::Eq4 | AmbientMode::Transmittance
    );
    if needs_normals || needs_ambient {
        device_stages(r, &scene, &mut bake, &mut stats)?;
    }
    bake.stats = stats;
    Ok(bake)
}

fn device_stages(
    r: &mut Recorder<'_>,
    scene: &Scene<'_>,
    bake: &mut Bake,
    stats: &mut Stats,
) -> Result<()> {
    let Scene {
        geometry,
        split,
        settings,
        frame,
    } = scene;
    r.report("leaves", 0.0);
    let foliage = normalised(geometry, frame, &split.foliage_vertices);
    let leaves = Leaves::new(
        &geometry.positions,
        &split.foliage_indices,
        settings.primitive,
    );
    stats.generators = leaves.len();
    let points = r.upload("foliage points", &foliage)?;
    let generators = generators::generators(r, &points, &local_indices(geometry, split), &leaves)?;
    let radii = [settings.rho, settings.rho_ambient];
    let grid = BinGrid::for_generators(frame.half, generators.count, &radii);
    let binned = generators.bin(r, grid)?;
    let sorted = generators.texels(r, &binned, 0.0)?;
    let queries = Queries::sort(r, "foliage", &points, foliage.len(), frame.half)?;

    if std::env::var_os("DBGQ").is_some() {
        let q: Vec<[f32;4]> = r.fetch("q", &queries.sorted, Vec::new)?; let p: Vec<[f32;4]> = r.fetch("q", &points, Vec::new)?;
        let mut seen = vec![0; queries.count]; let mut bad=0; for x in &q { let i=x[3].to_bits() as usize; if i>=seen.len() {bad+=1;continue;} seen[i]+=1; if p[i][..3]!=x[..3] {bad+=1;} }
        eprintln!("bad {bad} missing {} dup {}", seen.iter().filter(|&&x|x==0).count(), seen.iter().filter(|&&x|x>1).count());
        let b=16; for c in q.chunks(b).take(8) { let mut lo=[9f32;3]; let mut hi=[-9f32;3]; for x in c { for k in 0..3 { lo[k]=lo[k].min(x[k]); hi[k]=hi[k].max(x[k]); } } eprintln!("{lo:?} {hi:?}"); }
    }
    let near = Field {
        generators: &sorted,
        radius: settings.rho,
        norm: settings.norm,
    };
    let field = near.at_queries(r, "field at foliage", &queries, true)?;
    let found = r.array::<[f32; 4]>("directions", queries.count)?;
    let counters = r.array::<u32>("missing directions", 1)?;
    r.fill("clear missing", &counters, 0)?;
    r.compute(
        "directions",
        Kernel {
            shader: shaders::DIRECTIONS_COMP,
            constants: &[(0, abi::DIRECTIONS_SINGLE)],
        },
        &[
            Use::Read(&field),
            Use::Read(&field),
            Use::ReadWrite(&found),
            Use::ReadWrite(&counters),
        ],
        &abi::Directions {
            count: queries.count as u32,
            radius: settings.rho,
            wide_radius: 2.0 * settings.rho,
        },
        queries.count,
    )?;
    let ambient_field = Field {
        radius: settings.rho_ambient,
        ..near
    };
    let ambient = ambient_field.at_queries(r, "ambient density", &queries, false)?;
    let d = r.fetch("x", &ambient, || vec![0.0f32])?;
    let n = NodeGridTest(r, &near, frame, settings)?;
    let _ = (d, n, bake, found);
    Ok(())
}
#[allow(non_snake_case)]
fn NodeGridTest(r: &mut Recorder<'_>, near: &Field<'_>, frame: &Frame, s: &Settings) -> Result<Vec<f32>> {
    let g = super::field::NodeGrid::around(frame.half, f64::from(s.rho), s.cells, s.memory)?;
    let d = near.on_grid(r, "density grid", &g)?;
    r.fetch("x", &d, || vec![0.0f32])
}
#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{Gpu, GpuOptions};
    #[test]
    fn dbg_scan() {
        let gpu = Gpu::new(&GpuOptions::default()).unwrap();
        let mut p = |_: &str, _: f32| {};
        let mut r = Recorder::new(Some(&gpu), &mut p);
        for n in [1usize, 255, 256, 257, 1000, 70_000, 262_144] {
            let values: Vec<u32> = (0..n as u32).map(|i| (i * 7919) % 13).collect();
            let v = r.upload("v", &values).unwrap();
            let f = super::super::bins::scan(&mut r, "t", &v, n).unwrap();
            let got: Vec<u32> = r.fetch("f", &f, Vec::new).unwrap();
            let mut run = 0;
            let mut bad = 0;
            for i in 0..n { if got[i] != run { bad += 1; } run += values[i]; }
            assert_eq!((bad, got[n]), (0, run), "n={n}");
        }
    }
}
