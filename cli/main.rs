//! The `plume` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(plume_cli::run(std::env::args_os(), &plume_cli::Host::Binary))
}
