//! Ray-traced ambient coefficients: scenes whose answer is known.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use umbrage::foliage::cutout::opaque_shares;
use umbrage::foliage::traced::{Occluders, Rays, Weighting};
use umbrage::math::sampling::{fibonacci_directions, uniform, uniform_sphere};
use umbrage::scene::{
    AlphaMode, Geometry, ImageSource, Material, Model, Primitive, Texture, TextureRef,
};

use super::foliage_field::ball_cloud;

const RAYS: Rays = Rays {
    count: 1024,
    seed: 1,
    weighting: Weighting::Sphere,
};

fn model(positions: Vec<[f32; 3]>, indices: Vec<u32>) -> Model {
    let solid = vec![Primitive {
        positions,
        indices,
        ..Default::default()
    }];
    Model::of_mesh("mesh", solid, vec![Material::default()])
}

/// A square of side 2 at height 0.
fn card() -> Model {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let mut model = model(
        corners.iter().map(|c| [c[0], 0.0, c[1]]).collect(),
        vec![0, 1, 2, 0, 2, 3],
    );
    model.meshes[0].primitives[0].texcoords =
        corners.iter().map(|c| c.map(|x| 0.5 * (x + 1.0))).collect();
    model
}

fn ambient(model: &Model, at: Vec3, rays: &Rays) -> f32 {
    let geometry = Geometry::flatten(model);
    let occluders = Occluders::new(model, &geometry).unwrap();
    let local = (at.as_dvec3() - geometry.origin).as_vec3();
    occluders.ambient(&[local], &[Vec3::Y], rays)[0]
}

#[test]
fn a_card_hides_its_solid_angle() {
    // A square of half side a at distance d subtends 4 asin(a^2 / (a^2 + d^2)).
    for d in [0.5_f32, 1.0, 2.0] {
        let angle = 4.0 * (1.0 / (1.0 + d * d)).asin();
        let expected = 1.0 - angle / (4.0 * std::f32::consts::PI);
        let found = ambient(&card(), d * Vec3::Y, &RAYS);
        assert!(
            (found - expected).abs() < 0.01,
            "{found} for {expected} at {d}"
        );
    }
    // On the card itself nothing is hidden: the leaf is lit from both sides.
    assert_eq!(ambient(&card(), Vec3::ZERO, &RAYS), 1.0);
    // Far below a card that fills half the view, cosine weighting sees the form factor.
    let cosine = Rays {
        weighting: Weighting::Cosine,
        ..RAYS
    };
    let a = 1.0_f32 / 2.0_f32.sqrt();
    let form_factor = 4.0 / std::f32::consts::PI * a * a.atan();
    let found = ambient(&card(), Vec3::Y, &cosine);
    let expected = 1.0 - 0.5 * form_factor;
    assert!((found - expected).abs() < 0.01, "{found} for {expected}");
}

#[test]
fn masked_texels_let_rays_pass() {
    let checker = |opaque: fn(usize) -> bool| {
        let mut model = card();
        let pixels: Vec<u8> = (0..256)
            .flat_map(|i| [255, 255, 255, if opaque(i) { 200 } else { 100 }])
            .collect();
        model.images.push(ImageSource::Rgba8 {
            name: "mask".into(),
            width: 16,
            height: 16,
            pixels: Arc::from(pixels),
        });
        model.textures.push(Texture::default());
        model.materials[0].base_color_texture = Some(TextureRef::new(0));
        model
    };
    let share =
        |model: &Model| opaque_shares(model, &Geometry::flatten(model), &[true]).unwrap()[0];
    let at = Vec3::new(0.0, 0.3, 0.0);
    let solid = ambient(&card(), at, &RAYS);
    let mut half = checker(|i| (i + i / 16) % 2 == 0);
    assert_eq!(ambient(&half, at, &RAYS), solid, "opaque ignores alpha");
    assert_eq!(share(&half), 1.0);
    half.materials[0].alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
    assert!((share(&half) - 0.5).abs() < 0.02, "{}", share(&half));
    let found = ambient(&half, at, &RAYS);
    let expected = 0.5 * (1.0 + solid);
    assert!((found - expected).abs() < 0.02, "{found} for {expected}");
    half.materials[0].alpha_mode = AlphaMode::Mask { cutoff: 0.9 };
    assert_eq!(ambient(&half, at, &RAYS), 1.0);
    half.materials[0].alpha_mode = AlphaMode::Blend;
    assert!((ambient(&half, at, &RAYS) - expected).abs() < 0.02);
}

