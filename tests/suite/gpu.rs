//! The mechanism: shared layouts, conformance of the smallest kernels, drawing, limits.

use std::collections::BTreeMap;

use umbrage::abi;
use umbrage::app::conform;
use umbrage::gpu::reflect::Reflection;
use umbrage::gpu::{
    Binding, BufferInfo, ColorTarget, Cull, DepthTarget, Format, GpuOptions, GraphicsPipelineInfo,
    ImageInfo, QueueKind, RenderPass, shaders,
};

use crate::fixture;

/// Every struct of `abi.rs` that a shader uses has the same offsets, size and stride there.
#[test]
fn shared_structs_have_the_same_layout_in_rust_and_spirv() {
    let host: BTreeMap<_, _> = abi::layouts().into_iter().map(|l| (l.name, l)).collect();
    let mut seen = BTreeMap::new();
    for shader in shaders::ALL {
        for s in Reflection::of(&shader.words()).structs {
            let Some(layout) = host.get(s.name.as_str()) else {
                continue;
            };
            let device: Vec<(&str, usize)> = s
                .members
                .iter()
                .map(|(n, o)| (n.as_str(), *o as usize))
                .collect();
            assert_eq!(device, layout.fields, "{} in {}", s.name, shader.name);
            if let Some(stride) = s.array_stride {
                assert_eq!(
                    stride as usize, layout.size,
                    "stride of {} in {}",
                    s.name, shader.name
                );
            }
            *seen.entry(layout.name).or_insert(0) += 1;
        }
    }
    let unused: Vec<_> = host.keys().filter(|n| !seen.contains_key(*n)).collect();
    assert!(unused.is_empty(), "no shader uses {unused:?}");
}

/// Push constants that are a shared struct have its size.
#[test]
fn the_group_size_is_the_shared_constant() {
    let r = Reflection::of(&shaders::gpu::FILL_SEQUENCE_COMP.words());
    assert_eq!(r.local_size, [abi::GROUP_1D, 1, 1]);
    assert_eq!(r.push_bytes as usize, size_of::<abi::FillSequence>());
}

#[test]
fn conformance_cases_of_the_mechanism_pass() {
    let gpu = fixture::gpu();
    for case in conform::cases()
        .iter()
        .filter(|c| c.name.starts_with("gpu."))
    {
        let outcome = (case.run)(&gpu).expect(case.name);
        assert!(outcome.passed(), "{}: {outcome:?}", case.name);
    }
}

/// The same cases on one queue: aliasing changes nothing.
#[test]
fn a_single_queue_gives_the_same_results() {
    let gpu = fixture::gpu_with(GpuOptions {
        single_queue: true,
        ..Default::default()
    });
    assert_eq!(gpu.info().queues.slots().len(), 1);
    for case in conform::cases()
        .iter()
        .filter(|c| c.name.starts_with("gpu."))
    {
        assert!((case.run)(&gpu).expect(case.name).passed(), "{}", case.name);
    }
}

fn covered(samples: u32, cull: Cull) -> (usize, Vec<u8>) {
    let gpu = fixture::gpu();
    let extent = [64, 64];
    let color = gpu
        .image(ImageInfo::target("colour", Format::Rgba8Unorm, extent, 1))
        .unwrap();
    let many = (samples > 1).then(|| {
        gpu.image(ImageInfo::target(
            "samples",
            Format::Rgba8Unorm,
            extent,
            samples,
        ))
        .unwrap()
    });
    let depth = gpu
        .image(ImageInfo::target("depth", Format::Depth32, extent, samples))
        .unwrap();
    let square = gpu
        .graphics_pipeline(&GraphicsPipelineInfo {
            name: "square",
            vertex: shaders::gpu::SQUARE_VERT,
            fragment: Some(shaders::gpu::SQUARE_FRAG),
            color_formats: &[Format::Rgba8Unorm],
            depth_format: Some(Format::Depth32),
            samples,
            cull,
            ..Default::default()
        })
        .unwrap();
    let push = abi::Square {
        min: [-0.5, -0.25],
        max: [0.5, 0.25],
        color: [1.0, 0.5, 0.0, 1.0],
        depth: 0.5,
    };
    let far = abi::Square {
        depth: 0.25,
        color: [0.0, 0.0, 1.0, 1.0],
        ..push
    };
    let mut work = gpu.work(QueueKind::Graphics, "square").unwrap();
    let target = match &many {
        Some(many) => ColorTarget {
            image: many,
            clear: Some([0.0; 4]),
            resolve: Some(&color),
            store: false,
        },
        None => ColorTarget {
            image: &color,
            clear: Some([0.0; 4]),
            resolve: None,
            store: true,
        },
    };
    let pass = RenderPass {
        extent,
        color: &[target],
        depth: Some(DepthTarget {
            image: &depth,
            clear: Some(0.0),
            store: false,
        }),
        reads: &[],
    };
    work.render("square", &pass, |draws| {
        draws.pipeline(&square);
        for p in [&push, &far] {
            draws.push(p)?;
            draws.draw(0..6, 1)?;
        }
        Ok(())
    })
    .unwrap();
    let image = work.read_image("colour", &color).unwrap();
    let mut done = work.submit().unwrap().wait().unwrap();
    assert_eq!(done.passes()[0].label, "square");
    assert!(
        !gpu.info().timestamps || done.passes()[0].nanoseconds > 0,
        "{:?}",
        done.passes()
    );
    let pixels = done.take(image);
    (pixels.chunks_exact(4).filter(|p| p[3] != 0).count(), pixels)
}

