//! Pictures by their meaning: what stage 1 says of known geometry, coverage, light and shade,
//! and the extremes.

use glam::{DAffine3, DVec3, Vec3};
use umbrage::app::conform;
use umbrage::render::{
    Background, Baked, CameraSpec, Channel, GBuffer, Picture, Plan, RenderSettings, Renderer,
    Subject, View,
};
use umbrage::scene::{Geometry, Model, Primitive};

use crate::fixture;
use crate::render_plan::card;

fn place(model: &mut Model, local_to_world: DAffine3) {
    for instance in &mut model.instances {
        instance.local_to_world = local_to_world;
    }
}

/// A square of edge 2 in the plane z = 0, facing +z, with its middle at the origin.
fn square() -> Model {
    let square = vec![Primitive {
        positions: vec![[-1., -1., 0.], [1., -1., 0.], [-1., 1., 0.], [1., 1., 0.]],
        normals: vec![[0.0, 0.0, 1.0]; 4],
        indices: vec![0, 1, 2, 2, 1, 3],
        ..Primitive::default()
    }];
    Model::of_mesh("square", square, vec![umbrage::scene::Material::default()])
}

fn plain(size: [u32; 2]) -> RenderSettings {
    RenderSettings {
        size,
        samples: 1,
        shadows: false,
        ground: false,
        background: Background::Color([0.0; 3]),
        ..RenderSettings::default()
    }
}

fn look(eye: DVec3, target: DVec3) -> CameraSpec {
    CameraSpec::LookAt { eye, target }
}

fn picture(model: &Model, settings: &RenderSettings, view: View) -> Picture {
    let gpu = fixture::gpu();
    let geometry = Geometry::flatten(model);
    let subject = Subject::new(model, &geometry);
    let plan = Plan::new(&subject, settings, &[view]).unwrap();
    let mut renderer = Renderer::new(&gpu, &subject, settings, plan).unwrap();
    renderer.render_view(view).unwrap().picture
}

fn gbuffer(subject: &Subject<'_>, settings: &RenderSettings) -> GBuffer {
    let gpu = fixture::gpu();
    let plan = Plan::with_channels(subject, settings, &[], &Channel::ALL).unwrap();
    let mut renderer = Renderer::new(&gpu, subject, settings, plan).unwrap();
    renderer.render_channels().unwrap().0
}

#[test]
fn every_conform_case_of_the_room_passes() {
    let gpu = fixture::gpu();
    let cases = conform::cases();
    let mut ran = 0;
    for case in cases.iter().filter(|c| c.name.starts_with("render.")) {
        let outcome = (case.run)(&gpu).unwrap();
        assert!(outcome.passed(), "{}: {outcome:?}", case.name);
        ran += 1;
    }
    assert!(ran >= 5, "{ran} cases");
}

#[test]
fn stage_one_keeps_baked_normals_ambient_depth_and_extent() {
    let model = square();
    let geometry = Geometry::flatten(&model);
    let normal = Vec3::new(0.3, 0.8, -0.2).normalize();
    let (normals, ambient) = (vec![normal; 4], vec![0.37; 4]);
    let subject = Subject {
        baked: Some(Baked {
            normals: &normals,
            ambient: &ambient,
            foliage_parts: &[true],
        }),
        ..Subject::new(&model, &geometry)
    };
    // From behind: a realigned normal must not turn round.
    let settings = RenderSettings {
        camera: look(DVec3::new(0.0, 0.0, -5.0), DVec3::ZERO),
        fov: 2.0 * 0.4f64.atan().to_degrees(),
        ..plain([100, 100])
    };
    let g = gbuffer(&subject, &settings);
    let seen: Vec<usize> = (0..g.depth.len()).filter(|&i| g.depth[i] > 0.0).collect();
    // Half-width of the picture at distance 5 is 2, of the square 1.
    assert_eq!(seen.len(), 50 * 50);
    for i in seen {
        assert!((g.depth[i] - 5.0).abs() < 1e-4, "depth {}", g.depth[i]);
        let n = g.normal[i];
        assert!(n.truncate().distance(normal) < 2e-3, "normal {n}");
        assert!((n.w - 0.37).abs() < 1e-3, "ambient {}", n.w);
        assert_eq!(g.albedo[i].w, 1.0);
    }
    let flipped = gbuffer(
        &subject,
        &RenderSettings {
            flip_back_faces: true,
            ..settings
        },
    );
    let middle = 50 * 100 + 50;
    assert!(flipped.normal[middle].truncate().distance(-normal) < 2e-3);
}

