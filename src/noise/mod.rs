//! Noise over space, in lanes.
