//! The implicit surface and what is nearest to it, against the twins in f64.
//!
//! Topology is compared on the device's own density, widened: a node that rounding puts on the
//! other side of the threshold would otherwise look like a fault of the surface.

use glam::DVec3;

use super::{Case, Outcome};
use crate::Result;
use crate::foliage::probe::{SurfaceAnswer, SurfaceQuestion, surface};
use crate::foliage::{Norm, SurfaceNormals};
use crate::gpu::Gpu;
use crate::math::sampling::uniform;
use crate::reference::density::{self, Field, Grid};
use crate::reference::generators::Generator;
use crate::reference::marching_cubes::{Surface, marching_cubes};
use crate::reference::realign;

pub(super) fn cases() -> Vec<Case> {
    vec![
        Case {
            name: "foliage.surface.topology.one_ball",
            run: |gpu| topology(gpu, &ball()),
        },
        Case {
            name: "foliage.surface.topology.cloud",
            run: |gpu| topology(gpu, &cloud(Norm::Euclidean)),
        },
        Case {
            name: "foliage.surface.topology.manhattan",
            run: |gpu| topology(gpu, &cloud(Norm::Manhattan)),
        },
        Case {
            name: "foliage.surface.topology.maximum",
            run: |gpu| topology(gpu, &cloud(Norm::Maximum)),
        },
        Case {
            name: "foliage.surface.topology.empty",
            run: |gpu| topology(gpu, &Blob { tau: 1e3, ..ball() }),
        },
        Case {
            name: "foliage.surface.topology.coincident",
            run: |gpu| topology(gpu, &coincident()),
        },
        Case {
            name: "foliage.surface.topology.tau_zero",
            run: |gpu| topology(gpu, &Blob { tau: 0.0, ..ball() }),
        },
        Case {
            name: "foliage.surface.vertices",
            run: vertices,
        },
        Case {
            name: "foliage.surface.normals.gradient",
            run: |gpu| normals(gpu, SurfaceNormals::Gradient),
        },
        Case {
            name: "foliage.surface.normals.faces",
            run: |gpu| normals(gpu, SurfaceNormals::Faces),
        },
        Case {
            name: "foliage.nearest.vertex",
            run: nearest_vertex,
        },
        Case {
            name: "foliage.nearest.tie",
            run: nearest_tie,
        },
        Case {
            name: "foliage.realign.vertex",
            run: |gpu| directions(gpu, &cloud(Norm::Euclidean), |a| &a.vertex, twin_vertex),
        },
        Case {
            name: "foliage.realign.face",
            run: |gpu| directions(gpu, &cloud(Norm::Euclidean), |a| &a.face, twin_face),
        },
        Case {
            name: "foliage.realign.vertex.fine",
            run: |gpu| directions(gpu, &fine(), |a| &a.vertex, twin_vertex),
        },
        Case {
            name: "foliage.realign.face.fine",
            run: |gpu| directions(gpu, &fine(), |a| &a.face, twin_face),
        },
        Case {
            name: "foliage.realign.exact",
            run: |gpu| directions(gpu, &cloud(Norm::Euclidean), |a| &a.exact, twin_exact),
        },
        Case {
            name: "foliage.realign.exact.crowded",
            run: |gpu| directions(gpu, &crowded(), |a| &a.exact, twin_exact),
        },
    ]
}

/// Generators, field and grid of one case.
struct Blob {
    generators: Vec<[f32; 4]>,
    half: DVec3,
    radius: f32,
    tau: f32,
    norm: Norm,
    cells: u32,
    queries: Vec<[f32; 4]>,
    normals: SurfaceNormals,
}

fn ball() -> Blob {
    Blob {
        generators: vec![[0.01, -0.02, 0.03, 1.0]],
        half: DVec3::splat(0.1),
        radius: 0.3,
        tau: 0.3,
        norm: Norm::Euclidean,
        cells: 24,
        queries: Vec::new(),
        normals: SurfaceNormals::Gradient,
    }
}

fn coincident() -> Blob {
    Blob {
        generators: vec![[0.0, 0.0, 0.0, 1.0]; 100],
        tau: 30.0,
        ..ball()
    }
}

/// 300 generators in a box, with queries among them.
fn cloud(norm: Norm) -> Blob {
    let half = DVec3::new(0.35, 0.3, 0.2);
    let point = |i: u32, w: f32| {
        let [x, y, z] =
            [0, 1, 2].map(|a| ((2.0 * uniform(7, 3 * i + a as u32) - 1.0) * half[a]) as f32);
        [x, y, z, w]
    };
    let generators = (0..300).map(|i| point(i, 1.0)).collect();
    let queries = (300..500).map(|i| point(i, 0.0)).collect();
    Blob {
        generators,
        half,
        radius: 0.12,
        tau: 0.6,
        norm,
        cells: 32,
        queries,
        ..ball()
    }
}

