//! sRGB (IEC 61966-2-1), and linear light to 8-bit codes of it by table, exactly rounded.

/// Number of buckets of linear light, enough that none contains two code steps.
const BUCKETS: usize = 4096;

/// The table.
pub struct SrgbTable {
    /// Code at the start of each bucket.
    codes: Vec<u8>,
    /// Minimum linear value of each code.
    thresholds: [f32; 257],
}

impl Default for SrgbTable {
    fn default() -> Self {
        let mut thresholds = [f32::INFINITY; 257];
        thresholds[0] = 0.0;
        for (code, threshold) in thresholds.iter_mut().enumerate().take(256).skip(1) {
            *threshold = linear((code as f64 - 0.5) / 255.0) as f32;
        }
        let code_at = |value: f32| (thresholds.partition_point(|&t| t <= value) - 1) as u8;
        let codes = (0..=BUCKETS).map(|k| code_at(k as f32 / BUCKETS as f32)).collect();
        Self { codes, thresholds }
    }
}

impl SrgbTable {
    /// The code of a linear value, clamped to 0–1.
    #[inline]
    pub fn encode(&self, value: f32) -> u8 {
        let value = value.clamp(0.0, 1.0);
        let code = self.codes[(value * BUCKETS as f32) as usize];
        code + u8::from(value >= self.thresholds[usize::from(code) + 1])
    }
}

/// The linear value of an sRGB value, both in 0–1.
pub fn linear(value: f64) -> f64 {
    if value <= 0.040_45 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_survives_the_round_trip() {
        let table = SrgbTable::default();
        for code in 0..=255_u8 {
            assert_eq!(table.encode(linear(f64::from(code) / 255.0) as f32), code);
        }
    }

    #[test]
    fn the_table_matches_the_definition() {
        let table = SrgbTable::default();
        for k in 0..=100_000 {
            let value = k as f32 / 100_000.0;
            let defined = (table.thresholds.partition_point(|&t| t <= value) - 1) as u8;
            assert_eq!(table.encode(value), defined, "{value}");
        }
        assert_eq!([table.encode(-1.0), table.encode(2.0), table.encode(f32::NAN)], [0, 255, 0]);
    }
}
