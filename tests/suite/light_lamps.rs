//! Lamps near the scene against closed forms, and as a user draws them.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use umbrage::abi::LeafSides;
use umbrage::leaf::lamp::{Lamp, PlacedLamps};
use umbrage::leaf::lamp_maps::{LampMaps, LampSettings};
use umbrage::leaf::optics::Optics;
use umbrage::leaf::rays::{Occluders, RayScene};
use umbrage::leaf::receivers::Receivers;
use umbrage::reference::lamps::scattered;
use umbrage::scene::{Geometry, Part};

use crate::fixture;
use crate::place::Place;
use crate::small_model::small_tree;

/// Irradiance on a patch at the origin that looks along +y, from `count` points of `lamp`.
fn irradiance(lamp: &str, count: u32) -> f64 {
    let lamp = Lamp::parse(lamp).unwrap();
    let placed = PlacedLamps::new(std::slice::from_ref(&lamp), (DVec3::ZERO, 1.0), count);
    let white = LeafSides {
        rho_d_front: [1.0; 3],
        ..LeafSides::default()
    };
    let patch = (DVec3::ZERO, DVec3::Y, DVec3::Y);
    let light = scattered(
        (&placed.records[0], &placed.points),
        (&white, [0.0, 0.0, 0.0, 0.3], &[]),
        patch,
    );
    PI * light.x
}

/// Of a disc of radius r at height d over a parallel patch: pi L r^2 / (r^2 + d^2), which is the
/// intensity over r^2 + d^2.
#[test]
fn a_disc_lights_a_patch_by_the_closed_form() {
    for (r, d) in [(0.5, 2.0), (1.0, 1.0), (0.01, 3.0)] {
        let lamp = format!("disc:0,{d},0/0,-1,0/{r}/3");
        let expected = 3.0 / (r * r + d * d);
        for (count, limit) in [(4, 0.08), (16, 0.02), (256, 1.5e-3)] {
            let found = irradiance(&lamp, count);
            let error = (found / expected - 1.0).abs();
            assert!(error < limit, "{r} {d} {count}: {found} for {expected}");
        }
    }
}

/// Of a quad over a parallel patch under its middle: four times the form factor of a corner,
/// (x atan(y / X) / X + y atan(x / Y) / Y) / 2 pi with X^2 = d^2 + x^2 (Howell, configuration C-11).
#[test]
fn a_quad_lights_a_patch_by_the_closed_form() {
    for (w, h, d) in [(1.0, 1.0, 1.0), (2.0, 0.5, 1.5)] {
        let lamp = format!("quad:0,{d},0/0,-1,0/{w}x{h}/2");
        let (x, y) = (0.5 * w / d, 0.5 * h / d);
        let corner = |a: f64, b: f64| {
            let r = (1.0 + a * a).sqrt();
            a / r * (b / r).atan()
        };
        let factor = 4.0 * (corner(x, y) + corner(y, x)) / (2.0 * PI);
        let expected = PI * 2.0 / (w * h) * factor;
        for (count, limit) in [(16, 0.03), (256, 3e-3)] {
            let found = irradiance(&lamp, count);
            let error = (found / expected - 1.0).abs();
            assert!(error < limit, "{w} {h} {count}: {found} for {expected}");
        }
    }
}

#[test]
fn nothing_arrives_behind_a_lamp_or_from_a_point_of_no_size_too_much() {
    assert_eq!(irradiance("disc:0,1,0/0,1,0/0.5/3", 16), 0.0);
    // On the lamp itself there is at most what its radiance gives a half-space.
    let on_it = irradiance("disc:0,1e-6,0/0,-1,0/0.5/1", 64);
    let radiance = 1.0 / (0.25 * PI);
    assert!(
        on_it.is_finite() && on_it <= 2.0 * PI * radiance * 1.01,
        "{on_it}"
    );
}

