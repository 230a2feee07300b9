//! What every command gets: the global options and what follows from them.

use std::cell::OnceCell;
use std::path::PathBuf;

use super::cache::Cache;
use super::cli::GlobalArgs;
use super::{console, output};
use crate::Result;
use crate::gpu::{Gpu, GpuOptions, Validation};

/// Global options, and the device they choose, which is opened when it is first needed.
#[derive(Debug)]
pub struct Context {
    options: GlobalArgs,
    gpu: OnceCell<Gpu>,
    cache: OnceCell<Option<PathBuf>>,
}

impl Context {
    /// A context for one command.
    #[must_use]
    pub fn new(options: GlobalArgs) -> Self {
        Self {
            options,
            gpu: OnceCell::new(),
            cache: OnceCell::new(),
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
        Ok(self.gpu.get_or_init(|| gpu))
    }

    /// Opens the device now if the user named one: a name that no device has is told before a
    /// large model is read.
    ///
    /// # Errors
    /// As [`Context::gpu`].
    pub fn check_device(&self) -> Result<()> {
        match self.options.device {
            Some(_) => self.gpu().map(|_| ()),
            None => Ok(()),
        }
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

    /// Where bakes and pipelines are kept; none when that is not wanted, or not possible, which
    /// is told once.
    fn cache_folder(&self) -> Option<PathBuf> {
        if self.options.no_cache {
            return None;
        }
        let find = || {
            let chosen = self.options.cache_dir.clone();
            let folder = chosen.or_else(Cache::default_folder)?;
            match output::check_folder(&folder) {
                Ok(()) => Some(folder),
                Err(error) => {
                    log::warn!("cache: {error}; nothing is kept");
                    None
                }
            }
        };
        self.cache.get_or_init(find).clone()
    }
}
