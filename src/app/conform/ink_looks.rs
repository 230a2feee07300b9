//! Looks of drawings on made-up attributes: light with the sun's shadow, edges, washes.

use glam::{DVec4, Mat4, Vec3};

use super::{Case, Outcome};
use crate::Result;
use crate::abi::{INK_OBJECTS, InkEdges, InkFrame, InkLight, InkSoften, InkStyle, InkWash};
use crate::gpu::shaders::ink as shaders;
use crate::gpu::{Binding, Buffer, Format, Gpu, Image, ImageInfo, QueueKind, SamplerInfo, Shader};
use crate::math::packing::f16_to_f32;
use crate::math::sampling::uniform;
use crate::reference::ink_looks::{self as twin, Lighting, Texels};

/// Pixels across and down.
const SIZE: [u32; 2] = [61, 43];
/// Texels of the sun's map.
const TEXELS: u32 = 48;

pub(super) fn cases() -> Vec<Case> {
    vec![
        Case {
            name: "ink.light",
            run: |gpu| light(gpu, false),
        },
        Case {
            name: "ink.light.shadow",
            run: |gpu| light(gpu, true),
        },
        Case {
            name: "ink.edges",
            run: edges,
        },
        Case {
            name: "ink.soften.first",
            run: |gpu| soften(gpu, true),
        },
        Case {
            name: "ink.soften.second",
            run: |gpu| soften(gpu, false),
        },
        Case {
            name: "ink.wash",
            run: wash,
        },
    ]
}

fn pixels() -> u32 {
    SIZE[0] * SIZE[1]
}

/// Where pixel `i` is.
fn place(i: usize) -> (i64, i64) {
    let width = SIZE[0] as usize;
    ((i % width) as i64, (i / width) as i64)
}

/// Smooth waves in x, y, z, w.
fn waves(seed: u32) -> Vec<[f32; 4]> {
    let one = |i: u32| {
        let (x, y) = place(i as usize);
        [0, 1, 2, 3].map(|k| {
            let (a, b) = (uniform(seed, 2 * k), uniform(seed, 2 * k + 1));
            let wave = (x as f64 * (0.05 + 0.1 * a) + y as f64 * (0.05 + 0.1 * b) + 9.0 * a).sin();
            // What a float of 16 bits holds exactly.
            (((0.5 + 0.4 * wave) * 1024.0).round() / 1024.0) as f32
        })
    };
    (0..pixels()).map(one).collect()
}

/// Holes of nothing in a surface that waves.
fn depths() -> Vec<f32> {
    let waves = waves(5);
    let one = |i: u32| {
        let [a, b, ..] = waves[i as usize];
        if a > 0.75 { 0.0 } else { 4.0 + 2.0 * b }
    };
    (0..pixels()).map(one).collect()
}

fn texture<T: bytemuck::Pod>(
    gpu: &Gpu,
    format: Format,
    extent: [u32; 2],
    texels: &[T],
) -> Result<Image> {
    let image = gpu.image(ImageInfo::texture("attribute", format, extent, 1))?;
    let mut work = gpu.work(QueueKind::Transfer, "attribute")?;
    work.upload_image("attribute", &image, &[bytemuck::cast_slice(texels)])?;
    work.submit()?.wait()?;
    Ok(image)
}

/// Runs a kernel that writes `outputs` images of one format last.
fn run<P: bytemuck::Pod>(
    gpu: &Gpu,
    (shader, constants): (Shader, &[(u32, u32)]),
    (images, buffers): (&[&Image], &[&Buffer]),
    (format, outputs): (Format, usize),
    push: &P,
) -> Result<Vec<Vec<[f32; 4]>>> {
    let kernel = gpu.compute_pipeline_with(shader, constants)?;
    let plain = gpu.sampler(&SamplerInfo::default())?;
    let out: Vec<Image> = (0..outputs)
        .map(|_| gpu.image(ImageInfo::storage("ink", format, SIZE)))
        .collect::<Result<_>>()?;
    let mut bindings: Vec<Binding<'_>> =
        images.iter().map(|i| Binding::Sampled(i, &plain)).collect();
    bindings.extend(buffers.iter().map(|b| Binding::Read(b)));
    bindings.extend(out.iter().map(Binding::StorageWrite));
    let mut work = gpu.work(QueueKind::Graphics, "ink")?;
    work.compute("ink", &kernel, &bindings, push, [SIZE[0], SIZE[1], 1])?;
    let reads: Vec<_> = out
        .iter()
        .map(|image| work.read_image("ink", image))
        .collect::<Result<_>>()?;
    let mut done = work.submit()?.wait()?;
    let decoded = |bytes: Vec<u8>| -> Vec<[f32; 4]> {
        if format == Format::R32Float {
            let floats: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes);
            return floats.into_iter().map(|v| [v; 4]).collect();
        }
        let half = |b: &[u8]| f16_to_f32(u16::from_le_bytes([b[0], b[1]]));
        bytes
            .chunks_exact(8)
            .map(|t| [0, 2, 4, 6].map(|k| half(&t[k..k + 2])))
            .collect()
    };
    Ok(reads.into_iter().map(|r| decoded(done.take(r))).collect())
}

