//! Hatching of branches: where the strokes of a trunk lie in a picture, against its known axis.

use std::f32::consts::TAU;

use glam::{DVec2, DVec3, Vec3};
use umbrage::ink::leaves::LeafTriangles;
use umbrage::ink::mix::Mix;
use umbrage::ink::plan::Attribute;
use umbrage::ink::plant::Plant;
use umbrage::ink::renderer::{InkRenderer, InkScene};
use umbrage::ink::style::Style;
use umbrage::ink::view::View;
use umbrage::scene::{Camera, Geometry, Material, Model, Primitive};

use crate::fixture;

/// A leaning trunk of 16 sides, 2 m long, about `axis`.
fn trunk(axis: Vec3) -> Primitive {
    let (a, b) = axis.any_orthonormal_pair();
    let (sides, rings) = (16_u32, 20_u32);
    let mut tube = Primitive::default();
    for ring in 0..=rings {
        let t = ring as f32 / rings as f32;
        for side in 0..sides {
            let phi = TAU * side as f32 / sides as f32;
            let radial = (phi.cos() * a + phi.sin() * b) * (0.2 - 0.08 * t);
            let place = axis * (2.0 * t - 1.0) + radial;
            tube.positions.push(place.to_array());
            if ring > 0 {
                let below = (ring - 1) * sides;
                let (p, q) = (below + side, below + (side + 1) % sides);
                tube.indices
                    .extend([p, q, q + sides, p, q + sides, p + sides]);
            }
        }
    }
    tube
}

/// A small card behind the trunk: a style wants a leaf.
fn card() -> Primitive {
    let mut card = Primitive {
        material: 1,
        ..Primitive::default()
    };
    for (x, y) in [(0.0, 0.0), (0.1, 0.0), (0.1, 0.1), (0.0, 0.1)] {
        card.positions.push([x, y, -3.0]);
    }
    card.indices = vec![0, 1, 2, 0, 2, 3];
    card
}

/// Hatch coordinates of every wood pixel with its place on the trunk.
fn drawn(axis: Vec3, along: &str) -> (Vec<(DVec2, DVec3)>, f64) {
    let gpu = fixture::gpu();
    let materials = vec![Material::default(), Material::default()];
    let model = Model::of_mesh("trunk", vec![trunk(axis), card()], materials);
    let geometry = Geometry::flatten(&model);
    let indices = &geometry.indices[geometry.indices.len() - 6..];
    let list = LeafTriangles {
        indices,
        first: &[0, 2],
        triangles: &[0, 1],
    };
    let style = Style::parse(&format!(
        "format_version = 1\ndescription = \"trunk\"\n\
         [contour]\nstrength = 1.0\n\
         [hatching]\nstrength = 1.0\nscale = 0.05\nwood = \"{along}\"\n"
    ));
    let style = style.unwrap();
    let plant = Plant::new(
        &model,
        &geometry,
        list,
        &[false, true],
        None,
        std::slice::from_ref(&style),
    )
    .unwrap();
    let size = [240, 180];
    let camera = Camera {
        eye: DVec3::new(0.3, 0.2, 3.0),
        forward: DVec3::NEG_Z,
        fov: 50.0,
        aspect: 4.0 / 3.0,
        near: 0.01,
        roll: 0.0,
    };
    let view = View::new(camera, geometry.origin, size, Vec3::Y, &geometry.positions);
    let scene = InkScene {
        model: &model,
        geometry: &geometry,
        plant: &plant,
    };
    let renderer = InkRenderer::new(&gpu, &scene, &Mix::single(style.clone()), &view, 1).unwrap();
    let wanted = [Attribute::Depth, Attribute::Ids, Attribute::Hatch];
    let drawing = renderer.draw_with(&scene, &view, &wanted).unwrap();
    let bytes = |wanted: Attribute| {
        let found = drawing.attributes.iter().find(|a| a.0 == wanted);
        &found.expect("an attribute of the style").1
    };
    let depth: Vec<f32> = bytemuck::pod_collect_to_vec(bytes(Attribute::Depth));
    let ids: Vec<[f32; 2]> = bytemuck::pod_collect_to_vec(bytes(Attribute::Ids));
    let hatch: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(bytes(Attribute::Hatch));
    let [right, up, _] = camera.basis();
    let mut out = Vec::new();
    for (i, &depth) in depth.iter().enumerate() {
        if depth <= 0.0 || ids[i][1] > 0.0 {
            continue;
        }
        let x = (i % 240) as f64 + 0.5 - 120.0;
        let y = 90.0 - (i / 240) as f64 - 0.5;
        let ray = camera.forward + (x * right + y * up) / view.focal();
        let place = camera.eye + f64::from(depth) * ray;
        let at = DVec2::new(f64::from(hatch[i][0]), f64::from(hatch[i][1]));
        out.push((at, place));
    }
    // As the renderer: the style's pixels in the distance of the middle.
    let tiles = view.focal() / (view.middle_distance() * 512.0 * 0.05);
    (out, tiles)
}

/// How well phases agree: 1 entirely, 0 not at all.
fn agreement(phases: impl Iterator<Item = f64>) -> f64 {
    let mut sum = DVec2::ZERO;
    let mut count = 0.0;
    for phase in phases {
        sum += DVec2::from_angle(std::f64::consts::TAU * phase);
        count += 1.0;
    }
    sum.length() / count
}

#[test]
fn strokes_round_a_trunk_lie_across_its_axis() {
    let axis = Vec3::new(0.5, 1.0, 0.25).normalize();
    let (pixels, tiles) = drawn(axis, "round");
    assert!(pixels.len() > 2000, "{} pixels of wood", pixels.len());
    let axis = axis.as_dvec3();
    let by = |direction: DVec3| {
        let one = |sign: f64| {
            let phases = pixels
                .iter()
                .map(|(at, place)| at.y - sign * tiles * place.dot(direction));
            agreement(phases)
        };
        one(1.0).max(one(-1.0))
    };
    let found = by(axis);
    assert!(found > 0.98, "along the axis: {found}");
    // As it was before: by the height in the world.
    let height = by(DVec3::Y);
    assert!(height < 0.8, "by height: {height}");
    // Turned by eight degrees strokes would no longer lie across.
    let turned = glam::DQuat::from_axis_angle(DVec3::Z, 8.0_f64.to_radians()) * axis;
    assert!(by(turned) < found - 0.01, "turned: {}", by(turned));
}

#[test]
fn strokes_along_a_trunk_keep_to_their_side() {
    let axis = Vec3::new(-0.3, 1.0, 0.1).normalize();
    let (pixels, tiles) = drawn(axis, "along");
    let axis = axis.as_dvec3();
    // Along the axis it is u that grows by the way.
    let one = |sign: f64| {
        agreement(
            pixels
                .iter()
                .map(|(at, place)| at.x - sign * tiles * place.dot(axis)),
        )
    };
    let found = one(1.0).max(one(-1.0));
    assert!(found > 0.98, "{found}");
}
