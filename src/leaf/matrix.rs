//! Transfer matrices: which light comes to a vertex from each direction when distant light of each
//! harmonic shines, l^T = M l (Wang et al. 2005, section 4.1, after Sloan, Kautz, Snyder 2002).
//!
//! A matrix a vertex, over the full sphere, serves both sides. M^d, the integral of
//! visibility times two harmonics, is symmetric and has no colour; M^i is what comes over other leaves. What a leaf makes of incident
//! light is a product of b(v) and l^T at the time of drawing, so that it may change with the view.

use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

use super::light::{Lighting, Storage, load, store};
use crate::abi::{LeafSides, Receiver};
use crate::math::sampling::frame;
use crate::math::sh::CLAMPED_COSINE;
use crate::math::sh_rotation::ShRotation;
use crate::{Error, Result};

/// Which colours indirect light has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colours {
    /// One operator for all channels, as the sizes of Wang et al. 2005 imply.
    Mono,
    /// One for each.
    Rgb,
}

impl Colours {
    /// All, with their names in files and on the command line.
    pub const NAMES: [(Self, &'static str); 2] = [(Self::Mono, "mono"), (Self::Rgb, "rgb")];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        let known = Self::NAMES.iter().find(|n| n.0 == self);
        known.map_or("", |n| n.1)
    }

    /// The one of that name.
    ///
    /// # Errors
    /// There is none.
    pub fn parse(name: &str) -> Result<Self> {
        let known = Self::NAMES.iter().find(|n| n.1 == name);
        known
            .map(|n| n.0)
            .ok_or_else(|| Error::usage(format!("--matrix-colours {name}: expected mono or rgb")))
    }

    const fn channels(self) -> usize {
        match self {
            Self::Mono => 1,
            Self::Rgb => 3,
        }
    }
}

/// Floats of a receiver's matrices of `order` bands: the upper triangle of M^d, then M^i.
#[must_use]
pub const fn matrix_floats(order: u32, colours: Colours) -> usize {
    let n = (order * order) as usize;
    n * (n + 1) / 2 + n * n * colours.channels()
}

/// Floats of a receiver as kernels sum them: all of M^d, then M^i with RGB for each element.
#[must_use]
pub const fn raw_floats(order: u32) -> usize {
    4 * (order * order * order * order) as usize
}

/// The form of [`matrix_floats`] of what kernels have summed for some receivers.
#[must_use]
pub fn pack(raw: &[f32], order: u32, colours: Colours) -> Vec<f32> {
    let n = (order * order) as usize;
    let mut out = Vec::with_capacity(raw.len() / raw_floats(order) * matrix_floats(order, colours));
    for receiver in raw.chunks_exact(raw_floats(order)) {
        let (direct, indirect) = receiver.split_at(n * n);
        for row in 0..n {
            out.extend((row..n).map(|k| 0.5 * (direct[row * n + k] + direct[k * n + row])));
        }
        match colours {
            Colours::Rgb => out.extend_from_slice(indirect),
            Colours::Mono => {
                out.extend(indirect.chunks_exact(3).map(|c| (c[0] + c[1] + c[2]) / 3.0));
            }
        }
    }
    out
}

/// Transfer matrices as they are stored.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredMatrices {
    /// Form.
    pub storage: Storage,
    /// Bands.
    pub order: u32,
    /// Colours of the indirect part.
    pub colours: Colours,
    /// Values of [`matrix_floats`], receiver after receiver, little-endian.
    pub bytes: Vec<u8>,
    /// Scale of each float of a receiver; bytes only.
    pub scales: Vec<f32>,
    /// Paths of each vertex, for the record.
    pub paths: u32,
    /// Distance of the vertices that have matrices, metres; 0: all have.
    pub edge: f32,
}

impl StoredMatrices {
    /// Stores packed matrices of a level of detail of `edge` metres.
    #[must_use]
    pub fn new(
        values: &[f32],
        (order, colours): (u32, Colours),
        storage: Storage,
        (paths, edge): (u32, f32),
    ) -> Self {
        let (bytes, scales) = store(values, matrix_floats(order, colours), storage);
        Self {
            storage,
            order,
            colours,
            bytes,
            scales,
            paths,
            edge,
        }
    }