/// Largest difference of any component.
fn outcome(got: &[[f32; 4]], expected: &[DVec4], limit: f64, measure: &'static str) -> Outcome {
    let error = |got: &[f32; 4], want: &DVec4| {
        let off = DVec4::from(got.map(f64::from)) - want;
        off.abs().max_element()
    };
    Outcome::worst((got, expected), error, (limit, measure))
}

fn frame() -> InkFrame {
    let forward = Vec3::new(0.2, -0.1, -1.0).normalize();
    let right = forward.cross(Vec3::Y).normalize();
    InkFrame {
        eye: [0.3, 0.2, 5.0],
        focal: 60.0,
        forward: forward.to_array(),
        width: SIZE[0],
        right: right.to_array(),
        height: SIZE[1],
        up: right.cross(forward).to_array(),
        to_sun: Vec3::new(0.4, 0.7, 0.5).normalize().to_array(),
        ..InkFrame::default()
    }
}

fn light(gpu: &Gpu, shadow: bool) -> Result<Outcome> {
    let depths = depths();
    let mut normals = waves(6);
    for n in &mut normals {
        *n = [
            2.0 * n[0] - 1.0,
            2.0 * n[1] - 1.0,
            2.0 * n[2] - 1.0,
            0.5 * n[3],
        ];
    }
    let map: Vec<f32> = (0..TEXELS * TEXELS)
        .map(|i| uniform(8, i / 5) as f32)
        .collect();
    let frame = frame();
    // Two styles side by side.
    let style_of = |i: u32| u32::from(i % SIZE[0] > 30);
    let ids: Vec<[f32; 2]> = (0..pixels())
        .map(|i| [(style_of(i) * INK_OBJECTS + 7) as f32 + 1.0, 0.0])
        .collect();
    let styles = [[0.3, 0.6, 0.8], [0.1, 0.0, 0.4]].map(|[ambient, wrap, shadow]| InkStyle {
        ambient,
        wrap,
        shadow,
        ..InkStyle::default()
    });
    let lightings = styles.map(|s| Lighting {
        ambient: f64::from(s.ambient),
        wrap: f64::from(s.wrap),
        shadow: f64::from(s.shadow),
    });
    let turn = Mat4::from_rotation_x(0.7) * Mat4::from_scale(Vec3::new(0.2, 0.2, 0.08));
    let push = InkLight {
        relative_to_sun: (Mat4::from_translation(Vec3::new(0.0, 0.0, 0.5)) * turn)
            .to_cols_array_2d(),
        width: SIZE[0],
        height: SIZE[1],
        reach: 2.3,
        bias: 0.05,
        texels: TEXELS,
    };
    let images = [
        texture(gpu, Format::R32Float, SIZE, &depths)?,
        texture(gpu, Format::Rgba32Float, SIZE, &normals)?,
        texture(gpu, Format::R32Float, [TEXELS; 2], &map)?,
        texture(gpu, Format::Rg32Float, SIZE, &ids)?,
    ];
    let buffer = gpu.upload("frame", &[frame])?;
    let records = gpu.upload("styles", &styles)?;
    let bound: Vec<&Image> = images.iter().collect();
    let constants = [(0, u32::from(shadow)), (1, 1)];
    let found = run(
        gpu,
        (shaders::LIGHT_COMP, &constants),
        (&bound, &[&buffer, &records]),
        (Format::Rgba16Float, 1),
        &push,
    )?;
    let one = |i: usize| {
        let surface = DVec4::from(normals[i].map(f64::from));
        let map = shadow.then_some(&map[..]);
        twin::light(
            &push,
            (&frame, &lightings[style_of(i as u32) as usize]),
            (f64::from(depths[i]), surface),
            map,
            place(i),
        )
    };
    let expected: Vec<DVec4> = (0..depths.len()).map(one).collect();
    // Half floats are exact to 2^-11 of 1.
    Ok(outcome(&found[0], &expected, 1e-3, "light"))
}