#[test]
fn four_samples_measure_the_area_of_a_slanted_edge() {
    // A square turned by 20 degrees covers the same area; white on black.
    let mut model = square();
    place(&mut model, DAffine3::from_rotation_z(0.35));
    let settings = RenderSettings {
        camera: look(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO),
        fov: 2.0 * 0.4f64.atan().to_degrees(),
        samples: 4,
        ..plain([64, 64])
    };
    let mut lit = settings;
    lit.sky = umbrage::render::Sky::constant([1.0; 3]);
    lit.sun.color = [0.0; 3];
    let p = picture(&model, &lit, View::Standard);
    let sum: f64 = p
        .rgba
        .chunks_exact(4)
        .map(|c| f64::from(umbrage::math::colour::srgb8_to_linear(c[1])))
        .sum();
    assert!((sum / 1024.0 - 1.0).abs() < 0.01, "{sum} of 1024 pixels");
    let partial = p
        .rgba
        .chunks_exact(4)
        .filter(|c| c[1] > 0 && c[1] < 255)
        .count();
    assert!(partial > 60, "{partial} pixels on the edge");
}

#[test]
fn masks_cut_a_disc_out_of_a_card() {
    let model = card();
    for samples in [1, 4] {
        let settings = RenderSettings {
            samples,
            camera: look(DVec3::new(0.0, 1.2, 5.0), DVec3::new(0.0, 1.2, 0.0)),
            fov: 2.0 * 0.4f64.atan().to_degrees(),
            ..plain([128, 128])
        };
        let p = picture(&model, &settings, View::Standard);
        let green = p
            .rgba
            .chunks_exact(4)
            .filter(|c| c[1] > c[0].saturating_add(20))
            .count();
        // The disc has 28/32 of the card's half-edge, which is 32 pixels.
        let disc = std::f64::consts::PI * 28.0 * 28.0;
        assert!(
            (green as f64 / disc - 1.0).abs() < 0.06,
            "x{samples}: {green} of {disc}"
        );
    }
}

#[test]
fn cut_cards_show_what_whole_cards_show() {
    let model = card();
    let settings = RenderSettings {
        samples: 4,
        camera: look(DVec3::new(0.0, 1.2, 5.0), DVec3::new(0.0, 1.2, 0.0)),
        fov: 2.0 * 0.4f64.atan().to_degrees(),
        ..plain([128, 128])
    };
    assert!(settings.leaf_outline > 0, "cards are cut by default");
    let cut = picture(&model, &settings, View::Standard);
    let whole = RenderSettings {
        leaf_outline: 0,
        ..settings
    };
    let whole = picture(&model, &whole, View::Standard);
    let pairs = cut.rgba.chunks_exact(4).zip(whole.rgba.chunks_exact(4));
    let off = pairs
        .filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 8))
        .count();
    assert!(off < 16, "{off} of 16384 pixels");
}

#[test]
fn far_from_the_origin_and_at_any_scale_the_picture_is_the_same() {
    let settings = RenderSettings {
        shadow_size: 256,
        samples: 1,
        size: [96, 72],
        ..RenderSettings::default()
    };
    let reference = picture(&card(), &settings, View::Textured);
    let far = DAffine3::from_translation(DVec3::new(5e6, -30.0, 5e6));
    for (name, transform) in [
        ("offset", far),
        ("small", DAffine3::from_scale(DVec3::splat(1e-3))),
        ("large", DAffine3::from_scale(DVec3::splat(1e6))),
    ] {
        let mut model = card();
        place(&mut model, transform);
        let p = picture(&model, &settings, View::Textured);
        let off = reference
            .rgba
            .iter()
            .zip(&p.rgba)
            .filter(|(a, b)| a.abs_diff(**b) > 2)
            .count();
        assert!(
            off * 200 < p.rgba.len(),
            "{name}: {off} of {} bytes differ",
            p.rgba.len()
        );
    }
}

#[test]
fn nothing_gives_the_background() {
    let settings = RenderSettings {
        background: Background::Color([0.2, 0.4, 0.6]),
        ..plain([16, 16])
    };
    for view in [View::Textured, View::Standard, View::Normals, View::Depth] {
        let p = picture(&Model::default(), &settings, view);
        let first = p.pixel(0, 0);
        assert!(p.rgba.chunks_exact(4).all(|c| c == first), "{view}");
    }
    let p = picture(&Model::default(), &settings, View::Textured);
    assert_eq!(p.pixel(3, 3), [124, 170, 203, 255]);
}

