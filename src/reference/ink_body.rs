//! Twin of `ink_body.glsl`: hatch coordinates of smooth bodies (Coconu, Deussen, Hege 2006,
//! equations 9 and 10).

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec2, DVec3};

use crate::abi::InkCluster;

/// Coordinates in tiles of a place on a body, in the frame of the cluster: from `eye`, with the
/// picture's `right` and `up`.
#[must_use]
pub fn body_hatch(
    cluster: &InkCluster,
    place: DVec3,
    eye: DVec3,
    [right, up]: [DVec3; 2],
) -> DVec2 {
    let centre = DVec3::from(cluster.centre.map(f64::from));
    let radius = f64::from(cluster.radius);
    let reference = DVec2::from(cluster.reference.map(f64::from));
    let away = place - centre;
    let front = (eye - centre).normalize();
    let across = right - right.dot(front) * front;
    let x = if across.length_squared() > 1e-6 {
        across.normalize()
    } else {
        up.cross(front).normalize()
    };
    let y = front.cross(x);
    let flat = DVec2::new(away.dot(x), away.dot(y));
    if flat.length() <= 1e-9 * radius {
        return reference;
    }
    let before = away.dot(front);
    // Behind the middle as at a right angle.
    let scale = if before > 0.0 {
        flat.length().atan2(before) * away.length() / flat.length()
    } else {
        FRAC_PI_2
    };
    let offset = flat * scale / radius;
    let v = DVec2::from(cluster.texture_up.map(f64::from));
    let turned = DVec2::new(
        v.y * offset.x - v.x * offset.y,
        v.x * offset.x + v.y * offset.y,
    );
    reference + DVec2::from(cluster.tiles.map(f64::from)) / PI * turned
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cluster() -> InkCluster {
        InkCluster {
            radius: 0.5,
            tiles: [3.0, 3.0],
            texture_up: [0.0, 1.0],
            ..InkCluster::default()
        }
    }

    fn at(place: DVec3) -> DVec2 {
        body_hatch(&cluster(), place, DVec3::Z * 4.0, [DVec3::X, DVec3::Y])
    }

    #[test]
    fn the_front_point_is_the_middle_and_the_sphere_is_equation_3_on_its_axes() {
        assert_eq!(at(DVec3::Z * 0.5), DVec2::ZERO, "S(R) = 0");
        for k in 1..9 {
            let angle = 0.15 * f64::from(k);
            let sphere = 0.5 * DVec3::new(angle.sin(), 0.0, angle.cos());
            // m phi / pi and n theta / pi.
            assert!((at(sphere).x - 3.0 * angle / PI).abs() < 1e-12, "{angle}");
            let sphere = 0.5 * DVec3::new(0.0, angle.sin(), angle.cos());
            assert!((at(sphere).y - 3.0 * angle / PI).abs() < 1e-12, "{angle}");
        }
    }

    #[test]
    fn behind_the_middle_nothing_leaps_or_folds() {
        // The angle alone would be near pi on both sides, in opposite directions.
        let place = |x: f64, z: f64| at(DVec3::new(x, 0.05, z));
        for z in [-0.3, -1e-6, 1e-6, 0.3] {
            let mut last = place(-0.2, z).x;
            for k in 1..=40 {
                let now = place(-0.2 + 0.01 * f64::from(k), z).x;
                assert!(now > last && now - last < 0.04, "{z}: {last} to {now}");
                last = now;
            }
        }
        let across = place(0.2, 1e-9) - place(0.2, -1e-9);
        assert!(across.length() < 1e-6, "{across}");
    }

    #[test]
    fn a_flat_patch_is_hatched_evenly_and_by_the_radius() {
        // Through the centre, facing the eye: the angle is a right one, the distance is linear.
        let step = at(DVec3::new(0.1, 0.05, 0.0));
        let twice = at(DVec3::new(0.2, 0.1, 0.0));
        assert!((twice - 2.0 * step).length() < 1e-12, "{step} {twice}");
        assert!(
            (step.x / step.y - 2.0).abs() < 1e-12,
            "no direction is favoured"
        );
        // Equation 10 by length alone would change with the unit of the scene.
        let scaled = InkCluster {
            radius: 500.0,
            ..cluster()
        };
        let place = DVec3::new(100.0, 50.0, 0.0);
        let far = body_hatch(&scaled, place, DVec3::Z * 4000.0, [DVec3::X, DVec3::Y]);
        assert!((far - step).length() < 1e-9, "{far} {step}");
    }
}
