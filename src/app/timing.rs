//! Times of repeated work: per stage on the CPU, per pass on the device.

use std::time::Instant;

use serde_json::{Value, json};

use super::report::Table;
use crate::gpu::PassTime;
use crate::math::stats::median;

/// Samples of named stages, in the order they first happened.
#[derive(Debug, Clone, Default)]
pub struct Timings {
    stages: Vec<Stage>,
}

/// All samples of one stage or pass.
#[derive(Debug, Clone)]
struct Stage {
    label: String,
    place: String,
    milliseconds: Vec<f64>,
}

impl Timings {
    /// Adds a sample of `label`; `place` is `cpu` or the queue.
    pub fn add(&mut self, label: &str, place: &str, milliseconds: f64) {
        let same = |s: &&mut Stage| s.label == label && s.place == place;
        match self.stages.iter_mut().find(same) {
            Some(stage) => stage.milliseconds.push(milliseconds),
            None => self.stages.push(Stage {
                label: label.to_owned(),
                place: place.to_owned(),
                milliseconds: vec![milliseconds],
            }),
        }
    }

    /// Adds the device times of passes.
    pub fn add_passes(&mut self, passes: &[PassTime]) {
        for pass in passes {
            self.add(&pass.label, pass.queue, pass.nanoseconds as f64 * 1e-6);
        }
    }

    /// Runs `work` and adds its wall time under `label`.
    pub fn measure<T>(&mut self, label: &str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.add(label, "cpu", start.elapsed().as_secs_f64() * 1e3);
        result
    }

    /// Adds the samples of other timings.
    pub fn append(&mut self, other: Self) {
        for stage in other.stages {
            for sample in stage.milliseconds {
                self.add(&stage.label, &stage.place, sample);
            }
        }
    }

    /// Sum of the medians of the stages on the device whose labels `counts` takes, milliseconds.
    #[must_use]
    pub fn device_sum(&self, counts: impl Fn(&str) -> bool) -> f64 {
        let device = self.stages.iter().filter(|s| s.place != "cpu");
        device
            .filter(|s| counts(&s.label))
            .map(|s| median(&s.milliseconds))
            .sum()
    }

    /// Whether there is any sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.stages.is_empty()
    }

    /// Sum of the medians of every stage whose place is not `cpu`, milliseconds.
    #[must_use]
    pub fn device_total(&self) -> f64 {
        let device = self.stages.iter().filter(|s| s.place != "cpu");
        device.map(|s| median(&s.milliseconds)).sum()
    }

    /// Median, smallest, largest and number of samples of each stage.
    #[must_use]
    pub fn table(&self) -> Table {
        let mut table = Table::new(&["stage", "on", "median ms", "min ms", "max ms", "N"]);
        for stage in &self.stages {
            let [mid, low, high] = stage.summary().map(|v| format!("{v:.3}"));
            let count = stage.milliseconds.len();
            table.row(&[&stage.label, &stage.place, &mid, &low, &high, &count]);
        }
        table
    }

    /// The same as JSON.
    #[must_use]
    pub fn json(&self) -> Value {
        let rows = self.stages.iter().map(|stage| {
            let [mid, low, high] = stage.summary();
            json!({
                "stage": stage.label, "on": stage.place,
                "median_ms": mid, "min_ms": low, "max_ms": high,
                "samples": stage.milliseconds.len(),
            })
        });
        rows.collect()
    }
}

impl Stage {
    fn summary(&self) -> [f64; 3] {
        let all = self.milliseconds.iter().copied();
        [
            median(&self.milliseconds),
            all.clone().fold(f64::INFINITY, f64::min),
            all.fold(0.0, f64::max),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_gather_under_their_label_and_place() {
        let mut timings = Timings::default();
        for ms in [3.0, 1.0, 2.0] {
            timings.add("density", "compute", ms);
        }
        timings.add("density", "cpu", 9.0);
        let json = timings.json();
        assert_eq!(json[0]["median_ms"], 2.0, "median");
        assert_eq!(json[0]["samples"], 3, "N");
        assert_eq!(json[1]["on"], "cpu", "another place is another row");
        assert_eq!(timings.device_total(), 2.0, "the CPU is no device");
    }
}