    /// Vertices that have matrices.
    #[must_use]
    pub fn receivers(&self) -> usize {
        let width = matrix_floats(self.order, self.colours) * self.storage.bytes() as usize;
        self.bytes.len() / width
    }

    /// The values again.
    #[must_use]
    pub fn values(&self) -> Vec<f32> {
        load(&self.bytes, &self.scales, self.storage)
    }

    /// Light that comes to each of `receivers` under `lighting`, in the frame of its normal: an
    /// entry for each coefficient of the matrices' order.
    ///
    /// The frame is [`frame`] of the normal; directions in it are those the light comes from.
    #[must_use]
    pub fn incident(&self, lighting: &Lighting<'_>, receivers: &[Receiver]) -> Vec<[f32; 3]> {
        let n = (self.order * self.order) as usize;
        let used = lighting.order.pow(2).min(n);
        let light = |k: usize, with_sun: bool| {
            let sun = if with_sun {
                lighting.sun[k]
            } else {
                DVec3::ZERO
            };
            (lighting.sky[k] + sun).as_vec3()
        };
        let direct: Vec<Vec3> = (0..used).map(|k| light(k, lighting.direct_sun)).collect();
        let later: Vec<Vec3> = (0..used).map(|k| light(k, true)).collect();
        let channels = self.colours.channels();
        let values = self.values();
        values
            .par_chunks_exact(matrix_floats(self.order, self.colours))
            .zip(receivers)
            .flat_map_iter(|(matrix, receiver)| {
                let (own, others) = matrix.split_at(n * (n + 1) / 2);
                let mut out = vec![DVec3::ZERO; n];
                for (j, out) in out.iter_mut().enumerate().take(used) {
                    let mut sum = Vec3::ZERO;
                    for (k, &light) in direct.iter().enumerate() {
                        let (a, b) = (j.min(k), j.max(k));
                        sum += own[a * n - a * (a + 1) / 2 + b] * light;
                    }
                    let row = others[j * n * channels..].chunks_exact(channels);
                    for (element, &light) in row.zip(&later) {
                        sum += match *element {
                            [r, g, b] => Vec3::new(r, g, b) * light,
                            _ => element[0] * light,
                        };
                    }
                    *out = sum.as_dvec3();
                }
                ShRotation::new(to_local(receiver), self.order as usize).apply(&mut out);
                out.into_iter().map(|v| v.as_vec3().to_array())
            })
            .collect()
    }
}

/// Turns directions into the frame of a receiver's normal.
fn to_local(receiver: &Receiver) -> DMat3 {
    frame(DVec3::from(receiver.normal.map(f64::from)).normalize()).transpose()
}

