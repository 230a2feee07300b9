//! Drawings: contours against analytic outlines, styles as a user draws them, what bad input gets.

use glam::{DVec2, DVec3, Vec3};
use umbrage::abi::{InkCluster, InkLeaf};
use umbrage::ink::leaves::LeafTriangles;
use umbrage::ink::mix::Mix;
use umbrage::ink::plan::Attribute;
use umbrage::ink::plant::Plant;
use umbrage::ink::renderer::{Drawing, InkRenderer, InkScene};
use umbrage::ink::style::Style;
use umbrage::ink::view::View;
use umbrage::reference::ink as twin;
use umbrage::scene::{Camera, Geometry, Instance, Material, Mesh, Model, Primitive};

use crate::fixture;
use crate::model_fixture::shared;
use crate::place::Place;
use crate::small_model::small_tree;

/// A leaf of the test: a square card around a disc, at a depth below 0.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Disc {
    pub(crate) at: Vec3,
    pub(crate) radius: f32,
}

/// Cards that face +z; each becomes the disc around it.
pub(crate) fn cards(discs: &[Disc]) -> Model {
    let mut card = Primitive::default();
    for disc in discs {
        let first = card.positions.len() as u32;
        // The disc of a square passes through its corners.
        let half = disc.radius / 2.0_f32.sqrt();
        for (x, y) in [(-half, -half), (half, -half), (half, half), (-half, half)] {
            card.positions
                .push((disc.at + Vec3::new(x, y, 0.0)).to_array());
        }
        card.indices
            .extend([0, 1, 2, 0, 2, 3].map(|i: u32| first + i));
    }
    Model {
        name: "discs".into(),
        meshes: vec![Mesh {
            name: "discs".into(),
            primitives: vec![card],
        }],
        instances: vec![Instance {
            name: "discs".into(),
            mesh: 0,
            local_to_world: glam::DAffine3::IDENTITY,
            source: None,
        }],
        materials: vec![Material::default()],
        ..Model::default()
    }
}

/// What is drawn of the cards from the origin towards -z, and what it was drawn from.
pub(crate) struct Drawn {
    pub(crate) drawing: Drawing,
    pub(crate) view: View,
    pub(crate) leaves: Vec<InkLeaf>,
    of_leaf: Vec<u32>,
    clusters: Vec<InkCluster>,
}

/// Draws with depth, ids and, if the style has them, hatch coordinates read back.
fn draw(discs: &[Disc], style: &Style, size: [u32; 2]) -> Drawn {
    let first: Vec<u32> = (0..=discs.len() as u32).map(|i| 2 * i).collect();
    draw_leaves(&cards(discs), &first, style, size)
}

/// The same for any leaves, `first` the first triangle of each, closed by their number.
pub(crate) fn draw_leaves(model: &Model, first: &[u32], style: &Style, size: [u32; 2]) -> Drawn {
    let gpu = fixture::gpu();
    let geometry = Geometry::flatten(model);
    let triangles: Vec<u32> = (0..first[first.len() - 1]).collect();
    let list = LeafTriangles {
        indices: &geometry.indices,
        first,
        triangles: &triangles,
    };
    let plant = Plant::new(
        model,
        &geometry,
        list,
        &vec![true; geometry.parts.len()],
        None,
        std::slice::from_ref(style),
    )
    .unwrap();
    let camera = Camera {
        eye: DVec3::ZERO,
        forward: DVec3::NEG_Z,
        fov: 60.0,
        aspect: f64::from(size[0]) / f64::from(size[1]),
        near: 0.01,
        roll: 0.0,
    };
    let view = View::new(camera, geometry.origin, size, Vec3::Y, &geometry.positions);
    let scene = InkScene {
        model,
        geometry: &geometry,
        plant: &plant,
    };
    let renderer = InkRenderer::new(&gpu, &scene, &Mix::single(style.clone()), &view, 1).unwrap();
    let wanted = [Attribute::Depth, Attribute::Ids, Attribute::Hatch];
    Drawn {
        drawing: renderer.draw_with(&scene, &view, &wanted).unwrap(),
        leaves: plant.records(),
        of_leaf: plant.clusters_of(0).of_leaf.clone(),
        clusters: renderer.cluster_records(&scene, &view),
        view,
    }
}

