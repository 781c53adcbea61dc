//! The colours of basalt.

use super::super::color::palette;

palette! {
    /// Colours of basalt, as linear red, green and blue.
    BasaltColors {
        /// The darkest of the lining.
        lining_dark: [0.021, 0.020, 0.020],
        /// The palest of the lining.
        lining_pale: [0.115, 0.108, 0.103],
        /// The darkest of the rock behind the lining.
        spall_dark: [0.046, 0.041, 0.038],
        /// The palest of the rock behind the lining.
        spall_pale: [0.150, 0.131, 0.115],
        /// Red oxide along flow levels and broken edges.
        oxide: [0.150, 0.052, 0.026],
        /// Streaks of ochre.
        ochre: [0.160, 0.100, 0.045],
        /// Sulphates in cracks and in hollows of the roof.
        sulphate: [0.340, 0.310, 0.260],
        /// Dust on what faces up.
        dust: [0.118, 0.104, 0.090],
        /// The darkest ash of the floor.
        ash_dark: [0.023, 0.021, 0.020],
        /// The palest ash of the floor.
        ash_pale: [0.112, 0.097, 0.085],
        /// The darkest slabs and ropes of the floor.
        stone_dark: [0.027, 0.026, 0.026],
        /// The palest slabs and ropes of the floor.
        stone_pale: [0.175, 0.153, 0.134],
    }
}
