//! Transfer matrices by the same paths as on the device, and the glossy light of a view.
//!
//! Twin of `shaders/leaf/matrix_start.comp`, `matrix_gather.comp` and `gloss_view.comp`.

use glam::{DVec2, DVec3};

use super::prt::Scene;
use crate::abi::{LOBE_COEFFICIENTS, LOBE_NODES, Receiver};
use crate::math::sampling::{even_numbers, frame, uniform_sphere};
use crate::math::sh;

/// Rows of the direct part and of the indirect one.
pub type Matrices = [Vec<[DVec3; sh::MAX_COEFFICIENTS]>; 2];

impl Scene<'_> {
    /// Matrices of receiver `number` by `paths` paths.
    #[must_use]
    pub fn matrices(&self, receiver: &Receiver, number: u32, paths: u32) -> Matrices {
        let rows = || vec![[DVec3::ZERO; sh::MAX_COEFFICIENTS]; sh::MAX_COEFFICIENTS];
        let mut sums = [rows(), rows()];
        let share = 4.0 * std::f64::consts::PI / f64::from(paths);
        for sample in 0..paths {
            let u = even_numbers(number, sample, self.seed);
            let first = uniform_sphere(DVec2::new(u[0], u[1]));
            let start = (self.origin(receiver, first), first, DVec3::ONE);
            let Some((part, direction, weight)) = self.follow(start, number, sample) else {
                continue;
            };
            let (own, far) = (sh::evaluate(first), sh::evaluate(direction));
            for (row, y) in sums[part].iter_mut().zip(own) {
                for (sum, z) in row.iter_mut().zip(far) {
                    *sum += share * y * z * weight;
                }
            }
        }
        sums
    }
}

/// What the lobe of a receiver reflects of `light` (coefficients in the frame of the normal) to
/// the eye, for specular intensity 1: seen from the front and from the back.
#[must_use]
pub fn gloss_view(receiver: &Receiver, light: &[DVec3], lobes: &[f32], eye: DVec3) -> [DVec3; 2] {
    let wide = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    let to_eye = (eye - wide(receiver.position)).normalize();
    let local = frame(wide(receiver.normal)).transpose() * to_eye;
    let across = local.x.hypot(local.y);
    let azimuth = if across > 0.0 {
        local.y.atan2(local.x)
    } else {
        0.0
    };
    let at = across.atan2(local.z.abs()).to_degrees() / 90.0 * f64::from(LOBE_NODES - 1);
    let node = (at as usize).min(LOBE_NODES as usize - 2);
    let width = LOBE_COEFFICIENTS as usize;
    let first = (receiver.material as usize * LOBE_NODES as usize + node) * width;
    let mut out = [DVec3::ZERO; 2];
    for (k, &light) in light.iter().enumerate() {
        let l = sh::band(k);
        let m = k as i64 - (l * (l + 1)) as i64;
        let index = l * (l + 1) / 2 + m.unsigned_abs() as usize;
        let [a, b] = [first, first + width].map(|f| f64::from(lobes[f + index]));
        let lobe = a + (at - node as f64) * (b - a);
        let turn = azimuth * m.unsigned_abs() as f64;
        let factor = if m < 0 { turn.sin() } else { turn.cos() };
        let term = lobe * factor * light;
        out[0] += term;
        out[1] += if (l as i64 + m) % 2 == 0 { term } else { -term };
    }
    out
}
