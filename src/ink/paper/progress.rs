//! How far the drawing of lines is, for who waits for it.

use std::sync::atomic::{AtomicU64, Ordering};

/// A stage of drawing lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Primitives that are seen are outlined.
    Outlines,
    /// Strokes that carry tones are placed; how many there will be is an estimate.
    Strokes,
    /// Curves are fitted to lines.
    Curves,
}

impl Stage {
    /// What is done, and to what.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Outlines => "outlining primitives",
            Self::Strokes => "placing strokes",
            Self::Curves => "fitting curves",
        }
    }
}

/// Is told the stage, how much of it is done, and all of it (0: unknown), now and then, from any
/// thread.
pub type Tell<'a> = &'a (dyn Fn(Stage, u64, u64) + Sync);

/// Tells nobody.
pub fn quiet(_: Stage, _: u64, _: u64) {}

/// What is told at most: each so manieth.
const EVERY: u64 = 256;

/// Counts what is done of a stage.
pub(super) struct Count<'a> {
    tell: Tell<'a>,
    stage: Stage,
    all: u64,
    done: AtomicU64,
}

impl<'a> Count<'a> {
    pub(super) fn new(tell: Tell<'a>, stage: Stage, all: usize) -> Self {
        let all = all as u64;
        tell(stage, 0, all);
        Self {
            tell,
            stage,
            all,
            done: AtomicU64::new(0),
        }
    }

    /// One more is done.
    pub(super) fn add(&self) {
        let done = 1 + self.done.fetch_add(1, Ordering::Relaxed);
        if done.is_multiple_of(EVERY) || done == self.all {
            (self.tell)(self.stage, done, self.all);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use rayon::prelude::*;

    use super::*;

    #[test]
    fn the_end_is_told_and_what_is_told_is_little() {
        let told = Mutex::new(Vec::new());
        let tell = |stage, done, all| told.lock().unwrap().push((stage, done, all));
        let count = Count::new(&tell, Stage::Outlines, 10_000);
        (0..10_000).into_par_iter().for_each(|_| count.add());
        let told = told.into_inner().unwrap();
        assert_eq!(told[0], (Stage::Outlines, 0, 10_000));
        assert!(told.contains(&(Stage::Outlines, 10_000, 10_000)));
        assert!(told.len() < 45, "{}", told.len());
    }
}
