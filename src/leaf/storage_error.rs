//! What storing transfer vectors in fewer bits costs, in transferred radiance.

use glam::DVec3;

use super::environment::Coefficients;
use super::light::{Lighting, Storage, StoredTransfer, exit_radiance};
use super::prt::Transfer;
use crate::abi::SH_MAX_COEFFICIENTS;

/// Errors of one form of storage: root mean squares over all sides and channels, each over the
/// mean of the light it is an error of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StorageError {
    /// The form.
    pub storage: Storage,
    /// Bytes of all vectors.
    pub bytes: u64,
    /// Of the light of the sky and of the sun's over other leaves.
    pub all: f64,
    /// Of the sun's over other leaves alone.
    pub indirect: f64,
}

/// Errors of every form that `transfer` may be stored in, under `sky` and `sun`.
#[must_use]
pub fn storage_errors(
    transfer: &Transfer,
    sky: &Coefficients,
    sun: &Coefficients,
) -> Vec<StorageError> {
    let dark = [DVec3::ZERO; SH_MAX_COEFFICIENTS as usize];
    let under = |sky| Lighting {
        sky,
        sun,
        direct_sun: false,
        order: transfer.order as usize,
    };
    let lights = [under(sky), under(&dark)];
    let wanted = lights.map(|l| exit_radiance(transfer, &l));
    let forms = Storage::NAMES.iter();
    forms
        .map(|&(storage, _)| {
            let stored = StoredTransfer::new(transfer, storage, 0, 0.0);
            let back = stored.transfer();
            let [all, indirect] =
                [0, 1].map(|k| relative(&exit_radiance(&back, &lights[k]), &wanted[k]));
            StorageError {
                storage,
                bytes: stored.bytes.len() as u64,
                all,
                indirect,
            }
        })
        .collect()
}

/// Root mean square of the difference, over the mean of what is wanted; 0 where that is dark.
fn relative(found: &[[f32; 3]], wanted: &[[f32; 3]]) -> f64 {
    let (mut mean, mut square) = (0.0, 0.0);
    for (a, b) in found.as_flattened().iter().zip(wanted.as_flattened()) {
        mean += f64::from(*b);
        square += f64::from(a - b).powi(2);
    }
    let count = (3 * wanted.len()).max(1) as f64;
    if mean > 0.0 {
        (square / count).sqrt() / (mean / count)
    } else {
        0.0
    }
}
