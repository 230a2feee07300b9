//! What every command gets: the global options and what follows from them.

use super::cli::GlobalArgs;

/// Global options, and the device they choose.
#[derive(Debug)]
pub struct Context {
    options: GlobalArgs,
}

impl Context {
    /// A context for one command.
    #[must_use]
    pub fn new(options: GlobalArgs) -> Self {
        Self { options }
    }

    /// Results as JSON on stdout.
    #[must_use]
    pub fn json(&self) -> bool {
        self.options.json
    }
}