/// The cloud on a fine grid: more items than one level of any table holds.
fn fine() -> Blob {
    let mut blob = Blob {
        cells: 112,
        ..cloud(Norm::Euclidean)
    };
    blob.queries.truncate(60);
    blob
}

/// Thousands of generators in reach of every point, and a grid so coarse that the descent is long:
/// drivers that end the loops of an invocation after so many rounds must not end it early.
fn crowded() -> Blob {
    let half = DVec3::new(0.3, 0.06, 0.05);
    let point = |i: u32, w: f32| {
        let [x, y, z] =
            [0, 1, 2].map(|a| ((2.0 * uniform(9, 3 * i + a as u32) - 1.0) * half[a]) as f32);
        [x, y, z, w]
    };
    Blob {
        generators: (0..8000).map(|i| point(i, 1.0)).collect(),
        half,
        radius: 0.45,
        tau: 600.0,
        cells: 6,
        queries: (8000..8016).map(|i| point(i, 0.0)).collect(),
        ..ball()
    }
}

impl Blob {
    fn run(&self, gpu: &Gpu) -> Result<SurfaceAnswer> {
        surface(
            gpu,
            &SurfaceQuestion {
                generators: &self.generators,
                half: self.half,
                radius: self.radius,
                norm: self.norm,
                cells: self.cells,
                tau: self.tau,
                normals: self.normals,
                queries: &self.queries,
            },
        )
    }

    fn field(&self) -> Field {
        let generators: Vec<Generator> = self
            .generators
            .iter()
            .map(|g| Generator {
                position: point(*g),
                weight: f64::from(g[3]),
                area: 0.0,
            })
            .collect();
        let norm = match self.norm {
            Norm::Euclidean => density::Norm::Euclidean,
            Norm::Manhattan => density::Norm::Manhattan,
            Norm::Maximum => density::Norm::Maximum,
        };
        Field::new(&generators, f64::from(self.radius), norm)
    }

    /// The twin's surface on the device's density.
    fn twin(&self, answer: &SurfaceAnswer) -> Surface {
        let g = &answer.grid;
        let grid = Grid {
            origin: g.origin,
            cell: g.cell,
            nodes: g.nodes,
        };
        let values: Vec<f64> = answer.density.iter().map(|&d| f64::from(d)).collect();
        marching_cubes(&grid, &values, f64::from(self.tau))
    }
}

fn point(p: [f32; 4]) -> DVec3 {
    DVec3::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2]))
}

/// The device's surface as the twin's type, so that later stages are compared on one surface.
fn widened(answer: &SurfaceAnswer) -> Surface {
    Surface {
        vertices: answer
            .surface
            .positions
            .iter()
            .map(|p| p.as_dvec3())
            .collect(),
        triangles: answer
            .surface
            .indices
            .chunks_exact(3)
            .map(|t| [t[0], t[1], t[2]])
            .collect(),
    }
}

/// Differing triangles, plus one for every edge that is not shared by exactly two.
fn topology(gpu: &Gpu, blob: &Blob) -> Result<Outcome> {
    let answer = blob.run(gpu)?;
    let (device, twin) = (widened(&answer), blob.twin(&answer));
    let differing = device
        .triangles
        .iter()
        .zip(&twin.triangles)
        .filter(|(a, b)| a != b)
        .count()
        + device.triangles.len().abs_diff(twin.triangles.len())
        + device.vertices.len().abs_diff(twin.vertices.len());
    let open = device.edges().values().filter(|&&e| e != (1, 1)).count();
    Ok(Outcome::new(
        (differing + open) as f64,
        0.0,
        "differing triangles and open edges",
    ))
}

/// Largest distance of a vertex from the twin's, in cells.
fn vertices(gpu: &Gpu) -> Result<Outcome> {
    let blob = cloud(Norm::Euclidean);
    let answer = blob.run(gpu)?;
    let twin = blob.twin(&answer);
    let cell = f64::from(answer.grid.cell);
    let device = widened(&answer);
    let far = device
        .vertices
        .iter()
        .zip(&twin.vertices)
        .map(|(a, b)| a.distance(*b) / cell);
    let count = answer.surface.positions.len().abs_diff(twin.vertices.len()) as f64;
    Ok(Outcome::new(far.fold(count, f64::max), 1e-4, "cells"))
}

