//! A hostile archive is checked without harm. The first byte selects its claimed kind.
#![no_main]

use std::fs;

use plume_exporters::check::check;

const ENDINGS: [&str; 4] = ["zip", "mjz", "tar.zst", "tgz"];

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Some((&first, content)) = bytes.split_first() else { return };
    let folder = tempfile::tempdir().expect("a folder can be made");
    let path = folder.path().join("package").with_extension(ENDINGS[usize::from(first) % ENDINGS.len()]);
    fs::write(&path, content).expect("a file can be written");
    if let Ok(report) = check(&path) {
        assert!(report.faults.iter().all(|fault| !fault.what.is_empty()));
    }
});
