//! Foliage as particles (Deussen and Strothotte 2000, section 3): leaves thinned twig by twig, and
//! what a view makes of them.

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use super::polygon::{outline_point, tilt};
use super::style::{Form, Ground, PaperStyle};
use crate::Result;
use crate::abi::PaperParticle;
use crate::ink::clusters::{Choice, Clusters};
use crate::ink::leaves::Leaf;
use crate::ink::view::View;
use crate::math::sampling::{pcg, uniform};

/// A particle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Particle {
    /// Place, in the geometry's frame.
    pub centre: Vec3,
    /// Unit normal.
    pub normal: Vec3,
    /// Unit direction from the leaf's base to its tip, if the model has one.
    pub axis: Option<Vec3>,
    /// Number that chooses everything random: the leaf's.
    pub seed: u32,
    /// Number of the object that it is of.
    pub object: u32,
}

/// Twigs for every particle that is left: fewer twigs than particles keep the crown's shape.
const TWIGS_PER_PARTICLE: f64 = 0.5;

/// Leaves as particles, thinned twig by twig to `count` (0: all of them).
///
/// # Errors
/// A leaf whose place is no number.
pub fn particles(leaves: &[Leaf], count: u32, seed: u32) -> Result<Vec<Particle>> {
    let particle = |(number, leaf): (usize, &Leaf)| Particle {
        centre: leaf.centre,
        normal: leaf.normal,
        axis: Some(leaf.axis),
        seed: pcg(number as u32 ^ pcg(seed)),
        object: leaf.instance,
    };
    let all: Vec<Particle> = leaves.iter().enumerate().map(particle).collect();
    if count == 0 || all.len() <= count as usize {
        return Ok(all);
    }
    let twigs = twigs(&all, f64::from(count) * TWIGS_PER_PARTICLE)?;
    let mut of_twig: Vec<Vec<u32>> = vec![Vec::new(); twigs.clusters.len()];
    for (leaf, &twig) in (0..).zip(&twigs.of_leaf) {
        of_twig[twig as usize].push(leaf);
    }
    // Every twig keeps its share; what rounding leaves over goes on to the next twig.
    let share = f64::from(count) / all.len() as f64;
    let mut owed = 0.5;
    let mut kept = Vec::with_capacity(count as usize);
    for mut twig in of_twig {
        owed += share * twig.len() as f64;
        let here = (owed.floor().max(0.0) as usize).min(twig.len());
        owed -= here as f64;
        twig.sort_by_key(|&leaf| (all[leaf as usize].seed, leaf));
        kept.extend_from_slice(&twig[..here]);
    }
    kept.sort_unstable();
    Ok(kept.iter().map(|&leaf| all[leaf as usize]).collect())
}

/// About so many groups of neighbours.
fn twigs(all: &[Particle], wanted: f64) -> Result<Clusters> {
    let centres: Vec<Vec3> = all.iter().map(|p| p.centre).collect();
    let low = centres.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let high = centres.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    let diagonal = (high - low).length().max(f32::MIN_POSITIVE);
    // Spheres of that radius side by side fill the crown; two trials correct the guess.
    let mut radius = 0.6 * diagonal / (wanted.max(1.0) as f32).cbrt();
    let mut found = Clusters::new(&centres, radius, Choice::First)?;
    for _ in 0..2 {
        let ratio = found.clusters.len() as f32 / wanted.max(1.0) as f32;
        if (0.7..1.4).contains(&ratio) {
            break;
        }
        radius = (radius * ratio.cbrt()).clamp(1e-6 * diagonal, diagonal);
        found = Clusters::new(&centres, radius, Choice::First)?;
    }
    Ok(found)
}

/// Particles of the ground about the plants: on the level of their lowest point, evenly over a disc.
#[must_use]
pub fn ground(positions: &[Vec3], ground: &Ground, seed: u32) -> Vec<Particle> {
    let Some((middle, radius)) = disc(positions, ground) else {
        return Vec::new();
    };
    let particle = |number: u32| {
        let seed = pcg(number ^ pcg(!seed));
        let angle = std::f64::consts::TAU * uniform(seed, 3);
        let way = radius * uniform(seed, 4).sqrt() as f32;
        let (sin, cos) = angle.sin_cos();
        Particle {
            centre: Vec3::new(
                middle.x + way * cos as f32,
                middle.y,
                middle.z + way * sin as f32,
            ),
            normal: Vec3::Y,
            axis: None,
            seed,
            object: 0,
        }
    };
    (0..ground.count).map(particle).collect()
}

