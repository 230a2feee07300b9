//! Eq. 1 on the device against its twin: function by function, and as pixels of a picture.

use glam::{DAffine3, DVec3, Vec3};

use super::{Case, Outcome};
use crate::Result;
use crate::abi::{ShadeProbe, ShadeProbes};
use crate::gpu::{Binding, BufferInfo, Gpu, QueueKind, shaders};
use crate::math::colour::linear_to_srgb;
use crate::math::packing::{pack_normal16, unpack_normal16};
use crate::math::sampling::{fibonacci_directions, uniform};
use crate::reference::shade::{
    Reflection, Surface, ambient_intensity, cone_share, ground_ambient, range_window, reflected,
    through_record,
};
use crate::render::setup::camera;
use crate::render::{
    Background, Baked, CameraSpec, Encoding, Plan, RenderSettings, Renderer, ShadowFit, Sky,
    Subject, View,
};
use crate::scene::{
    Geometry, Instance, LightKind, Material, Mesh, Model, Primitive, PunctualLight,
};

pub(super) fn cases() -> Vec<Case> {
    vec![
        Case {
            name: "render.shade.eq1",
            run: shade_probes,
        },
        Case {
            name: "render.picture.packed",
            run: |gpu| picture(gpu, Encoding::Packed, 1, None),
        },
        Case {
            name: "render.picture.length",
            run: |gpu| picture(gpu, Encoding::Length, 1, None),
        },
        Case {
            name: "render.picture.float.multisampled",
            run: |gpu| picture(gpu, Encoding::Float, 4, None),
        },
        Case {
            name: "render.shade.point",
            run: |gpu| picture(gpu, Encoding::Float, 1, Some(lamp(LightKind::Point))),
        },
        Case {
            name: "render.shade.spot",
            run: |gpu| {
                let (inner, outer) = (0.3, 0.8);
                let spot = lamp(LightKind::Spot { inner, outer });
                picture(gpu, Encoding::Float, 1, Some(spot))
            },
        },
        Case {
            name: "render.areas",
            run: areas,
        },
        Case {
            name: "render.shadow.box",
            run: |gpu| shadow(gpu, ShadowFit::Tight),
        },
        Case {
            name: "render.shadow.box.sphere",
            run: |gpu| shadow(gpu, ShadowFit::Sphere),
        },
    ]
}

const SKY: Sky = Sky {
    zenith: [0.5, 0.6, 0.7],
    ground: [0.2, 0.15, 0.1],
};

fn wide(v: [f32; 3]) -> DVec3 {
    Vec3::from(v).as_dvec3()
}

/// Random normals, lights, eyes and materials.
fn probes() -> Vec<ShadeProbe> {
    let directions = fibonacci_directions(1000);
    let unit = |i: usize| directions[i % directions.len()].as_vec3().to_array();
    (0u32..1000)
        .map(|i| {
            let r = |k: u32| uniform(11, 16 * i + k) as f32;
            ShadeProbe {
                normal: pack_normal16(Vec3::from(unit(i as usize))),
                ambient: r(0),
                albedo: [r(1), r(2), r(3)],
                specular: r(4),
                shininess: 1.0 + 60.0 * r(5),
                shadow: r(6),
                to_light: unit(i as usize * 7 + 3),
                to_eye: unit(i as usize * 13 + 5),
                light: [2.0 * r(7), 2.0 * r(8), 2.0 * r(9)],
                transmission: [r(10), r(11), r(12)],
            }
        })
        .collect()
}

