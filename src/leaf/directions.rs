//! For which directions of the sun visibility is kept: a grid over the sphere, or a day.

use glam::DVec3;

use crate::{Error, Result};

/// Texels along an edge of a face of the paper's cube.
pub const PAPER_GRID: u32 = 32;
/// Obliquity of the ecliptic, degrees.
const OBLIQUITY: f64 = 23.44;

/// A set of directions.
#[derive(Debug, Clone, PartialEq)]
pub enum Directions {
    /// Texel middles of a cube map: faces +x -x +y -y +z -z, rows, columns.
    Cube {
        /// Texels along an edge.
        side: u32,
    },
    /// Unit vectors in the order in which the sun takes them.
    Path(Vec<DVec3>),
}

/// What a direction is read from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tap {
    /// Number of the map.
    pub map: usize,
    /// Its share.
    pub weight: f64,
}

impl Directions {
    /// Every direction, in the order of the maps.
    #[must_use]
    pub fn all(&self) -> Vec<DVec3> {
        match self {
            Self::Path(path) => path.clone(),
            Self::Cube { side } => (0..6 * side * side)
                .map(|i| {
                    let middle = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(*side) - 1.0;
                    let (face, row, column) = (i / (side * side), i / side % side, i % side);
                    from_face(face, middle(column), middle(row)).normalize()
                })
                .collect(),
        }
    }

    /// Which maps stand for the unit direction `towards`: the nearest one, or the four about it
    /// on a face of the cube (two of a path), where `blend` is set.
    #[must_use]
    pub fn taps(&self, towards: DVec3, blend: bool) -> Vec<Tap> {
        match self {
            Self::Cube { side } => cube_taps(*side, towards, blend),
            Self::Path(path) => path_taps(path, towards, blend),
        }
    }

    /// The sun's way over a day of the year (1 to 365) at a latitude (degrees), every `minutes`
    /// while it is above the horizon. Up is +y, north -z, east +x.
    ///
    /// # Errors
    /// A latitude beyond the poles, or a sun that does not rise.
    pub fn day(latitude: f64, day: u32, minutes: f64) -> Result<Self> {
        if !(-90.0..=90.0).contains(&latitude) || !(1..=366).contains(&day) || minutes <= 0.0 {
            return Err(Error::usage(format!(
                "day path: latitude {latitude} is not -90 to 90, or day {day} not 1 to 366"
            )));
        }
        let year = 2.0 * std::f64::consts::PI * (284.0 + f64::from(day)) / 365.0;
        let declination = OBLIQUITY.to_radians() * year.sin();
        let steps = (1440.0 / minutes).round().max(1.0) as u32;
        let path: Vec<DVec3> = (0..steps)
            .map(|i| {
                sun_at(
                    latitude.to_radians(),
                    declination,
                    f64::from(i) / f64::from(steps),
                )
            })
            .filter(|d| d.y > 0.0)
            .collect();
        if path.is_empty() {
            return Err(Error::usage(format!(
                "day path: at latitude {latitude} the sun does not rise on day {day}"
            )));
        }
        Ok(Self::Path(path))
    }
}

/// Direction to the sun at a share of the day since midnight.
fn sun_at(latitude: f64, declination: f64, share: f64) -> DVec3 {
    let hour = 2.0 * std::f64::consts::PI * (share - 0.5);
    let (sin_d, cos_d) = declination.sin_cos();
    let (sin_l, cos_l) = latitude.sin_cos();
    DVec3::new(
        -cos_d * hour.sin(),
        sin_l * sin_d + cos_l * cos_d * hour.cos(),
        -(cos_l * sin_d - sin_l * cos_d * hour.cos()),
    )
}

fn from_face(face: u32, u: f64, v: f64) -> DVec3 {
    match face {
        0 => DVec3::new(1.0, -v, -u),
        1 => DVec3::new(-1.0, -v, u),
        2 => DVec3::new(u, 1.0, v),
        3 => DVec3::new(u, -1.0, -v),
        4 => DVec3::new(u, -v, 1.0),
        _ => DVec3::new(-u, -v, -1.0),
    }
}

