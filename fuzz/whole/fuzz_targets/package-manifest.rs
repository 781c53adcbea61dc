//! A manifest survives a round trip. It is sealed here, as an attacker could do, too.
#![no_main]

use plume_disk::sealed;
use plume_exporters::manifest::Manifest;

libfuzzer_sys::fuzz_target!(|text: &str| match Manifest::from_text(sealed::seal(text).as_bytes()) {
    Ok(manifest) => {
        let text = manifest.to_text().expect("it is a manifest");
        assert_eq!(Manifest::from_text(text.as_bytes()).as_ref(), Ok(&manifest));
    }
    Err(what) => assert!(!what.is_empty()),
});
