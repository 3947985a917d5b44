//! The panel in a terminal: a client of the panel's own API, as anybody could write one. In: what the server
//! sends, keys, the time since the client began. Out: requests, a picture in characters.
//!
//! Nothing here reads a clock, and only [`Screen`], [`secret`] and [`Client`] touch the world.

mod client;
mod desk;
mod draw;
mod jog;
mod keys;
mod screen;
mod secret;
mod typing;
mod wanted;

pub use client::{At, Client};
pub use desk::{Act, Desk};
pub use draw::draw;
pub use jog::{Asks, BEAT, Jog, REPEATS, SILENT, Way};
pub use keys::{Does, KEYS, Key};
pub use screen::{Screen, size, width};
pub use secret::secret;