/// A square over half the width and a quarter of the height covers 32 x 16 pixels, and the one
/// behind it (smaller depth: depth is reversed) stays hidden.
#[test]
fn a_square_covers_its_pixels_and_hides_what_is_behind() {
    for samples in [1, 4] {
        let (count, pixels) = covered(samples, Cull::None);
        assert_eq!(count, 32 * 16, "{samples} samples");
        let centre = 4 * (32 * 64 + 32);
        assert_eq!(pixels[centre..centre + 4], [255, 128, 0, 255]);
    }
}

#[test]
fn counter_clockwise_on_the_screen_is_the_front() {
    assert_eq!(covered(1, Cull::Back).0, 32 * 16);
    assert_eq!(covered(1, Cull::Front).0, 0);
}

#[test]
fn a_buffer_over_the_limits_is_refused_before_it_is_allocated() {
    let gpu = fixture::gpu();
    let before = gpu.allocations();
    let error = gpu
        .buffer(BufferInfo::device("enormous", 1 << 50))
        .expect_err("a petabyte");
    assert!(
        error
            .to_string()
            .contains("enormous needs 1125899906842624 bytes"),
        "{error}"
    );
    assert_eq!(error.exit_code(), 2);
    let error = gpu
        .image(ImageInfo::target(
            "wide",
            Format::Rgba8Unorm,
            [1 << 20, 4],
            1,
        ))
        .expect_err("a million pixels wide");
    assert!(error.to_string().contains("wide"), "{error}");
    assert_eq!(gpu.allocations(), before);
}

#[test]
fn memory_is_counted_by_name_and_given_back() {
    let gpu = fixture::gpu();
    let buffer = gpu.buffer(BufferInfo::device("counted", 10_000)).unwrap();
    assert!(
        gpu.allocations()
            .iter()
            .any(|(n, b)| n == "counted" && *b >= 10_000)
    );
    drop(buffer);
    assert!(gpu.allocations().is_empty(), "{:?}", gpu.allocations());
    assert!(gpu.peak_bytes() >= 10_000);
}

/// Work that is dropped without being submitted leaves its resources usable.
#[test]
fn abandoned_work_leaves_no_trace() {
    let gpu = fixture::gpu();
    let buffer = gpu.upload("kept", &[7u32; 16]).unwrap();
    let mut work = gpu.work(QueueKind::Compute, "abandoned").unwrap();
    work.fill("never run", &buffer, 9).unwrap();
    drop(work);
    assert_eq!(gpu.read::<u32>(&buffer).unwrap(), vec![7; 16]);
}

/// A buffer written on the compute queue and read by draws on the graphics queue.
#[test]
fn compute_results_reach_the_graphics_queue() {
    let gpu = fixture::gpu();
    let kernel = gpu
        .compute_pipeline(shaders::gpu::FILL_SEQUENCE_COMP)
        .unwrap();
    let buffer = gpu
        .buffer(BufferInfo::device("handed over", 4 * 64))
        .unwrap();
    let mut compute = gpu.work(QueueKind::Compute, "produce").unwrap();
    let push = abi::FillSequence {
        count: 64,
        first: 1,
        step: 1,
    };
    compute
        .compute(
            "produce",
            &kernel,
            &[Binding::Write(&buffer)],
            &push,
            [64, 1, 1],
        )
        .unwrap();
    let running = compute.submit().unwrap();
    let mut graphics = gpu.work(QueueKind::Graphics, "consume").unwrap();
    let readback = graphics.read::<u32>("handed over", &buffer).unwrap();
    let values = graphics.submit().unwrap().wait().unwrap().take(readback);
    assert_eq!(values, (1..=64).collect::<Vec<u32>>());
    assert_eq!(running.wait().unwrap().passes()[0].queue, "compute");
}

#[test]
fn an_unknown_device_is_an_error_that_lists_the_known_ones() {
    let options = GpuOptions {
        device: Some("no such device".into()),
        ..Default::default()
    };
    let error = umbrage::gpu::Gpu::new(&options).expect_err("not there");
    assert!(
        error.to_string().contains("not named \"no such device\""),
        "{error}"
    );
    assert_eq!(error.exit_code(), 2);
}

#[test]
fn the_pipeline_cache_is_written_and_a_damaged_one_is_ignored() {
    let folder = tempfile::tempdir().unwrap();
    let options = || GpuOptions {
        pipeline_cache: Some(folder.path().into()),
        ..Default::default()
    };
    let make = || {
        let gpu = fixture::gpu_with(options());
        drop(
            gpu.compute_pipeline(shaders::gpu::FILL_SEQUENCE_COMP)
                .unwrap(),
        );
    };
    make();
    let files: Vec<_> = std::fs::read_dir(folder.path())
        .unwrap()
        .flatten()
        .collect();
    assert_eq!(files.len(), 1, "{files:?}");
    let path = files[0].path();
    let mut bytes = std::fs::read(&path).unwrap();
    assert!(bytes.len() >= 64, "{} bytes", bytes.len());
    let last = bytes.len() - 1;
    bytes[last] ^= 0xff;
    std::fs::write(&path, &bytes).unwrap();
    make();
    let again = std::fs::read(&path).unwrap();
    assert_ne!(again, bytes, "the damaged file was replaced");
}
