//! The colours of rock salt.

use super::super::color::palette;

palette! {
    /// Colours of rock salt, as linear red, green and blue.
    SaltColors {
        /// The darkest bands.
        band_dark: [0.255, 0.248, 0.240],
        /// The palest bands.
        band_pale: [0.590, 0.570, 0.540],
        /// Bands that iron colours.
        iron_band: [0.430, 0.245, 0.140],
        /// Seams of clay and anhydrite between bands.
        clay_seam: [0.105, 0.100, 0.095],
        /// Crusts of salt that has crystallised anew.
        crust: [0.660, 0.640, 0.610],
        /// The darkest crushed salt, on the floor and on ledges.
        crushed_dark: [0.210, 0.199, 0.185],
        /// The palest crushed salt.
        crushed_pale: [0.480, 0.460, 0.430],
        /// The darkest lumps of the floor.
        lump_dark: [0.170, 0.145, 0.118],
        /// The palest lumps of the floor.
        lump_pale: [0.680, 0.660, 0.630],
    }
}