/// Largest angle of surface normals, degrees.
fn normals(gpu: &Gpu, mode: SurfaceNormals) -> Result<Outcome> {
    let blob = Blob {
        normals: mode,
        ..cloud(Norm::Euclidean)
    };
    let answer = blob.run(gpu)?;
    let surface = widened(&answer);
    let twin = match mode {
        SurfaceNormals::Gradient => surface.gradient_normals(&blob.field()),
        SurfaceNormals::Faces => surface.face_normals(),
    };
    let angles = answer
        .surface
        .normals
        .iter()
        .zip(twin)
        .map(|(a, b)| degrees(a.as_dvec3(), b));
    // Faces may be slivers, whose area vector is a difference of nearly equal numbers.
    Ok(Outcome::new(angles.fold(0.0, f64::max), 0.05, "degrees"))
}

fn degrees(a: DVec3, b: DVec3) -> f64 {
    // The arc cosine of a dot product near one would lose half the digits.
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

/// Queries whose nearest vertex is farther than the true nearest by more than rounding.
fn nearest_vertex(gpu: &Gpu) -> Result<Outcome> {
    let blob = cloud(Norm::Euclidean);
    let answer = blob.run(gpu)?;
    let vertices = widened(&answer).vertices;
    let wrong = blob
        .queries
        .iter()
        .zip(&answer.nearest_vertex)
        .filter(|(q, found)| {
            let q = point(**q);
            let best = realign::nearest_vertex(q, &vertices).expect("there is a surface");
            let (true_distance, distance) = (
                q.distance(vertices[best]),
                q.distance(vertices[**found as usize]),
            );
            best != **found as usize && distance > true_distance * (1.0 + 1e-6)
        });
    let missing = blob.queries.len().abs_diff(answer.nearest_vertex.len());
    Ok(Outcome::new(
        (wrong.count() + missing) as f64,
        0.0,
        "wrong vertices",
    ))
}

/// A query at the centre of a symmetric ball is equally far from several vertices: the lowest
/// number wins.
fn nearest_tie(gpu: &Gpu) -> Result<Outcome> {
    let blob = Blob {
        generators: vec![[0.0, 0.0, 0.0, 1.0]],
        half: DVec3::splat(0.25),
        radius: 0.25,
        cells: 18,
        queries: vec![[0.0; 4]; 3],
        ..ball()
    };
    let answer = blob.run(gpu)?;
    let squared = |p: &glam::Vec3| p.length_squared();
    let least = answer
        .surface
        .positions
        .iter()
        .map(squared)
        .fold(f32::INFINITY, f32::min);
    let lowest = answer
        .surface
        .positions
        .iter()
        .position(|p| squared(p) <= least * (1.0 + 2e-7));
    let wrong = answer.nearest_vertex.iter().filter(|&&n| {
        // Any of the equals within one rounding is a tie; a higher number than the lowest is not.
        Some(n as usize) != lowest && squared(&answer.surface.positions[n as usize]) > least
    });
    Ok(Outcome::new(wrong.count() as f64, 0.0, "ties lost"))
}

type Twin = fn(DVec3, &Blob, &Surface, &[DVec3]) -> Option<DVec3>;

fn twin_vertex(q: DVec3, _: &Blob, surface: &Surface, normals: &[DVec3]) -> Option<DVec3> {
    realign::vertex_normal(q, surface, normals)
}

fn twin_face(q: DVec3, _: &Blob, surface: &Surface, normals: &[DVec3]) -> Option<DVec3> {
    realign::face_normal(q, surface, normals)
}

fn twin_exact(q: DVec3, blob: &Blob, surface: &Surface, _: &[DVec3]) -> Option<DVec3> {
    realign::exact_normal(q, &blob.field(), f64::from(blob.tau), surface)
}

/// Largest angle of a realigned normal, degrees, over the queries that are not between two
/// nearest points (where the nearest and the next differ by rounding only).
fn directions(
    gpu: &Gpu,
    blob: &Blob,
    pick: fn(&SurfaceAnswer) -> &Vec<[f32; 4]>,
    twin: Twin,
) -> Result<Outcome> {
    let answer = blob.run(gpu)?;
    let surface = widened(&answer);
    let normals: Vec<DVec3> = answer
        .surface
        .normals
        .iter()
        .map(|n| n.as_dvec3())
        .collect();
    let mut angles: Vec<f64> = Vec::new();
    for (q, found) in blob.queries.iter().zip(pick(&answer)) {
        if let Some(expected) = twin(point(*q), blob, &surface, &normals) {
            angles.push(degrees(point(*found), expected));
        }
    }
    angles.sort_by(f64::total_cmp);
    // One query in fifty may sit where two points of the surface are equally near.
    let error = angles
        .get((angles.len() * 49).div_ceil(50).saturating_sub(1))
        .copied()
        .unwrap_or(f64::NAN);
    Ok(Outcome::new(error, 0.05, "degrees (98 % of the queries)"))
}
