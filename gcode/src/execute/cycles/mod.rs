//! Canned drilling cycles.

/// What canned cycles keep from block to block.
#[derive(Clone, Debug, Default)]
pub struct Sticky;
