//! From the command line to an exit code.

use std::ffi::OsString;
use std::process::ExitCode;

use clap::Parser as _;
use clap::error::ErrorKind;

use super::cli::{Cli, Command};
use super::{Context, Report, command, console, output, tradeoff};
use crate::Result;

/// Exit code of a usage error, the same as that of wrong input.
const USAGE: u8 = 2;

/// Runs the program with `arguments` (the program's name first) and says how it went.
///
/// 0: done. 1: a check failed (`conform`, or a message under `--validate`). 2: wrong usage or input, with one line on stderr and
/// no output file. 3: the device failed.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) => return usage(&error),
    };
    console::install(cli.global.verbosity());
    output::remove_on_interrupt();
    let context = Context::new(cli.global);
    let ran = dispatch(&context, &cli.command).and_then(|report| {
        report.print(context.json())?;
        Ok(report.succeeded())
    });
    let messages = context.validation_messages();
    for message in &messages {
        console::error(message);
    }
    match ran {
        Ok(succeeded) if succeeded && messages.is_empty() => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            console::error(&error);
            ExitCode::from(error.exit_code())
        }
    }
}

fn dispatch(context: &Context, command: &Command) -> Result<Report> {
    let computes = !matches!(
        command,
        Command::Grow(_) | Command::Settings(_) | Command::Style(_) | Command::Ink(_)
    );
    if computes {
        context.check_device()?;
    }
    match command {
        Command::Render(args) => command::render::run(context, args),
        Command::Bake(args) => command::bake::run(context, args),
        Command::Surface(args) => command::surface::run(context, args),
        Command::Light(args) => command::light::run(context, args),
        Command::Grow(args) => command::grow::run(context, args),
        Command::Ink(args) => command::ink::run(context, args),
        Command::Bench(args) => command::bench::run(context, args),
        Command::Conform(args) => command::conform::run(context, args),
        Command::Leaf(args) => command::leaf::run(context, args),
        Command::Info(args) => command::info::run(context, args),
        Command::Settings(args) => command::settings::run(context, args),
        Command::Style(args) => command::style::run(context, args),
        Command::Tradeoff(args) => tradeoff::run(context, args),
    }
}

/// Prints help in full, and any other message of the parser as one line.
fn usage(error: &clap::Error) -> ExitCode {
    if matches!(
        error.kind(),
        ErrorKind::DisplayHelp
            | ErrorKind::DisplayVersion
            | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
    ) {
        // A closed pipe (`umbrage --help | head -1`) is the reader's choice, not a failure.
        let _ = error.print();
        return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(USAGE));
    }
    console::error(&message(error));
    ExitCode::from(USAGE)
}

/// What the parser says, as one line.
pub(super) fn message(error: &clap::Error) -> String {
    let text = error.to_string();
    let message: Vec<&str> = text
        .lines()
        .map(str::trim)
        .take_while(|line| {
            !["Usage:", "For more", "tip:"]
                .iter()
                .any(|end| line.starts_with(end))
        })
        .filter(|line| !line.is_empty())
        .collect();
    let message = message.join(" ");
    message
        .strip_prefix("error: ")
        .unwrap_or(&message)
        .to_owned()
}
