//! What the user sees on stderr: messages, one-line errors, and progress of long work.

use std::fmt::Display;
use std::io::Write;
use std::sync::{LazyLock, Mutex, PoisonError};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use log::{Level, LevelFilter, Log, Metadata, Record};

/// Interval of the spinner's redraw.
const TICK: Duration = Duration::from_millis(100);

/// What is under way, and for how long.
const LINE_OF_WORK: &str = "{spinner} {msg} {elapsed}";

/// The same with a bar.
const BAR: &str = "{spinner} {msg} [{bar:30}] {pos} of {len} {elapsed}";

/// The progress line; hidden by indicatif when stderr is not a terminal.
static LINE: LazyLock<Mutex<Option<ProgressBar>>> = LazyLock::new(Mutex::default);

/// Prints log records of this crate and of what it uses, warnings and errors plainly.
struct Console;

impl Log for Console {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.level() <= log::max_level()
    }

    fn log(&self, record: &Record<'_>) {
        if !self.enabled(record.metadata()) {
            return;
        }
        let text = match record.level() {
            Level::Error => format!("umbrage: {}", record.args()),
            Level::Warn => format!("warning: {}", record.args()),
            Level::Info => record.args().to_string(),
            Level::Debug | Level::Trace => format!("{}: {}", record.target(), record.args()),
        };
        above_progress(&text);
    }

    fn flush(&self) {}
}

/// Sends log messages up to `level` to stderr.
pub fn install(level: LevelFilter) {
    if log::set_boxed_logger(Box::new(Console)).is_ok() {
        log::set_max_level(level);
    }
}

/// One line that says what is wrong.
pub fn error(error: &dyn Display) {
    let text = error.to_string();
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    above_progress(&format!("umbrage: {line}"));
}

/// A line of a report that is worth seeing before the report ends.
pub fn line(text: &str) {
    above_progress_on(&mut std::io::stdout(), text);
}

/// Names the work under way; the line goes when the guard does.
#[must_use]
pub fn working(on: impl Display) -> Working {
    let bar = ProgressBar::new_spinner()
        .with_style(ProgressStyle::with_template(LINE_OF_WORK).expect("a valid template"));
    bar.set_message(on.to_string());
    bar.enable_steady_tick(TICK);
    let before = progress().replace(bar);
    Working { before }
}

/// Keeps a progress line on the screen.
#[derive(Debug)]
pub struct Working {
    before: Option<ProgressBar>,
}

impl Working {
    /// Names the step under way.
    pub fn step(&self, name: &str) {
        if let Some(bar) = &*progress() {
            bar.set_message(name.to_owned());
        }
    }
}

impl Drop for Working {
    fn drop(&mut self) {
        let ended = std::mem::replace(&mut *progress(), self.before.take());
        if let Some(bar) = ended {
            bar.finish_and_clear();
        }
    }
}

/// Shows how much of a step of the work under way is done as a bar; where `all` is 0 the step is
/// only named.
pub fn part(name: &str, done: u64, all: u64) {
    let line = progress();
    let Some(bar) = &*line else {
        return;
    };
    // Another step, another kind of line; what stays is only moved on.
    if bar.message() != name || bar.length() != (all > 0).then_some(all) {
        bar.set_position(0);
        if all > 0 {
            bar.set_length(all);
        } else {
            bar.unset_length();
        }
        bar.set_message(name.to_owned());
        let template = if all == 0 { LINE_OF_WORK } else { BAR };
        bar.set_style(ProgressStyle::with_template(template).expect("a valid template"));
    }
    // Estimates may be too low.
    bar.set_position(if all > 0 { done.min(all) } else { done });
}

fn above_progress(text: &str) {
    above_progress_on(&mut std::io::stderr(), text);
}

/// Writes a line without tearing the progress line; a reader who has gone is no error.
fn above_progress_on(stream: &mut dyn Write, text: &str) {
    let bar = progress().clone();
    let mut write = || {
        let _ = writeln!(stream, "{text}");
    };
    match bar {
        Some(bar) => bar.suspend(write),
        None => write(),
    }
}

fn progress() -> std::sync::MutexGuard<'static, Option<ProgressBar>> {
    LINE.lock().unwrap_or_else(PoisonError::into_inner)
}
