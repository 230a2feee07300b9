//! Stage 2 of drawings on made-up attributes: discs before each other and before nothing.

use glam::DVec2;

use super::{Case, Outcome};
use crate::Result;
use crate::abi::{
    INK_BAND_LENGTH, INK_BAND_WIDTH, INK_DEPTH_LINEAR, INK_DEPTH_MAPPED, INK_OBJECTS, InkClean,
    InkCluster, InkContour, InkSilhouette,
};
use crate::gpu::shaders::ink as shaders;
use crate::gpu::{
    AddressMode, Binding, Format, Gpu, Image, ImageInfo, QueueKind, Sampler, SamplerInfo,
};
use crate::ink::strokes;
use crate::math::sampling::uniform;
use crate::reference::ink as twin;

/// Pixels across and down.
const SIZE: [u32; 2] = [75, 50];
/// Discs.
const DISCS: u32 = 24;
/// Styles of a picture: one, or three of which the second is worked on.
const ALONE: u32 = 1;
const STYLES: u32 = 3;
/// Differences of depth so near to the threshold are left to rounding.
const MARGIN: f64 = 1e-6;

pub(super) fn cases() -> Vec<Case> {
    vec![
        Case {
            name: "ink.contour.linear",
            run: |gpu| contour(gpu, INK_DEPTH_LINEAR, (false, ALONE)),
        },
        Case {
            name: "ink.contour.mapped",
            run: |gpu| contour(gpu, INK_DEPTH_MAPPED, (false, ALONE)),
        },
        Case {
            name: "ink.contour.detail",
            run: |gpu| contour(gpu, INK_DEPTH_LINEAR, (true, ALONE)),
        },
        Case {
            name: "ink.contour.mixed",
            run: |gpu| contour(gpu, INK_DEPTH_LINEAR, (true, STYLES)),
        },
        Case {
            name: "ink.clean",
            run: |gpu| clean(gpu, ALONE),
        },
        Case {
            name: "ink.clean.mixed",
            run: |gpu| clean(gpu, STYLES),
        },
        Case {
            name: "ink.silhouette",
            run: |gpu| silhouette(gpu, 0, ALONE),
        },
        Case {
            name: "ink.silhouette.blend",
            run: |gpu| silhouette(gpu, 1, ALONE),
        },
        Case {
            name: "ink.silhouette.mixed",
            run: |gpu| silhouette(gpu, 0, STYLES),
        },
    ]
}

/// Attributes of stage 1.
struct Attributes {
    depth: Vec<f32>,
    ids: Vec<[f32; 2]>,
    direction: Vec<[f32; 2]>,
    normal: Vec<[f32; 4]>,
    tone: Vec<f32>,
    clusters: Vec<InkCluster>,
}

impl Attributes {
    fn new(styles: u32) -> Self {
        let pixels = (SIZE[0] * SIZE[1]) as usize;
        let mut out = Self {
            depth: vec![0.0; pixels],
            ids: vec![[0.0; 2]; pixels],
            direction: vec![[0.0; 2]; pixels],
            normal: vec![[0.0; 4]; pixels],
            tone: vec![0.0; pixels],
            clusters: Vec::new(),
        };
        for disc in 0..DISCS {
            out.disc(disc, styles);
        }
        out
    }

    /// A disc of its own depth, over what lies behind; every eighth is wood.
    fn disc(&mut self, number: u32, styles: u32) {
        let u = |k: u32| uniform(77, 8 * number + k);
        let centre = DVec2::new(u(0) * f64::from(SIZE[0]), u(1) * f64::from(SIZE[1]));
        let radius = 4.0 + 9.0 * u(2);
        let depth = (2.0 + 6.0 * u(3)) as f32;
        let turn = std::f64::consts::TAU * u(4);
        self.clusters.push(InkCluster {
            pixel: centre.as_vec2().to_array(),
            radius: 1.0,
            // Every seventh is around the eye and has no outline.
            pixel_radius: if number % 7 == 6 { 0.0 } else { radius as f32 },
            texture_up: [turn.cos() as f32, turn.sin() as f32],
            ..InkCluster::default()
        });
        let leaf = number % 8 != 7;
        for i in 0..SIZE[0] * SIZE[1] {
            let p = DVec2::new(f64::from(i % SIZE[0]) + 0.5, f64::from(i / SIZE[0]) + 0.5);
            let away = (p - centre) / radius;
            let at = i as usize;
            let hidden = self.depth[at] > 0.0 && self.depth[at] <= depth;
            if away.length() > 1.0 || hidden {
                continue;
            }
            self.depth[at] = depth;
            let cluster = if leaf { number as f32 + 1.0 } else { 0.0 };
            let object = number % styles * INK_OBJECTS + number / 5;
            self.ids[at] = [object as f32 + 1.0, cluster];
            self.direction[at] = if leaf {
                away.as_vec2().to_array()
            } else {
                [0.0; 2]
            };
            let tone = uniform(78, i) as f32;
            self.normal[at] = [0.0, 0.0, 1.0, tone];
            self.tone[at] = tone;
        }
    }

