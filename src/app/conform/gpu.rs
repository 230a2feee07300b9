//! The mechanism itself: upload, kernel, download; copies; a drawn square.

use super::{Case, Outcome};
use crate::Result;
use crate::abi::FillSequence;
use crate::gpu::{Binding, BufferInfo, Gpu, QueueKind, shaders};

pub(super) fn cases() -> Vec<Case> {
    vec![
        Case {
            name: "gpu.fill_sequence.one",
            run: |gpu| fill_sequence(gpu, 1),
        },
        Case {
            name: "gpu.fill_sequence.odd",
            run: |gpu| fill_sequence(gpu, 1_000_003),
        },
        Case {
            name: "gpu.upload_download",
            run: upload_download,
        },
    ]
}

/// Differing words of an arithmetic sequence made by a kernel.
fn fill_sequence(gpu: &Gpu, count: u32) -> Result<Outcome> {
    let pipeline = gpu.compute_pipeline(shaders::gpu::FILL_SEQUENCE_COMP)?;
    let buffer = gpu.buffer(BufferInfo::device("sequence", 4 * u64::from(count)))?;
    let mut work = gpu.work(QueueKind::Compute, "fill sequence")?;
    let push = FillSequence {
        count,
        first: 5,
        step: 3,
    };
    work.compute(
        "fill sequence",
        &pipeline,
        &[Binding::Write(&buffer)],
        &push,
        [count, 1, 1],
    )?;
    let readback = work.read::<u32>("sequence", &buffer)?;
    let values = work.submit()?.wait()?.take(readback);
    let expected = (0..count).map(|i| 5u32.wrapping_add(i.wrapping_mul(3)));
    let wrong = expected.zip(&values).filter(|(a, b)| a != *b).count()
        + values.len().abs_diff(count as usize);
    Ok(Outcome {
        error: wrong as f64,
        limit: 0.0,
        measure: "differing words",
    })
}

/// Differing bytes after a round trip of sizes around the word size.
fn upload_download(gpu: &Gpu) -> Result<Outcome> {
    let mut wrong = 0usize;
    for length in [0usize, 1, 3, 4, 5, 4096, 70_001] {
        let data: Vec<u8> = (0..length).map(|i| (i * 31 % 251) as u8).collect();
        let back: Vec<u8> = gpu.read(&gpu.upload("bytes", &data)?)?;
        wrong +=
            data.iter().zip(&back).filter(|(a, b)| a != b).count() + back.len().abs_diff(length);
    }
    Ok(Outcome {
        error: wrong as f64,
        limit: 0.0,
        measure: "differing bytes",
    })
}
