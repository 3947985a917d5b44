//! Laws of motion under random parameters: limits kept, joints continuous, target reached, time reversible.

#[path = "properties/blend.rs"]
mod blend;
#[path = "properties/draw.rs"]
mod draw;
#[path = "properties/feed.rs"]
mod feed;
#[path = "properties/path.rs"]
mod path;
#[path = "properties/piece.rs"]
mod piece;
#[path = "properties/ramp.rs"]
mod ramp;
#[path = "properties/stroke.rs"]
mod stroke;
