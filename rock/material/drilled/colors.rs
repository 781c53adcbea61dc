//! The colours of the rock of a mine.

use super::super::color::palette;

palette! {
    /// Colours of the rock of a mine, as linear red, green and blue.
    DrilledColors {
        /// The darkest granite.
        granite_dark: [0.130, 0.128, 0.124],
        /// The palest granite.
        granite_pale: [0.300, 0.285, 0.270],
        /// Crystals of feldspar in granite.
        granite_feldspar: [0.420, 0.370, 0.335],
        /// Crystals of mica in granite.
        granite_mica: [0.045, 0.043, 0.042],
        /// Veins in granite.
        granite_vein: [0.470, 0.440, 0.410],
        /// The darkest host rock of ore.
        ore_dark: [0.060, 0.060, 0.062],
        /// The palest host rock of ore.
        ore_pale: [0.165, 0.160, 0.158],
        /// Sulphides of ore.
        ore_sulphide: [0.260, 0.150, 0.055],
        /// Veins of quartz in ore.
        ore_quartz: [0.540, 0.520, 0.490],
        /// The dullest coal.
        coal_dark: [0.012, 0.012, 0.013],
        /// The brightest coal.
        coal_pale: [0.048, 0.047, 0.047],
        /// The darkest mudstone between coal.
        mudstone_dark: [0.085, 0.080, 0.074],
        /// The palest mudstone between coal.
        mudstone_pale: [0.185, 0.172, 0.158],
        /// Streaks of rust.
        rust: [0.190, 0.085, 0.032],
        /// Crusts of lime.
        lime: [0.430, 0.410, 0.375],
        /// The darkest dust and mud.
        fines_dark: [0.062, 0.055, 0.048],
        /// The palest dust and mud.
        fines_pale: [0.160, 0.146, 0.130],
    }
}
