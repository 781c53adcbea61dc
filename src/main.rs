//! The `plume` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(plume::cli::run(std::env::args_os(), &plume::cli::Host::Binary))
}
