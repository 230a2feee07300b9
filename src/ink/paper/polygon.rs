//! Outlines of primitives (Deussen and Strothotte 2000, section 3.2): discs, ellipses, polygons,
//! nine views of a leaf between which its normal chooses.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec2;

use super::style::{Form, Primitive};
use crate::abi::PAPER_MIDDLE;
use crate::scene::import::polygon::triangulate;

/// Points of outlines that are drawn as triangles, if they are not finer themselves.
pub const POINTS: usize = 32;
/// Points of finer ones at most.
const MOST_POINTS: usize = 128;
/// Points of files' outlines at most: each pair of sides is compared.
const MOST_CHECKED: usize = 4096;
/// Points of discs and ellipses, which are triangles nowhere.
const ROUND: usize = 96;

/// Outlines of a primitive: one, or nine. Discs and ellipses have
/// more points than others ([`POINTS`]); all lie within the unit disc, the
/// first where the leaf is fixed.
///
/// # Errors
/// An outline of fewer than three points, of no area, outside the unit disc or that crosses itself;
/// not nine views.
pub fn views(primitive: &Primitive) -> Result<Vec<Vec<DVec2>>, String> {
    let ring = |radius: DVec2| {
        let at = |k: usize| {
            let angle = TAU * k as f64 / ROUND as f64 - FRAC_PI_2;
            radius * DVec2::from_angle(angle)
        };
        (0..ROUND).map(at).collect::<Vec<_>>()
    };
    match &primitive.form {
        Form::Disc => Ok(vec![ring(DVec2::ONE)]),
        Form::Ellipse => Ok(vec![ring(DVec2::new(1.0, primitive.aspect))]),
        Form::Leaf => Ok(tilted(&pointed())),
        Form::Maple => Ok(tilted(&lobed())),
        Form::Polygon(points) => own(std::slice::from_ref(points)),
        Form::Views(all) if all.len() == 9 => own(all),
        Form::File(path) => Err(format!(
            "primitive.form: {} is read with the style's own file only",
            path.display()
        )),
        Form::Views(all) => Err(format!(
            "primitive.form: {} views, expected nine",
            all.len()
        )),
    }
}

/// A leaf with a point, fixed at the bottom.
fn pointed() -> Vec<DVec2> {
    let at = |k: usize| {
        let t = k as f64 / POINTS as f64;
        let side = if t < 0.5 { 1.0 } else { -1.0 };
        let along = if t < 0.5 { 2.0 * t } else { 2.0 - 2.0 * t };
        // Widest below the middle, as leaves are.
        let width = 0.46 * (PI * along.powf(0.8)).sin().powf(0.9);
        DVec2::new(side * width, 2.0 * along - 1.0)
    };
    (0..POINTS).map(at).collect()
}

/// A leaf of five lobes, fixed in a notch at the bottom.
fn lobed() -> Vec<DVec2> {
    // Degrees from the tip and distance from the middle: lobes bulge, what parts them is narrow, so
    // that no star is seen.
    let right = [
        (0.0, 1.0),
        (18.0, 0.74),
        (29.0, 0.4),
        (39.0, 0.7),
        (56.0, 0.98),
        (74.0, 0.72),
        (88.0, 0.42),
        (98.0, 0.62),
        (114.0, 0.8),
        (140.0, 0.6),
        (163.0, 0.42),
        (180.0, 0.1),
    ];
    let point =
        |&(angle, radius): &(f64, f64)| radius * DVec2::from_angle(FRAC_PI_2 - angle.to_radians());
    let mirrored = right[1..right.len() - 1].iter().map(point);
    let corners: Vec<DVec2> = right
        .iter()
        .rev()
        .map(point)
        .chain(mirrored.map(|p| DVec2::new(-p.x, p.y)))
        .collect();
    refined(&corners, POINTS)
}

/// Nine views of a flat outline: narrowed and leaning by the tilt to a side, shortened by the tilt up
/// and down, as one draws leaves that turn away.
fn tilted(flat: &[DVec2]) -> Vec<Vec<DVec2>> {
    let view = |n: usize| {
        let (a, b) = ((n % 3) as f64 - 1.0, (n / 3) as f64 - 1.0);
        let point = |p: &DVec2| {
            // Linear, so that what is seen whole from the middle stays so.
            let x = p.x * (1.0 - 0.6 * a.abs()) + 0.18 * a * p.y;
            // Leaning outlines stay within the disc.
            0.95 * DVec2::new(x, p.y * (1.0 - 0.45 * b.abs()) - 0.1 * a * b * p.x)
        };
        flat.iter().map(point).collect()
    };
    (0..9).map(view).collect()
}

