//! Branching orders: what a mesh alone tells, against what the generator knows.

use glam::{DVec3, Vec3};
use umbrage::ink::branches::order::orders;
use umbrage::ink::paper::drawing::{Placement, drawing};
use umbrage::ink::paper::renderer::{PaperRenderer, PaperScene};
use umbrage::ink::paper::stems::{Told, drawn_stems};
use umbrage::scene::grow::{GrowOptions, Species, grow};

use crate::fixture;
use crate::paper::{SIZE, backdrop, scene, style, view};
use crate::place::{Place, stderr};

/// Places, triangles and the truth of a grown plant's wood.
fn wood(species: Species, seed: u64) -> (Vec<Vec3>, Vec<u32>, Vec<u8>) {
    let options = GrowOptions {
        seed,
        leaves: Some(400),
        ..GrowOptions::default()
    };
    let model = grow(species, &options).unwrap();
    let primitive = &model.meshes[0].primitives[0];
    let places = primitive.positions.iter().map(|&p| Vec3::from(p)).collect();
    let truth = primitive.botany.as_ref().unwrap().branch_order.clone();
    (places, primitive.indices.clone(), truth)
}

#[test]
fn the_mesh_alone_tells_the_orders_that_the_generator_knows() {
    for species in [Species::Broadleaf, Species::Conifer] {
        let (places, indices, truth) = wood(species, 2);
        let found = orders(&places, &indices).expect("orders are told");
        for cut in [1, 2] {
            let (mut both, mut only_found, mut only_true) = (0.0, 0.0, 0.0);
            for t in indices.chunks_exact(3) {
                let [a, b, c] = [0, 1, 2].map(|k| places[t[k] as usize]);
                let area = f64::from(0.5 * (b - a).cross(c - a).length());
                match (found[t[0] as usize] <= cut, truth[t[0] as usize] <= cut) {
                    (true, true) => both += area,
                    (true, false) => only_found += area,
                    (false, true) => only_true += area,
                    (false, false) => {}
                }
            }
            let (precision, recall) = (both / (both + only_found), both / (both + only_true));
            let deepest = truth.iter().max();
            println!(
                "{}, order {cut} of {deepest:?}: precision {precision:.4}, recall {recall:.4}",
                species.name()
            );
            assert!(precision >= 0.95 && recall >= 0.95, "{}", species.name());
        }
    }
}

#[test]
fn a_surface_that_is_one_piece_tells_no_order() {
    // A cross of two bars that share their vertices.
    let mut places = Vec::new();
    let mut indices: Vec<u32> = Vec::new();
    let bar = |places: &mut Vec<Vec3>, along: Vec3, across: Vec3| {
        let first = places.len() as u32;
        for k in 0..=20 {
            let middle = along * (0.1 * k as f32 - 1.0);
            for side in 0..4 {
                let (sin, cos) = (std::f32::consts::FRAC_PI_2 * side as f32).sin_cos();
                places.push(middle + 0.02 * (cos * across + sin * along.cross(across)));
            }
        }
        (first, first + 40)
    };
    for (along, across) in [(Vec3::Y, Vec3::X), (Vec3::X, Vec3::Y)] {
        let (first, _) = bar(&mut places, along, across);
        for ring in 0..20 {
            for side in 0..4 {
                let (a, b) = (first + 4 * ring + side, first + 4 * ring + (side + 1) % 4);
                indices.extend([a, b, b + 4, a, b + 4, a + 4]);
            }
        }
    }
    // What joins them.
    indices.extend([40, 41, 84 + 40]);
    assert_eq!(orders(&places, &indices), None);
    assert_eq!(orders(&[], &[]), None);
    assert_eq!(
        orders(&[Vec3::ONE; 3], &[0, 1, 2])
            .map(|o| o.len())
            .unwrap_or(3),
        3
    );
}

#[test]
fn the_program_says_what_told_it_the_branches() {
    let place = Place::new();
    let report = |model: &str, more: &str| {
        let style = format!(
            "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n[primitive]\ncount = 50\n{more}"
        );
        let style = place.write("own.toml", style);
        let arguments = [
            "render", model, "-o", "x.svg", "--style", &style, "--paper", "a6",
        ];
        place.json(&arguments)["branches"]
            .as_str()
            .unwrap()
            .to_owned()
    };
    assert_eq!(report("grow:shrub:1:60", ""), "order, as grown");
    let grown = place.umbrage(&["grow", "shrub", "--leaves", "60", "-o", "shrub.glb"]);
    assert_eq!(grown.status.code(), Some(0), "{}", stderr(&grown));
    assert_eq!(report("shrub.glb", ""), "order, told from their surface");
}

