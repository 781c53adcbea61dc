//! Threads with a stack of a stated size.
//!
//! The vectorised noise is inlined through rock and field. A compiler that optimises gives its thousands of
//! values the same place on the stack, but one that does not, as in the dev profile of other programs, gives each a place of its
//! own: more than the 2 MiB that threads have by default. Whatever evaluates a rock on several threads belongs in here.

/// The stack of a thread; chosen: eight times the default. The system gives memory only to what is used of it.
const STACK_BYTES: usize = 16 << 20;

/// Runs `work` on as many threads as the caller has, or on those of the caller if the system refuses to start more.
pub fn with_large_stacks<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(rayon::current_num_threads()).stack_size(STACK_BYTES);
    match pool.build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(),
    }
}
