//! The program as a user runs it: help, exit codes, one-line errors, no half-written files.

use std::process::{Command, Output};

/// Every command of the program.
const COMMANDS: &[&str] = &["conform"];

/// Runs the program.
fn umbrage(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_umbrage"))
        .args(arguments)
        .output()
        .expect("the program starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Exit code 2 and exactly one line on stderr, which contains every one of `words`.
fn assert_refused(arguments: &[&str], words: &[&str]) {
    let output = umbrage(arguments);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
    assert_eq!(text.lines().count(), 1, "{arguments:?}: one line: {text}");
    assert!(text.starts_with("umbrage: "), "{arguments:?}: {text}");
    for word in words {
        assert!(text.contains(word), "{arguments:?}: {word:?} in {text}");
    }
}

#[test]
fn help_names_every_command_and_gives_examples() {
    let output = umbrage(&["--help"]);
    assert_eq!(output.status.code(), Some(0), "help succeeds");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    for command in COMMANDS {
        assert!(
            text.contains(&format!("\n  {command} ")),
            "{command} in {text}"
        );
        let help = umbrage(&[command, "--help"]);
        let help = String::from_utf8_lossy(&help.stdout).into_owned();
        assert!(
            help.contains(&format!("umbrage {command}")),
            "example in {help}"
        );
    }
}

#[test]
fn wrong_usage_is_one_line_and_exit_code_2() {
    assert_refused(&["paint"], &["paint"]);
    assert_refused(&["conform", "--sizzle"], &["--sizzle"]);
    assert_refused(&["conform", "no.such.case"], &["no.such.case"]);
}