    /// Whether a picture of several styles has the pixel in another than the one worked on.
    fn is_foreign(&self, pixel: usize, styles: u32) -> bool {
        styles > 1 && twin::style_of(f64::from(self.ids[pixel][0])) != 1
    }

    fn pixels(&self) -> twin::Pixels<'_> {
        twin::Pixels {
            depth: &self.depth,
            ids: &self.ids,
            direction: &self.direction,
            tone: &self.tone,
        }
    }
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

/// Runs one kernel that writes an image of floats last.
fn run<P: bytemuck::Pod>(
    gpu: &Gpu,
    (shader, constants): (crate::gpu::Shader, &[(u32, u32)]),
    images: &[(&Image, &Sampler)],
    buffer: Option<&crate::gpu::Buffer>,
    push: &P,
) -> Result<Vec<f32>> {
    let kernel = gpu.compute_pipeline_with(shader, constants)?;
    let out = gpu.image(ImageInfo::storage("ink", Format::R32Float, SIZE))?;
    let mut bindings: Vec<Binding<'_>> =
        images.iter().map(|(i, s)| Binding::Sampled(i, s)).collect();
    bindings.extend(buffer.map(Binding::Read));
    bindings.push(Binding::StorageWrite(&out));
    let mut work = gpu.work(QueueKind::Graphics, "ink")?;
    work.compute("ink", &kernel, &bindings, push, [SIZE[0], SIZE[1], 1])?;
    let read = work.read_image("ink", &out)?;
    let mut done = work.submit()?.wait()?;
    Ok(bytemuck::pod_collect_to_vec(&done.take(read)))
}

fn contour_push(mapping: u32, styles: u32) -> InkContour {
    InkContour {
        width: SIZE[0],
        height: SIZE[1],
        threshold: 0.03,
        threshold_wood: 0.3,
        mapping,
        nearest: 1.5,
        farthest: 8.5,
        detail: 4.0,
        detail_power: 1.5,
        style: u32::from(styles > 1),
        clears: 1,
    }
}

fn contour(gpu: &Gpu, mapping: u32, (detail, styles): (bool, u32)) -> Result<Outcome> {
    let a = Attributes::new(styles);
    let plain = gpu.sampler(&SamplerInfo::default())?;
    let images = [
        texture(gpu, Format::R32Float, SIZE, &a.depth)?,
        texture(gpu, Format::Rg32Float, SIZE, &a.ids)?,
        texture(gpu, Format::Rg32Float, SIZE, &a.direction)?,
    ];
    let bound: Vec<_> = images.iter().map(|i| (i, &plain)).collect();
    let push = contour_push(mapping, styles);
    let constants = [(0, u32::from(detail)), (1, u32::from(styles > 1))];
    let found = run(
        gpu,
        (shaders::CONTOUR_COMP, &constants),
        &bound,
        None,
        &push,
    )?;
    let width = i64::from(SIZE[0]);
    let expected: Vec<(f64, f64)> = (0..found.len() as i64)
        .map(|i| {
            if a.is_foreign(i as usize, styles) {
                return (0.0, f64::INFINITY);
            }
            twin::contour(&push, detail, &a.pixels(), i % width, i / width)
        })
        .collect();
    let error = |got: &f32, want: &(f64, f64)| {
        if want.1 < MARGIN {
            0.0
        } else {
            (f64::from(*got) - want.0).abs()
        }
    };
    Ok(Outcome::worst((&found, &expected), error, (0.0, "contour")))
}

/// Lines and dots of random pixels.
fn lines() -> Vec<f32> {
    let one = |i| if uniform(79, i) < 0.3 { 1.0 } else { 0.0 };
    (0..SIZE[0] * SIZE[1]).map(one).collect()
}