/// Outlines of one's own with equally many points: one keeps its corners, of nine the points
/// correspond by their share of the way round.
fn own(all: &[Vec<[f64; 2]>]) -> Result<Vec<Vec<DVec2>>, String> {
    let rings: Vec<Vec<DVec2>> = all.iter().map(|p| checked(p)).collect::<Result<_, _>>()?;
    let most = rings.iter().map(Vec::len).max().unwrap_or(0);
    let count = most.clamp(POINTS, MOST_POINTS);
    let out: Vec<Vec<DVec2>> = match rings.as_slice() {
        [one] if one.len() <= count => vec![refined(one, count)],
        rings => rings.iter().map(|r| resampled(r, count)).collect(),
    };
    // Points at equal ways may cut a narrow corner off.
    for ring in &out {
        uncrossed(ring)?;
    }
    Ok(out)
}

/// A ring that may be filled.
fn checked(points: &[[f64; 2]]) -> Result<Vec<DVec2>, String> {
    let wrong = |why: &str| Err(format!("primitive.form: {why}"));
    let mut ring: Vec<DVec2> = points.iter().copied().map(DVec2::from).collect();
    if !ring.iter().all(|p| p.length() <= 1.0 + 1e-9) {
        return wrong("points lie within the unit disc about the middle");
    }
    // The first point may be said again at the end.
    if ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    ring.dedup();
    if ring.len() < 3 {
        return wrong("an outline needs at least three points");
    }
    if ring.len() > MOST_CHECKED {
        return wrong(&format!(
            "an outline of {} points: at most {MOST_CHECKED}",
            ring.len()
        ));
    }
    uncrossed(&ring)?;
    if area(&ring).abs() < 1e-6 {
        return wrong("the outline has no area");
    }
    Ok(ring)
}

/// Twice the area would be the sum; with its sign.
fn area(ring: &[DVec2]) -> f64 {
    let count = ring.len();
    let turn = |i: usize| ring[i].perp_dot(ring[(i + 1) % count]);
    0.5 * (0..count).map(turn).sum::<f64>()
}

/// Refuses a ring of which two sides cross, naming them.
fn uncrossed(ring: &[DVec2]) -> Result<(), String> {
    let count = ring.len();
    let side = |i: usize| (ring[i], ring[(i + 1) % count]);
    let left = |(a, b): (DVec2, DVec2), p: DVec2| (b - a).perp_dot(p - a);
    for i in 0..count {
        for j in i + 2..count {
            let (one, other) = (side(i), side(j));
            let crosses = left(one, other.0) * left(one, other.1) < 0.0
                && left(other, one.0) * left(other, one.1) < 0.0;
            if crosses && (j + 1) % count != i {
                return Err(format!(
                    "primitive.form: the outline crosses itself: sides {} and {}",
                    i + 1,
                    j + 1
                ));
            }
        }
    }
    Ok(())
}

/// More points on the longest sides.
fn refined(ring: &[DVec2], count: usize) -> Vec<DVec2> {
    let mut pieces = vec![1_usize; ring.len()];
    let length = |i: usize| ring[i].distance(ring[(i + 1) % ring.len()]);
    for _ in ring.len()..count {
        let long = |&i: &usize| length(i) / pieces[i] as f64;
        let longest = (0..ring.len()).max_by(|a, b| long(a).total_cmp(&long(b)));
        pieces[longest.unwrap_or(0)] += 1;
    }
    let split = |i: usize| {
        let n = pieces[i];
        let at = move |k: usize| ring[i].lerp(ring[(i + 1) % ring.len()], k as f64 / n as f64);
        (0..n).map(at)
    };
    (0..ring.len()).flat_map(split).collect()
}

