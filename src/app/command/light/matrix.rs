//! Transfer matrices of `umbrage light`.

use std::time::Instant;

use super::{Run, progress};
use crate::app::console;
use crate::leaf::matrix::{StoredMatrices, matrix_floats, pack, raw_floats};
use crate::leaf::prt::{Prt, PrtSettings};
use crate::render::plan::human_bytes;
use crate::{Error, Result};

impl super::Job {
    /// Whether vectors are computed, and whether matrices are.
    pub(super) fn kinds(&self) -> (bool, bool) {
        let any = self.prt.paths > 0;
        (
            any && self.transfer.vectors(),
            any && self.transfer.matrices(),
        )
    }

    /// Bytes of the matrices in memory: those of the level that keeps them, those that are done at
    /// once as kernels sum them, and the result with its file.
    pub(super) fn matrix_bytes(&self) -> u64 {
        let level = self.levels.first().map_or(0, |l| l.vertices as u64);
        let all = self.lit.vertices() as u64;
        let floats = matrix_floats(self.prt.order, self.colours) as u64;
        let at_once =
            all.min(u64::from(self.prt.batch / 2)) * 4 * raw_floats(self.prt.order) as u64;
        level * floats * (4 + 2 * self.storage.bytes()) + at_once
    }

    /// What of matrices is told before the work.
    pub(super) fn matrix_plan(&self) -> String {
        let floats = matrix_floats(self.prt.order, self.colours) as u64;
        let paths = self.matrix_settings().paths;
        format!(
            "\nmatrices: {} paths, {} a vertex stored, {}",
            self.lit.vertices() as u64 * u64::from(paths),
            human_bytes(floats * self.storage.bytes()),
            human_bytes(self.matrix_bytes()),
        )
    }

    /// As many paths of a vertex as its two sides have for vectors.
    fn matrix_settings(&self) -> PrtSettings {
        PrtSettings {
            paths: self.prt.paths.saturating_mul(2),
            ..self.prt
        }
    }
}

impl Run<'_> {
    /// The matrices of the finest level.
    pub(super) fn matrices(&mut self) -> Result<StoredMatrices> {
        let (gpu, job, scene) = (self.gpu, self.job, self.scene.clone());
        let settings = job.matrix_settings();
        let form = (settings.order, job.colours);
        let width = matrix_floats(form.0, form.1);
        let level = &job.levels[0];
        let mut packed = vec![0.0; level.vertices * width];
        let mut prt = Prt::matrices(gpu, &scene, &job.lit.receivers, settings)?;
        let before = std::mem::take(&mut self.so_far.matrices);
        let mut first = before.receivers as usize;
        if first > 0 {
            let so_far = std::mem::take(&mut self.so_far.packed);
            if so_far.len() != packed.len() {
                return Err(Error::usage(
                    "the interrupted run had other levels of detail",
                ));
            }
            packed = so_far;
        }
        prt.restore(before)?;
        let working = console::working("matrices");
        let (start, before) = (Instant::now(), prt.step().done);
        prt.run(&mut |prt| {
            let next = pack(&prt.take(), form.0, form.1);
            match &level.lod {
                Some(lod) => lod.gather(&mut packed, width, first, &next),
                None => packed[first * width..][..next.len()].copy_from_slice(&next),
            }
            first += next.len() / width;
            let step = prt.step();
            let rate = (step.done - before) as f64 / start.elapsed().as_secs_f64();
            working.step(&progress(("matrices", "paths"), step.done, step.all, rate));
            self.save(|so_far| {
                so_far.matrices = prt.snapshot()?;
                so_far.packed.clone_from(&packed);
                Ok(())
            })
        })?;
        self.done.passes.add_passes(prt.times());
        self.done.transfer_rays += prt.traced;
        self.done.transfer_seconds += start.elapsed().as_secs_f64();
        let stored = StoredMatrices::new(&packed, form, job.storage, (settings.paths, level.edge));
        self.so_far.matrices = prt.snapshot()?;
        self.so_far.packed = packed;
        Ok(stored)
    }
}
