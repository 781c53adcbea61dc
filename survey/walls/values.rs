//! Values in the current unit, or with a unit of their own.

use super::units::AngleUnit;
use crate::measure::METRES_PER_FOOT;
use plume_graph::echo::shown;

/// The foresight and the backsight of a reading such as `120/299.5`; two or more hyphens stand for a missing one.
pub(super) fn pair(word: &str) -> [Option<&str>; 2] {
    let (fore, back) = word.split_once('/').unwrap_or((word, ""));
    [fore, back].map(|word| (!word.is_empty() && !is_missing(word)).then_some(word))
}

/// Whether a value is only hyphens, at least two.
pub(super) fn is_missing(word: &str) -> bool {
    word.len() >= 2 && word.bytes().all(|byte| byte == b'-')
}

/// A length in metres: in the current unit, in metres (`7.5m`) or feet (`20f`), or in feet and inches (`12i3.5`).
pub(super) fn length_m(word: &str, unit_m: f64) -> Result<f64, String> {
    let small = word.to_ascii_lowercase();
    let length_m = if let Some((feet, inches)) = small.split_once('i') {
        let feet_m = if feet.is_empty() { Some(0.0) } else { number(feet) };
        let sign = if feet.starts_with('-') { -1.0 } else { 1.0 };
        feet_m.zip(number(inches)).map(|(feet, inches)| (feet + sign * inches / 12.0) * METRES_PER_FOOT)
    } else if let Some(metres) = small.strip_suffix('m') {
        number(metres)
    } else if let Some(feet) = small.strip_suffix('f') {
        number(feet).map(|feet| feet * METRES_PER_FOOT)
    } else {
        number(&small).map(|length| length * unit_m)
    };
    length_m.ok_or_else(|| format!("{} is not a length", shown(word)))
}

/// An angle in degrees: in the current unit, with one (`35d`, `40g`, `12p`), in degrees, minutes and seconds (`35:12:30`), or a
/// quadrant (`N35E`).
pub(super) fn angle_deg(word: &str, unit: AngleUnit) -> Result<f64, String> {
    let small = word.to_ascii_lowercase();
    let angle_deg = quadrant(&small).or_else(|| match small.as_bytes().last()? {
        b'd' => sexagesimal(&small[..small.len() - 1]),
        b'g' => Some(AngleUnit::Grads.degrees(number(&small[..small.len() - 1])?)),
        b'p' => Some(AngleUnit::Percent.degrees(number(&small[..small.len() - 1])?)),
        _ if small.contains(':') => sexagesimal(&small),
        _ => Some(unit.degrees(number(&small)?)),
    });
    angle_deg.ok_or_else(|| format!("{} is not an angle", shown(word)))
}

/// Degrees, minutes and seconds with colons between them; a missing part is 0.
fn sexagesimal(text: &str) -> Option<f64> {
    let (sign, text) = text.strip_prefix('-').map_or((1.0, text), |text| (-1.0, text));
    let parts: Vec<&str> = text.split(':').collect();
    let has_number = parts.len() <= 3 && parts.iter().any(|part| !part.is_empty());
    let part = |at: usize| match parts.get(at) {
        None | Some(&"") => Some(0.0),
        Some(part) => number(part).filter(|part| *part >= 0.0),
    };
    let degrees = part(0)? + part(1)? / 60.0 + part(2)? / 3600.0;
    has_number.then_some(sign * degrees)
}

/// A bearing such as `n35e`, which may have minutes.
fn quadrant(text: &str) -> Option<f64> {
    let (first, rest) = text.split_at_checked(1)?;
    if !matches!(first, "n" | "s" | "e" | "w") {
        return None;
    }
    let of = |side: &str| match side {
        "n" => 0.0,
        "e" => 90.0,
        "s" => 180.0,
        _ => 270.0,
    };
    if rest.is_empty() {
        return Some(of(first));
    }
    let last = rest.get(rest.len().checked_sub(1)?..)?;
    let angle_deg = sexagesimal(&rest[..rest.len() - 1]).filter(|deg| (0.0..=90.0).contains(deg))?;
    let turn = match (first, last) {
        ("n", "e") | ("e", "s") | ("s", "w") | ("w", "n") => angle_deg,
        ("n", "w") | ("w", "s") | ("s", "e") | ("e", "n") => -angle_deg,
        _ => return None,
    };
    Some((of(first) + turn + 360.0) % 360.0)
}

/// A decimal number.
pub(super) fn number(text: &str) -> Option<f64> {
    let is_plain = text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'.' | b'+' | b'-'));
    if is_plain { text.parse().ok().filter(|number: &f64| number.abs() < 1e9) } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_may_have_their_own_unit() {
        let read = |word| length_m(word, 0.3048).map(|length_m| (length_m * 1e4).round() / 1e4);
        for (word, expected_m) in
            [("10", 3.048), ("7.5m", 7.5), ("20F", 6.096), ("12i6", 3.81), ("i6", 0.1524), ("-1i6", -0.4572)]
        {
            assert_eq!(read(word), Ok(expected_m), "{word}");
        }
        for word in ["", "m", "x", "1e5", "nan", "inf", "5i", "--"] {
            assert!(read(word).is_err(), "{word}");
        }
    }

    #[test]
    fn angles_may_have_their_own_unit() {
        let read = |word| angle_deg(word, AngleUnit::Degrees).map(|deg| (deg * 1e4).round() / 1e4);
        let angles = [
            ("35", 35.0),
            ("100g", 90.0),
            ("100p", 45.0),
            ("35d", 35.0),
            ("35:30", 35.5),
            ("-35:30:36", -35.51),
            (":30", 0.5),
            ("N35E", 35.0),
            ("s45w", 225.0),
            ("n10:30w", 349.5),
            ("E", 90.0),
        ];
        for (word, expected_deg) in angles {
            assert_eq!(read(word), Ok(expected_deg), "{word}");
        }
        for word in ["", "d", ":", "n", "n95e", "n10n", "1:2:3:4", "ö", "nö", "100m", "1:-2"] {
            assert_eq!(read(word).is_ok(), word == "n", "{word}");
        }
    }

    #[test]
    fn readings_may_have_a_backsight_and_may_be_missing() {
        assert_eq!(pair("120/299.5"), [Some("120"), Some("299.5")]);
        assert_eq!(pair("--/3"), [None, Some("3")]);
        assert_eq!(pair("/3"), [None, Some("3")]);
        assert_eq!(pair("7"), [Some("7"), None]);
        assert_eq!(pair("--"), [None, None]);
    }
}
