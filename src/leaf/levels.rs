//! Levels of detail of transfer vectors, made while receivers finish: the vectors of all vertices
//! need never be held at once.

use super::light::{Lighting, Storage, StoredTransfer, exit_radiance};
use super::lod::Lod;
use super::prt::{Transfer, side_floats};
use crate::scene::Geometry;

/// One level of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Distance of its vertices, metres; 0: every vertex.
    pub edge: f32,
    /// Whom they stand for; none: every vertex for itself.
    pub lod: Option<Lod>,
    /// Its vertices.
    pub vertices: usize,
}

impl Level {
    /// The level of `edge` metres, 0 or more, of `geometry`.
    #[must_use]
    pub fn new(geometry: &Geometry, edge: f32) -> Self {
        let lod = (edge > 0.0).then(|| Lod::new(geometry, edge));
        let all = geometry.positions.len();
        Self {
            edge,
            vertices: lod.as_ref().map_or(all, |l| l.coarse.len()),
            lod,
        }
    }

    /// Radiance of every vertex (front, back), from that of the level's own.
    #[must_use]
    pub fn spread(&self, own: Vec<[f32; 3]>) -> Vec<[f32; 3]> {
        match &self.lod {
            Some(lod) => lod.spread(&own),
            None => own,
        }
    }
}

/// Sums of every level so far.
#[derive(Debug)]
pub struct LevelSums<'a> {
    /// Bands of the vectors.
    order: u32,
    levels: Vec<(&'a Level, Vec<f32>)>,
    /// Radiance of each side of each vertex that is done, under the light that levels are
    /// compared in.
    reference: Vec<[f32; 3]>,
}

/// What a level of detail costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelError {
    /// Distance of its vertices, metres.
    pub edge: f32,
    /// Its vertices.
    pub vertices: usize,
    /// Root mean square of the difference to the vertices' own vectors, over the mean radiance.
    pub rmse: f64,
    /// Mean of the difference over the mean radiance.
    pub bias: f64,
}

impl<'a> LevelSums<'a> {
    /// Nothing of `levels`, of vectors of `order` bands, yet.
    #[must_use]
    pub fn new(levels: &'a [Level], order: u32) -> Self {
        let width = 2 * side_floats(order);
        let sums = |level: &'a Level| (level, vec![0.0; level.vertices * width]);
        Self {
            order,
            levels: levels.iter().map(sums).collect(),
            reference: Vec::new(),
        }
    }

    /// Takes the vectors of the vertices that come next.
    pub fn add(&mut self, next: Vec<f32>, lighting: &Lighting<'_>) {
        let first = self.reference.len() / 2;
        let width = 2 * side_floats(self.order);
        for (level, sums) in &mut self.levels {
            match &level.lod {
                Some(lod) => lod.gather(sums, width, first, &next),
                None => sums[first * width..first * width + next.len()].copy_from_slice(&next),
            }
        }
        let next = Transfer {
            order: self.order,
            values: next,
        };
        self.reference.extend(exit_radiance(&next, lighting));
    }

    /// Everything that [`LevelSums::add`] has changed, for [`LevelSums::restore`].
    #[must_use]
    pub fn state(&self) -> Vec<f32> {
        let sums = self.levels.iter().flat_map(|l| &l.1).copied();
        let reference = self.reference.as_flattened().iter().copied();
        sums.chain(reference).collect()
    }

    /// Goes on from the state of sums of the same levels.
    ///
    /// # Errors
    /// A state of another size.
    pub fn restore(&mut self, state: &[f32]) -> Result<(), &'static str> {
        const OTHER: &str = "the interrupted run had other levels of detail";
        let mut rest = state;
        for (_, sums) in &mut self.levels {
            let (own, after) = rest.split_at_checked(sums.len()).ok_or(OTHER)?;
            sums.copy_from_slice(own);
            rest = after;
        }
        let (reference, odd) = rest.as_chunks::<3>();
        if !odd.is_empty() {
            return Err(OTHER);
        }
        self.reference = reference.to_vec();
        Ok(())
    }

    /// How far each level is from the vertices' own vectors, whose noise is part of it.
    #[must_use]
    pub fn errors(&self, lighting: &Lighting<'_>) -> Vec<LevelError> {
        let levels = self.levels.iter();
        levels
            .map(|(l, sums)| self.error(l, sums, lighting))
            .collect()
    }

    fn error(&self, level: &Level, sums: &[f32], lighting: &Lighting<'_>) -> LevelError {
        let transfer = Transfer {
            order: self.order,
            values: sums.to_vec(),
        };
        let own = level.spread(exit_radiance(&transfer, lighting));
        let (mut mean, mut bias, mut square) = (0.0, 0.0, 0.0);
        for (own, wanted) in own.iter().zip(&self.reference) {
            for (a, b) in own.iter().zip(wanted) {
                let difference = f64::from(a - b);
                mean += f64::from(*b);
                bias += difference;
                square += difference * difference;
            }
        }
        let count = (3 * self.reference.len()).max(1) as f64;
        let mean = (mean / count).max(f64::MIN_POSITIVE);
        LevelError {
            edge: level.edge,
            vertices: level.vertices,
            rmse: (square / count).sqrt() / mean,
            bias: bias / count / mean,
        }
    }

    /// The vectors of every level, finest first.
    #[must_use]
    pub fn stored(self, storage: Storage, paths: u32) -> Vec<StoredTransfer> {
        let order = self.order;
        let store = |(level, values): (&Level, Vec<f32>)| {
            StoredTransfer::new(&Transfer { order, values }, storage, paths, level.edge)
        };
        self.levels.into_iter().map(store).collect()
    }
}