/// Diffuse light that leaves the front and the back of each of `receivers`, from incident light of
/// `order` bands. Not clamped: ringing goes below 0.
#[must_use]
pub fn diffuse(
    incident: &[[f32; 3]],
    order: u32,
    receivers: &[Receiver],
    materials: &[LeafSides],
) -> Vec<[f32; 3]> {
    let n = (order * order) as usize;
    incident
        .chunks_exact(n)
        .zip(receivers)
        .flat_map(|(light, receiver)| {
            let leaf = &materials[receiver.material as usize];
            // Cosine-weighted integrals over the upper and the lower half.
            let (mut above, mut below) = (Vec3::ZERO, Vec3::ZERO);
            for l in 0..order as usize {
                let term = CLAMPED_COSINE[l] as f32 * Vec3::from(light[l * (l + 1)]);
                above += term;
                below += if l % 2 == 0 { term } else { -term };
            }
            let side = |rho_d: [f32; 3], own: Vec3, other: Vec3| {
                let sum = Vec3::from(rho_d) * own + Vec3::from(leaf.rho_t) * other;
                (sum / std::f32::consts::PI).to_array()
            };
            [
                side(leaf.rho_d_front, above, below),
                side(leaf.rho_d_back, below, above),
            ]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::leaf::environment::Environment;
    use crate::math::sh;

    fn receiver(normal: Vec3) -> Receiver {
        Receiver {
            normal: normal.to_array(),
            facing: normal.to_array(),
            ..Receiver::default()
        }
    }

    /// Matrices of a receiver in empty space: M^d is the identity.
    fn empty(order: u32, colours: Colours, storage: Storage) -> StoredMatrices {
        let n = (order * order) as usize;
        let mut raw = vec![0.0; raw_floats(order)];
        for j in 0..n {
            raw[j * n + j] = 1.0;
        }
        let values = pack(&raw, order, colours);
        assert_eq!(values.len(), matrix_floats(order, colours));
        StoredMatrices::new(&values, (order, colours), storage, (1, 0.0))
    }

    /// A linear sky on a leaf in empty space: closed form, whatever normal, order and form.
    #[test]
    fn empty_space_changes_nothing() {
        let (a, b) = (DVec3::new(0.3, 0.2, 0.1), DVec3::new(0.1, 0.2, 0.05));
        let up = DVec3::new(0.2, 0.9, -0.3).normalize();
        let sky = Environment::Linear { a, b, up }.coefficients();
        let dark = Environment::Constant(DVec3::ZERO).coefficients();
        let leaf = LeafSides {
            rho_d_front: [0.3; 3],
            rho_d_back: [0.5; 3],
            rho_t: [0.2; 3],
        };
        for normal in [
            Vec3::Z,
            Vec3::new(0.6, 0.0, -0.8),
            Vec3::new(-0.36, 0.48, 0.8),
        ] {
            for (order, colours) in [(2, Colours::Mono), (5, Colours::Rgb), (6, Colours::Mono)] {
                for (storage, limit) in [
                    (Storage::F32, 1e-6),
                    (Storage::F16, 1e-3),
                    (Storage::Byte, 1e-6),
                ] {
                    let matrices = empty(order, colours, storage);
                    assert_eq!(matrices.receivers(), 1);
                    let lighting = Lighting {
                        sky: &sky,
                        sun: &dark,
                        direct_sun: false,
                        order: 6,
                    };
                    let receivers = [receiver(normal)];
                    let light = matrices.incident(&lighting, &receivers);
                    let found = diffuse(&light, order, &receivers, &[leaf]);
                    let half = |side: f64| a + side * b * (2.0 / 3.0) * normal.as_dvec3().dot(up);
                    let wanted = [
                        0.3 * half(1.0) + 0.2 * half(-1.0),
                        0.5 * half(-1.0) + 0.2 * half(1.0),
                    ];
                    for (found, wanted) in found.iter().zip(wanted) {
                        let error = (Vec3::from(*found).as_dvec3() - wanted).abs().max_element();
                        assert!(error < limit, "{normal} {order} {storage:?}: {error}");
                    }
                }
            }
        }
    }

    /// Light comes from where it comes from, also in the frame of the normal.
    #[test]
    fn incident_light_is_in_the_frame_of_the_normal() {
        let normal = Vec3::new(-0.36, 0.48, 0.8);
        let towards = DVec3::new(0.2, -0.5, 0.6).normalize();
        let y = sh::evaluate(towards);
        let sky = std::array::from_fn(|k| DVec3::splat(y[k]));
        let lighting = Lighting {
            sky: &sky,
            sun: &[DVec3::ZERO; sh::MAX_COEFFICIENTS],
            direct_sun: false,
            order: 5,
        };
        let receivers = [receiver(normal)];
        let found = empty(5, Colours::Mono, Storage::F32).incident(&lighting, &receivers);
        let wanted = sh::evaluate(to_local(&receivers[0]) * towards);
        for (found, wanted) in found.iter().zip(wanted) {
            assert!(
                (f64::from(found[1]) - wanted).abs() < 1e-5,
                "{found:?} {wanted}"
            );
        }
    }
}
