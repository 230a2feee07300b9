//! The program as a user runs it: help, exit codes, one-line errors, no half-written files.

use serde_json::json;

use crate::place::{Place, stdout};
use crate::small_model::{SmallModel, small_tree};

/// Every command of the program.
const COMMANDS: &[&str] = &["info", "conform", "settings"];

#[test]
fn help_names_every_command_and_gives_examples() {
    let place = Place::new();
    let help = stdout(&place.umbrage(&["--help"]));
    for command in COMMANDS {
        assert!(
            help.contains(&format!("\n  {command} ")),
            "{command} in {help}"
        );
        let output = place.umbrage(&[command, "--help"]);
        assert_eq!(output.status.code(), Some(0), "{command} --help");
        let text = stdout(&output);
        assert!(
            text.contains("\nExamples:\n"),
            "{command}: examples in {text}"
        );
        assert!(
            text.contains(&format!("\n  umbrage {command}")),
            "{command}: {text}"
        );
        assert!(
            text.contains("--device"),
            "{command}: global options in {text}"
        );
    }
}

#[test]
fn wrong_usage_is_one_line_and_exit_code_2() {
    let place = Place::new();
    place.assert_refused(&["paint"], &["paint"]);
    place.assert_refused(&["conform", "--sizzle"], &["--sizzle"]);
    place.assert_refused(&["conform", "no.such.case"], &["no.such.case"]);
    place.assert_refused(&["settings", "no-such-setting"], &["no-such-setting"]);
    place.assert_refused(&["--device", "no such device", "info"], &["no such device"]);
}

#[test]
fn info_tells_facts_and_plan() {
    let place = Place::new();
    let tree = place.write("tree.glb", small_tree().glb());
    let info = place.json(&["info", &tree]);
    assert_eq!(info["model"]["vertices"], 11, "{info:#}");
    assert_eq!(info["model"]["triangles"], 5, "{info:#}");
    assert_eq!(info["model"]["foliage"]["vertices"], 8, "{info:#}");
    assert_eq!(info["model"]["materials"][0]["foliage"], true, "{info:#}");
    let bytes = |arguments: &[&str]| {
        let plan = place.json(&[&["info", tree.as_str()], arguments].concat());
        plan["plan"]["bytes"].as_u64().unwrap()
    };
    let whole = bytes(&[]);
    assert!(
        bytes(&["--shadows", "off"]) < whole,
        "no shadow map without shadows"
    );
    assert!(bytes(&["--samples", "1"]) < whole, "less with one sample");
}
