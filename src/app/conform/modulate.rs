//! Programs of style files on made-up maps.

use bytemuck::pod_collect_to_vec;

use super::paper::{SIZE, count, depths, expected, frames, numbers, run, texture};
use super::{Case, Outcome};
use crate::abi::{PaperModulate, PaperOp, PaperTrait};
use crate::gpu::shaders::ink as shaders;
use crate::gpu::{Binding, Format, Gpu, Image, ImageInfo, QueueKind, SamplerInfo};
use crate::ink::paper::expression::Program;
use crate::math::packing::f16_to_f32;
use crate::math::sampling::{pcg, uniform};
use crate::reference::modulate as twin;
use crate::{Error, Result};

/// Between them they have every step and every variable.
const PROGRAMS: [&str; 4] = [
    "if(mask > 0.4, 2 * smooth(0.2, 0.8, x), min(z / 11, abs(nz)) + shadow ^ 2)",
    "clamp(0.5 + sin(9 * y) * cos(id / 7) - 0.3 * tone, 0, max(0.1, object % 3))",
    "mix(sqrt(z), exp(-x) + log(1 + y), fract(5 * x)) * ((y >= 0.3) + 0.5)",
    "1 - (x - 0.5) ^ 2 / 0.25 + floor(4 * mask) * (nx < ny) + (x <= 0.2)",
];

pub(super) fn cases() -> Vec<Case> {
    vec![Case {
        name: "ink.paper.modulate",
        run: modulate,
    }]
}

fn image(gpu: &Gpu, format: Format, texels: &[u8]) -> Result<Image> {
    let image = gpu.image(ImageInfo::texture("map", format, SIZE, 1))?;
    let mut work = gpu.work(QueueKind::Transfer, "map")?;
    work.upload_image("map", &image, &[texels])?;
    work.submit()?.wait()?;
    Ok(image)
}

fn modulate(gpu: &Gpu) -> Result<Outcome> {
    let (mut steps, mut ends): (Vec<PaperOp>, _) = (Vec::new(), [0; 4]);
    for (text, end) in PROGRAMS.iter().zip(&mut ends) {
        steps.extend(Program::new(text).map_err(Error::usage)?.ops);
        *end = steps.len() as u32;
    }
    let noise = |seed: u32, k: u32| (2.0 * uniform(seed, k) - 1.0) as f32;
    let (foliage, stems) = (depths(91), depths(92));
    let number = numbers(&foliage);
    let shade: Vec<f32> = (0..count()).map(|i| uniform(93, i) as f32).collect();
    let normals: Vec<[f32; 4]> = (0..count())
        .map(|i| [0, 1, 2, 3].map(|k| noise(94, 4 * i + k)))
        .collect();
    let masks: Vec<[u8; 4]> = (0..count()).map(|i| pcg(i).to_le_bytes()).collect();
    let traits: Vec<PaperTrait> = (0..200)
        .map(|i| PaperTrait {
            normal: [0, 1, 2].map(|k| noise(95, 3 * i + k)),
            object: (i % 5) as f32,
        })
        .collect();
    let [mut frame, _] = frames();
    frame.to_sun = [0.6, 0.8, 0.0];
    let push = PaperModulate {
        ends,
        width: SIZE[0],
        height: SIZE[1],
        nearest: 1.8,
        farthest: 9.5,
        near: 1.0,
        far: 11.0,
        ambient: 0.2,
    };
    let plain = gpu.sampler(&SamplerInfo::default())?;
    let buffers = (
        gpu.upload("camera", &[frame])?,
        gpu.upload("steps", &steps)?,
        gpu.upload("traits", &traits)?,
    );
    let images = [
        texture(gpu, SIZE, &foliage)?,
        texture(gpu, SIZE, &number)?,
        texture(gpu, SIZE, &stems)?,
        image(gpu, Format::Rgba32Float, bytemuck::cast_slice(&normals))?,
        texture(gpu, SIZE, &shade)?,
        image(gpu, Format::Rgba8Unorm, bytemuck::cast_slice(&masks))?,
    ];
    let mut bindings: Vec<Binding<'_>> = [&buffers.0, &buffers.1, &buffers.2]
        .map(Binding::Read)
        .into();
    bindings.extend(images.iter().map(|i| Binding::Sampled(i, &plain)));
    let kernel = (shaders::MODULATE_COMP, &[][..]);
    let bytes = run(gpu, kernel, &bindings, Format::Rgba16Float, &push)?;
    let halves: Vec<[u16; 4]> = pod_collect_to_vec(&bytes);
    let maps = twin::Buffers {
        frame: &frame,
        steps: &steps,
        traits: &traits,
        foliage_depth: &foliage,
        foliage_number: &number,
        stem_depth: &stems,
        stem_normal: &normals,
        shadow: &shade,
        masks: &masks,
    };
    let mut wrong = 0;
    for channel in 0..2 {
        let want = expected(|x, y| twin::factors(&maps, &push, x, y)[channel]);
        let found = halves.iter().map(|h| f64::from(f16_to_f32(h[channel])));
        let far = found
            .zip(&want)
            .filter(|(f, w)| (f - *w).abs() > 1e-3 * w.abs().max(1.0));
        wrong += far.count();
    }
    // Where a step leaps, a place on its edge may go to either side.
    let share = wrong as f64 / f64::from(2 * count());
    Ok(Outcome::new(share, 0.002, "share of values that differ"))
}
