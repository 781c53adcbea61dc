//! One seed, many independent streams.
//!
//! Every consumer of randomness names its stream, so a new consumer does not affect other streams, and attempt `k` of a
//! stage never depends on attempt `k - 1`. The generator is PCG-XSL-RR 128/64 (O'Neill 2014), whose output is fixed by its
//! definition: the same on every platform and in every version of `rand_pcg`.
//!
//! ```
//! use plume_graph::rng::Rng;
//! use plume_graph::seed::stream;
//!
//! let draw = |name, attempt| Rng::new(stream(7, name, attempt)).unit();
//! assert_eq!(draw("lamps", 0), draw("lamps", 0));
//! assert_ne!(draw("lamps", 0), draw("lamps", 1));
//! assert_ne!(draw("lamps", 0), draw("spawns", 0));
//! ```

use rand_pcg::Pcg64;
use sha2::{Digest, Sha256};

/// The stream called `name` for this `seed`; `index` is a counter, such as that of attempts.
pub fn stream(seed: u64, name: &str, index: u64) -> Pcg64 {
    let digest = digest(seed, name, index);
    let word = |at: usize| u128::from_le_bytes(digest[at..at + 16].try_into().expect("16 bytes"));
    Pcg64::new(word(0), word(16))
}

/// A 32-bit salt for hash-based noise, from the same naming scheme.
pub fn salt(seed: u64, name: &str) -> u32 {
    u32::from_le_bytes(digest(seed, name, 0)[..4].try_into().expect("4 bytes"))
}

fn digest(seed: u64, name: &str, index: u64) -> [u8; 32] {
    let mut hash = Sha256::new();
    hash.update(seed.to_le_bytes());
    hash.update(index.to_le_bytes());
    hash.update(name.as_bytes());
    hash.finalize().into()
}