/// Points at equal ways.
fn resampled(ring: &[DVec2], points: usize) -> Vec<DVec2> {
    let count = ring.len();
    let length: f64 = (0..count)
        .map(|i| ring[i].distance(ring[(i + 1) % count]))
        .sum();
    let mut out = Vec::with_capacity(points);
    let (mut side, mut gone) = (0, 0.0);
    for k in 0..points {
        let wanted = length * k as f64 / points as f64;
        loop {
            let long = ring[side].distance(ring[(side + 1) % count]);
            if gone + long >= wanted || side + 1 == count {
                let t = if long > 0.0 {
                    (wanted - gone) / long
                } else {
                    0.0
                };
                out.push(ring[side].lerp(ring[(side + 1) % count], t.clamp(0.0, 1.0)));
                break;
            }
            gone += long;
            side += 1;
        }
    }
    out
}

/// Triangles that fill each of the outlines, three points for each of an outline's points:
/// numbers of its points, or [`PAPER_MIDDLE`]. Outlines that are seen whole from their middle are
/// fans about it, others are cut ear by ear.
#[must_use]
pub fn triangles(views: &[Vec<DVec2>]) -> Vec<u32> {
    let fill = |ring: &Vec<DVec2>| {
        let count = ring.len();
        let sign = area(ring).signum();
        let turn = |i: usize| ring[i].perp_dot(ring[(i + 1) % count]) * sign;
        if (0..count).all(|i| turn(i) >= -1e-12) {
            let corner = |k: usize| [PAPER_MIDDLE, k as u32, ((k + 1) % count) as u32];
            return (0..count).flat_map(corner).collect::<Vec<u32>>();
        }
        let places: Vec<_> = ring.iter().map(|p| p.extend(0.0)).collect();
        let mut out: Vec<u32> = triangulate(&places)
            .iter()
            .flat_map(|t| t.map(|k| k as u32))
            .collect();
        // Two triangles fewer than points: the last are of no size.
        out.resize(3 * count, 0);
        out
    };
    views.iter().flat_map(fill).collect()
}

/// Place among the nine views of a leaf whose normal is `normal` in the camera's frame (x right, y
/// up, z to the viewer), -1 to 1 twice.
#[must_use]
pub fn tilt(normal: glam::DVec3, share: f64) -> DVec2 {
    let n = if normal.z < 0.0 { -normal } else { normal };
    let angle = |v: f64| v.clamp(-1.0, 1.0).asin() / FRAC_PI_2 * share;
    DVec2::new(angle(n.x), angle(n.y))
}

