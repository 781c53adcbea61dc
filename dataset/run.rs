//! Makes a whole dataset: the caves that are missing, then the files that describe them.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use plume::cave::CaveError;
use plume::pipeline::Observer;

use crate::engine::{Engine, Reply};
use crate::finish::{Outcome, finish, record_costs};
use crate::folder::Folder;
use crate::item;
use crate::plan::Plan;

/// Follows the making of a dataset.
pub trait Watch: Observer {
    /// So many caves are to be made, of which some are done.
    fn begin_caves(&self, all: usize, done: usize);
    /// A cave is done, or could not be made.
    fn cave_done(&self, reply: &Reply);
    /// No more caves are made.
    fn end_caves(&self);
}

/// Makes the caves that are missing in the folder `root`; then index, card, sheet and sums. After an interruption it resumes
/// where it stopped.
///
/// # Errors
/// A faulty recipe; if another run works in the folder, it holds something else, the disk fails, or work was stopped.
pub fn run(plan: &Plan, root: &Path, engine: &dyn Engine, watch: &dyn Watch) -> Result<Outcome, CaveError> {
    plan.verify()?;
    let folder = Folder::open(root, plan)?;
    let missing: Vec<usize> = (0..plan.len()).filter(|number| !folder.has(*number)).collect();
    let replies = Mutex::new(Vec::new());
    let on_reply = |reply: Reply| {
        watch.cave_done(&reply);
        replies.lock().unwrap_or_else(PoisonError::into_inner).push(reply);
    };
    watch.begin_caves(plan.len(), plan.len() - missing.len());
    let made = match missing.as_slice() {
        [] => Ok(()),
        missing => engine.make(plan, missing, root, watch.stop(), &on_reply),
    };
    watch.end_caves();
    // What workers that were killed have left.
    plume_disk::sweep(&item::work_folder(root));
    let _ = std::fs::remove_dir(item::work_folder(root));
    let mut replies = replies.into_inner().unwrap_or_else(PoisonError::into_inner);
    replies.sort_by_key(|reply| reply.item);
    record_costs(&folder, &replies)?;
    made?;
    let faults: BTreeMap<usize, String> =
        replies.iter().filter_map(|reply| Some((reply.item, reply.fault.clone()?))).collect();
    let outcome = finish(plan, &folder, &faults, watch)?;
    Ok(Outcome { made: replies.len() - faults.len(), cpu_s: replies.iter().map(|reply| reply.cpu_s).sum(), ..outcome })
}
