//! Makes a whole dataset: the caves that are missing, then what stands at the top.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use plume::cave::CaveError;
use plume::pipeline::Observer;

use crate::finish::{Outcome, finish, note_costs};
use crate::folder::Folder;
use crate::item;
use crate::local::{self, Answer, Worker};
use crate::plan::Plan;

/// Follows the making of a dataset.
pub trait Watch: Observer {
    /// So many caves are to be made, of which some are done.
    fn begin_caves(&self, all: usize, done: usize);
    /// A cave is done, or could not be made.
    fn heard(&self, answer: &Answer);
    /// No more caves are made.
    fn end_caves(&self);
}

/// Makes the caves that are missing in the folder of the worker by so many of them; then index, card, sheet and sums.
/// After an interruption it goes on where it was stopped.
///
/// # Errors
/// A faulty recipe; if another run works in the folder, it holds something else, the disk fails, or work was stopped.
pub fn run(plan: &Plan, worker: &Worker, workers: usize, watch: &dyn Watch) -> Result<Outcome, CaveError> {
    let root = worker.root.as_path();
    plan.verify()?;
    let folder = Folder::open(root, plan)?;
    let missing: Vec<usize> = (0..plan.len()).filter(|number| !folder.has(*number)).collect();
    let answers = Mutex::new(Vec::new());
    let hear = |answer: Answer| {
        watch.heard(&answer);
        answers.lock().unwrap_or_else(PoisonError::into_inner).push(answer);
    };
    watch.begin_caves(plan.len(), plan.len() - missing.len());
    let asked = local::ask(&missing, workers.min(missing.len()), || worker.command(), watch.stop(), &hear);
    watch.end_caves();
    // What workers that were killed have left.
    plume_disk::sweep(&item::workshop(root));
    let _ = std::fs::remove_dir(item::workshop(root));
    let mut answers = answers.into_inner().unwrap_or_else(PoisonError::into_inner);
    answers.sort_by_key(|answer| answer.item);
    note_costs(&folder, &answers)?;
    asked?;
    let faults: BTreeMap<usize, String> =
        answers.iter().filter_map(|answer| Some((answer.item, answer.fault.clone()?))).collect();
    let outcome = finish(plan, &folder, &faults, watch)?;
    Ok(Outcome {
        made: answers.len() - faults.len(),
        cpu_s: answers.iter().map(|answer| answer.cpu_s).sum(),
        ..outcome
    })
}
