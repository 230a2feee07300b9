//! One error type: what was being done, to which file or object, and why it failed.

use std::path::{Path, PathBuf};

/// Result with [`Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Everything that can go wrong for reasons outside the program.
///
/// A broken invariant of the program itself is a panic with values, never an `Error`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file that cannot be read, or whose content is wrong.
    #[error("{}: {reason}", path.display())]
    File {
        /// The file at fault.
        path: PathBuf,
        /// The object inside it and what is wrong with it.
        reason: String,
    },
    /// A setting outside its range, an unknown name, an impossible combination.
    #[error("{0}")]
    Usage(String),
    /// A limit of the device is exceeded before anything is allocated.
    #[error("{0}")]
    Unsupported(String),
    /// There is no Vulkan driver, or none of its devices can be used.
    #[error("{0}")]
    NoDevice(String),
    /// The device was lost or ran out of memory while working.
    #[error("{doing}: {reason}; try a smaller size, a coarser grid or another --device")]
    Device {
        /// The pass or call that failed.
        doing: String,
        /// Vulkan's own name of the failure.
        reason: String,
    },
}

impl Error {
    /// Wrong content of `path`.
    pub fn file(path: impl AsRef<Path>, reason: impl std::fmt::Display) -> Self {
        Self::File {
            path: path.as_ref().to_owned(),
            reason: reason.to_string(),
        }
    }

    /// A wrong setting.
    pub fn usage(reason: impl std::fmt::Display) -> Self {
        Self::Usage(reason.to_string())
    }

    /// Process exit code: 2 for input the user can mend, 3 for the device.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::File { .. } | Self::Usage(_) | Self::Unsupported(_) => 2,
            Self::NoDevice(_) | Self::Device { .. } => 3,
        }
    }
}
