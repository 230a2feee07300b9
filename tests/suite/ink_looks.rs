//! Looks of drawings: the sun's shadow against where it must fall, what is off costs nothing.

use glam::Vec3;
use umbrage::ink::leaves::LeafTriangles;
use umbrage::ink::mix::Mix;
use umbrage::ink::plan::{Attribute, InkPlan};
use umbrage::ink::plant::Plant;
use umbrage::ink::renderer::{InkRenderer, InkScene};
use umbrage::ink::style::Style;
use umbrage::ink::view::View;
use umbrage::math::packing::f16_to_f32;
use umbrage::scene::{Camera, Geometry};

use crate::fixture;
use crate::ink::{Disc, cards};

/// A small disc before a large one, as the eye sees them from the origin towards -z.
const DISCS: [Disc; 3] = [
    Disc {
        at: Vec3::new(0.0, 0.0, -4.0),
        radius: 0.4,
    },
    Disc {
        at: Vec3::new(0.0, 0.0, -6.0),
        radius: 3.0,
    },
    // Out of sight: the median leaf is small.
    Disc {
        at: Vec3::new(0.0, 0.0, -6.4),
        radius: 0.3,
    },
];
const SIZE: [u32; 2] = [240, 180];

fn style(shadow: f32) -> Style {
    Style::parse(&format!(
        "format_version = 1\ndescription = \"shadow\"\n\
         [leaves]\nshape = 0.0\ncluster_radius = 0.001\n\
         [shading]\nstrength = 1.0\ncrown = 0.0\ndepth = 0.0\nshadow = {shadow}\n\
         shadow_texels = 512\nshadow_radius = 1.0\n"
    ))
    .unwrap()
}

/// Depth and light (sun, sky, shadow, tone) of every pixel, with the view they were drawn from.
fn lit(to_sun: Vec3) -> (Vec<f32>, Vec<[f32; 4]>, View) {
    let style = style(1.0);
    let gpu = fixture::gpu();
    let model = cards(&DISCS);
    let geometry = Geometry::flatten(&model);
    let list = LeafTriangles {
        indices: &geometry.indices,
        first: &[0, 2, 4, 6],
        triangles: &[0, 1, 2, 3, 4, 5],
    };
    let plant = Plant::new(
        &model,
        &geometry,
        list,
        &[true],
        None,
        std::slice::from_ref(&style),
    )
    .unwrap();
    let camera = Camera {
        eye: glam::DVec3::ZERO,
        forward: glam::DVec3::NEG_Z,
        fov: 40.0,
        aspect: 240.0 / 180.0,
        near: 0.01,
        roll: 0.0,
    };
    let view = View::new(camera, geometry.origin, SIZE, to_sun, &geometry.positions);
    let scene = InkScene {
        model: &model,
        geometry: &geometry,
        plant: &plant,
    };
    let renderer = InkRenderer::new(&gpu, &scene, &Mix::single(style.clone()), &view, 1).unwrap();
    let drawing = renderer
        .draw_with(&scene, &view, &[Attribute::Depth])
        .unwrap();
    let depth = bytemuck::pod_collect_to_vec(&drawing.attributes[0].1);
    let half = |b: &[u8]| f16_to_f32(u16::from_le_bytes([b[0], b[1]]));
    let light = drawing.light.chunks_exact(8);
    let light = light.map(|t| [0, 2, 4, 6].map(|k| half(&t[k..k + 2])));
    (depth, light.collect(), view)
}

#[test]
fn a_disc_throws_its_shadow_where_the_sun_puts_it_and_none_on_itself() {
    let to_sun = Vec3::new(0.3, 0.2, 1.0).normalize();
    let (depth, light, view) = lit(to_sun);
    let focal = view.focal();
    let (mut wrong, mut dark, mut seen) = (0, 0, 0);
    for (i, (&z, light)) in depth
        .iter()
        .zip(&light)
        .enumerate()
        .filter(|p| *p.1.0 > 0.0)
    {
        let (x, y) = (
            (i % 240) as f64 + 0.5 - 120.0,
            90.0 - (i / 240) as f64 - 0.5,
        );
        let p = glam::DVec3::new(x / focal, y / focal, -1.0) * f64::from(z);
        let hidden = f64::from(light[2]);
        if z < 5.0 {
            assert!(hidden < 1e-3, "the disc hides {hidden} of itself at {p}");
            continue;
        }
        // Where the ray to the sun meets the plane of the small disc.
        let to_sun = to_sun.as_dvec3();
        let at = p + to_sun * (2.0 / to_sun.z);
        let away = (at - DISCS[0].at.as_dvec3()).length() / 0.4;
        if (0.93..1.07).contains(&away) {
            continue;
        }
        seen += 1;
        dark += u32::from(away < 1.0);
        let expected = if away < 1.0 { 1.0 } else { 0.0 };
        wrong += u32::from((hidden - expected).abs() > 0.02);
        let tone = f64::from(light[3]);
        assert!((tone - f64::from(light[0] + light[1])).abs() < 2e-3);
    }
    assert!(
        seen > 5_000 && dark > 300,
        "{seen} pixels, {dark} in shadow"
    );
    assert!(wrong * 500 < seen, "{wrong} of {seen} pixels");
}

