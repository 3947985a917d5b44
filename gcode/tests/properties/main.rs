//! What holds for any block that is accepted: none of its words is ignored, its spelling and the order of its
//! words do not matter, and its codes are executed in the order that the language says. And what holds for
//! any program: it ends.

mod blocks;
mod limits;
mod order;
mod spelling;
mod words;