fn lines_of_discs(threshold: f32) -> Style {
    let text = format!(
        "format_version = 1\ndescription = \"discs\"\n\
         [leaves]\nfacing = 1.0\nshape = 0.0\ncluster_radius = 0.01\n\
         [contour]\nstrength = 1.0\nthreshold = {threshold}\n"
    );
    Style::parse(&text).unwrap()
}

fn random_discs(count: u32) -> Vec<Disc> {
    let mut state = 12_345_u32;
    let mut next = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / 16_777_216.0
    };
    (0..count)
        .map(|i| {
            // Depths apart by a step, in random order of place.
            let depth = 4.0 + 4.0 * ((i * 389) % count) as f32 / count as f32;
            let across = 0.5 * depth;
            Disc {
                at: Vec3::new(
                    (next() - 0.5) * across * 2.0,
                    (next() - 0.5) * across,
                    -depth,
                ),
                radius: depth * (0.02 + 0.04 * next()),
            }
        })
        .collect()
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytemuck::pod_collect_to_vec(bytes)
}

#[test]
fn a_higher_threshold_never_has_more_contours() {
    let size = [200, 150];
    let discs = random_discs(120);
    let count = |threshold: f32| {
        let drawing = draw(&discs, &lines_of_discs(threshold), size).drawing;
        floats(&drawing.lines[0])
            .iter()
            .filter(|v| **v > 0.0)
            .count()
    };
    let counts: Vec<usize> = [0.0, 0.05, 0.2, 0.5, 1.0].map(count).to_vec();
    assert!(counts.windows(2).all(|w| w[1] <= w[0]), "{counts:?}");
    // Against nothing outlines are drawn at any threshold.
    assert!(
        counts[4] > 0 && counts[0] as f64 > 1.3 * counts[4] as f64,
        "{counts:?}"
    );
}

#[test]
fn hatching_and_places_of_leaves_are_those_of_their_twins() {
    let style = Style::parse(
        "format_version = 1\ndescription = \"hatching\"\n\
         [leaves]\nfacing = 1.0\nshape = 0.0\ncluster_radius = 0.15\ndisplacement = 1.0\n\
         [contour]\nstrength = 1.0\n[hatching]\nstrength = 1.0\n",
    )
    .unwrap();
    let leaf = |x: f32, y: f32, z: f32| Disc {
        at: Vec3::new(x, y, z),
        radius: 0.05,
    };
    // Two clusters of three leaves: two ends, and one between them that has a way to go.
    let three = |x: f32, z: f32| {
        [
            leaf(x, -0.3, z),
            leaf(x, 0.3, z),
            leaf(x + 0.1, 0.0, z + 0.04),
        ]
    };
    let discs = [three(-0.8, -3.0), three(0.9, -4.0)].concat();
    let size = [480, 360];
    let drawn = draw(&discs, &style, size);
    assert_eq!(drawn.clusters.len(), 2);
    let of = |attribute: Attribute| {
        let found = drawn.drawing.attributes.iter().find(|a| a.0 == attribute);
        found.map(|a| a.1.clone()).unwrap()
    };
    let depth = floats(&of(Attribute::Depth));
    let ids = floats(&of(Attribute::Ids));
    let hatch = floats(&of(Attribute::Hatch));
    let packing = (
        f64::from(style.hatching.packing),
        f64::from(style.hatching.packing_steps),
    );
    let mut seen = 0;
    for (i, &d) in depth.iter().enumerate().filter(|p| *p.1 > 0.0) {
        let pixel = DVec2::new((i % 480) as f64 + 0.5, (i / 480) as f64 + 0.5);
        let cluster = &drawn.clusters[ids[2 * i + 1] as usize - 1];
        let (at, level) = twin::hatch(cluster, pixel, f64::from(d), packing).unwrap();
        let found = DVec2::new(f64::from(hatch[4 * i]), f64::from(hatch[4 * i + 1]));
        let off = at - found;
        // Tiles repeat: whole ones do not count.
        assert!((off - off.round()).length() < 3e-3, "{pixel}: {at} {found}");
        assert!(
            (level - f64::from(hatch[4 * i + 2])).abs() < 0.01,
            "{pixel}"
        );
        seen += 1;
    }
    assert!(seen > 100, "{seen} pixels");
    for (leaf, cluster) in drawn.leaves.iter().zip(&drawn.of_leaf) {
        let cluster = &drawn.clusters[*cluster as usize];
        let (place, _) = twin::displaced(leaf, cluster, 1.0);
        let (pixel, expected) = drawn.view.pixel(place);
        let there = pixel.y as usize * 480 + pixel.x as usize;
        let found = f64::from(depth[there]);
        assert!(
            (found - expected).abs() < 1e-4,
            "{place}: {found} {expected}"
        );
        let centre = DVec3::from(cluster.centre.map(f64::from));
        assert!((place.distance(centre) - f64::from(cluster.radius)).abs() < 1e-6);
    }
}

