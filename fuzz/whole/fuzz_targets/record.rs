//! A path is smooth, or an error in words; so is a rig.
#![no_main]

use std::path::Path;

use plume_record::rig::Rig;
use plume_record::trajectory::{Trajectory, tum};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match tum::parse(text).and_then(|poses| Trajectory::through(&poses)) {
        Ok(path) => {
            let middle = path.at_ns(path.start_ns() + (path.end_ns() - path.start_ns()) / 2);
            assert!(middle.pose.translation.vector.iter().all(|along| along.is_finite()));
        }
        Err(error) => assert!(!error.to_string().is_empty() && !error.hint().is_empty()),
    }
    if let Err(error) = Rig::parse(text, Path::new("fuzz.toml")) {
        assert!(!error.to_string().is_empty() && !error.hint().is_empty());
    }
});
