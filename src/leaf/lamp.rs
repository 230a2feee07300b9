//! Lamps near the scene: flat, small, of any shape (Wang et al. 2005, section 4.2: "our approach is
//! applicable to \[..\] several small area light sources").
//!
//! A lamp is points of equal power on a plane, each sending light by the cosine to one side. Its
//! intensity is that along the normal; it does not change with its size.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;

use super::shape::{Mask, Shape};
use crate::abi::LampRecord;
use crate::{Error, Result};

/// What a lamp is written as.
const FORMS: &str = "expected disc:X,Y,Z/NX,NY,NZ/RADIUS/R,G,B, quad:X,Y,Z/NX,NY,NZ/WIDTHxHEIGHT/R,G,B \
                     or mask:X,Y,Z/NX,NY,NZ/WIDTHxHEIGHT/R,G,B/FILE";
/// Most points of a lamp that rays are sent to.
pub const MOST_POINTS: u32 = 4096;

/// A lamp.
#[derive(Debug, Clone, PartialEq)]
pub struct Lamp {
    /// Where its middle is, metres.
    pub position: DVec3,
    /// Unit vector that its face looks along; nothing is sent to the other side.
    pub normal: DVec3,
    /// Half its width and height, metres; +y, as far as it lies in the plane, is the top (-z for
    /// a lamp that looks up or down).
    pub half: [f64; 2],
    /// Outline.
    pub shape: Shape,
    /// Irradiance at one metre along the normal, as of a point (W/sr per channel).
    pub intensity: DVec3,
}

/// Lamps in the units of kernels.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlacedLamps {
    /// One each.
    pub records: Vec<LampRecord>,
    /// Points of all of them.
    pub points: Vec<[f32; 3]>,
}

impl Lamp {
    /// Area that sends light, square metres.
    #[must_use]
    pub fn area(&self) -> f64 {
        4.0 * self.half[0] * self.half[1] * self.shape.area()
    }

    /// Radiance of its face: intensity over area.
    #[must_use]
    pub fn radiance(&self) -> DVec3 {
        self.intensity / self.area()
    }

    /// Unit vectors along its width and height, seen from the front.
    #[must_use]
    pub fn axes(&self) -> [DVec3; 2] {
        let hint = if self.normal.y.abs() > 0.999_999 {
            DVec3::NEG_Z
        } else {
            DVec3::Y
        };
        let right = hint.cross(self.normal).normalize();
        [right, self.normal.cross(right)]
    }

    /// `count` points of equal power, metres.
    #[must_use]
    pub fn points(&self, count: u32) -> Vec<DVec3> {
        let [right, up] = self.axes();
        let [w, h] = self.half;
        let place = |[x, y]: [f64; 2]| self.position + w * x * right + h * y * up;
        self.shape.points(count).into_iter().map(place).collect()
    }

    /// As `--lamp` says it; reads the mask.
    ///
    /// # Errors
    /// What is wrong with the text, or with the mask.
    pub fn parse(text: &str) -> Result<Self> {
        let wrong = |what: &str| Error::usage(format!("--lamp {text}: {what}"));
        let (kind, rest) = text.split_once(':').ok_or_else(|| wrong(FORMS))?;
        let parts: Vec<&str> = rest
            .splitn(if kind == "mask" { 5 } else { 4 }, '/')
            .collect();
        let (half, shape) = match (kind, parts.as_slice()) {
            ("disc", [_, _, radius, _]) => {
                let [r] = numbers(radius).ok_or_else(|| wrong("the radius is no number"))?;
                ([r, r], Shape::Disc)
            }
            ("quad", [_, _, size, _]) | ("mask", [_, _, size, _, _]) => {
                let [w, h] = numbers(&size.replace('x', ","))
                    .ok_or_else(|| wrong("the size is not WIDTHxHEIGHT"))?;
                let shape = match parts.get(4) {
                    Some(file) => Shape::Mask(Arc::new(Mask::read(Path::new(file))?)),
                    None => Shape::Square,
                };
                ([0.5 * w, 0.5 * h], shape)
            }
            _ => return Err(wrong(FORMS)),
        };
        let position = numbers(parts[0]).ok_or_else(|| wrong("the place is not X,Y,Z"))?;
        let normal = numbers(parts[1]).ok_or_else(|| wrong("the normal is not NX,NY,NZ"))?;
        let intensity = numbers(parts[3])
            .or_else(|| numbers(parts[3]).map(|[v]| [v; 3]))
            .ok_or_else(|| wrong("the intensity is not R,G,B"))?;
        let lamp = Self {
            position: position.into(),
            normal: DVec3::from(normal)
                .try_normalize()
                .ok_or_else(|| wrong("a normal without length looks nowhere"))?,
            half,
            shape,
            intensity: intensity.into(),
        };
        if lamp.intensity.min_element() < 0.0 {
            return Err(wrong("the intensity is below 0"));
        }
        if !(half[0] > 0.0 && half[1] > 0.0) {
            return Err(wrong("a lamp needs a size above 0"));
        }
        Ok(lamp)
    }
}

