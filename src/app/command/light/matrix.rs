//! Transfer matrices of `umbrage light`.

use std::time::Instant;

use super::{Run, progress};
use crate::app::console;
use crate::leaf::matrix::{StoredMatrices, matrix_floats, pack};
use crate::leaf::prt::Prt;
use crate::{Error, Result};

impl Run<'_> {
    /// The matrices of the finest level.
    pub(super) fn matrices(&mut self) -> Result<StoredMatrices> {
        let (gpu, job, scene) = (self.gpu, self.job, self.scene.clone());
        let settings = job.how.matrix_settings();
        let form = (settings.order, job.how.colours);
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
        let stored =
            StoredMatrices::new(&packed, form, job.how.storage, (settings.paths, level.edge));
        self.so_far.matrices = prt.snapshot()?;
        self.so_far.packed = packed;
        Ok(stored)
    }
}
