//! What holds for any block that is accepted: none of its words is ignored, its spelling and the order of its words do not
//! matter, and its codes are executed in the order that the language says.

mod blocks;
mod order;
mod spelling;
mod words;
