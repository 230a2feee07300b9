//! The `umbrage` program: everything is in the library's `app` room.

use std::process::ExitCode;

fn main() -> ExitCode {
    umbrage::app::run(std::env::args_os())
}
