//! `umbrage conform`: one line per case in the dEQP manner.

use std::time::Instant;

use serde_json::{Value, json};

use crate::app::cli::ConformArgs;
use crate::app::conform::{Case, Outcome, cases};
use crate::app::{Context, Report, console};
use crate::gpu::Gpu;
use crate::{Error, Result};

/// Runs or lists the conformance cases.
///
/// # Errors
/// No case has the wanted name, or the device is lost.
pub fn run(context: &Context, args: &ConformArgs) -> Result<Report> {
    let filter = args.filter.as_deref().unwrap_or("");
    let cases: Vec<Case> = cases()
        .into_iter()
        .filter(|case| case.name.contains(filter))
        .collect();
    if cases.is_empty() {
        return Err(Error::usage(format!(
            "conform: no case has a name that contains {filter:?}; `umbrage conform --list` names them"
        )));
    }
    if args.list {
        let names: Vec<&str> = cases.iter().map(|c| c.name).collect();
        let text = names.join("\n") + "\n";
        return Ok(Report::new(text, json!({ "cases": names })));
    }
    let gpu = context.gpu()?;
    let start = Instant::now();
    let mut rows = Vec::new();
    let mut passed = 0;
    for case in &cases {
        let (result, json) = run_case(gpu, case)?;
        passed += usize::from(result.starts_with("Pass"));
        if !context.json() {
            console::line(&result);
        }
        rows.push(json);
    }
    Ok(totals(gpu, rows, passed, start.elapsed().as_secs_f64()))
}

/// The line and the JSON of one case. Only a lost device ends the run.
fn run_case(gpu: &Gpu, case: &Case) -> Result<(String, Value)> {
    let working = console::working(case.name);
    let outcome = (case.run)(gpu);
    let messages = gpu.take_validation_messages();
    drop(working);
    let name = case.name;
    Ok(match outcome {
        Err(error @ Error::Device { .. }) => return Err(error),
        Err(error) => (
            format!("Fail {name} {error}"),
            json!({ "name": name, "passed": false, "reason": error.to_string() }),
        ),
        Ok(_) if !messages.is_empty() => (
            format!("Fail {name} validation: {}", messages[0]),
            json!({ "name": name, "passed": false, "validation": messages }),
        ),
        Ok(outcome) => line(name, &outcome),
    })
}

fn line(name: &str, outcome: &Outcome) -> (String, Value) {
    let Outcome {
        error,
        limit,
        measure,
    } = outcome;
    let passed = outcome.passed();
    let word = if passed { "Pass" } else { "Fail" };
    (
        format!(
            "{word} {name} error {} limit {} {measure}",
            short(*error),
            short(*limit)
        ),
        json!({
            "name": name, "passed": passed, "error": error, "limit": limit, "measure": measure,
        }),
    )
}

/// Few digits: `0`, `0.05`, `3.1e-6`.
fn short(value: f64) -> String {
    if value == 0.0 || (1e-3..1e4).contains(&value.abs()) {
        format!("{}", (value * 1e4).round() / 1e4)
    } else {
        format!("{value:.1e}")
    }
}

fn totals(gpu: &Gpu, rows: Vec<Value>, passed: usize, seconds: f64) -> Report {
    let failed = rows.len() - passed;
    let device = &gpu.info().name;
    let text = format!("{passed} passed, {failed} failed on {device} in {seconds:.1} s\n");
    let json = json!({
        "device": device, "driver": gpu.info().driver, "passed": passed, "failed": failed,
        "seconds": seconds, "cases": rows,
    });
    let report = Report::new(text, json);
    if failed == 0 { report } else { report.failed() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_read_like_this() {
        let outcome = Outcome {
            error: 3.14e-6,
            limit: 1e-5,
            measure: "relative density",
        };
        assert_eq!(
            line("foliage.density.two_balls", &outcome).0,
            "Pass foliage.density.two_balls error 3.1e-6 limit 1.0e-5 relative density",
            "a passed case"
        );
        let nan = Outcome {
            error: f64::NAN,
            ..outcome
        };
        assert!(
            line("x", &nan).0.starts_with("Fail x error NaN"),
            "NaN never passes"
        );
        assert_eq!(
            [short(0.0), short(0.05), short(12.0)],
            ["0", "0.05", "12"],
            "short"
        );
    }
}