fn edges(gpu: &Gpu) -> Result<Outcome> {
    let mut normals = waves(11);
    for (n, d) in normals.iter_mut().zip(depths()) {
        *n = if d > 0.0 {
            n.map(|v| 2.0 * v - 1.0)
        } else {
            [0.0; 4]
        };
    }
    let image = texture(gpu, Format::Rgba32Float, SIZE, &normals)?;
    let push = InkEdges {
        width: SIZE[0],
        height: SIZE[1],
        reach: 1.4,
        threshold: 0.02,
        softness: 0.3,
    };
    let shader = (shaders::EDGES_COMP, &[][..]);
    let found = run(gpu, shader, (&[&image], &[]), (Format::R32Float, 1), &push)?;
    let normals = Texels {
        size: SIZE.map(i64::from),
        texels: &normals,
    };
    let expected: Vec<DVec4> = (0..found[0].len())
        .map(|i| DVec4::splat(twin::edges(&push, &normals, place(i))))
        .collect();
    Ok(outcome(&found[0], &expected, 1e-4, "line"))
}

fn soften(gpu: &Gpu, first: bool) -> Result<Outcome> {
    let (depths, colours, tones) = (depths(), waves(21), waves(22));
    let images = [
        texture(gpu, Format::R32Float, SIZE, &depths)?,
        texture(gpu, Format::Rgba32Float, SIZE, &colours)?,
        texture(gpu, Format::Rgba32Float, SIZE, &tones)?,
    ];
    let push = InkSoften {
        width: SIZE[0],
        height: SIZE[1],
        deviation: 3.3,
    };
    let bound: Vec<&Image> = images.iter().collect();
    let constants = [(0, u32::from(first))];
    let shader = (shaders::SOFTEN_COMP, &constants[..]);
    let found = run(gpu, shader, (&bound, &[]), (Format::Rgba16Float, 2), &push)?;
    let size = SIZE.map(i64::from);
    let of = |texels| Texels { size, texels };
    let both = (&of(&colours), &of(&tones));
    let (colour, tone): (Vec<DVec4>, Vec<DVec4>) = (0..depths.len())
        .map(|i| twin::soften(&push, first.then_some(&depths[..]), both, place(i)))
        .map(|(c, t)| (c, DVec4::splat(t)))
        .unzip();
    let expected = [colour, tone].concat();
    Ok(outcome(&found.concat(), &expected, 1e-3, "colour"))
}

fn wash(gpu: &Gpu) -> Result<Outcome> {
    let (mut colours, mut tones) = (waves(31), waves(32));
    for (c, t) in colours.iter_mut().zip(&mut tones) {
        // Premultiplied.
        *c = [c[0] * c[3], c[1] * c[3], c[2] * c[3], c[3]];
        *t = t.map(|t| t * c[3]);
    }
    let images = [
        texture(gpu, Format::Rgba32Float, SIZE, &colours)?,
        texture(gpu, Format::Rgba32Float, SIZE, &tones)?,
    ];
    let push = InkWash {
        paper: [0.9, 0.85, 0.8],
        width: SIZE[0],
        height: SIZE[1],
        factor: 2.0,
        wobble: 2.5,
        feather: 3.0,
        darkening: 0.8,
        edge_width: 4.0,
        density: 0.5,
        pigment: 0.4,
        grain: 0.3,
        middle: 0.6,
        dark: 0.35,
        seed: 9,
    };
    let bound: Vec<&Image> = images.iter().collect();
    let shader = (shaders::WASH_COMP, &[][..]);
    let found = run(gpu, shader, (&bound, &[]), (Format::Rgba16Float, 1), &push)?;
    let size = SIZE.map(i64::from);
    let of = |texels| Texels { size, texels };
    let both = (&of(&colours), &of(&tones));
    let expected: Vec<DVec4> = (0..colours.len())
        .map(|i| twin::wash(&push, both, place(i)).extend(1.0))
        .collect();
    // An edge is the quotient of two small differences.
    Ok(outcome(&found[0], &expected, 4e-3, "colour"))
}
