//! The plan: what is switched off is neither allocated nor run, and the rest has the bytes it says.

use glam::Vec3;
use umbrage::render::plan::label;
use umbrage::render::{Baked, Channel, Encoding, Plan, RenderSettings, Renderer, Subject, View};
use umbrage::scene::{
    AlphaMode, Geometry, ImageSource, Instance, Material, Mesh, Model, Primitive, Texture,
    TextureRef,
};

use crate::fixture;

/// One textured, alpha-masked card over an opaque triangle.
pub(crate) fn card() -> Model {
    let pixels: Vec<u8> = (0..64 * 64)
        .flat_map(|i| {
            let (x, y) = (i % 64 - 32, i / 64 - 32);
            let inside = x * x + y * y < 28 * 28;
            [60, 130, 40, if inside { 255 } else { 0 }]
        })
        .collect();
    let primitive = |material, half: f32, y: f32| Primitive {
        material,
        positions: vec![
            [-half, y, 0.0],
            [half, y, 0.0],
            [-half, y + 2.0 * half, 0.0],
            [half, y + 2.0 * half, 0.0],
        ],
        texcoords: vec![[0.0, 1.0], [1.0, 1.0], [0.0, 0.0], [1.0, 0.0]],
        indices: vec![0, 1, 2, 2, 1, 3],
        ..Primitive::default()
    };
    Model {
        name: "card".into(),
        meshes: vec![Mesh {
            name: "card".into(),
            primitives: vec![primitive(0, 0.1, 0.0), primitive(1, 1.0, 0.2)],
        }],
        instances: vec![Instance {
            name: "card".into(),
            mesh: 0,
            local_to_world: glam::DAffine3::IDENTITY,
            source: None,
        }],
        materials: vec![
            Material {
                name: "bark".into(),
                ..Material::default()
            },
            Material {
                name: "leaves".into(),
                base_color_texture: Some(TextureRef::new(0)),
                alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
                double_sided: true,
                ..Material::default()
            },
        ],
        textures: vec![Texture::default()],
        images: vec![ImageSource::Rgba8 {
            name: "disc".into(),
            width: 64,
            height: 64,
            pixels: pixels.into(),
        }],
        ..Model::default()
    }
}

fn small() -> RenderSettings {
    RenderSettings {
        size: [64, 48],
        shadow_size: 128,
        ..RenderSettings::default()
    }
}

struct Scene {
    model: Model,
    geometry: Geometry,
    normals: Vec<Vec3>,
    ambient: Vec<f32>,
}

impl Scene {
    fn new() -> Self {
        let model = card();
        let geometry = Geometry::flatten(&model);
        let n = geometry.positions.len();
        Self {
            model,
            geometry,
            normals: vec![Vec3::Z; n],
            ambient: vec![0.5; n],
        }
    }

    fn subject(&self) -> Subject<'_> {
        Subject {
            baked: Some(Baked {
                normals: &self.normals,
                ambient: &self.ambient,
                foliage_parts: &[false, true],
            }),
            ..Subject::new(&self.model, &self.geometry)
        }
    }

    fn plan(&self, settings: &RenderSettings, views: &[View]) -> Plan {
        Plan::new(&self.subject(), settings, views).unwrap()
    }
}

fn labels(plan: &Plan) -> Vec<&str> {
    plan.passes.iter().map(|p| p.label).collect()
}

#[test]
fn shadows_off_leaves_out_their_pass_map_and_indices() {
    let scene = Scene::new();
    let on = scene.plan(&small(), &[View::Textured]);
    let off = scene.plan(
        &RenderSettings {
            shadows: false,
            ..small()
        },
        &[View::Textured],
    );
    assert!(labels(&on).contains(&label::SHADOW_MAP));
    assert!(!labels(&off).contains(&label::SHADOW_MAP));
    let map = 128 * 128 * 2;
    let indices = 4 * scene.geometry.indices.len() as u64;
    // 64x64 alpha with all its levels.
    let alpha: u64 = (0..7).map(|l| (64u64 >> l).pow(2)).sum();
    assert_eq!(on.bytes() - off.bytes(), map + indices + alpha);
}