fn shade_probes(gpu: &Gpu) -> Result<Outcome> {
    let probes = probes();
    let pipeline = gpu.compute_pipeline(shaders::render::SHADE_COMP)?;
    let input = gpu.upload("probes", &probes)?;
    let output = gpu.buffer(BufferInfo::device("shaded", 16 * probes.len() as u64))?;
    let count = u32::try_from(probes.len()).expect("few");
    let push = ShadeProbes {
        sky_zenith: SKY.zenith,
        sky_ground: SKY.ground,
        count,
    };
    let mut work = gpu.work(QueueKind::Compute, "shade probes")?;
    let bindings = [Binding::Read(&input), Binding::Write(&output)];
    work.compute("shade probes", &pipeline, &bindings, &push, [count, 1, 1])?;
    let pending = work.read::<[f32; 4]>("shaded", &output)?;
    let shaded = work.submit()?.wait()?.take(pending);
    let mut error = 0f64;
    for (p, got) in probes.iter().zip(&shaded) {
        let normal = unpack_normal16(p.normal).as_dvec3();
        let reflection = Reflection {
            albedo: wide(p.albedo),
            specular: f64::from(p.specular),
            shininess: f64::from(p.shininess),
            transmission: wide(p.transmission),
        };
        let (to_light, to_eye) = (wide(p.to_light), wide(p.to_eye));
        let ambient = ambient_intensity(normal, wide(SKY.zenith), wide(SKY.ground));
        let want = reflection.albedo * f64::from(p.ambient) * ambient
            + wide(p.light)
                * f64::from(p.shadow)
                * reflected(normal, to_light, to_eye, &reflection);
        let under = ground_ambient(3.0 * to_light, 1.0 + f64::from(p.ambient), p.shadow.into());
        let [r, g, b, a] = got.map(f64::from);
        let difference = (DVec3::new(r, g, b) - want).abs().max_element();
        error = error.max(difference).max((a - under).abs());
        if !difference.is_finite() {
            error = f64::NAN;
            break;
        }
    }
    Ok(Outcome {
        error,
        limit: 1e-4,
        measure: "light",
    })
}

/// Quads across and down.
const QUADS: usize = 8;
/// Pixels along a quad's edge.
const QUAD_PIXELS: u32 = 16;

/// A wall of quads facing +z, each with its own material.
fn wall() -> Model {
    let mut model = Model::default();
    for i in 0..QUADS * QUADS {
        let [x, y] = [i % QUADS, i / QUADS].map(|k| k as f32 - 0.5 * QUADS as f32);
        let color = [1, 2, 3].map(|k| uniform(3, 8 * i as u32 + k) as f32);
        model.materials.push(Material {
            base_color: [color[0], color[1], color[2], 1.0],
            roughness: uniform(3, 8 * i as u32) as f32,
            ..Material::default()
        });
        model.meshes.push(Mesh {
            name: format!("quad {i}"),
            primitives: vec![Primitive {
                material: i,
                positions: [(0., 0.), (1., 0.), (0., 1.), (1., 1.)]
                    .map(|(dx, dy)| [x + dx, y + dy, 0.0])
                    .to_vec(),
                indices: vec![0, 1, 2, 2, 1, 3],
                ..Primitive::default()
            }],
        });
        model.instances.push(Instance {
            name: format!("quad {i}"),
            mesh: i,
            local_to_world: DAffine3::IDENTITY,
            source: None,
        });
    }
    model
}

/// A lamp before the wall whose range ends within it.
fn lamp(kind: LightKind) -> PunctualLight {
    PunctualLight {
        kind,
        color: [40.0, 30.0, 20.0],
        position: DVec3::new(0.7, -0.4, 3.0),
        direction: DVec3::new(-0.1, 0.2, -1.0).normalize(),
        range: 4.5,
    }
}

