//! Direct light on vertices that leaves their two sides, taken for diffuse: what rays of gloss see of a
//! leaf besides the light of its transfer.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::receivers::Receivers;

/// Adds to `radiance` (front and back of each of the `receivers`) a light that a vertex sees in
/// direction and with irradiance `light`, as far as `visibility` lets it.
pub fn add_direct(
    radiance: &mut [[f32; 3]],
    receivers: &Receivers,
    visibility: &[f32],
    light: impl Fn(usize) -> (DVec3, DVec3) + Sync,
) {
    let vertices = radiance.par_chunks_exact_mut(2).enumerate();
    vertices.zip(visibility).for_each(|((i, sides), &seen)| {
        let point = &receivers.points[i];
        let material = &receivers.transfer[point.material as usize];
        let (towards, irradiance) = light(i);
        let cosine = Vec3::from(point.normal).dot(towards.as_vec3());
        let falls = irradiance.as_vec3() * (seen * cosine.abs() / std::f32::consts::PI);
        let scatters = if cosine > 0.0 {
            [material.rho_d_front, material.rho_t]
        } else {
            [material.rho_t, material.rho_d_back]
        };
        for (side, rho) in sides.iter_mut().zip(scatters) {
            *side = (Vec3::from(*side) + falls * Vec3::from(rho)).to_array();
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::abi::{LeafSides, Receiver};

    #[test]
    fn light_is_reflected_on_its_side_and_goes_through_to_the_other() {
        let leaf = LeafSides {
            rho_d_front: [0.2; 3],
            rho_d_back: [0.3; 3],
            rho_t: [0.4; 3],
        };
        let point = Receiver {
            normal: [0.0, 1.0, 0.0],
            ..Receiver::default()
        };
        let receivers = Receivers {
            points: vec![point; 2],
            faces: Vec::new(),
            materials: vec![leaf],
            transfer: vec![leaf],
            turns: Vec::new(),
        };
        let sun = DVec3::new(0.0, 0.6, 0.8);
        let e = DVec3::splat(std::f64::consts::PI);
        let mut out = vec![[1.0; 3]; 4];
        let from = |i: usize| (if i == 0 { sun } else { -sun }, e);
        add_direct(&mut out, &receivers, &[1.0, 0.5], from);
        let expected = [1.12, 1.24, 1.12, 1.09];
        for (found, expected) in out.iter().zip(expected) {
            assert!((found[1] - expected).abs() < 1e-6, "{out:?}");
        }
    }
}