#[test]
fn textures_off_leaves_out_images_and_coordinates() {
    let scene = Scene::new();
    let settings = RenderSettings {
        textures: false,
        ..small()
    };
    let plan = scene.plan(&settings, &[View::Textured]);
    assert!(plan.images.iter().all(|i| i.texture.is_none()));
    assert!(plan.buffers.iter().all(|b| b.label != label::TEXCOORDS));
}

#[test]
fn one_sample_takes_a_quarter_of_the_surface_targets() {
    let scene = Scene::new();
    let bytes = |samples| {
        let settings = RenderSettings { samples, ..small() };
        let plan = scene.plan(&settings, &[View::Textured]);
        [label::RECORD_A, label::RECORD_B, label::DEPTH]
            .map(|l| plan.image(l).unwrap().bytes())
            .iter()
            .sum::<u64>()
    };
    assert_eq!(bytes(1), 64 * 48 * 12);
    assert_eq!(bytes(4), 4 * bytes(1));
}

#[test]
fn views_bring_only_what_they_show() {
    let scene = Scene::new();
    let has = |plan: &Plan, label: &str| plan.buffers.iter().any(|b| b.label == label);
    let standard = scene.plan(&small(), &[View::Standard]);
    assert!(has(&standard, label::MODEL_NORMALS) && !has(&standard, label::SHADING));
    assert!(
        standard.pass(label::SHADOW_MAP).is_none(),
        "standard light has no shadows"
    );
    let ambient = scene.plan(&small(), &[View::Ambient]);
    assert!(!has(&ambient, label::MODEL_NORMALS) && has(&ambient, label::SHADING));
    let normals = scene.plan(&small(), &[View::Normals]);
    assert_eq!(labels(&normals), [label::GBUFFER_PASS]);
    assert!(normals.image(Channel::Normal.label()).is_some());
    assert!(normals.image(Channel::Depth.label()).is_none());
    assert!(normals.image(label::PICTURE).is_none());
}

#[test]
fn encodings_have_the_bytes_they_say() {
    let scene = Scene::new();
    for (encoding, bytes) in [
        (Encoding::Packed, 8),
        (Encoding::Length, 12),
        (Encoding::Float, 16),
    ] {
        let settings = RenderSettings {
            encoding,
            ..small()
        };
        let plan = scene.plan(&settings, &[View::Textured]);
        let buffer = plan
            .buffers
            .iter()
            .find(|b| b.label == label::SHADING)
            .unwrap();
        assert_eq!(buffer.bytes, bytes * scene.normals.len() as u64);
    }
}

#[test]
fn what_is_allocated_is_what_was_planned() {
    let scene = Scene::new();
    let gpu = fixture::gpu();
    let views = [View::Textured, View::Standard, View::Normals, View::Depth];
    for settings in [
        small(),
        RenderSettings {
            samples: 1,
            shadows: false,
            ..small()
        },
    ] {
        let plan = scene.plan(&settings, &views);
        let before = gpu.allocations();
        let mut renderer = Renderer::new(&gpu, &scene.subject(), &settings, plan.clone()).unwrap();
        for view in views {
            let passes = renderer.render_view(view).unwrap().passes;
            for p in passes.iter().filter(|p| p.label != "frame") {
                let read_back =
                    p.label == "read back" || Channel::ALL.iter().any(|c| c.label() == p.label);
                let planned = plan
                    .pass(&p.label)
                    .is_some_and(|q| q.views.contains(&view) || q.label == label::SHADOW_MAP);
                assert!(
                    read_back || planned,
                    "{view}: {} is not in the plan",
                    p.label
                );
            }
        }
        let mut made: Vec<String> = gpu.allocations().into_iter().map(|a| a.0).collect();
        for (name, _) in &before {
            if let Some(at) = made.iter().position(|m| m == name) {
                made.remove(at);
            }
        }
        made.sort();
        let mut planned: Vec<String> = plan.images.iter().map(|i| i.label.clone()).collect();
        planned.extend(plan.buffers.iter().map(|b| b.label.to_owned()));
        planned.sort();
        assert_eq!(made, planned);
        assert_eq!(renderer.allocated_bytes(), plan.bytes());
    }
}

#[test]
fn the_table_names_every_pass_and_the_sum() {
    let scene = Scene::new();
    let plan = scene.plan(&small(), &[View::Textured]);
    let text = plan.to_string();
    for p in &plan.passes {
        assert!(text.contains(p.label), "{text}");
    }
    assert!(text.contains("total"), "{text}");
}