/// Patches on the floor under a half-plane, and a disc above: what is seen of a disc past a
/// straight edge at x radii from its middle is (acos x - x sqrt(1 - x^2)) / pi.
#[test]
fn a_half_plane_hides_a_disc_by_the_closed_form() {
    let mut g = Geometry::default();
    let mut quad = |corners: [Vec3; 4]| {
        let first = g.positions.len() as u32;
        for p in corners {
            g.positions.push(p);
            g.normals.push(Vec3::Y);
            g.texcoords.push([0.0; 2]);
            g.texcoords1.push([0.0; 2]);
            g.colors.push([1.0; 4]);
            g.ambient.push(1.0);
        }
        g.indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
    };
    // The screen at height 5 ends at x = 0; the lamp is at height 10: a patch at x sees the edge
    // at -x on the lamp's plane.
    let v = Vec3::new;
    quad([
        v(-40.0, 5.0, -40.0),
        v(0.0, 5.0, -40.0),
        v(0.0, 5.0, 40.0),
        v(-40.0, 5.0, 40.0),
    ]);
    let count = 41;
    for i in 0..count {
        let x = 1.2 * (i as f32 / (count - 1) as f32 * 2.0 - 1.0);
        let s = 1e-3;
        quad([
            v(x, 0.0, 0.0),
            v(x + s, 0.0, 0.0),
            v(x + s, 0.0, s),
            v(x, 0.0, s),
        ]);
    }
    let all = g.positions.len();
    g.parts.push(Part {
        instance: 0,
        mesh: 0,
        primitive: 0,
        material: 0,
        first_vertex: 0,
        vertex_count: all,
        first_index: 0,
        index_count: g.indices.len(),
    });
    (g.min, g.max) = (v(-40.0, 0.0, -40.0), v(40.0, 5.0, 40.0));
    let occluders = Occluders::solid(&g);
    let receivers = Receivers::new(&g, &occluders, &[Optics::opaque([0.5; 3])]);
    let gpu = fixture::gpu();
    let scene = RayScene::new(&gpu, &occluders).unwrap();
    let lamp = Lamp::parse("disc:0,10,0/0,-1,0/1/1").unwrap();
    let found = |points: u32, exhaustive: bool| {
        let settings = LampSettings {
            points,
            exhaustive,
            offset: 1e-6,
            ..LampSettings::default()
        };
        let from = (&occluders, g.origin);
        let mut maps = LampMaps::new(&gpu, &scene, from, &receivers, settings).unwrap();
        let map = maps.map(&lamp).unwrap();
        (map, maps.traced)
    };
    let (map, rays) = found(256, true);
    let (few, few_rays) = found(256, false);
    assert!(few_rays < rays, "{few_rays} of {rays} rays");
    for i in 0..count {
        let at = 4 + 4 * i;
        let x = f64::from(g.positions[at].x).clamp(-1.0, 1.0);
        let open = (PI - x.acos() + x * (1.0 - x * x).sqrt()) / PI;
        let error = (f64::from(map[at]) - open).abs();
        assert!(error < 0.02, "{x}: {} for {open}", map[at]);
        // Eight points decide; they lie at the outline, so that little is missed.
        assert!((f64::from(few[at]) - open).abs() < 0.06, "{x}: {}", few[at]);
    }
    // A patch that the screen hides sees nothing, one that it does not sees all.
    assert_eq!((map[4], map[4 + 4 * (count - 1)]), (0.0, 1.0));
}

fn leaf50(place: &Place, more: &[&str]) -> serde_json::Value {
    let model = crate::model_fixture::shared("../leaf/truth/crossed.obj");
    let model = model.to_str().unwrap();
    let how = [
        "render",
        model,
        "-o",
        "out.png",
        "--validate",
        "--up",
        "z",
        "--size",
        "128x128",
        "--camera",
        "0.16,0.12,0.22/0,0,0",
        "--fov",
        "34",
        "--reflectance",
        "0.12,0.16,0.05",
        "--transmittance",
        "0.17,0.2,0.04",
        "--environment",
        "constant:0",
        "--sun-irradiance",
        "0,0,0",
        "--splits",
        "3",
    ];
    place.json(&[&how[..], more].concat())
}

/// Two lamps of different shapes on crossed leaves: two passes against path tracing.
#[test]
fn lamps_look_like_the_truth() {
    let place = Place::new();
    let mask: Vec<u8> = (0..64)
        .map(|i| if (i + i / 8) % 3 == 0 { 255 } else { 0 })
        .collect();
    let image = image::GrayImage::from_raw(8, 8, mask).unwrap();
    image.save(place.path("mask.png")).unwrap();
    let mask = format!(
        "mask:0.1,-0.25,0.1/-0.3,1,-0.3/0.04x0.04/0.05,0.02,0.02/{}",
        place.path("mask.png").display()
    );
    let report = leaf50(
        &place,
        &[
            "--lighting",
            "lvc,truth",
            "--truth-samples",
            "64",
            "--lamp",
            "disc:0.15,0.2,0.1/-0.6,-0.8,-0.4/0.02/0.1,0.1,0.08",
            "--lamp",
            &mask,
        ],
    );
    let row = &report["errors"][0];
    let (bias, blocks) = (
        row["bias"].as_f64().unwrap(),
        row["block_rmse"].as_f64().unwrap(),
    );
    assert!(bias.abs() < 0.02 && blocks < 0.06, "{row:#}");
}

/// Half of the sun is hidden by the moon: the picture is drawn, and stored maps are refused.
#[test]
fn the_sun_may_have_a_shape() {
    let place = Place::new();
    let image =
        image::GrayImage::from_fn(16, 16, |x, _| image::Luma([if x < 8 { 255 } else { 0 }]));
    image.save(place.path("half.png")).unwrap();
    let half = place.path("half.png").display().to_string();
    let tree = place.write("tree.glb", small_tree().glb());
    let draw = [
        "render",
        &tree,
        "-o",
        "out.png",
        "--size",
        "48x48",
        "--sun-shape",
        &half,
        "--reflectance",
        "0.2",
    ];
    let report = place.json(
        &[
            &draw[..],
            &["--lighting", "lvc,truth", "--truth-samples", "8"],
        ]
        .concat(),
    );
    assert!(
        report["errors"][0]["bias"].as_f64().unwrap().abs() < 0.2,
        "{report:#}"
    );
    place.json(&[
        "light",
        &tree,
        "-o",
        "a.light",
        "--paths",
        "0",
        "--minutes",
        "240",
    ]);
    let stored = ["--lighting", "lvc", "--light", "a.light", "--stored"];
    place.assert_refused(&[&draw[..], &stored].concat(), &["--sun-shape"]);
    let wrong = [
        "render",
        &tree,
        "-o",
        "out.png",
        "--lighting",
        "lvc",
        "--lamp",
        "disc:1",
    ];
    place.assert_refused(&wrong, &["--lamp disc:1"]);
}