fn picture(
    gpu: &Gpu,
    encoding: Encoding,
    samples: u32,
    lamp: Option<PunctualLight>,
) -> Result<Outcome> {
    let mut model = wall();
    model.lights.extend(lamp);
    let geometry = Geometry::flatten(&model);
    let spread = fibonacci_directions((QUADS * QUADS) as u32);
    // One normal and coefficient per quad, in the half-space of the viewer and outside it.
    let normals: Vec<Vec3> = (0..4 * QUADS * QUADS)
        .map(|v| spread[v / 4].as_vec3())
        .collect();
    let ambient: Vec<f32> = (0..4 * QUADS * QUADS)
        .map(|v| 0.1 + 0.9 * uniform(9, (v / 4) as u32) as f32)
        .collect();
    let parts = vec![true; geometry.parts.len()];
    let subject = Subject {
        baked: Some(Baked {
            normals: &normals,
            ambient: &ambient,
            foliage_parts: &parts,
        }),
        ..Subject::new(&model, &geometry)
    };
    let edge = QUADS as u32 * QUAD_PIXELS;
    let settings = RenderSettings {
        size: [edge, edge],
        samples,
        shadows: false,
        ground: false,
        background: Background::Color([0.0; 3]),
        camera: CameraSpec::Orbit {
            azimuth: 0.0,
            elevation: 0.0,
            distance: 1.0,
        },
        margin: 0.0,
        sky: SKY,
        encoding,
        ..RenderSettings::default()
    };
    let plan = Plan::new(&subject, &settings, &[View::Textured])?;
    let picture = Renderer::new(gpu, &subject, &settings, plan)?
        .render_view(View::Textured)?
        .picture;
    let eye = camera(&subject, &settings).eye;
    let mut error = 0f64;
    for (i, material) in model.materials.iter().enumerate() {
        let [column, row] = [i % QUADS, QUADS - 1 - i / QUADS].map(|k| k as u32);
        let pixel = picture.pixel(
            column * QUAD_PIXELS + QUAD_PIXELS / 2,
            row * QUAD_PIXELS + QUAD_PIXELS / 2,
        );
        let surface = through_record(&Surface {
            albedo: wide([0, 1, 2].map(|c| material.base_color[c])),
            ambient: ambient[4 * i].into(),
            normal: normals[4 * i].as_dvec3(),
        });
        let centre = DVec3::new(
            (i % QUADS) as f64 - 0.5 * QUADS as f64 + 0.5,
            (i / QUADS) as f64 - 0.5 * QUADS as f64 + 0.5,
            0.0,
        );
        // The pixel's middle lies beside the quad's.
        let at = centre + DVec3::new(0.5, -0.5, 0.0) / f64::from(QUAD_PIXELS);
        let want = eq1(&surface, material, &settings, [at, eye], lamp.as_ref());
        for c in 0..3 {
            let srgb = f64::from(linear_to_srgb(want[c].clamp(0.0, 1.0) as f32)) * 255.0;
            error = error.max((f64::from(pixel[c]) - srgb).abs());
        }
    }
    Ok(Outcome {
        error,
        limit: 1.5,
        measure: "steps of 255",
    })
}

/// Eq. 1 at a point seen from an eye, for ambient light, an unshadowed sun, and a lamp.
fn eq1(
    surface: &Surface,
    material: &Material,
    s: &RenderSettings,
    [at, eye]: [DVec3; 2],
    lamp: Option<&PunctualLight>,
) -> DVec3 {
    let to_eye = (eye - at).normalize();
    let roughness = f64::from(material.roughness);
    let reflection = Reflection {
        albedo: surface.albedo,
        specular: f64::from(s.specular) * (1.0 - roughness * roughness),
        shininess: s.shininess.into(),
        transmission: DVec3::splat(s.translucency.into()),
    };
    let n = surface.normal;
    let ambient = ambient_intensity(n, wide(s.sky.zenith), wide(s.sky.ground));
    let mut light = surface.albedo * surface.ambient * ambient
        + wide(s.sun.color) * reflected(n, s.sun.direction(), to_eye, &reflection);
    if let Some(lamp) = lamp {
        let to_lamp = lamp.position - at;
        let d2 = to_lamp.length_squared();
        let to_lamp = to_lamp.normalize();
        let mut intensity = range_window(d2, lamp.range.into()) / (d2 * std::f64::consts::PI);
        if let LightKind::Spot { inner, outer } = lamp.kind {
            let [inner, outer] = [inner, outer].map(|a| f64::from(a).cos());
            intensity *= cone_share(-to_lamp.dot(lamp.direction), outer, 1.0 / (inner - outer));
        }
        light += wide(lamp.color) * intensity * reflected(n, to_lamp, to_eye, &reflection);
    }
    light * f64::from(s.exposure)
}

