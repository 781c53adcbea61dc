//! A model file gives a thing, or an error in words.
#![no_main]

use plume::model::{Format, ModelError};
use plume::things::Replica;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let format = if bytes.starts_with(b"glTF") { Format::Glb } else { Format::Obj };
    // A file that a model names is itself.
    let mut beside = |_: &str| -> Result<Vec<u8>, ModelError> { Ok(bytes.to_vec()) };
    if let Err(error) = format.read(bytes, &mut beside).and_then(|model| Replica::new(model, 1.0)) {
        assert!(!error.message.is_empty() && !error.hint.is_empty());
    }
});
