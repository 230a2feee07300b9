//! Light of lamps over other leaves, by the transfer vectors of distant light: each vertex takes a
//! lamp for a distant one that stands where it sees it and is as bright as it sees it. Leaves
//! about the vertex see it elsewhere and otherwise, so that this holds the better the farther the
//! lamp is in distances of leaves.

use glam::{DQuat, DVec3, Vec3};
use rayon::prelude::*;

use super::lamp::Lamp;
use super::prt::{Transfer, side_floats};
use crate::math::sh;

/// What of the transfer is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LampTransfer {
    /// Whether the direct part too (PRT alone).
    pub direct: bool,
    /// Bands at most.
    pub order: usize,
    /// Strength of the window against ringing.
    pub window: f64,
    /// Turns directions of the lamps into the frame of the transfer.
    pub turn: DQuat,
}

/// Adds the light of `lamps` to `radiance` (front and back of each vertex). `places` are those of
/// the vertices of `transfer`, metres, as the lamps'. A vertex's own sum below 0 (ringing) is 0.
pub fn add(
    radiance: &mut [[f32; 3]],
    transfer: &Transfer,
    (places, lamps): (&[DVec3], &[Lamp]),
    what: LampTransfer,
) {
    let order = what.order.min(transfer.order as usize);
    let n = order * order;
    let window = sh::window(what.window);
    let side_floats = side_floats(transfer.order);
    let floats = side_floats / 2;
    radiance
        .par_chunks_exact_mut(2)
        .zip(transfer.values.par_chunks_exact(2 * side_floats))
        .zip(places)
        .for_each(|((sides, values), &place)| {
            for lamp in lamps {
                let (towards, irradiance) = seen(lamp, place);
                if irradiance.max_element() <= 0.0 {
                    continue;
                }
                let y = sh::evaluate(what.turn * towards);
                for (out, side) in sides.iter_mut().zip(values.chunks_exact(side_floats)) {
                    let mut sum = Vec3::ZERO;
                    for (k, y) in y.iter().enumerate().take(n) {
                        let at = |part: usize| Vec3::from_slice(&side[part * floats + 3 * k..]);
                        let both = if what.direct { at(0) + at(1) } else { at(1) };
                        sum += both * (y * window[sh::band(k)]) as f32;
                    }
                    let more = (sum * irradiance.as_vec3()).max(Vec3::ZERO);
                    *out = (Vec3::from(*out) + more).to_array();
                }
            }
        });
}

/// Direction to the lamp's middle from `place` and irradiance across it.
#[must_use]
pub fn seen(lamp: &Lamp, place: DVec3) -> (DVec3, DVec3) {
    let to = lamp.position - place;
    let squared = to.length_squared().max(1e-30);
    let towards = to / squared.sqrt();
    let least = lamp.area() / std::f64::consts::TAU;
    let falloff = (-towards.dot(lamp.normal)).max(0.0) / squared.max(least);
    (towards, lamp.intensity * falloff)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Transfer of the constant band alone: irradiance times `Y_0`, on the side that has it.
    #[test]
    fn a_lamp_is_a_distant_light_of_its_irradiance() {
        let lamp = Lamp::parse("disc:0,4,0/0,-1,0/0.01/8").unwrap();
        let floats = side_floats(5);
        let mut values = vec![0.0; 2 * floats];
        values[floats + floats / 2] = 2.0; // back, indirect, red
        let transfer = Transfer { order: 5, values };
        let mut radiance = [[0.25; 3], [0.0; 3]];
        let what = LampTransfer {
            direct: false,
            order: 5,
            window: 0.0,
            turn: DQuat::IDENTITY,
        };
        let places = [DVec3::new(0.0, 2.0, 0.0)];
        add(
            &mut radiance,
            &transfer,
            (&places, std::slice::from_ref(&lamp)),
            what,
        );
        assert_eq!(radiance[0], [0.25; 3]);
        let y0 = sh::evaluate(DVec3::Y)[0] as f32;
        assert!(
            (radiance[1][0] - 2.0 * y0 * 2.0).abs() < 1e-5,
            "{radiance:?}"
        );
        // Behind its face it sends nothing.
        let behind = [DVec3::new(0.0, 5.0, 0.0)];
        let before = radiance;
        add(&mut radiance, &transfer, (&behind, &[lamp]), what);
        assert_eq!(radiance, before);
    }
}
