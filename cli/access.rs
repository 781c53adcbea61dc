//! What a command may use: threads, the programs of recipes, files from outside the folder of a survey. Commands have only the
//! options that do something there.

use clap::Args;

/// What a command may use.
#[derive(Clone, Copy, Debug, Default)]
pub struct Access {
    /// Number of threads; all cores if `None`.
    pub threads: Option<u16>,
    /// Whether recipes may run programs.
    pub programs: bool,
    /// Whether surveys may include files from outside their own folder.
    pub outside_files: bool,
}

/// The option of commands that compute.
#[derive(Args, Clone, Copy)]
pub struct Threads {
    /// Number of threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// The option of commands that read surveys.
#[derive(Args, Clone, Copy)]
pub struct Outside {
    /// Allow surveys to include files from outside their own folder
    #[arg(long)]
    allow_outside: bool,
}

/// The options of commands that make caves.
#[derive(Args, Clone, Copy)]
pub struct Making {
    #[command(flatten)]
    threads: Threads,
    /// Allow recipes to run programs, as the generator `external` does
    #[arg(long)]
    allow_run: bool,
    #[command(flatten)]
    outside: Outside,
}

impl From<Threads> for Access {
    fn from(Threads { threads }: Threads) -> Self {
        Self { threads, ..Self::default() }
    }
}

impl From<Outside> for Access {
    fn from(Outside { allow_outside }: Outside) -> Self {
        Self { outside_files: allow_outside, ..Self::default() }
    }
}

impl From<Making> for Access {
    fn from(Making { threads, allow_run, outside }: Making) -> Self {
        Self { threads: threads.threads, programs: allow_run, outside_files: outside.allow_outside }
    }
}
