//! The leaf-area field and how much sky it lets through (modes `transmittance` and `open`).

use glam::DVec3;

use super::field::{Field, NodeGrid, Queries};
use super::recorder::{Recorder, Store, Use};
use super::settings::Norm;
use super::stages::{Scene, Sources};
use crate::Result;
use crate::abi;
use crate::gpu::shaders::foliage as shaders;
use crate::math::sampling;

/// Integral over space of the Euclidean D_i with radius 1: 4 pi (1/3 - 2/5 + 1/7).
const KERNEL_VOLUME: f64 = 32.0 * std::f64::consts::PI / 105.0;

/// Mean projection of a unit area over random leaf angles.
pub const EXTINCTION: f32 = 0.5;

/// What an area weighs so that the field is area per volume.
pub(super) fn area_scale(radius: f32) -> f32 {
    (1.0 / (KERNEL_VOLUME * f64::from(radius).powi(3))) as f32
}

/// Leaf area per volume on a grid, and the directions along which it is crossed.
pub(super) struct LeafArea {
    grid: NodeGrid,
    values: Store,
    rays: Store,
    directions: u32,
}

impl LeafArea {
    pub(super) fn new(r: &mut Recorder<'_>, scene: &Scene<'_>, sources: &Sources) -> Result<Self> {
        let s = scene.settings;
        let radius = s.rho_ambient;
        let grid = NodeGrid::around(scene.frame.half, f64::from(radius), s.cells, s.memory)?;
        let field = Field {
            generators: sources
                .areas
                .as_ref()
                .expect("made where leaf area is needed"),
            radius,
            norm: Norm::Euclidean,
        };
        let values = field.on_grid(r, "leaf area grid", &grid)?;
        let rays: Vec<[f32; 4]> = sampling::fibonacci_directions(s.directions)
            .iter()
            .map(|w: &DVec3| w.as_vec3().extend(0.0).to_array())
            .collect();
        let rays = r.upload("sky directions", &rays)?;
        Ok(Self {
            grid,
            values,
            rays,
            directions: s.directions,
        })
    }
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
    leaf_area: &LeafArea,
    what: &str,
    queries: &Queries,
) -> Result<Openness> {
    let directions = r.array::<[f32; 4]>(&format!("{what} open directions"), queries.count)?;
    let ambient = r.array::<f32>(&format!("{what} transmittance"), queries.count)?;
    let counters = r.array::<u32>("missing directions", 1)?;
    r.fill("clear missing", &counters, 0)?;
    let grid = &leaf_area.grid;
    r.compute(
        &format!("open sky at {what}"),
        shaders::OPENNESS_COMP,
        &[
            Use::Read(&queries.sorted),
            Use::Read(&leaf_area.values),
            Use::Read(&leaf_area.rays),
            Use::Write(&directions),
            Use::Write(&ambient),
            Use::ReadWrite(&counters),
        ],
        &abi::Openness {
            origin: grid.origin,
            cell: grid.cell,
            nodes: grid.nodes,
            count: queries.count as u32,
            directions: leaf_area.directions,
            extinction: EXTINCTION,
        },
        queries.count,
    )?;
    Ok(Openness {
        directions,
        ambient,
        counters,
    })
}
