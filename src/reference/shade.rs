//! Twin of `shaders/include/shade.glsl` and `surface_record.glsl`: eq. 1 of Luft, Balzer, Deussen
//! 2007 for one point, and what stage 1 keeps of a surface.

use glam::{DVec2, DVec3};

use super::encode::{decode_octahedral, encode_octahedral};

/// `I_a` for a unit normal under a sky and over a ground.
#[must_use]
pub fn ambient_intensity(normal: DVec3, zenith: DVec3, ground: DVec3) -> DVec3 {
    ground.lerp(zenith, 0.5 + 0.5 * normal.y)
}

/// Phong's lobe `((V.R)+)^n`; nil on the side away from the light.
#[must_use]
pub fn specular_lobe(normal: DVec3, to_light: DVec3, to_eye: DVec3, shininess: f64) -> f64 {
    let cosine = normal.dot(to_light);
    let mirrored = 2.0 * cosine * normal - to_light;
    if cosine > 0.0 {
        to_eye.dot(mirrored).max(1e-8).powf(shininess)
    } else {
        0.0
    }
}

/// How a surface answers light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflection {
    /// Base colour, `k_d`.
    pub albedo: DVec3,
    /// `k_s`.
    pub specular: f64,
    /// Exponent `n`.
    pub shininess: f64,
    /// Share of diffuse light from the far side; zero in the paper's model.
    pub transmission: DVec3,
}

/// The bracket of eq. 1 for one light.
#[must_use]
pub fn reflected(normal: DVec3, to_light: DVec3, to_eye: DVec3, r: &Reflection) -> DVec3 {
    let cosine = normal.dot(to_light);
    let diffuse = r.albedo * (cosine.max(0.0) + r.transmission * (-cosine).max(0.0));
    diffuse + r.specular * specular_lobe(normal, to_light, to_eye, r.shininess)
}

/// Window of `KHR_lights_punctual` that ends a light at `range`; range 0 is unlimited.
#[must_use]
pub fn range_window(distance_squared: f64, range: f64) -> f64 {
    if range <= 0.0 {
        return 1.0;
    }
    let ratio = distance_squared / (range * range);
    (1.0 - ratio * ratio).clamp(0.0, 1.0)
}

/// Share of a spot's light at a cosine from its axis.
#[must_use]
pub fn cone_share(cosine: f64, cos_outer: f64, scale: f64) -> f64 {
    ((cosine - cos_outer) * scale).clamp(0.0, 1.0).powi(2)
}

/// Ambient coefficient of the ground under a sphere that hides a share of the sky.
#[must_use]
pub fn ground_ambient(to_crown: DVec3, radius: f64, opacity: f64) -> f64 {
    let d2 = to_crown.length_squared().max(radius * radius);
    let hidden = to_crown.y / d2.sqrt() * radius * radius / d2;
    1.0 - opacity * hidden.clamp(0.0, 1.0)
}

/// What stage 1 keeps of the nearest surface of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Linear base colour in \[0,1\].
    pub albedo: DVec3,
    /// Ambient coefficient.
    pub ambient: f64,
    /// Normal; any length above 0.
    pub normal: DVec3,
}

fn byte(v: f64) -> f64 {
    (v.clamp(0.0, 1.0) * 255.0).round() / 255.0
}

/// The surface after its way through the record.
#[must_use]
pub fn through_record(s: &Surface) -> Surface {
    const STEPS: f64 = 2047.0;
    let e = encode_octahedral(s.normal) * 0.5 + 0.5;
    let e = (e * STEPS).round() / STEPS;
    let root = DVec3::from_array(s.albedo.to_array().map(|c| byte(c.max(0.0).sqrt())));
    Surface {
        albedo: root * root,
        ambient: byte(s.ambient),
        normal: decode_octahedral(e * 2.0 - DVec2::ONE),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MATT: Reflection = Reflection {
        albedo: DVec3::splat(0.5),
        specular: 0.0,
        shininess: 10.0,
        transmission: DVec3::ZERO,
    };

    #[test]
    fn light_from_the_mirror_direction_gives_the_whole_lobe() {
        let to_light = DVec3::new(0.6, 0.8, 0.0);
        let to_eye = DVec3::new(-0.6, 0.8, 0.0);
        for n in [1.0, 10.0, 300.0] {
            assert!((specular_lobe(DVec3::Y, to_light, to_eye, n) - 1.0).abs() < 1e-12);
        }
        assert_eq!(specular_lobe(DVec3::Y, -to_light, to_eye, 10.0), 0.0);
    }

    #[test]
    fn a_leaf_sends_back_or_through_no_more_than_it_gets() {
        let r = Reflection {
            transmission: DVec3::splat(1.0),
            ..MATT
        };
        for i in 0..100 {
            let a = f64::from(i) * 0.0628;
            let l = DVec3::new(a.sin(), a.cos(), 0.0);
            assert!(reflected(DVec3::Y, l, DVec3::Y, &r).max_element() <= 0.5 + 1e-12);
        }
    }

    #[test]
    fn mean_over_all_light_directions_is_a_quarter() {
        // The mean of (N.L)+ over the sphere is 1/4.
        let n = 20_000;
        let sum: f64 = (0..n)
            .map(|i| {
                let y = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(n);
                let l = DVec3::new((1.0 - y * y).sqrt(), y, 0.0);
                reflected(DVec3::Y, l, DVec3::Y, &MATT).x
            })
            .sum();
        assert!((sum / f64::from(n) - 0.125).abs() < 1e-6);
    }

    #[test]
    fn record_keeps_normals_to_an_eighth_of_a_degree() {
        let mut worst = 0f64;
        for i in 0..20_000 {
            let y = 1.0 - 2.0 * (f64::from(i) + 0.5) / 20_000.0;
            let a = f64::from(i) * 2.399_963;
            let r = (1.0 - y * y).sqrt();
            let n = DVec3::new(r * a.cos(), y, r * a.sin());
            let s = Surface {
                albedo: DVec3::ZERO,
                ambient: 1.0,
                normal: n * 0.3,
            };
            let back = through_record(&s).normal;
            worst = worst.max(back.cross(n).length().asin().to_degrees());
        }
        assert!(worst < 0.12, "{worst} degrees");
    }
}
