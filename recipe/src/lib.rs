//! How a thread of a standard is cut. In: its name, the tool, the material, what is wished besides; mm.
//! Out: a [`Recipe`]: diameters, depth and place of every pass, speed; and that as a part program.
//!
//! ```
//! use recipe::{Dialect, Order, Recipe, Units};
//! let thread: metrology::Thread = "M20x2-6g".parse()?;
//! let recipe = Recipe::of(&thread, &Order::default())?;
//! assert_eq!(recipe.crest_mm, 19.822);
//! assert!(recipe::program(&recipe, Dialect::Linuxcnc, Units::Mm).contains("G76 P2 "));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | file | holds |
//! |---|---|
//! | `insert.rs` | the edge of a tool, from the designation of an insert |
//! | `material.rs` | cutting speeds |
//! | `force.rs` | what a pass asks of the machine |
//! | `infeed.rs` | depths of the passes, and where beside the groove each of them runs |
//! | `order.rs` | what is wished |
//! | `plan.rs` | from a thread and wishes to the numbers of a recipe |
//! | `program.rs`, `words.rs` | that as a part program; numbers and comments in a dialect |
#![forbid(unsafe_code)]

mod force;
mod infeed;
mod insert;
mod material;
mod order;
mod plan;
mod program;
mod words;

pub use infeed::{Infeed, Law};
pub use insert::{Form, Tool};
pub use material::Material;
pub use order::{Order, Sequence};
pub use plan::{Pass, Recipe, Refused};
pub use program::program;
pub use words::{Dialect, Units};
