//! Bakes any [`crate::field::Surface`] over any chunk.
