//! The colours of limestone.

use super::super::color::palette;

palette! {
    /// Colours of limestone, as linear red, green and blue.
    LimestoneColors {
        /// The darkest of bare rock; each bed has its own shade.
        bed_dark: [0.140, 0.120, 0.095],
        /// The palest of bare rock.
        bed_pale: [0.370, 0.326, 0.260],
        /// Iron-rich bands of flowstone.
        flowstone_dark: [0.370, 0.245, 0.125],
        /// Pure bands of flowstone.
        flowstone_pale: [0.470, 0.395, 0.285],
        /// Stains of iron, in streaks.
        iron: [0.300, 0.165, 0.065],
        /// Stains of manganese.
        manganese: [0.070, 0.062, 0.055],
        /// Crusts of calcite.
        calcite: [0.520, 0.475, 0.390],
        /// Spots and worms of clay (vermiculations).
        clay: [0.120, 0.085, 0.056],
        /// Silt on ledges.
        silt: [0.200, 0.145, 0.090],
        /// Mud that high water left on the foot of the walls.
        flood_mud: [0.135, 0.092, 0.056],
        /// The darkest mud of the floor.
        mud_dark: [0.075, 0.053, 0.035],
        /// The palest mud of the floor.
        mud_pale: [0.225, 0.170, 0.118],
        /// The darkest stones of the floor.
        stone_dark: [0.085, 0.071, 0.055],
        /// The palest stones of the floor.
        stone_pale: [0.385, 0.331, 0.260],
    }
}
