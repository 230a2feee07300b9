//! What every command gets: the global options and what follows from them.

use std::cell::OnceCell;
use std::path::PathBuf;

use super::cache::Cache;
use super::cli::GlobalArgs;
use super::console;
use crate::Result;
use crate::gpu::{Gpu, GpuOptions, Validation};

/// Global options, and the device they choose, which is opened when it is first needed.
#[derive(Debug)]
pub struct Context {
    options: GlobalArgs,
    gpu: OnceCell<Gpu>,
}

impl Context {
    /// A context for one command.
    #[must_use]
    pub fn new(options: GlobalArgs) -> Self {
        Self {
            options,
            gpu: OnceCell::new(),
        }
    }

    /// Results as JSON on stdout.
    #[must_use]
    pub fn json(&self) -> bool {
        self.options.json
    }

    /// GPU time per pass is wanted.
    #[must_use]
    pub fn timings(&self) -> bool {
        self.options.timings
    }

    /// The device.
    ///
    /// # Errors
    /// No device fits, or the validation layer is wanted and missing.
    pub fn gpu(&self) -> Result<&Gpu> {
        if let Some(gpu) = self.gpu.get() {
            return Ok(gpu);
        }
        let _working = console::working("opening the device");
        let gpu = Gpu::new(&GpuOptions {
            device: self.options.device.clone(),
            validation: if self.options.validate {
                Validation::Required
            } else {
                Validation::Off
            },
            pipeline_cache: self.cache_folder(),
            ..GpuOptions::default()
        })?;
        log::info!("device: {} ({})", gpu.info().name, gpu.info().driver_info);
        Ok(self.gpu.get_or_init(|| gpu))
    }

    /// Kept results; an empty cache with `--no-cache`.
    #[must_use]
    pub fn cache(&self) -> Cache {
        Cache::new(self.cache_folder())
    }

    /// What the validation layer said, if a device was opened.
    #[must_use]
    pub fn validation_messages(&self) -> Vec<String> {
        self.gpu
            .get()
            .map_or_else(Vec::new, Gpu::take_validation_messages)
    }

    fn cache_folder(&self) -> Option<PathBuf> {
        if self.options.no_cache {
            return None;
        }
        self.options
            .cache_dir
            .clone()
            .or_else(Cache::default_folder)
    }
}
