//! Proof that the validation gate is alive: a missing barrier must be reported.

use ash::vk;

use super::{BufferInfo, Gpu, GpuOptions, QueueKind, Validation};

fn checked_gpu() -> Gpu {
    Gpu::new(&GpuOptions {
        validation: Validation::Required,
        ..Default::default()
    })
    .expect("the tests need a Vulkan driver and the validation layer (see README)")
}

#[test]
fn a_missing_barrier_is_reported_exactly_once() {
    let gpu = checked_gpu();
    let buffer = gpu
        .buffer(BufferInfo::device("unordered", 1024))
        .expect("small");
    let mut work = gpu
        .work(QueueKind::Compute, "two fills without a barrier")
        .expect("records");
    work.fill("first", &buffer, 1).expect("records");
    // SAFETY: a hazard on purpose, on memory that nobody reads.
    unsafe {
        gpu.inner
            .device
            .cmd_fill_buffer(work.cmd, buffer.inner.raw, 0, vk::WHOLE_SIZE, 2);
    };
    drop(work.submit().expect("submits").wait().expect("completes"));
    let messages = gpu.take_validation_messages();
    assert_eq!(messages.len(), 1, "{messages:#?}");
    assert!(
        messages[0].contains("SYNC-HAZARD-WRITE-AFTER-WRITE"),
        "{}",
        messages[0]
    );
}

#[test]
fn the_same_fills_with_their_barrier_are_silent() {
    let gpu = checked_gpu();
    let buffer = gpu
        .buffer(BufferInfo::device("ordered", 1024))
        .expect("small");
    let mut work = gpu.work(QueueKind::Compute, "two fills").expect("records");
    work.fill("first", &buffer, 1).expect("records");
    work.fill("second", &buffer, 2).expect("records");
    drop(work.submit().expect("submits").wait().expect("completes"));
    assert_eq!(gpu.take_validation_messages(), Vec::<String>::new());
    assert_eq!(gpu.read::<u32>(&buffer).expect("reads"), vec![2; 256]);
}

#[test]
fn wrong_api_use_is_reported_too() {
    let gpu = checked_gpu();
    let info = vk::BufferCreateInfo::default()
        .size(0)
        .usage(vk::BufferUsageFlags::STORAGE_BUFFER);
    // SAFETY: wrong on purpose; whatever comes back is destroyed.
    unsafe {
        if let Ok(raw) = gpu.inner.device.create_buffer(&info, None) {
            gpu.inner.device.destroy_buffer(raw, None);
        }
    }
    let messages = gpu.take_validation_messages();
    assert!(
        messages
            .iter()
            .any(|m| m.contains("VUID-VkBufferCreateInfo-size")),
        "{messages:#?}"
    );
}
