//! A recipe that is taken is one when it is written again.
#![no_main]

use std::path::Path;

use plume::recipe::Recipe;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match Recipe::from_toml(text, Path::new("fuzz.toml"), &[]) {
        Ok(recipe) => {
            let again = Recipe::from_toml(&recipe.to_toml(), Path::new("again.toml"), &[]).expect("it is a recipe");
            assert_eq!(recipe.to_json(), again.to_json());
        }
        Err(faults) => assert!(!faults.to_string().is_empty()),
    }
});
