//! Colours of paper, ink and elevations.

/// Colour theme of maps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Theme {
    /// White paper.
    #[default]
    Light,
    /// A dark screen.
    Dark,
}

/// The colours of a theme, in SVG notation.
pub struct Palette {
    /// Behind everything.
    pub paper: &'static str,
    /// Text and marks.
    pub ink: &'static str,
    /// Secondary text.
    pub faint: &'static str,
    /// Grid lines of heights.
    pub grid: &'static str,
    /// Passages of other storeys.
    pub ghost: &'static str,
    /// Outlines of passages.
    pub wall: &'static str,
}

static LIGHT: Palette =
    Palette { paper: "#ffffff", ink: "#1b1f24", faint: "#5b6470", grid: "#e3e7ec", ghost: "#e3e7ec", wall: "#30363d" };

static DARK: Palette =
    Palette { paper: "#14171c", ink: "#e8ebef", faint: "#9aa4b2", grid: "#272d36", ghost: "#2a313b", wall: "#b4bcc8" };

impl Theme {
    /// Its colours.
    pub fn palette(self) -> &'static Palette {
        match self {
            Self::Light => &LIGHT,
            Self::Dark => &DARK,
        }
    }
}

/// The colours of [`elevation_color`], low to high: viridis of matplotlib (CC0), perceptually uniform, also for colour-blind
/// people.
pub static VIRIDIS: [u32; 32] = [
    0x44_01_54, 0x46_0c_5f, 0x47_18_6a, 0x48_22_73, 0x46_2d_7c, 0x44_37_81, 0x41_41_86, 0x3d_4a_89, 0x39_54_8b,
    0x35_5c_8c, 0x31_64_8d, 0x2e_6c_8e, 0x2a_75_8e, 0x27_7c_8e, 0x24_84_8d, 0x22_8b_8d, 0x1f_94_8b, 0x1e_9b_89,
    0x1f_a3_86, 0x24_aa_82, 0x2e_b2_7c, 0x39_b9_76, 0x47_c0_6e, 0x57_c6_65, 0x6b_cd_59, 0x7e_d2_4e, 0x92_d7_41,
    0xa7_db_33, 0xbf_df_24, 0xd4_e1_1a, 0xe9_e4_19, 0xfd_e7_24,
];

/// The class of [`VIRIDIS`] for a relative height.
pub fn elevation_class(share: f64) -> usize {
    ((share * VIRIDIS.len() as f64) as usize).min(VIRIDIS.len() - 1)
}

/// The colour of a class, in SVG notation.
pub fn class_color(class: usize) -> String {
    format!("#{:06x}", VIRIDIS[class])
}
