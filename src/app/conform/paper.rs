//! Kernels of drawings on paper on made-up maps.

use bytemuck::pod_collect_to_vec;

use super::{Case, Outcome};
use crate::Result;
use crate::abi::{InkFrame, PaperBitmap, PaperDifference, PaperParticle, PaperSunlit};
use crate::gpu::shaders::ink as shaders;
use crate::gpu::{Binding, Format, Gpu, Image, ImageInfo, QueueKind, SamplerInfo, Shader};
use crate::math::packing::f16_to_f32;
use crate::math::sampling::uniform;
use crate::reference::paper as twin;

/// Pixels across and down.
pub(super) const SIZE: [u32; 2] = [61, 43];
/// Texels along the sun's map.
const MAP: u32 = 32;
/// Particles, of which the last fifth are ground.
const PARTICLES: u32 = 40;

pub(super) fn cases() -> Vec<Case> {
    vec![
        Case {
            name: "ink.paper.difference.linear",
            run: |gpu| difference(gpu, 0, 0, 0.0),
        },
        Case {
            name: "ink.paper.difference.mapped",
            run: |gpu| difference(gpu, 1, 1, 0.0),
        },
        Case {
            name: "ink.paper.difference.slope",
            run: |gpu| difference(gpu, 1, 0, 2.5),
        },
        Case {
            name: "ink.paper.shadow",
            run: sunlit,
        },
        Case {
            name: "ink.paper.bitmap",
            run: |gpu| bitmap(gpu, false, false),
        },
        Case {
            name: "ink.paper.bitmap.shadow",
            run: |gpu| bitmap(gpu, true, false),
        },
        Case {
            name: "ink.paper.bitmap.modulated",
            run: |gpu| bitmap(gpu, false, true),
        },
    ]
}

pub(super) fn count() -> u32 {
    SIZE[0] * SIZE[1]
}

/// Patches of one depth with holes, on a slope.
pub(super) fn depths(seed: u32) -> Vec<f32> {
    let one = |i: u32| {
        let (x, y) = (i % SIZE[0], i / SIZE[0]);
        let patch = (y / 6) * 16 + x / 5;
        if uniform(seed, 2 * patch) < 0.3 {
            return 0.0;
        }
        let slope = if uniform(seed, 2 * patch + 1) < 0.5 {
            0.02 * f64::from(x)
        } else {
            0.0
        };
        (2.0 + 6.0 * uniform(seed, 2 * patch) + slope) as f32
    };
    (0..count()).map(one).collect()
}

pub(super) fn numbers(depth: &[f32]) -> Vec<f32> {
    let one = |(i, &d): (u32, &f32)| {
        let patch = (i / SIZE[0] / 6) * 16 + i % SIZE[0] / 5;
        if d > 0.0 {
            (1 + patch % PARTICLES) as f32
        } else {
            0.0
        }
    };
    (0..).zip(depth).map(one).collect()
}

pub(super) fn particles() -> Vec<PaperParticle> {
    let one = |i: u32| PaperParticle {
        centre: [0, 1, 2].map(|k| (3.0 * uniform(41, 3 * i + k) - 1.5) as f32),
        row: (f64::from(SIZE[1]) * uniform(42, i)) as f32,
        ..PaperParticle::default()
    };
    (0..PARTICLES).map(one).collect()
}

pub(super) fn texture(gpu: &Gpu, extent: [u32; 2], texels: &[f32]) -> Result<Image> {
    let image = gpu.image(ImageInfo::texture("map", Format::R32Float, extent, 1))?;
    let mut work = gpu.work(QueueKind::Transfer, "map")?;
    work.upload_image("map", &image, &[bytemuck::cast_slice(texels)])?;
    work.submit()?.wait()?;
    Ok(image)
}