#[test]
fn a_grazing_sun_leaves_no_specks_on_a_disc() {
    let (depth, light, _) = lit(Vec3::new(0.97, 0.1, 0.2).normalize());
    let specks = depth.iter().zip(&light);
    // The shadow of the small disc falls far aside.
    let specks = specks.filter(|p| *p.0 > 0.0 && p.1[2] > 0.02).count();
    assert_eq!(specks, 0, "pixels of a flat disc in its own shadow");
}

#[test]
fn what_a_style_does_not_use_has_no_pass_and_no_bytes() {
    let with = InkPlan::new(&style(0.5));
    let without = InkPlan::new(&style(0.0));
    let sun = ["ink sun", "ink light"];
    assert!(sun.iter().all(|p| with.passes().contains(p)));
    assert!(sun.iter().all(|p| !without.passes().contains(p)));
    assert_eq!(with.bytes(SIZE) - without.bytes(SIZE), 240 * 180 * 8);
    let mut washed = style(0.0);
    washed.wash.strength = 1.0;
    washed.edges.strength = 1.0;
    let all = InkPlan::new(&washed);
    let more = [
        "ink edges",
        "ink soften across",
        "ink soften down",
        "ink wash",
    ];
    assert!(
        more.iter()
            .all(|p| all.passes().contains(p) && !without.passes().contains(p))
    );
    assert_eq!(without.attributes(), [Attribute::Normal, Attribute::Depth]);
    assert_eq!(
        all.attributes(),
        [Attribute::Albedo, Attribute::Normal, Attribute::Depth]
    );
    // Colour twice, tone twice, paint, edges, base colour.
    assert_eq!(
        all.bytes(SIZE) - without.bytes(SIZE),
        240 * 180 * (5 * 8 + 4 + 4)
    );
}

/// Width in pixels of each disc that is drawn, by its cluster.
fn widths(w: f32, lod: f32) -> Vec<f64> {
    // Discs of 6 pixels at a depth of 10, far from each other.
    let discs: Vec<Disc> = (0..200)
        .map(|i| Disc {
            at: Vec3::new(
                (i % 20) as f32 * 0.6 - 5.7,
                (i / 20) as f32 * 0.6 - 2.7,
                -10.0,
            ),
            radius: 0.075,
        })
        .collect();
    let style = Style::parse(&format!(
        "format_version = 1\ndescription = \"lod\"\n\
         [leaves]\nfacing = 1.0\nshape = 0.0\ncluster_radius = 0.001\nlod = {lod}\nenlarge = {w}\n\
         [contour]\nstrength = 1.0\n"
    ))
    .unwrap();
    let gpu = fixture::gpu();
    let model = cards(&discs);
    let geometry = Geometry::flatten(&model);
    let first: Vec<u32> = (0..=200).map(|i| 2 * i).collect();
    let triangles: Vec<u32> = (0..400).collect();
    let list = LeafTriangles {
        indices: &geometry.indices,
        first: &first,
        triangles: &triangles,
    };
    let styles = std::slice::from_ref(&style);
    let plant = Plant::new(&model, &geometry, list, &[true], None, styles).unwrap();
    let camera = Camera {
        eye: glam::DVec3::ZERO,
        forward: glam::DVec3::NEG_Z,
        fov: 2.0 * (0.75_f64).atan().to_degrees(),
        aspect: 4.0 / 3.0,
        near: 0.01,
        roll: 0.0,
    };
    // 600 pixels for 2 x 7.5 metres: 40 a metre.
    let view = View::new(
        camera,
        geometry.origin,
        [800, 600],
        Vec3::Y,
        &geometry.positions,
    );
    let scene = InkScene {
        model: &model,
        geometry: &geometry,
        plant: &plant,
    };
    let mix = Mix::single(style.clone());
    let renderer = InkRenderer::new(&gpu, &scene, &mix, &view, 1).unwrap();
    let drawing = renderer
        .draw_with(&scene, &view, &[Attribute::Ids])
        .unwrap();
    let ids: Vec<[f32; 2]> = bytemuck::pod_collect_to_vec(&drawing.attributes[0].1);
    let mut spans = vec![(i64::MAX, i64::MIN); 200];
    for (i, id) in (0_i64..).zip(&ids).filter(|(_, id)| id[1] > 0.0) {
        let span = &mut spans[id[1] as usize - 1];
        *span = (span.0.min(i % 800), span.1.max(i % 800));
    }
    let seen = spans.iter().filter(|s| s.1 >= s.0);
    seen.map(|s| (s.1 - s.0 + 1) as f64).collect()
}

#[test]
fn few_leaves_are_left_of_a_small_plant_and_have_the_size_of_the_law() {
    assert_eq!(widths(1.0, 0.0).len(), 200);
    for w in [0.0, 0.5, 1.0] {
        let mut found = widths(w, 12.0);
        found.sort_by(f64::total_cmp);
        // A quarter, within what a random order of 200 leaves has.
        assert!((35..=70).contains(&found.len()), "{} leaves", found.len());
        let expected = 6.0 * (f64::from(w) * 2.0 + 1.0 - f64::from(w));
        // Those about to go are smaller already; the others are all alike.
        let median = found[found.len() / 2];
        assert!(
            (median - expected).abs() <= 1.0,
            "w {w}: {median} pixels, not {expected}"
        );
    }
}