/// Leaves at random in a ball: the share of a direction that is seen is exp(-G L path), G = 1/2.
#[test]
fn a_ball_of_random_leaves_obeys_beer_lambert() {
    let (count, depth) = (12_000, 1.0_f64);
    let volume = 4.0 / 3.0 * std::f64::consts::PI;
    let area = 2.0 * depth * volume / f64::from(count);
    let side = area.sqrt();
    let mut positions = Vec::new();
    let mut indices = Vec::new();
    for (i, g) in ball_cloud(count, 1.0, 3).iter().enumerate() {
        let random = |k: u32| uniform(17, 2 * i as u32 + k);
        let n = uniform_sphere((random(0), random(1)).into());
        let x = 0.5 * side * n.any_orthonormal_vector();
        let y = n.cross(x);
        let first = positions.len() as u32;
        positions
            .extend([x + y, y - x, -x - y, x - y].map(|c| (g.position + c).as_vec3().to_array()));
        indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
    }
    let model = model(positions, indices);
    let geometry = Geometry::flatten(&model);
    let occluders = Occluders::new(&model, &geometry).unwrap();
    // Starts spread over a sphere of radius 0.5 average over local clusters of leaves.
    let starts: Vec<Vec3> = fibonacci_directions(24)
        .iter()
        .map(|w| (0.5 * *w - geometry.origin).as_vec3())
        .collect();
    let seen = occluders.ambient(&starts, &[Vec3::Y; 24], &RAYS);
    let mean = f64::from(seen.iter().sum::<f32>()) / 24.0;
    let expected = (0..1000)
        .map(|i| (f64::from(i) + 0.5) / 500.0 - 1.0)
        .map(|c| -0.5 * c + (1.0 - 0.25 * (1.0 - c * c)).sqrt())
        .map(|path| (-depth * path).exp() / 1000.0)
        .sum::<f64>();
    assert!((mean - expected).abs() < 0.02, "{mean} for {expected}");
    assert_eq!(
        seen,
        occluders.ambient(&starts, &[Vec3::Y; 24], &RAYS),
        "seeded"
    );
    let other = Rays { seed: 2, ..RAYS };
    assert_ne!(seen, occluders.ambient(&starts, &[Vec3::Y; 24], &other));
}

#[test]
fn scale_and_place_change_nothing() {
    let at = |scale: f64, offset: DVec3| {
        let mut model = card();
        model.instances[0].local_to_world = DAffine3::from_scale_rotation_translation(
            DVec3::splat(scale),
            Default::default(),
            offset,
        );
        let geometry = Geometry::flatten(&model);
        let occluders = Occluders::new(&model, &geometry).unwrap();
        let points: Vec<Vec3> = (0..20)
            .map(|i| Vec3::new(0.1 * i as f32 - 1.0, 0.2, 0.3) * scale as f32)
            .collect();
        occluders.ambient(&points, &[Vec3::Y; 20], &RAYS)
    };
    let base = at(1.0, DVec3::ZERO);
    for (scale, offset) in [
        (1e-3, DVec3::ZERO),
        (1e6, DVec3::ZERO),
        (1.0, DVec3::splat(5e6)),
    ] {
        for (a, b) in at(scale, offset).iter().zip(&base) {
            assert!((a - b).abs() <= 2.0 / 1024.0, "{a} {b} at scale {scale}");
        }
    }
}