/// Middle and radius of the ground; none under nothing.
fn disc(positions: &[Vec3], ground: &Ground) -> Option<(Vec3, f32)> {
    let low = positions.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let high = positions
        .iter()
        .copied()
        .fold(Vec3::NEG_INFINITY, Vec3::max);
    let radius = 0.5 * (high - low).x.max((high - low).z) * ground.extent as f32;
    let middle = 0.5 * (low + high);
    low.is_finite()
        .then_some((Vec3::new(middle.x, low.y, middle.z), radius))
}

/// Where on the ground the shadows of `positions` lie, at its edge where they fall beyond: what of
/// it is to be seen. Nothing where there is no ground or no sun above it.
#[must_use]
pub fn shadows_on_ground(positions: &[Vec3], ground: &Ground, to_sun: Vec3) -> Vec<Vec3> {
    let Some((middle, radius)) = disc(positions, ground) else {
        return Vec::new();
    };
    if ground.count == 0 || to_sun.y <= 0.0 {
        return Vec::new();
    }
    let fall = |&p: &Vec3| {
        let away = p - to_sun * ((p.y - middle.y) / to_sun.y) - middle;
        let reach = (radius / away.length().max(f32::MIN_POSITIVE)).min(1.0);
        middle + away * reach
    };
    positions
        .iter()
        .map(fall)
        .filter(|p| p.is_finite())
        .collect()
}

/// Metres of a length in the paper's unit, in which the plants' depths span ten.
#[must_use]
pub fn unit(view: &View) -> f64 {
    (f64::from(view.depths[1]) - f64::from(view.depths[0])) / 10.0
}

/// The particles as kernels see them in a view; those from number `leaves` on are ground.
#[must_use]
pub fn records(
    particles: &[Particle],
    leaves: usize,
    style: &PaperStyle,
    view: &View,
) -> Vec<PaperParticle> {
    let [right, up, back] = view.camera.basis();
    let p = &style.primitive;
    let sizes = [p.size, style.ground.size].map(|s| s * unit(view));
    let random_turn = matches!(p.form, Form::Ellipse);
    // Sizes are those at the plants' front, or at the distance that is told.
    let front = f64::from(style.depth.metres(view.depths)[0]);
    let to_camera = |v: Vec3| {
        let v = v.as_dvec3();
        DVec3::new(v.dot(right), v.dot(up), v.dot(back))
    };
    let record = |(number, particle): (usize, &Particle)| {
        let radius = sizes[usize::from(number >= leaves)];
        let (pixel, depth) = view.pixel(particle.centre.as_dvec3());
        // From the outline's base (below) to the leaf's.
        let along = particle.axis.map(|a| to_camera(a).truncate());
        let along = along
            .and_then(DVec2::try_normalize)
            .filter(|_| !random_turn);
        let angle = || std::f64::consts::TAU * uniform(particle.seed, 0);
        // (0, 1) turned is the axis.
        let turn = along.map_or_else(|| DVec2::from_angle(angle()), |a| DVec2::new(a.y, -a.x));
        let tilt = tilt(to_camera(particle.normal), p.views);
        let waves = [1, 2].map(|k| (std::f64::consts::TAU * uniform(particle.seed, k)).sin_cos());
        PaperParticle {
            centre: particle.centre.to_array(),
            radius: (radius * growth(p.constant_size, p.largest, depth / front)) as f32,
            turn: turn.as_vec2().to_array(),
            tilt: tilt.as_vec2().to_array(),
            // Here, since devices have cosines of their own.
            waves: [waves[0].1, waves[1].1, waves[0].0, waves[1].0].map(|v| v as f32),
            row: pixel.y as f32,
        }
    };
    particles.par_iter().enumerate().map(record).collect()
}

/// Factor on the size of a primitive `ratio` times as far away as the front (section 3.3):
/// `r = w d / s + 1 - w`, above `w = 1` without the second term, within 1 and `largest`.
#[must_use]
pub fn growth(weight: f64, largest: f64, ratio: f64) -> f64 {
    let r = if weight <= 1.0 {
        weight * ratio + 1.0 - weight
    } else {
        weight * ratio
    };
    r.clamp(1.0, largest)
}

