//! What the rock looks like, in shape and colour.