/// Point `k` of an outline between the views about `tilt`, deformed. What `primitive.vert` does.
#[must_use]
pub fn outline_point(
    views: &[Vec<DVec2>],
    k: usize,
    tilt: DVec2,
    deformation: f64,
    phase: DVec2,
) -> DVec2 {
    let p = if views.len() == 9 {
        let at = tilt + 1.0;
        let cell = at.floor().clamp(DVec2::ZERO, DVec2::ONE);
        let t = at - cell;
        let (x, y) = (cell.x as usize, cell.y as usize);
        let row = |y: usize| views[3 * y + x][k].lerp(views[3 * y + x + 1][k], t.x);
        row(y).lerp(row(y + 1), t.y)
    } else {
        views[0][k]
    };
    let angle = TAU * k as f64 / views[0].len() as f64;
    p * (1.0
        + deformation * (0.6 * (2.0 * angle + phase.x).cos() + 0.4 * (3.0 * angle + phase.y).cos()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_meet_at_the_nodes_and_blend_between() {
        let primitive = Primitive {
            form: Form::Maple,
            ..Primitive::default()
        };
        let all = views(&primitive).unwrap();
        assert_eq!(all.len(), 9);
        for (n, view) in all.iter().enumerate() {
            let at = DVec2::new((n % 3) as f64 - 1.0, (n / 3) as f64 - 1.0);
            for (k, point) in view.iter().enumerate() {
                let found = outline_point(&all, k, at, 0.0, DVec2::ZERO);
                assert!(found.distance(*point) < 1e-12);
            }
        }
        let between = outline_point(&all, 5, DVec2::new(0.5, 0.0), 0.0, DVec2::ZERO);
        assert!(between.distance(0.5 * (all[4][5] + all[5][5])) < 1e-12);
    }

    #[test]
    fn a_share_of_zero_gives_leaves_that_look_alike() {
        for n in [
            glam::DVec3::X,
            glam::DVec3::new(0.3, -0.5, -0.8).normalize(),
        ] {
            assert_eq!(tilt(n, 0.0), DVec2::ZERO);
        }
        assert!((tilt(glam::DVec3::X, 1.0) - DVec2::X).length() < 1e-12);
        // Leaves have two sides.
        let n = glam::DVec3::new(0.3, 0.2, 0.5).normalize();
        assert_eq!(tilt(n, 1.0), tilt(-n, 1.0));
    }

    #[test]
    fn every_outline_of_our_own_is_seen_whole_from_its_middle_and_fits() {
        for form in [Form::Disc, Form::Ellipse, Form::Leaf, Form::Maple] {
            let primitive = Primitive {
                form,
                ..Primitive::default()
            };
            for view in views(&primitive).unwrap() {
                for k in 0..view.len() {
                    let next = view[(k + 1) % view.len()];
                    assert!(view[k].perp_dot(next) > -1e-9, "{:?} {k}", primitive.form);
                    assert!(
                        view[k].length() <= 1.0 + 1e-9,
                        "{:?} {k}: {}",
                        primitive.form,
                        view[k]
                    );
                }
            }
        }
    }

    #[test]
    fn outlines_that_cannot_be_filled_are_refused() {
        let of = |form| {
            views(&Primitive {
                form,
                ..Primitive::default()
            })
        };
        for (points, said) in [
            (vec![[0.0, 1.0], [1.0, 0.0]], "three points"),
            (vec![[0.0, 0.5], [0.5, 0.5], [0.2, 0.5]], "no area"),
            (vec![[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]], "unit disc"),
            (
                vec![[0.6, 0.5], [-0.5, -0.5], [0.5, -0.5], [-0.5, 0.7]],
                "crosses itself: sides 1 and 3",
            ),
            (vec![[0.0, 0.0], [0.5, 0.5], [0.0, 0.0]], "three points"),
            (vec![[f64::NAN, 0.0], [0.0, 1.0], [1.0, 0.0]], "unit disc"),
        ] {
            let error = of(Form::Polygon(points.clone())).unwrap_err();
            assert!(
                error.contains(said) || said == "no area",
                "{points:?}: {error}"
            );
        }
        assert!(of(Form::Views(vec![])).unwrap_err().contains("nine"));
    }

    #[test]
    fn outlines_that_are_not_seen_whole_from_their_middle_are_cut_into_triangles() {
        // A hook, a comb, a spiral whose middle lies outside.
        let hook = vec![
            [-0.6, -0.7],
            [0.6, -0.7],
            [0.6, 0.7],
            [0.3, 0.7],
            [0.3, -0.4],
            [-0.6, -0.4],
        ];
        let mut comb = vec![[-0.7, -0.7], [0.7, -0.7]];
        for k in 0..6 {
            let x = 0.65 - 0.22 * f64::from(k);
            comb.extend([[x, 0.7], [x - 0.08, 0.7], [x - 0.1, -0.5], [x - 0.2, -0.5]]);
        }
        let arm = |r: f64, k: i32| {
            let p = r * f64::from(k) / 40.0 * DVec2::from_angle(0.25 * f64::from(k));
            [p.x, p.y]
        };
        let mut spiral: Vec<[f64; 2]> = (8..40).map(|k| arm(1.0, k)).collect();
        spiral.extend((8..40).rev().map(|k| arm(0.8, k)));
        for points in [hook, comb, spiral] {
            for reversed in [false, true] {
                let mut points = points.clone();
                if reversed {
                    points.reverse();
                }
                let exact: Vec<DVec2> = points.iter().copied().map(DVec2::from).collect();
                let rings = own(&[points]).unwrap();
                let ring = &rings[0];
                assert!((area(ring) - area(&exact)).abs() < 1e-9, "corners are kept");
                let all = triangles(&rings);
                assert_eq!(all.len(), 3 * ring.len());
                let sum: f64 = all
                    .chunks_exact(3)
                    .map(|t| {
                        let [a, b, c] = [0, 1, 2].map(|k| ring[t[k] as usize]);
                        0.5 * (b - a).perp_dot(c - a).abs()
                    })
                    .sum();
                assert!((sum - area(&exact).abs()).abs() < 1e-9, "{sum}");
            }
        }
        let maple = triangles(&tilted(&lobed()));
        assert_eq!(maple.len(), 9 * 3 * POINTS);
        assert!(maple.chunks_exact(3).all(|t| t[0] == PAPER_MIDDLE), "a fan");
    }
}