#[test]
fn from_below_the_ground_the_model_is_seen_whole() {
    let settings = RenderSettings {
        camera: "0,-40".parse().unwrap(),
        ground: true,
        background: Background::Color([0.0; 3]),
        ..plain([64, 64])
    };
    let p = picture(&square(), &settings, View::Textured);
    let lit = |x: u32, y: u32| p.pixel(x, y)[..3] != [0; 3];
    let rows: Vec<u32> = (0..64).filter(|&y| (0..64).any(|x| lit(x, y))).collect();
    let columns: Vec<u32> = (0..64).filter(|&x| (0..64).any(|y| lit(x, y))).collect();
    // Framed: as far from one edge as from the other, and all of it inside.
    for seen in [&rows, &columns] {
        let (first, last) = (seen[0], seen[seen.len() - 1]);
        assert!(first >= 1 && last <= 62, "{first}..{last}");
        assert!(first.abs_diff(63 - last) <= 2, "{first}..{last}");
    }
    assert!(columns.len() > 50, "{}", columns.len());
}

#[test]
fn a_single_pixel_and_a_single_triangle_are_drawn() {
    let mut model = square();
    model.meshes[0].primitives[0].indices.truncate(3);
    for samples in [1, 4] {
        let settings = RenderSettings {
            size: [1, 1],
            samples,
            shadow_size: 16,
            ..RenderSettings::default()
        };
        let p = picture(&model, &settings, View::Textured);
        assert_eq!((p.width, p.height), (1, 1));
    }
}

#[test]
fn two_runs_give_the_same_bytes() {
    let settings = RenderSettings {
        size: [80, 60],
        shadow_size: 128,
        ..RenderSettings::default()
    };
    let a = picture(&card(), &settings, View::Textured);
    let b = picture(&card(), &settings, View::Textured);
    assert!(a == b, "the pictures differ");
}

#[test]
fn a_view_that_was_not_planned_is_refused() {
    let gpu = fixture::gpu();
    let model = square();
    let geometry = Geometry::flatten(&model);
    let subject = Subject::new(&model, &geometry);
    let settings = plain([8, 8]);
    let plan = Plan::new(&subject, &settings, &[View::Standard]).unwrap();
    let mut renderer = Renderer::new(&gpu, &subject, &settings, plan).unwrap();
    let e = renderer.render_view(View::Textured).unwrap_err();
    assert!(e.to_string().contains("textured"), "{e}");
}

#[test]
fn slice_and_surface_are_drawn_over_the_tree() {
    let gpu = fixture::gpu();
    let model = square();
    let geometry = Geometry::flatten(&model);
    // A density that falls linearly with x, and a surface of one triangle before the square.
    let values: Vec<f32> = (0..27).map(|i| 1.0 - 0.5 * (i % 3) as f32).collect();
    let corners = [(-0.5, -0.5), (0.5, -0.5), (0.0, 0.5)];
    let positions = corners.map(|(x, y)| Vec3::new(x, y, 1.0));
    let subject = Subject {
        field: Some(umbrage::render::FieldGrid {
            min: Vec3::splat(-1.0),
            cell: 1.0,
            nodes: [3, 3, 3],
            values: &values,
            tau: 0.25,
        }),
        surface: Some(umbrage::render::SurfaceMesh {
            positions: &positions,
            normals: &[Vec3::Z; 3],
            indices: &[0, 1, 2],
        }),
        ..Subject::new(&model, &geometry)
    };
    let settings = RenderSettings {
        camera: look(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO),
        fov: 2.0 * 0.4f64.atan().to_degrees(),
        ..plain([64, 64])
    };
    let views = [View::Textured, View::Slice, View::Surface];
    let plan = Plan::new(&subject, &settings, &views).unwrap();
    let mut renderer = Renderer::new(&gpu, &subject, &settings, plan).unwrap();
    let [textured, slice, surface] = views.map(|v| renderer.render_view(v).unwrap().picture);
    for p in [&slice, &surface] {
        assert_eq!(p.pixel(2, 2), textured.pixel(2, 2), "outside");
        assert_ne!(p.pixel(32, 32), textured.pixel(32, 32), "in the middle");
    }
    let light = |p: [u8; 4]| u32::from(p[0]) + u32::from(p[1]) + u32::from(p[2]);
    // Dense is pale, thin is dark; x to the right.
    assert!(light(slice.pixel(19, 30)) > light(slice.pixel(40, 30)) + 100);
    assert_eq!(
        surface.pixel(18, 18),
        textured.pixel(18, 18),
        "beside the triangle"
    );
}