fn clean(gpu: &Gpu, styles: u32) -> Result<Outcome> {
    let plain = gpu.sampler(&SamplerInfo::default())?;
    let lines = lines();
    let image = texture(gpu, Format::R32Float, SIZE, &lines)?;
    let a = Attributes::new(styles);
    let ids = texture(gpu, Format::Rg32Float, SIZE, &a.ids)?;
    let push = InkClean {
        width: SIZE[0],
        height: SIZE[1],
        neighbours: 3,
        style: u32::from(styles > 1),
        clears: 1,
    };
    let found = run(
        gpu,
        (shaders::CLEAN_COMP, &[(0, u32::from(styles > 1))]),
        &[(&image, &plain), (&ids, &plain)],
        None,
        &push,
    )?;
    let width = i64::from(SIZE[0]);
    let expected: Vec<f32> = (0..found.len() as i64)
        .map(|i| {
            if a.is_foreign(i as usize, styles) {
                return 0.0;
            }
            twin::clean(&push, &lines, i % width, i / width)
        })
        .collect();
    let error = |got: &f32, want: &f32| f64::from((got - want).abs());
    Ok(Outcome::worst((&found, &expected), error, (0.0, "line")))
}

/// The band of strokes at a place, bilinear, repeating along u.
fn band(texels: &[u8], at: DVec2, channel: usize) -> f64 {
    let (length, width) = (f64::from(INK_BAND_LENGTH), f64::from(INK_BAND_WIDTH));
    let (x, y) = (at.x * length - 0.5, at.y * width - 0.5);
    let texel = |x: f64, y: f64| {
        let column = x.rem_euclid(length) as usize;
        let row = y.clamp(0.0, width - 1.0) as usize;
        f64::from(texels[4 * (row * length as usize + column) + channel]) / 255.0
    };
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = (x - x0, y - y0);
    let top = texel(x0, y0) * (1.0 - fx) + texel(x0 + 1.0, y0) * fx;
    let bottom = texel(x0, y0 + 1.0) * (1.0 - fx) + texel(x0 + 1.0, y0 + 1.0) * fx;
    top * (1.0 - fy) + bottom * fy
}

fn silhouette(gpu: &Gpu, blend: u32, styles: u32) -> Result<Outcome> {
    let a = Attributes::new(styles);
    let plain = gpu.sampler(&SamplerInfo::default())?;
    let smooth = gpu.sampler(&SamplerInfo {
        linear: true,
        address: [AddressMode::Repeat, AddressMode::Clamp],
        ..SamplerInfo::default()
    })?;
    let width = i64::from(SIZE[0]);
    let contour_push = contour_push(INK_DEPTH_LINEAR, styles);
    let lines: Vec<f32> = (0..i64::from(SIZE[0] * SIZE[1]))
        .map(|i| twin::contour(&contour_push, false, &a.pixels(), i % width, i / width).0 as f32)
        .collect();
    let strokes = strokes::band(5);
    let images = [
        texture(gpu, Format::Rg32Float, SIZE, &a.ids)?,
        texture(gpu, Format::Rg32Float, SIZE, &a.direction)?,
        texture(gpu, Format::Rgba32Float, SIZE, &a.normal)?,
        texture(gpu, Format::R32Float, SIZE, &lines)?,
    ];
    let extent = [INK_BAND_LENGTH, INK_BAND_WIDTH];
    let strokes_image = texture(gpu, Format::Rgba8Unorm, extent, &strokes)?;
    let mut bound: Vec<_> = images.iter().map(|i| (i, &plain)).collect();
    bound.push((&strokes_image, &smooth));
    let clusters = gpu.upload("clusters", &a.clusters)?;
    let push = InkSilhouette {
        width: SIZE[0],
        height: SIZE[1],
        reach: 9.3,
        band_length: 30.0,
        aspect: 1.3,
        blend,
        style: u32::from(styles > 1),
        clears: 1,
    };
    let constants = [(0, u32::from(styles > 1))];
    let shader = (shaders::SILHOUETTE_COMP, &constants[..]);
    let found = run(gpu, shader, &bound, Some(&clusters), &push)?;
    let mut off = 0_u32;
    let mut inked = 0_u32;
    for (i, &got) in (0_i64..).zip(&found) {
        let at = twin::silhouette(
            &push,
            &a.pixels(),
            &lines,
            &a.clusters,
            i % width,
            i / width,
        )
        .filter(|_| !a.is_foreign(i as usize, styles));
        let expected = at.map_or(0.0, |(at, shade)| {
            let of = |k: f64| band(&strokes, at, k.min(3.0) as usize);
            if blend == 1 {
                of(shade.floor()) + shade.fract() * (of(shade.floor() + 1.0) - of(shade.floor()))
            } else {
                of((shade + 0.5).floor())
            }
        });
        inked += u32::from(expected > 0.0);
        // Strokes are steep.
        off += u32::from((f64::from(got) - expected).abs() > 0.004);
    }
    // Where a step ends on a pixel's border, rounding decides about one pixel of the way.
    let error = if inked < 100 {
        f64::NAN
    } else {
        f64::from(off) / f64::from(inked)
    };
    Ok(Outcome::new(
        error,
        0.02,
        "share of inked pixels that differ",
    ))
}
