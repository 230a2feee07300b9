//! A device for tests: validated, and silent or the test fails.

use std::ops::Deref;

use umbrage::gpu::{Gpu, GpuOptions, Validation};

/// A device whose every validation message fails the test.
pub(crate) struct TestGpu(Gpu);

/// Opens the default device with validation and synchronisation validation.
pub(crate) fn gpu() -> TestGpu {
    gpu_with(GpuOptions::default())
}

/// As [`gpu`], with options of its own.
pub(crate) fn gpu_with(options: GpuOptions) -> TestGpu {
    let options = GpuOptions {
        validation: Validation::Required,
        ..options
    };
    TestGpu(Gpu::new(&options).expect("tests need a Vulkan driver and the validation layer"))
}

impl Deref for TestGpu {
    type Target = Gpu;
    fn deref(&self) -> &Gpu {
        &self.0
    }
}

impl Drop for TestGpu {
    fn drop(&mut self) {
        let messages = self.0.take_validation_messages();
        if !std::thread::panicking() {
            assert!(
                messages.is_empty(),
                "validation messages:\n{}",
                messages.join("\n")
            );
        }
    }
}