/// The outline of a particle in the picture, pixels; empty where it is not before the camera.
#[must_use]
pub fn outline(
    record: &PaperParticle,
    views: &[Vec<DVec2>],
    deformation: f64,
    view: &View,
) -> Vec<DVec2> {
    let (middle, depth) = view.pixel(Vec3::from(record.centre).as_dvec3());
    if depth <= view.camera.near || depth.is_nan() {
        return Vec::new();
    }
    let pixels = f64::from(record.radius) * view.focal() / depth;
    let turn = DVec2::from(record.turn.map(f64::from));
    let tilt = DVec2::from(record.tilt.map(f64::from));
    let [cosine, other_cosine, sine, other_sine] = record.waves.map(f64::from);
    let phase = DVec2::new(sine.atan2(cosine), other_sine.atan2(other_cosine));
    (0..views[0].len())
        .map(|k| {
            let p = turn.rotate(outline_point(views, k, tilt, deformation, phase));
            middle + pixels * DVec2::new(p.x, -p.y)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn leaf(at: Vec3) -> Leaf {
        Leaf {
            centre: at,
            normal: Vec3::Z,
            axis: Vec3::Y,
            radius: 0.1,
            area: 0.01,
            texcoord: glam::Vec2::ZERO,
            texcoord_per_metre: glam::Mat2::ZERO,
            material: 0,
            instance: 0,
        }
    }

    #[test]
    fn what_is_seen_of_the_ground_is_where_shadows_fall() {
        let positions = [
            Vec3::new(-1.0, 0.0, -1.0),
            Vec3::new(1.0, 2.0, 1.0),
            Vec3::new(0.0, 8.0, 0.0),
        ];
        let field = Ground {
            count: 10,
            extent: 3.0,
            ..Ground::default()
        };
        let to_sun = Vec3::new(0.6, 0.8, 0.0);
        let found = shadows_on_ground(&positions, &field, to_sun);
        // The foot's lies at the foot; a tall one's at the ground's edge, 3 metres away.
        let wanted = [
            positions[0],
            Vec3::new(-0.5, 0.0, 1.0),
            Vec3::new(-3.0, 0.0, 0.0),
        ];
        assert!(
            found.iter().zip(wanted).all(|(f, w)| f.distance(w) < 1e-5),
            "{found:?}"
        );
        assert!(shadows_on_ground(&positions, &Ground::default(), to_sun).is_empty());
        assert!(shadows_on_ground(&positions, &field, -to_sun).is_empty());
        assert!(shadows_on_ground(&[], &field, to_sun).is_empty());
    }

    #[test]
    fn thinning_leaves_as_many_as_are_wanted_evenly_over_the_crown() {
        let at = |i: u32| {
            Vec3::new(
                (uniform(1, 3 * i)) as f32,
                uniform(1, 3 * i + 1) as f32,
                uniform(1, 3 * i + 2) as f32,
            )
        };
        let leaves: Vec<Leaf> = (0..8000).map(|i| leaf(at(i))).collect();
        for count in [1, 7, 500, 4000] {
            let kept = particles(&leaves, count, 3).unwrap();
            assert!(
                kept.len().abs_diff(count as usize) <= 1,
                "{count}: {}",
                kept.len()
            );
            assert_eq!(kept, particles(&leaves, count, 3).unwrap());
        }
        // In each eighth of the cube about an eighth.
        let kept = particles(&leaves, 800, 3).unwrap();
        for n in 0..8 {
            let inside = |p: &&Particle| (0..3).all(|k| (p.centre[k] > 0.5) == (n >> k & 1 == 1));
            let here = kept.iter().filter(inside).count();
            assert!((70..=130).contains(&here), "{here}");
        }
        assert_eq!(particles(&leaves, 0, 3).unwrap().len(), 8000);
        assert_eq!(particles(&leaves, 9000, 3).unwrap().len(), 8000);
        assert!(particles(&[], 5, 3).unwrap().is_empty());
    }

    #[test]
    fn sizes_follow_the_law() {
        for (weight, ratio, expected) in [
            (0.0, 1.8, 1.0),
            (0.5, 1.8, 1.4),
            (1.0, 1.8, 1.8),
            (1.5, 1.2, 1.8),
            (1.0, 3.0, 2.0),
            (1.0, 0.5, 1.0),
        ] {
            let r = growth(weight, 2.0, ratio);
            assert!((r - expected).abs() < 1e-12, "{weight} {ratio}: {r}");
        }
    }
}
