//! Settings as written in both formats: the words after a command.

use super::{Dialect, Instruments, Order, Quantity, Reading, Style, Unit};
use plume_graph::echo::shown;

/// Parses a number.
type Number<'a> = &'a dyn Fn(&str) -> Option<f64>;

impl Order {
    /// The words after `data`: `<style> <column>…`, or `default`.
    pub(in super::super) fn read(words: &[&str]) -> Result<Self, String> {
        let Some((style, columns)) = words.split_first() else { return Err("the data style is missing".to_owned()) };
        if style.eq_ignore_ascii_case("default") {
            return Ok(Self::default());
        }
        let style = Style::named(style).ok_or_else(|| format!("{} is not a data style", shown(style)))?;
        let column = |word: &&str| Reading::named(word).ok_or_else(|| format!("{} is not a reading", shown(word)));
        let columns: Result<Vec<Reading>, String> = columns.iter().map(column).collect();
        Self::new(style, &columns?)
    }
}

impl Instruments {
    /// Executes `units`, `calibrate`, `sd`, `declination` or `infer`.
    pub(in super::super) fn obey(&mut self, command: &str, words: &[&str], number: Number) -> Result<(), String> {
        match command {
            "units" => self.read_units(words, number),
            "calibrate" => self.read_calibration(words, number),
            "sd" => self.read_spread(words, number),
            "declination" => self.read_declination(words, number),
            "infer" => self.infer(words),
            _ => Err(format!("`{command}` is not a setting")),
        }
    }

    /// `units <quantities> [<factor>] <unit>`
    fn read_units(&mut self, words: &[&str], number: Number) -> Result<(), String> {
        if is_default(words) {
            self.reset_units();
            return Ok(());
        }
        let (quantities, rest) = self.quantities(words)?;
        let (factor, unit) = match rest {
            [unit] => (1.0, unit),
            [factor, unit] => (some(factor, number)?, unit),
            _ => return Err("a unit is an optional factor and a name".to_owned()),
        };
        self.set_unit(&quantities, factor, named_unit(unit)?)
    }

    /// `calibrate <quantities> <zero error> [<unit>] [<scale>]`
    fn read_calibration(&mut self, words: &[&str], number: Number) -> Result<(), String> {
        if is_default(words) {
            self.reset_calibration();
            return Ok(());
        }
        let (quantities, rest) = self.quantities(words)?;
        let [zero, rest @ ..] = rest else { return Err("the zero error is missing".to_owned()) };
        let zero = some(zero, number)?;
        let (unit, rest) = match rest {
            [word, rest @ ..] if Unit::named(word).is_some() => (Unit::named(word), rest),
            rest => (None, rest),
        };
        let scale = match rest {
            [] => 1.0,
            [scale] => some(scale, number)?,
            _ => return Err("a calibration is a zero error and an optional scale".to_owned()),
        };
        self.calibrate(&quantities, zero, unit, scale)
    }

    /// `sd <quantities> <standard deviation> <unit>`
    fn read_spread(&mut self, words: &[&str], number: Number) -> Result<(), String> {
        let (quantities, rest) = self.quantities(words)?;
        let [spread, unit] = rest else { return Err("a standard deviation is a number and its unit".to_owned()) };
        self.set_spread(&quantities, some(spread, number)?, named_unit(unit)?)
    }

    /// `declination <angle> <unit>`
    fn read_declination(&mut self, words: &[&str], number: Number) -> Result<(), String> {
        match words {
            [auto, ..] if auto.eq_ignore_ascii_case("auto") => {
                Err("`declination auto` needs a model of the earth's magnetic field".to_owned())
            }
            [declination, unit] => {
                let Unit::Angle(factor) = named_unit(unit)? else {
                    return Err(format!("{} is not an angle", shown(unit)));
                };
                self.set_declination_rad(some(declination, number)? * factor);
                Ok(())
            }
            _ => Err("a declination is an angle and its unit".to_owned()),
        }
    }

    /// The quantities at the start of a command, and the rest.
    fn quantities<'a, 'b>(&self, words: &'a [&'b str]) -> Result<(Vec<Quantity>, &'a [&'b str]), String> {
        let mut quantities: Vec<Quantity> = words.iter().map_while(|word| Quantity::named(word)).collect();
        if quantities.is_empty() {
            let found = words.first().copied().unwrap_or_default();
            return Err(format!("{} is not a quantity", shown(found)));
        }
        let rest = &words[quantities.len()..];
        if self.dialect == Dialect::Therion {
            let backs: Vec<Quantity> = quantities.iter().filter_map(|quantity| quantity.back()).collect();
            quantities.extend(backs);
        }
        Ok((quantities, rest))
    }

    /// `infer <what> on|off`
    fn infer(&mut self, words: &[&str]) -> Result<(), String> {
        let &[what, switch] = words else { return Err("`infer` takes what to infer, and on or off".to_owned()) };
        let on = match switch.to_ascii_lowercase().as_str() {
            "on" => true,
            "off" => false,
            _ => return Err("`infer` must be on or off".to_owned()),
        };
        match what.to_ascii_lowercase().as_str() {
            "plumbs" => self.infer_plumbs = on,
            "equates" => self.infer_equates = on,
            "exports" => {}
            _ => return Err(format!("{} cannot be inferred", shown(what))),
        }
        Ok(())
    }
}

fn is_default(words: &[&str]) -> bool {
    words.len() == 1 && words[0].eq_ignore_ascii_case("default")
}

fn named_unit(word: &str) -> Result<Unit, String> {
    Unit::named(word).ok_or_else(|| format!("{} is not a unit", shown(word)))
}

fn some(word: &str, number: Number) -> Result<f64, String> {
    number(word).ok_or_else(|| format!("{} is not a number", shown(word)))
}