/// A few cards in the air over the ground, seen from outside, from between them (one reaches
/// through the near plane), from below, and without a ground: the picture that is divided into
/// areas against the one that is shaded everywhere alike.
fn areas(gpu: &Gpu) -> Result<Outcome> {
    let mut model = wall();
    for (i, mesh) in (0u32..).zip(&mut model.meshes) {
        let r = |k: u32| uniform(5, 8 * i + k) as f32;
        for p in &mut mesh.primitives[0].positions {
            *p = [
                0.5 * p[0] + r(0),
                0.4 * p[1] + 4.0,
                3.0 * r(1) - 1.5 + 0.3 * p[0],
            ];
        }
    }
    let geometry = Geometry::flatten(&model);
    let subject = Subject::new(&model, &geometry);
    let mut error = 0f64;
    let mut divided = 0;
    for (camera, samples, ground) in [
        ("20,15,1.6", 4, true),
        ("0,4,0/1,3.5,-1", 4, true),
        ("200,60,2.5", 1, true),
        ("3,0.5,3/9,1.5,9", 1, true),
        ("40,-35", 4, true),
        ("40,5,2", 4, false),
    ] {
        let settings = RenderSettings {
            size: [150, 101],
            samples,
            ground,
            shadow_size: 256,
            camera: camera.parse()?,
            ..RenderSettings::default()
        };
        for view in [View::Textured, View::Combined] {
            let plan = Plan::new(&subject, &settings, &[view])?;
            let mut renderer = Renderer::new(gpu, &subject, &settings, plan)?;
            let apart = renderer.render_view(view)?.picture;
            divided += usize::from(renderer.divide_nothing());
            renderer.forget();
            let alike = renderer.render_view(view)?.picture;
            let differing = apart.rgba.iter().zip(&alike.rgba).filter(|(a, b)| a != b);
            error += differing.count() as f64;
        }
    }
    Ok(Outcome {
        error: if divided >= 6 { error } else { f64::NAN },
        limit: 0.0,
        measure: "differing bytes",
    })
}

/// A lid over a floor, sun from straight above: pixels of the floor under the lid get no sun, the
/// others all of it. Error: share of pixels (off the edge of the shadow) that are wrong.
fn shadow(gpu: &Gpu, shadow_fit: ShadowFit) -> Result<Outcome> {
    let quad = |half: f32, y: f32| Primitive {
        positions: vec![
            [-half, y, -half],
            [half, y, -half],
            [-half, y, half],
            [half, y, half],
        ],
        normals: vec![[0.0, 1.0, 0.0]; 4],
        indices: vec![0, 2, 1, 1, 2, 3],
        ..Primitive::default()
    };
    let quads = vec![quad(4.0, 0.0), quad(1.0, 1.0)];
    let model = Model::of_mesh("box", quads, vec![Material::default()]);
    let geometry = Geometry::flatten(&model);
    let subject = Subject::new(&model, &geometry);
    let mut settings = RenderSettings {
        size: [128, 128],
        samples: 1,
        shadow_size: 256,
        shadow_fit,
        ground: false,
        // From below the lid, so that it hides nothing of the floor that is looked at.
        camera: "0,0.45,7/0,0,0".parse()?,
        ..RenderSettings::default()
    };
    settings.sun.elevation = 90.0;
    let channels = [crate::render::Channel::Depth, crate::render::Channel::Shade];
    let plan = Plan::with_channels(&subject, &settings, &[], &channels)?;
    let mut renderer = Renderer::new(gpu, &subject, &settings, plan)?;
    let (gbuffer, _) = renderer.render_channels()?;
    let camera = *renderer.camera();
    let [right, up, _] = camera.basis();
    let [tan_x, tan_y] = camera.half_extent();
    let (mut wrong, mut seen) = (0usize, 0usize);
    for (i, (&depth, shade)) in gbuffer.depth.iter().zip(&gbuffer.shade).enumerate() {
        let [x, y] = [i % 128, i / 128].map(|k| (k as f64 + 0.5) / 64.0 - 1.0);
        let ray = camera.forward + right * (x * tan_x) - up * (y * tan_y);
        let at = camera.eye + ray * f64::from(depth);
        let from_edge = (at.x.abs().max(at.z.abs()) - 1.0).abs();
        if depth <= 0.0 || at.y > 0.5 || from_edge < 0.15 {
            continue;
        }
        let lit = at.x.abs().max(at.z.abs()) > 1.0;
        seen += 1;
        wrong += usize::from((f64::from(shade.w) - f64::from(u8::from(lit))).abs() > 0.01);
    }
    Ok(Outcome {
        error: if seen > 500 {
            wrong as f64 / seen as f64
        } else {
            f64::NAN
        },
        limit: 0.0,
        measure: "share of wrong pixels",
    })
}