#[test]
fn clusters_around_and_behind_the_camera_are_drawn_finitely() {
    let mut style = Style::named("silhouette-hatching").unwrap();
    style.leaves.cluster_radius = 1.0;
    let at = |x: f32, y: f32, z: f32| Disc {
        at: Vec3::new(x, y, z),
        radius: 0.3,
    };
    // One before, one behind, one across the near plane, two in one place.
    let discs = [
        at(0.0, 0.0, -2.0),
        at(0.2, 0.0, 2.0),
        at(0.05, 0.05, -0.01),
        at(0.5, 0.3, -3.0),
        at(0.5, 0.3, -3.0),
    ];
    for size in [[64, 48], [1, 1], [1, 40], [40, 1]] {
        let drawing = draw(&discs, &style, size).drawing;
        for bytes in drawing.pixels.chunks_exact(2) {
            let bits = u16::from_le_bytes([bytes[0], bytes[1]]);
            assert!(bits & 0x7c00 != 0x7c00, "{size:?}: a pixel is no number");
        }
    }
}

/// Share of the picture's pixels that are darker than half.
fn ink(path: &std::path::Path) -> f64 {
    let image = image::open(path).unwrap().to_luma8();
    let dark = image.pixels().filter(|p| p[0] < 128).count();
    dark as f64 / f64::from(image.width() * image.height())
}

#[test]
fn every_style_draws_a_tree_twice_alike() {
    let place = Place::new();
    let tree = "grow:broadleaf:1:800";
    for (name, _) in umbrage::ink::style::PRESETS {
        let draw = |out: &str| {
            let what = [
                "render", tree, "-o", out, "--style", name, "--size", "160x160",
            ];
            place.json(&[&what[..], &["--cells", "24", "--validate"]].concat())
        };
        let report = draw("a.png");
        assert_eq!(report["leaves"], 800, "{name}");
        assert!(report["clusters"].as_u64().unwrap() > 5, "{name}: {report}");
        draw("b.png");
        let bytes = |f: &str| std::fs::read(place.path(f)).unwrap();
        assert_eq!(bytes("a.png"), bytes("b.png"), "{name}");
        let dark = ink(&place.path("a.png"));
        assert!(dark > 0.002 && dark < 0.6, "{name}: ink {dark}");
    }
}

#[test]
fn lines_alone_take_no_bake() {
    let place = Place::new();
    let what = [
        "render",
        "grow:shrub:1:300",
        "-o",
        "a.png",
        "--style",
        "outline",
    ];
    let report = place.json(&[&what[..], &["--size", "80x80", "--validate"]].concat());
    let passes: Vec<_> = report["passes"].as_array().unwrap().iter().collect();
    assert_eq!(
        passes,
        ["ink stage 1", "ink contour", "ink clean", "ink compose"]
    );
    let stages = report["times"].as_array().unwrap();
    assert!(stages.iter().all(|s| s["stage"] != "bake"), "{stages:?}");
}