#[test]
fn outlines_of_stems_follow_the_cone() {
    const SIDES: u32 = 24;
    let (foot, slope, rings) = (DVec3::new(0.7, -2.0, -6.0), 0.08, 9_u32);
    let radius = |up: f64| 0.5 - slope * up;
    let mut geometry = backdrop();
    geometry.positions.clear();
    geometry.normals.clear();
    let mut stems: Vec<u32> = Vec::new();
    for ring in 0..=rings {
        let up = 4.0 * f64::from(ring) / f64::from(rings);
        for side in 0..SIDES {
            let angle = std::f64::consts::TAU * f64::from(side) / f64::from(SIDES);
            let out = DVec3::new(angle.cos(), 0.0, angle.sin());
            let place = foot + up * DVec3::Y + radius(up) * out;
            geometry.positions.push(place.as_vec3());
            geometry
                .normals
                .push((out + slope * DVec3::Y).normalize().as_vec3());
            if ring > 0 {
                let (a, b) = (
                    (ring - 1) * SIDES + side,
                    (ring - 1) * SIDES + (side + 1) % SIDES,
                );
                stems.extend([a, b, b + SIDES, a, b + SIDES, a + SIDES]);
            }
        }
    }
    let style = style("[stem]\nhatching = 0.0\n");
    let particles = [];
    let scene = PaperScene {
        stems: &stems,
        ..scene(&geometry, &particles)
    };
    let renderer = PaperRenderer::new(&fixture::gpu(), &scene, &style, SIZE).unwrap();
    let maps = renderer.maps(&scene, &view()).unwrap();
    let (found, _) = drawing(&maps, &style, &view());
    // On a circular cone seen from the origin the outline is two straight lines, at the angles where
    // the normal is across the view.
    let tip = foot + DVec3::Y * radius(0.0) / slope;
    let away = foot.x.hypot(foot.z);
    let lines = [1.0, -1.0].map(|side| {
        let at = foot.z.atan2(foot.x) + side * (-(radius(0.0) + slope * foot.y) / away).acos();
        let low = foot + radius(0.0) * DVec3::new(at.cos(), 0.0, at.sin());
        [low, low.lerp(tip, 0.6)].map(|p| view().pixel(p).0)
    });
    let placement = Placement::new(&style, maps.size);
    let ends = [0.5, 3.5].map(|up| view().pixel(foot + up * DVec3::Y).0.y);
    let (mut most, mut sum, mut count) = (0.0_f64, 0.0, 0.0);
    for p in found.layers[0].strokes.iter().flat_map(|s| &s.line.points) {
        let p = (*p - placement.corner) / placement.scale;
        if p.y < ends[0] && p.y > ends[1] {
            let off = lines.map(|[a, b]| ((b - a).perp_dot(p - a) / (b - a).length()).abs());
            let off = off[0].min(off[1]);
            most = most.max(off);
            sum += off;
            count += 1.0;
        }
    }
    println!(
        "{count} points, mean {:.3} px, most {most:.3} px",
        sum / count
    );
    assert!(count > 100.0 && most <= 0.5, "{count} points, {most} px");
}

#[test]
fn a_plant_without_leaves_is_drawn_by_its_branches() {
    let place = Place::new();
    let arguments = |style: &'static str| {
        [
            "render",
            "grow:broadleaf:1:0",
            "-o",
            "x.svg",
            "--style",
            style,
            "--paper",
            "a6",
        ]
    };
    let branches = place.umbrage(&arguments("ds00-fig2"));
    assert_eq!(branches.status.code(), Some(0), "{}", stderr(&branches));
    assert!(
        !stderr(&branches).contains("no foliage"),
        "nothing is missing"
    );
    let svg = std::fs::read_to_string(place.path("x.svg")).unwrap();
    assert!(svg.contains("1 stem contour"));
    let leaves = place.umbrage(&arguments("ds00-fig3a"));
    assert_eq!(leaves.status.code(), Some(0), "{}", stderr(&leaves));
    assert!(
        stderr(&leaves).contains("no foliage was found"),
        "{}",
        stderr(&leaves)
    );
}

/// A short stump, and a tall stem apart from it: what is thickest and lowest is no trunk.
#[test]
fn where_orders_reach_no_crown_the_radius_tells() {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    let mut tube = |radius: f32, foot: Vec3, height: f32| {
        let first = positions.len() as u32;
        for ring in 0..12_u32 {
            for side in 0..8_u32 {
                let (sin, cos) = (std::f32::consts::FRAC_PI_4 * side as f32).sin_cos();
                let up = height * ring as f32 / 11.0;
                positions.push(foot + Vec3::new(radius * cos, up, radius * sin));
                if ring > 0 {
                    let (a, b) = ((ring - 1) * 8 + side, (ring - 1) * 8 + (side + 1) % 8);
                    indices.extend([a, b, b + 8, a, b + 8, a + 8].map(|i| first + i));
                }
            }
        }
    };
    tube(0.2, Vec3::ZERO, 1.5);
    // On the stump and on each other: of orders 1 to 4.
    tube(0.15, Vec3::new(0.05, 1.4, 0.0), 1.2);
    tube(0.14, Vec3::new(0.0, 2.5, 0.04), 1.2);
    tube(0.13, Vec3::new(0.04, 3.6, 0.0), 1.2);
    tube(0.12, Vec3::new(0.0, 4.7, 0.04), 1.2);
    let stem = umbrage::ink::paper::style::Stem {
        order: 0,
        ..Default::default()
    };
    let (kept, told) = drawn_stems(&positions, indices.clone(), None, &stem);
    let top = kept
        .iter()
        .map(|&v| positions[v as usize].y)
        .fold(0.0, f32::max);
    assert_eq!((told, top > 5.0), (Told::Radius, true), "up to {top}");
}
