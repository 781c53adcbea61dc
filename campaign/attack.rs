//! The interface of attacks.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::desk::Desk;
use crate::packages::Packages;
use crate::python::Python;
use crate::rng::Rng;
use crate::tally::Tally;

/// A row of the table.
pub struct Attack {
    /// Its name.
    pub name: &'static str,
    /// What it tries, in a few words.
    pub tries: &'static str,
    /// Its share of the time of a long campaign, in percent.
    pub share: u32,
    /// The attack itself.
    pub run: fn(&mut Context) -> Tally,
}

/// Everything an attack can use.
pub struct Context<'a> {
    /// The program under attack.
    pub plume: &'a Path,
    /// The repository that it was built from.
    pub repository: &'a Path,
    /// The kinds of packages that it writes without Python.
    pub packages: &'a Packages,
    /// The Python package, if it is installed.
    pub python: Option<&'a Python>,
    /// A finished small cave folder. Attacks copy it and never change it.
    pub cave: &'a Path,
    /// Scratch folder of this attack.
    pub scratch: PathBuf,
    /// Random numbers.
    pub rng: Rng,
    /// How much to try.
    pub length: Length,
}

/// How much to try.
#[derive(Clone, Copy)]
pub enum Length {
    /// The same few tries each time.
    Short,
    /// Every fixed try, then random ones until this moment.
    Long(Instant),
}

impl Length {
    /// Whether this is a long campaign.
    pub fn is_long(self) -> bool {
        matches!(self, Self::Long(_))
    }

    /// Indices of random tries: `short` of them in a short campaign; in a long one at least `least`, more if time is left.
    pub fn rounds(self, short: usize, least: usize) -> impl Iterator<Item = usize> {
        (0..).take_while(move |&round| match self {
            Self::Short => round < short,
            Self::Long(end) => round < least || Instant::now() < end,
        })
    }

    /// In a short campaign `count` of several, spread evenly from the first to the last; in a long one all.
    pub fn some_of<T: Clone>(self, several: &[T], count: usize) -> Vec<T> {
        let last = several.len().saturating_sub(1);
        match self {
            Self::Short if several.len() > count => {
                (0..count).map(|at| several[at * last / count.saturating_sub(1).max(1)].clone()).collect()
            }
            _ => several.to_vec(),
        }
    }

    /// What is left of the time of a long campaign.
    pub fn left(self) -> Duration {
        match self {
            Self::Short => Duration::ZERO,
            Self::Long(end) => end.saturating_duration_since(Instant::now()),
        }
    }
}

impl Context<'_> {
    /// An empty folder for a try.
    pub fn desk(&self) -> Desk {
        Desk::new(self.plume, &self.scratch)
    }

    /// A folder for a try, with a copy of the cave in `c`.
    pub fn desk_with_cave(&self) -> Desk {
        let desk = self.desk();
        desk.copy(self.cave, "c");
        desk
    }
}