#[test]
fn wrong_styles_and_plants_without_leaves_are_refused() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let style = |name: &str, text: &str| {
        let head = "format_version = 1\ndescription = \"x\"\n";
        place.write(name, format!("{head}{text}"))
    };
    let unknown = style("unknown.toml", "[contour]\nstrenght = 1.0\n");
    let outside = style("outside.toml", "[leaves]\nshape = 1.5\n");
    let refused = |style: &str, words: &[&str]| {
        let arguments = ["render", &tree, "-o", "out.png", "--style", style];
        place.assert_refused(&arguments, words);
    };
    refused("no-such", &["no-such", "silhouette-hatching"]);
    refused("missing.toml", &["missing.toml"]);
    refused(&unknown, &["unknown.toml", "strenght"]);
    refused(&outside, &["outside.toml", "leaves.shape", "1.5"]);
    let bare = small_tree().with(|m| m.json["materials"][0]["name"] = "Stone".into());
    let bare = place.write(
        "bare.glb",
        bare.with(|m| m.json["materials"][0]["doubleSided"] = false.into())
            .glb(),
    );
    let arguments = ["render", &bare, "-o", "out.png", "--style", "outline"];
    place.assert_refused(&arguments, &["bare.glb", "no foliage"]);
    // The model of nobody here.
    let oak = shared("eztree/oak_medium.glb");
    let arguments = [
        "render",
        oak.to_str().unwrap(),
        "-o",
        "out.txt",
        "--style",
        "outline",
    ];
    place.assert_refused(&arguments, &["out.txt"]);
}

/// Every number of a picture, none of which is infinite or none at all.
fn finite(drawing: &Drawing, what: &str) -> Vec<f32> {
    let halves = drawing.pixels.chunks_exact(2);
    let all: Vec<f32> = halves
        .map(|b| umbrage::math::packing::f16_to_f32(u16::from_le_bytes([b[0], b[1]])))
        .collect();
    assert!(all.iter().all(|v| v.is_finite()), "{what}");
    all
}

#[test]
fn clusters_of_one_leaf_and_leaves_at_their_centres_stay_what_they_are() {
    let mut style = Style::named("silhouette-hatching").unwrap();
    (style.leaves.displacement, style.leaves.kept) = (1.0, 1.0);
    let size = [120, 90];
    let at = |x: f32, y: f32| Disc {
        at: Vec3::new(x, y, -3.0),
        radius: 0.2,
    };
    // Apart: every leaf is its own cluster. Together: one is exactly at its cluster's centre.
    for (radius, discs, clusters) in [
        (0.001, [at(-1.0, 0.0), at(0.0, 0.5), at(1.0, 0.0)], 3),
        (1.0, [at(-0.5, 0.0), at(0.0, 0.0), at(0.5, 0.0)], 1),
    ] {
        style.leaves.cluster_radius = radius;
        let drawn = draw(&discs, &style, size);
        assert_eq!(drawn.clusters.len(), clusters);
        finite(&drawn.drawing, "picture");
        for (_, attribute) in drawn.drawing.attributes.iter().take(2) {
            assert!(floats(attribute).iter().all(|v| v.is_finite()), "attribute");
        }
        for (leaf, cluster) in drawn.leaves.iter().zip(&drawn.of_leaf) {
            let cluster = &drawn.clusters[*cluster as usize];
            assert!(cluster.radius > 0.199, "at least that of a leaf");
            let (place, normal) = twin::displaced(leaf, cluster, 1.0);
            assert!(place.is_finite() && (normal.length() - 1.0).abs() < 1e-6);
            let centre = Vec3::from(cluster.centre);
            if Vec3::from(leaf.centre).distance(centre) < 1e-6 {
                // Its own normal stands for the direction that it does not have.
                let own = DVec3::from(leaf.normal.map(f64::from));
                assert!(normal.distance(own) < 1e-6, "{normal}");
            }
        }
    }
}

#[test]
fn a_picture_of_nothing_is_paper_and_has_no_lines() {
    let behind = [Disc {
        at: Vec3::new(0.0, 0.0, 4.0),
        radius: 0.3,
    }];
    for name in ["full", "silhouette-hatching"] {
        let style = Style::named(name).unwrap();
        let drawing = draw(&behind, &style, [40, 30]).drawing;
        let pixels = finite(&drawing, name);
        let paper = style
            .paper
            .colour
            .map(umbrage::math::colour::srgb_to_linear);
        for pixel in pixels.chunks_exact(4) {
            for (found, paper) in pixel.iter().zip(paper) {
                assert!((found - paper).abs() < 1e-3, "{name}: {pixel:?}");
            }
        }
        for line in &drawing.lines {
            assert!(floats(line).iter().all(|v| *v == 0.0), "{name}: no lines");
        }
    }
}
