//! Laws of motion under random parameters: limits kept, joints continuous, target reached, time reversible.

mod blend;
mod draw;
mod feed;
mod path;
mod piece;
mod ramp;
mod stroke;