/// Face and place on it of a direction.
fn to_face(d: DVec3) -> (u32, f64, f64) {
    let axis = d.abs().max_position();
    let length = d[axis].abs();
    let (face, u, v) = match (axis, d[axis] > 0.0) {
        (0, true) => (0, -d.z, -d.y),
        (0, false) => (1, d.z, -d.y),
        (1, true) => (2, d.x, d.z),
        (1, false) => (3, d.x, -d.z),
        (2, true) => (4, d.x, -d.y),
        _ => (5, -d.x, -d.y),
    };
    (face, u / length, v / length)
}

fn cube_taps(side: u32, towards: DVec3, blend: bool) -> Vec<Tap> {
    let (face, u, v) = to_face(towards);
    let n = f64::from(side);
    let at = |c: f64| ((c + 1.0) / 2.0 * n - 0.5).clamp(0.0, n - 1.0);
    let (x, y) = (at(u), at(v));
    let map = |row: f64, column: f64| {
        (face * side * side) as usize + row as usize * side as usize + column as usize
    };
    if !blend {
        return vec![Tap {
            map: map(y.round(), x.round()),
            weight: 1.0,
        }];
    }
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = (x - x0, y - y0);
    let (x1, y1) = ((x0 + 1.0).min(n - 1.0), (y0 + 1.0).min(n - 1.0));
    let all = [
        (map(y0, x0), (1.0 - fx) * (1.0 - fy)),
        (map(y0, x1), fx * (1.0 - fy)),
        (map(y1, x0), (1.0 - fx) * fy),
        (map(y1, x1), fx * fy),
    ];
    let taps = all.iter().map(|&(map, weight)| Tap { map, weight });
    taps.filter(|t| t.weight > 0.0).collect()
}

fn path_taps(path: &[DVec3], towards: DVec3, blend: bool) -> Vec<Tap> {
    let near = |i: &usize| path[*i].distance_squared(towards);
    let order = |a: &usize, b: &usize| near(a).total_cmp(&near(b)).then(a.cmp(b));
    let Some(nearest) = (0..path.len()).min_by(order) else {
        return Vec::new();
    };
    let neighbours = [nearest.wrapping_sub(1), nearest + 1];
    let beside = neighbours.into_iter().filter(|&i| i < path.len());
    match beside.min_by(order) {
        Some(other) if blend => {
            let (a, b) = (near(&nearest).sqrt(), near(&other).sqrt());
            let weight = if a + b > 0.0 { b / (a + b) } else { 1.0 };
            let tap = |map, weight| Tap { map, weight };
            vec![tap(nearest, weight), tap(other, 1.0 - weight)]
        }
        _ => vec![Tap {
            map: nearest,
            weight: 1.0,
        }],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampling::fibonacci_directions;

    #[test]
    fn texel_middles_are_their_own_taps() {
        let grid = Directions::Cube { side: PAPER_GRID };
        let all = grid.all();
        assert_eq!(all.len(), 6144);
        for (i, d) in all.iter().enumerate() {
            for blend in [false, true] {
                let taps = grid.taps(*d, blend);
                let own = taps.iter().find(|t| t.map == i).map_or(0.0, |t| t.weight);
                assert!(own > 1.0 - 1e-9, "{i}: {taps:?}");
            }
        }
        for d in fibonacci_directions(500) {
            let taps = grid.taps(d, true);
            let sum: f64 = taps.iter().map(|t| t.weight).sum();
            assert!((sum - 1.0).abs() < 1e-12);
            let farthest = taps.iter().map(|t| all[t.map].angle_between(d));
            assert!(farthest.fold(0.0, f64::max).to_degrees() < 5.1);
        }
    }

    #[test]
    fn the_sun_stands_in_the_south_at_noon() {
        let Directions::Path(path) = Directions::day(50.0, 172, 15.0).unwrap() else {
            panic!("a path");
        };
        let noon = path
            .iter()
            .copied()
            .max_by(|a, b| a.y.total_cmp(&b.y))
            .unwrap();
        let elevation = noon.y.asin().to_degrees();
        assert!((elevation - 63.4).abs() < 0.2, "{elevation}");
        assert!(noon.z > 0.0 && noon.x.abs() < 1e-9, "{noon}");
        // East in the morning; 16 hours of light.
        assert!(path[0].x > 0.5 && path.len() > 60, "{} steps", path.len());
        assert!(Directions::day(80.0, 355, 15.0).is_err(), "polar night");
        assert!(Directions::day(95.0, 1, 15.0).is_err(), "beyond the pole");
    }
}
