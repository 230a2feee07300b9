//! Skylight through the leaf-area field: the ambient mode `transmittance` and the normals `open`.
//!
//! The field counts leaf area, not leaves: every triangle is a generator weighted with its area
//! without the transparent margin of cards, so that a frond of a hundred leaflets and a single
//! leaf are treated alike, and the Beer-Lambert law holds with nothing to fit.

use super::bins::BinGrid;
use super::field::{Field, NodeGrid, Queries};
use super::generators;
use super::recorder::{Recorder, Store, Use};
use super::settings::{Norm, Primitive};
use super::split::Leaves;
use super::stages::Scene;
use crate::Result;
use crate::abi;
use crate::gpu::shaders::foliage as shaders;
use crate::math::sampling;

/// Integral over space of the Euclidean D_i with radius 1: 4 pi (1/3 - 2/5 + 1/7).
const KERNEL_VOLUME: f64 = 32.0 * std::f64::consts::PI / 105.0;

/// Mean projection of a unit area over random leaf angles.
const EXTINCTION: f32 = 0.5;

/// Nodes per radius beyond which a finer grid adds nothing.
const NODES_PER_RADIUS: f64 = 3.0;

/// Bytes of optical depths at a time; more directions are swept in batches.
const DEPTH_BYTES: u64 = 64 << 20;

/// The foliage's triangles on the device.
#[derive(Debug, Clone, Copy)]
pub(super) struct Triangles<'a> {
    /// Normalised vertices of the foliage.
    pub(super) points: &'a Store,
    /// Corners as indices into `points`.
    pub(super) indices: &'a [u32],
    /// Per triangle: the share of its area that is leaf.
    pub(super) shares: &'a [f32],
}

/// What arrives from all directions at the nodes of a grid.
pub(super) struct Skylight {
    grid: NodeGrid,
    light: Store,
}

impl Skylight {
    pub(super) fn new(
        r: &mut Recorder<'_>,
        scene: &Scene<'_>,
        triangles: &Triangles<'_>,
    ) -> Result<Self> {
        let s = scene.settings;
        let radius = f64::from(s.rho_ambient);
        let extent = 2.0 * (scene.frame.half.max_element() + radius);
        let enough = (NODES_PER_RADIUS * extent / radius).ceil() + 2.0;
        let cells = s.cells.min(enough as u32);
        let grid = NodeGrid::around(scene.frame.half, radius, cells, s.memory)?;
        let leaf_area = leaf_area(r, scene, &grid, triangles)?;
        let light = sweep(r, &grid, &leaf_area, s.directions)?;
        Ok(Self { grid, light })
    }
}

/// Leaf area per volume at every node.
fn leaf_area(
    r: &mut Recorder<'_>,
    scene: &Scene<'_>,
    grid: &NodeGrid,
    triangles: &Triangles<'_>,
) -> Result<Store> {
    let radius = scene.settings.rho_ambient;
    let each = Leaves::new(&[], triangles.indices, Primitive::Triangle);
    let generators = generators::generators(r, triangles.points, triangles.indices, &each)?;
    let shares = r.upload("leaf shares", triangles.shares)?;
    r.compute(
        "leaf share",
        shaders::LEAF_SHARE_COMP,
        &[Use::Read(&shares), Use::ReadWrite(&generators.areas)],
        &abi::Count {
            count: generators.count as u32,
        },
        generators.count,
    )?;
    let bins = BinGrid::for_generators(scene.frame.half, generators.count, &[radius]);
    let binned = generators.bin(r, bins, radius)?;
    let unit_integral = 1.0 / (KERNEL_VOLUME * f64::from(radius).powi(3));
    let field = Field {
        generators: &generators.texels(r, &binned, unit_integral as f32)?,
        radius,
        norm: Norm::Euclidean,
    };
    field.on_grid(r, "leaf area grid", grid)
}

/// Light at every node; batches of directions add up in order.
fn sweep(
    r: &mut Recorder<'_>,
    grid: &NodeGrid,
    leaf_area: &Store,
    directions: u32,
) -> Result<Store> {
    let nodes = grid.node_count();
    let vectors: Vec<[f32; 4]> = sampling::fibonacci_directions(directions)
        .iter()
        .map(|w| w.as_vec3().extend(0.0).to_array())
        .collect();
    let batch = (DEPTH_BYTES / grid.bytes()).clamp(1, u64::from(directions)) as u32;
    let vectors = r.upload("sky directions", &vectors)?;
    let depth = r.array::<f32>("sky depth", nodes * batch as usize)?;
    let light = r.array::<[f32; 4]>("sky light", nodes)?;
    for first in (0..directions).step_by(batch as usize) {
        let count = batch.min(directions - first);
        r.compute(
            "sky depth",
            shaders::SKY_DEPTH_COMP,
            &[
                Use::Read(leaf_area),
                Use::Read(&vectors),
                Use::ReadWrite(&depth),
            ],
            &abi::SkyDepth {
                nodes: grid.nodes,
                cell: grid.cell,
                first,
                count,
            },
            (abi::SKY_GROUP * count) as usize,
        )?;
        r.compute(
            "sky light",
            shaders::SKY_LIGHT_COMP,
            &[
                Use::Read(&vectors),
                Use::Read(&depth),
                Use::Read(leaf_area),
                Use::ReadWrite(&light),
            ],
            &abi::SkyLight {
                node_count: nodes as u32,
                first,
                count,
                share: 1.0 / directions as f32,
                extinction: EXTINCTION,
                cell: grid.cell,
            },
            nodes,
        )?;
    }
    Ok(light)
}

/// Open direction and mean transmittance per query.
pub(super) struct Openness {
    /// Unit direction, and 1 where there is one.
    pub(super) directions: Store,
    /// Mean transmittance.
    pub(super) ambient: Store,
    counters: Store,
}

impl Openness {
    /// Queries without an open direction.
    pub(super) fn missing(&self, r: &mut Recorder<'_>) -> Result<usize> {
        Ok(r.fetch::<u32>("missing directions", &self.counters, || vec![0])?[0] as usize)
    }
}

pub(super) fn at_queries(
    r: &mut Recorder<'_>,
    skylight: &Skylight,
    what: &str,
    queries: &Queries,
) -> Result<Openness> {
    let directions = r.array::<[f32; 4]>(&format!("{what} open directions"), queries.count)?;
    let ambient = r.array::<f32>(&format!("{what} transmittance"), queries.count)?;
    let counters = r.array::<u32>("missing directions", 1)?;
    r.fill("clear missing", &counters, 0)?;
    r.compute(
        &format!("gather light at {what}"),
        shaders::SKY_GATHER_COMP,
        &[
            Use::Read(&queries.sorted),
            Use::Read(&skylight.light),
            Use::Write(&directions),
            Use::Write(&ambient),
            Use::ReadWrite(&counters),
        ],
        &abi::SkyGather {
            origin: skylight.grid.origin,
            cell: skylight.grid.cell,
            nodes: skylight.grid.nodes,
            count: queries.count as u32,
        },
        queries.count,
    )?;
    Ok(Openness {
        directions,
        ambient,
        counters,
    })
}
