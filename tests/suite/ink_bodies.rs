//! Smooth bodies: a rabbit in clusters, and what models without leaves get.

use std::collections::HashMap;

use glam::{DVec2, DVec3, Vec3};
use umbrage::ink::leaves::LeafTriangles;
use umbrage::ink::mix::Mix;
use umbrage::ink::plan::Attribute;
use umbrage::ink::plant::Plant;
use umbrage::ink::renderer::{InkRenderer, InkScene};
use umbrage::ink::style::Style;
use umbrage::ink::view::View;
use umbrage::reference::ink_body::body_hatch;
use umbrage::scene::grow::rabbit;
use umbrage::scene::{Camera, Geometry};

use crate::fixture;
use crate::place::Place;

const NO_LEAVES: LeafTriangles<'_> = LeafTriangles {
    indices: &[],
    first: &[0],
    triangles: &[],
};

#[test]
fn pixels_of_a_body_have_the_coordinates_of_their_cluster() {
    let gpu = fixture::gpu();
    let model = rabbit();
    let geometry = Geometry::flatten(&model);
    let style = Style::named("smooth").unwrap();
    let plant = Plant::new(
        &model,
        &geometry,
        NO_LEAVES,
        &[false],
        None,
        std::slice::from_ref(&style),
    )
    .unwrap();
    let size = [200, 160];
    let camera = Camera {
        eye: DVec3::new(0.0, 0.2, 1.0),
        forward: DVec3::NEG_Z,
        fov: 32.0,
        aspect: 1.25,
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
    let clusters = renderer.cluster_records(&scene, &view);
    let of = |a: Attribute| &drawing.attributes.iter().find(|x| x.0 == a).unwrap().1;
    let depth: Vec<f32> = bytemuck::pod_collect_to_vec(of(Attribute::Depth));
    let ids: Vec<[f32; 2]> = bytemuck::pod_collect_to_vec(of(Attribute::Ids));
    let hatch: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(of(Attribute::Hatch));
    let [right, up, _] = camera.basis();
    let mut worst = Vec::new();
    let mut seen: HashMap<u32, u32> = HashMap::new();
    for (i, &depth) in depth.iter().enumerate().filter(|d| *d.1 > 0.0) {
        assert!(ids[i][1] > 0.0, "a cluster everywhere");
        *seen.entry(ids[i][1] as u32).or_default() += 1;
        let x = (i % 200) as f64 + 0.5 - 100.0;
        let y = 80.0 - (i / 200) as f64 - 0.5;
        let ray = camera.forward + (x * right + y * up) / view.focal();
        let place = camera.eye - geometry.origin + f64::from(depth) * ray;
        let cluster = &clusters[ids[i][1] as usize - 1];
        let want = body_hatch(cluster, place, view.eye(), [right, up]);
        let at = |k: usize| f64::from(hatch[i][k]);
        let off = DVec2::new(at(0), at(1)) - want;
        worst.push((off - off.round()).abs().max_element());
    }
    assert!(worst.iter().all(|w| w.is_finite()), "a number everywhere");
    worst.sort_by(f64::total_cmp);
    assert!(
        worst.len() > 5000 && seen.len() > 8,
        "{} pixels",
        worst.len()
    );
    // Coordinates are linear over small triangles, and read back as halves.
    let most = worst[worst.len() * 99 / 100];
    assert!(most < 0.02, "{most} tiles");
}

#[test]
fn a_model_without_leaves_is_refused_by_styles_for_leaves_and_welcome_to_smooth_ones() {
    let place = Place::new();
    place.assert_refused(
        &["render", "grow:rabbit", "-o", "x.png", "--style", "outline"],
        &["rabbit", "foliage"],
    );
    let size = ["--size", "96x64", "--ink-supersample", "1"];
    let mut arguments = vec![
        "render",
        "grow:rabbit",
        "-o",
        "rabbit.png",
        "--style",
        "smooth",
    ];
    arguments.extend(size);
    let output = place.umbrage(&arguments);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        crate::place::stderr(&output)
    );
}