/// Runs a kernel whose last binding is an image of `format`.
pub(super) fn run<P: bytemuck::Pod>(
    gpu: &Gpu,
    (shader, constants): (Shader, &[(u32, u32)]),
    bindings: &[Binding<'_>],
    format: Format,
    push: &P,
) -> Result<Vec<u8>> {
    let kernel = gpu.compute_pipeline_with(shader, constants)?;
    let out = gpu.image(ImageInfo::storage("out", format, SIZE))?;
    let mut all = bindings.to_vec();
    all.push(Binding::StorageWrite(&out));
    let mut work = gpu.work(QueueKind::Graphics, "paper")?;
    work.compute("paper", &kernel, &all, push, [SIZE[0], SIZE[1], 1])?;
    let read = work.read_image("out", &out)?;
    let mut done = work.submit()?.wait()?;
    Ok(done.take(read))
}

/// The twin's value of every pixel.
pub(super) fn expected<T>(one: impl Fn(i64, i64) -> T) -> Vec<T> {
    let width = i64::from(SIZE[0]);
    (0..i64::from(count()))
        .map(|i| one(i % width, i / width))
        .collect()
}

fn difference(gpu: &Gpu, mapped: u32, sky_at_far: u32, slope: f32) -> Result<Outcome> {
    let depth = depths(31);
    let push = PaperDifference {
        width: SIZE[0],
        height: SIZE[1],
        mapped,
        sky_at_far,
        nearest: 1.8,
        farthest: 9.5,
        near: 1.0,
        far: 11.0,
        slope,
    };
    let plain = gpu.sampler(&SamplerInfo::default())?;
    let image = texture(gpu, SIZE, &depth)?;
    let bindings = vec![Binding::Sampled(&image, &plain)];
    let bytes = run(
        gpu,
        (shaders::DIFFERENCE_COMP, &[]),
        &bindings,
        Format::R32Float,
        &push,
    )?;
    let found: Vec<f32> = pod_collect_to_vec(&bytes);
    let want = expected(|x, y| twin::difference(&depth, &push, x, y));
    // Beside nothing differences are 1e9: relative there.
    let error =
        |got: &f32, want: &f64| (f64::from(*got) - want).abs() / want.abs().max(65535.0) * 65535.0;
    Ok(Outcome::worst(
        (&found, &want),
        error,
        (0.2, "units of 1/65535 of the range"),
    ))
}

pub(super) fn frames() -> [InkFrame; 2] {
    let camera = InkFrame {
        eye: [0.2, 0.1, 5.0],
        focal: 50.0,
        forward: [0.0, 0.0, -1.0],
        right: [1.0, 0.0, 0.0],
        up: [0.0, 1.0, 0.0],
        ..InkFrame::default()
    };
    let sun = InkFrame {
        // Straight down, two metres to each side.
        relative_to_clip: [
            [0.5, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.1, 0.0],
            [0.0, 0.5, 0.0, 0.0],
            [0.01, 0.02, 0.5, 1.0],
        ],
        eye: [0.0, 8.0, 0.0],
        forward: [0.0, -1.0, 0.0],
        ..InkFrame::default()
    };
    [camera, sun]
}

fn sunlit(gpu: &Gpu) -> Result<Outcome> {
    let (foliage, stems) = (depths(51), depths(52));
    let number = numbers(&foliage);
    let sun_map = |seed| -> Vec<f32> {
        let one = |i| {
            if uniform(seed, i) < 0.3 {
                0.0
            } else {
                (5.0 + 4.0 * uniform(seed + 9, i)) as f32
            }
        };
        (0..MAP * MAP).map(one).collect()
    };
    let (sun_foliage, sun_stems) = (sun_map(61), sun_map(62));
    let particles = particles();
    let [frame, sun] = frames();
    let push = PaperSunlit {
        width: SIZE[0],
        height: SIZE[1],
        map_size: MAP,
        reach: 1,
        bias: 0.3,
        softness: 1.5,
        leaves: particles.len() as u32 / 2,
        ground_bias: 0.02,
        ground_softness: 0.4,
    };
    let plain = gpu.sampler(&SamplerInfo::default())?;
    let buffers = [gpu.upload("camera", &[frame])?, gpu.upload("sun", &[sun])?];
    let records = gpu.upload("particles", &particles)?;
    let images = [
        texture(gpu, SIZE, &foliage)?,
        texture(gpu, SIZE, &number)?,
        texture(gpu, SIZE, &stems)?,
        texture(gpu, [MAP; 2], &sun_foliage)?,
        texture(gpu, [MAP; 2], &sun_stems)?,
    ];
    let mut bindings: Vec<Binding<'_>> = buffers.iter().map(Binding::Read).collect();
    bindings.push(Binding::Read(&records));
    bindings.extend(images.iter().map(|i| Binding::Sampled(i, &plain)));
    let bytes = run(
        gpu,
        (shaders::SUNLIT_COMP, &[]),
        &bindings,
        Format::R32Float,
        &push,
    )?;
    let found: Vec<f32> = pod_collect_to_vec(&bytes);
    let maps = twin::Sunlit {
        frame: &frame,
        sun: &sun,
        particles: &particles,
        foliage_depth: &foliage,
        foliage_number: &number,
        stem_depth: &stems,
        sun_foliage: &sun_foliage,
        sun_stems: &sun_stems,
    };
    let want = expected(|x, y| twin::sunlit(&maps, &push, x, y));
    let far = |(got, want): &(&f32, &f64)| (f64::from(**got) - **want).abs() > 1e-4;
    let off = found.iter().zip(&want).filter(far).count();
    let dark = want.iter().filter(|&&w| w > 0.1).count();
    // A place on the border of two texels may go to either.
    let share = if dark < 100 {
        f64::NAN
    } else {
        off as f64 / f64::from(count())
    };
    Ok(Outcome::new(share, 0.005, "share of pixels that differ"))
}

fn bitmap(gpu: &Gpu, shadow: bool, modulated: bool) -> Result<Outcome> {
    let (foliage, stems) = (depths(71), depths(72));
    let number = numbers(&foliage);
    let noise = |seed: u32, most: f64| -> Vec<f32> {
        (0..count())
            .map(|i| (most * uniform(seed, i)) as f32)
            .collect()
    };
    let (foliage_difference, stem_difference) = (noise(73, 3000.0), noise(74, 3000.0));
    let shade = noise(75, 1.0);
    let particles = particles();
    let push = PaperBitmap {
        paper: [1.0, 0.9, 0.8],
        width: SIZE[0],
        ink: [0.0, 0.6, 0.1],
        height: SIZE[1],
        stem_ink: [0.5, 0.2, 0.0],
        shadow_ink: [0.1, 0.2, 0.4],
        ground_ink: [0.3, 0.0, 0.7],
        foliage: 2600.0,
        stem: 2800.0,
        foliage_width: 0.7,
        stem_width: 1.2,
        lower: 1,
        leaves: 4 * PARTICLES / 5,
        detail: -0.5,
        black: 0.95,
        pressure: 0.8,
        widest: if modulated { 1.5 } else { 1.0 },
    };
    let plain = gpu.sampler(&SamplerInfo::default())?;
    let records = gpu.upload("particles", &particles)?;
    let maps = [
        &foliage,
        &number,
        &foliage_difference,
        &stems,
        &stem_difference,
        &shade,
    ];
    let images: Vec<Image> = maps
        .iter()
        .map(|m| texture(gpu, SIZE, m))
        .collect::<Result<_>>()?;
    let mut bindings: Vec<Binding<'_>> =
        images.iter().map(|i| Binding::Sampled(i, &plain)).collect();
    bindings.insert(5, Binding::Read(&records));
    let factors: Vec<[f32; 4]> = (0..count())
        .map(|i| [0.9, 1.5].map(|most| (most * uniform(76, i)) as f32))
        .map(|[a, b]| [a, b, 0.0, 0.0])
        .collect();
    let image = gpu.image(ImageInfo::texture("map", Format::Rgba32Float, SIZE, 1))?;
    let mut work = gpu.work(QueueKind::Transfer, "map")?;
    work.upload_image("map", &image, &[bytemuck::cast_slice(&factors)])?;
    work.submit()?.wait()?;
    bindings.push(Binding::Sampled(&image, &plain));
    let constants = [(0, u32::from(shadow)), (1, u32::from(modulated))];
    let bytes = run(
        gpu,
        (shaders::BITMAP_COMP, &constants),
        &bindings,
        Format::Rgba16Float,
        &push,
    )?;
    let halves: Vec<[u16; 4]> = pod_collect_to_vec(&bytes);
    let found: Vec<[f32; 3]> = halves
        .iter()
        .map(|h| [h[0], h[1], h[2]].map(f16_to_f32))
        .collect();
    let lines = twin::Lines {
        foliage_depth: &foliage,
        foliage_number: &number,
        foliage_difference: &foliage_difference,
        stem_depth: &stems,
        stem_difference: &stem_difference,
        particles: &particles,
        shadow: shadow.then_some(&shade),
        factors: modulated.then_some(&factors),
    };
    let want = expected(|x, y| twin::bitmap(&lines, &push, x, y));
    let error = |got: &[f32; 3], want: &[f64; 3]| {
        let off = |k: usize| (f64::from(got[k]) - want[k]).abs();
        off(0).max(off(1)).max(off(2))
    };
    Ok(Outcome::worst((&found, &want), error, (2e-3, "colour")))
}
