//! How the light of a model is computed, and what that takes.

use glam::DVec3;

use crate::app::cli::LightArgs;
use crate::app::cli::light::{SunDirections, TransferKind};
use crate::leaf::directions::Directions;
use crate::leaf::levels::Level;
use crate::leaf::light::Storage;
use crate::leaf::lvc::LvcSettings;
use crate::leaf::matrix::{Colours, matrix_floats, raw_floats};
use crate::leaf::prt::{PrtSettings, side_floats};
use crate::render::plan::human_bytes;
use crate::scene::Geometry;
use crate::{Error, Result};

/// How transfer and visibility are computed.
pub(super) struct How {
    pub(super) storage: Storage,
    /// Vectors, matrices or both.
    pub(super) transfer: TransferKind,
    /// Colours of matrices.
    pub(super) colours: Colours,
    pub(super) directions: Option<Directions>,
    /// Times that triangles are split for visibility.
    pub(super) splits: u32,
    pub(super) prt: PrtSettings,
    pub(super) lvc: LvcSettings,
}

impl How {
    /// What `args` say; the sun stands at `sun`.
    pub(super) fn new(args: &LightArgs, sun: DVec3) -> Result<Self> {
        let directions = match args.directions {
            SunDirections::None => None,
            SunDirections::Sun => Some(Directions::Path(vec![sun])),
            SunDirections::Cube => Some(Directions::Cube {
                side: args.cube_side,
            }),
            SunDirections::Day => Some(Directions::day(args.latitude, args.day, args.minutes)?),
        };
        Ok(Self {
            storage: Storage::parse(&args.storage)?,
            transfer: args.transfer,
            colours: Colours::parse(&args.matrix_colours)?,
            directions,
            splits: args.splits,
            prt: PrtSettings {
                order: args.order,
                paths: args.paths,
                bounces: args.bounces,
                seed: args.seed,
                offset: args.offset,
                // Matrices add it by the view.
                gloss: args.transfer != TransferKind::Both,
                ..PrtSettings::default()
            },
            lvc: LvcSettings {
                radius_degrees: args.sun.sun_radius,
                samples: args.samples,
                exhaustive: args.exhaustive,
                offset: args.offset,
                ..LvcSettings::default()
            },
        })
    }

    /// Whether vectors are computed, and whether matrices are.
    pub(super) fn kinds(&self) -> (bool, bool) {
        let any = self.prt.paths > 0;
        (
            any && self.transfer.vectors(),
            any && self.transfer.matrices(),
        )
    }

    /// As many paths of a vertex as its two sides have for vectors.
    pub(super) fn matrix_settings(&self) -> PrtSettings {
        PrtSettings {
            paths: self.prt.paths.saturating_mul(2),
            ..self.prt
        }
    }

    /// Bytes of the transfer in memory: sums of the levels, the vectors that are done at once,
    /// radiance to compare with, and the result with its file.
    fn transfer_bytes(&self, vertices: u64, levels: &[Level]) -> u64 {
        let kept: u64 = levels.iter().map(|l| l.vertices as u64).sum();
        let width = 8 * side_floats(self.prt.order) as u64;
        let stored = width / 4 * self.storage.bytes();
        let at_once = vertices.min(u64::from(self.prt.batch / 2)) * width;
        kept * (width + 2 * stored) + at_once + 24 * vertices
    }

    /// Bytes of the matrices in memory: those of the level that keeps them, those that are done at
    /// once as kernels sum them, and the result with its file.
    fn matrix_bytes(&self, vertices: u64, levels: &[Level]) -> u64 {
        let level = levels.first().map_or(0, |l| l.vertices as u64);
        let floats = matrix_floats(self.prt.order, self.colours) as u64;
        let at_once =
            vertices.min(u64::from(self.prt.batch / 2)) * 4 * raw_floats(self.prt.order) as u64;
        level * floats * (4 + 2 * self.storage.bytes()) + at_once
    }
}

/// Numbers and bytes of the work on a geometry.
pub(super) struct Sizes {
    vertices: u64,
    triangles: u64,
    /// Vertices of the maps at most.
    finer: u64,
    directions: u64,
    transfer: u64,
    matrices: u64,
    maps: u64,
}

impl Sizes {
    /// Of `geometry`; `kept`: the maps are there already.
    pub(super) fn new(how: &How, geometry: &Geometry, levels: &[Level], kept: bool) -> Self {
        let vertices = geometry.positions.len() as u64;
        let triangles = geometry.indices.len() as u64 / 3;
        let directions = match &how.directions {
            Some(directions) if !kept => directions.all().len() as u64,
            _ => 0,
        };
        let (vectors, matrices) = how.kinds();
        let of = |wanted: bool, bytes: u64| if wanted { bytes } else { 0 };
        // Three edges a triangle at most, each with a middle, and four times as many every time.
        let finer = vertices + triangles * (4u64.pow(how.splits) - 1);
        Self {
            vertices,
            triangles,
            finer,
            directions,
            transfer: of(vectors, how.transfer_bytes(vertices, levels)),
            matrices: of(matrices, how.matrix_bytes(vertices, levels)),
            maps: finer * directions,
        }
    }

    /// Whether it stays within `--max-bytes`.
    ///
    /// # Errors
    /// It does not.
    pub(super) fn check(&self, args: &LightArgs) -> Result<()> {
        let bytes = self.transfer + self.matrices + self.maps;
        if bytes <= args.max_bytes {
            return Ok(());
        }
        Err(Error::Unsupported(format!(
            "{}: the light takes {} in memory ({} of transfer, {} of maps), --max-bytes allows \
             {}; try --lod, fewer directions or less of --splits",
            args.input.input,
            human_bytes(bytes),
            human_bytes(self.transfer + self.matrices),
            human_bytes(self.maps),
            human_bytes(args.max_bytes)
        )))
    }

    /// What will be computed, with sizes and numbers of rays; `occluders`: bytes of the hierarchy.
    pub(super) fn text(&self, how: &How, occluders: u64) -> String {
        let (vectors, matrices) = how.kinds();
        let paths = if vectors { u64::from(how.prt.paths) } else { 0 };
        let told = if matrices {
            self.matrix_text(how)
        } else {
            String::new()
        };
        format!(
            "{} vertices, {} triangles ({} for rays)\n\
             transfer: {} paths, {}{told}\n\
             sun: {} directions, at most {} vertices, {} rays and more, up to {}",
            self.vertices,
            self.triangles,
            human_bytes(occluders),
            2 * self.vertices * paths,
            human_bytes(self.transfer),
            self.directions,
            self.finer,
            self.maps * u64::from(how.lvc.samples.min(4)),
            human_bytes(self.maps),
        )
    }

    fn matrix_text(&self, how: &How) -> String {
        let floats = matrix_floats(how.prt.order, how.colours) as u64;
        format!(
            "\nmatrices: {} paths, {} a vertex stored, {}",
            self.vertices * u64::from(how.matrix_settings().paths),
            human_bytes(floats * how.storage.bytes()),
            human_bytes(self.matrices),
        )
    }
}
