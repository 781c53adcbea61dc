//! File names that Windows reserves for devices.

/// Whether Windows takes this name for a device, whatever its extension and case.
pub fn is_device_name(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default().trim_end().to_ascii_lowercase();
    match stem.as_str() {
        "con" | "prn" | "aux" | "nul" | "conin$" | "conout$" => true,
        stem => stem.strip_prefix("com").or(stem.strip_prefix("lpt")).is_some_and(is_digit),
    }
}

/// Windows accepts superscripts as digits here.
fn is_digit(text: &str) -> bool {
    let mut letters = text.chars();
    letters.next().is_some_and(|letter| letter.is_ascii_digit() || "¹²³".contains(letter)) && letters.next().is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn devices_are_recognized_with_any_extension_and_case() {
        for name in ["con", "NUL", "Aux.tar.gz", "com1", "LPT9.txt", "prn ", "com²"] {
            assert!(is_device_name(name), "{name}");
        }
        for name in ["cone", "console", "com", "com10", "lpt", "null", "con_1", "my.con", "", "c"] {
            assert!(!is_device_name(name), "{name}");
        }
    }
}
