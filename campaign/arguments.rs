//! Command-line arguments of the campaign.

use std::path::{Path, PathBuf};

/// The seed of all random numbers, unless another is given.
const SEED: u64 = 13;

/// Arguments of the campaign.
pub struct Arguments {
    /// The program under attack.
    pub plume: PathBuf,
    /// The repository that it was built from.
    pub repository: PathBuf,
    /// How long a long campaign takes; a short one has none.
    pub minutes: Option<f64>,
    /// The seed of all random numbers.
    pub seed: u64,
    /// Number of attacks that run in parallel.
    pub jobs: usize,
    /// The attacks to run; none means all.
    chosen: Vec<String>,
}

impl Arguments {
    /// Reads `PLUME REPOSITORY [--minutes N] [--seed N] [--jobs N] [ATTACK…]`.
    pub fn read(words: impl Iterator<Item = String>) -> Result<Self, String> {
        let (mut words, mut free) = (words, Vec::new());
        let (mut minutes, mut seed) = (None, SEED);
        let mut jobs = std::thread::available_parallelism().map_or(1, usize::from);
        while let Some(word) = words.next() {
            match word.as_str() {
                "--minutes" => minutes = Some(number(&word, words.next())?),
                "--seed" => seed = number(&word, words.next())?,
                "--jobs" => jobs = number(&word, words.next())?,
                option if option.starts_with("--") => return Err(format!("there is no option {option}")),
                _ => free.push(word),
            }
        }
        let (Some(plume), Some(repository)) = (free.first(), free.get(1)) else {
            return Err("name the program and the repository".to_owned());
        };
        let (plume, repository) = (absolute(plume)?, absolute(repository)?);
        if minutes.is_some_and(|minutes: f64| !(0.0..=1e5).contains(&minutes)) {
            return Err("--minutes has to be a number of minutes".to_owned());
        }
        let chosen = free.split_off(2);
        let known = |name: &&String| !crate::attacks::ATTACKS.iter().any(|attack| attack.name == **name);
        match chosen.iter().find(known) {
            Some(name) => Err(format!("there is no attack `{name}`")),
            None => Ok(Self { plume, repository, minutes, seed, jobs: jobs.max(1), chosen }),
        }
    }

    /// Whether an attack is to be run.
    pub fn wants(&self, name: &str) -> bool {
        self.chosen.is_empty() || self.chosen.iter().any(|chosen| chosen == name)
    }
}

fn absolute(path: &str) -> Result<PathBuf, String> {
    Path::new(path).canonicalize().map_err(|error| format!("{path}: {error}"))
}

fn number<T: std::str::FromStr>(option: &str, word: Option<String>) -> Result<T, String> {
    word.and_then(|word| word.parse().ok()).ok_or_else(|| format!("{option} takes a number"))
}
