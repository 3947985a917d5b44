//! Lines become blocks: words and numbers in every legal spelling, comments, parameters, expressions.

pub mod memory;