/// `N` finite numbers with commas between.
fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let all: Option<Vec<f64>> = text
        .split(',')
        .map(|n| n.trim().parse().ok().filter(|v: &f64| v.is_finite()))
        .collect();
    all?.try_into().ok()
}

impl PlacedLamps {
    /// `lamps` with `count` points each, in coordinates relative to `origin`, times `scale`.
    #[must_use]
    pub fn new(lamps: &[Lamp], (origin, scale): (DVec3, f64), count: u32) -> Self {
        let mut out = Self::default();
        for lamp in lamps {
            let points = lamp.points(count);
            let each = f64::from(count.max(1));
            // A point stands for area / count; at the squared distance of that over 2 pi it sends
            // what a half-space of the lamp's radiance would.
            let least = lamp.area() / each / std::f64::consts::TAU;
            out.records.push(LampRecord {
                normal: lamp.normal.as_vec3().to_array(),
                first_point: out.points.len() as u32,
                // Distances grow by `scale`, irradiance stays.
                intensity: (lamp.intensity * (scale * scale / each))
                    .as_vec3()
                    .to_array(),
                points: points.len() as u32,
                least: (least * scale * scale) as f32,
            });
            let relative = |p: DVec3| (scale * (p - origin)).as_vec3().to_array();
            out.points.extend(points.into_iter().map(relative));
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_of_the_option() {
        let disc = Lamp::parse("disc:1,2,3/0,-2,0/0.5/3,2,1").unwrap();
        assert_eq!(disc.normal, DVec3::NEG_Y);
        assert!((disc.area() - 0.25 * std::f64::consts::PI).abs() < 1e-12);
        let quad = Lamp::parse("quad:0,0,0/0,0,1/2x0.5/4").unwrap();
        assert_eq!(quad.intensity, DVec3::splat(4.0));
        assert_eq!(quad.radiance(), DVec3::splat(4.0));
        let points = quad.points(64);
        assert!(points.iter().all(|p| p.z == 0.0 && p.y.abs() < 0.25));
        assert!(points.iter().any(|p| p.x.abs() > 0.9));
        for (text, reason) in [
            ("disc", "expected"),
            ("ball:0,0,0/0,0,1/1/1,1,1", "expected"),
            ("disc:0,0/0,0,1/1/1,1,1", "X,Y,Z"),
            ("disc:0,0,0/0,0,0/1/1,1,1", "looks nowhere"),
            ("disc:0,0,0/0,0,1/0/1,1,1", "above 0"),
            ("disc:0,0,0/0,0,1/1/1,-1,1", "below 0"),
            ("quad:0,0,0/0,0,1/1/1,1,1", "WIDTHxHEIGHT"),
            ("mask:0,0,0/0,0,1/1x1/1,1,1/nothing.png", "nothing.png"),
        ] {
            let e = Lamp::parse(text).unwrap_err().to_string();
            assert!(e.contains(reason), "{text}: {e}");
        }
    }

    /// A small lamp far away: intensity over the square of the distance, whatever the units.
    #[test]
    fn irradiance_does_not_depend_on_units() {
        let lamp = Lamp::parse("disc:0,3,0/0,-1,0/0.1/2,2,2").unwrap();
        for scale in [1.0, 0.01, 50.0] {
            let origin = DVec3::new(0.0, 1.0, 0.0);
            let placed = PlacedLamps::new(std::slice::from_ref(&lamp), (origin, scale), 8);
            let e: f32 = placed
                .points
                .iter()
                .map(|&[_, y, _]| placed.records[0].intensity[0] / (y * y))
                .sum();
            assert!((e - 0.5).abs() < 1e-5, "{scale}: {e}");
        }
    }
}
