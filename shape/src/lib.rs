//! What is cut, as functions of a parameter: formulas, surfaces under a tool, seams on a positioner. Pure mathematics,
//! no state of the machine, no I/O.
//!
//! | part | holds | equations |
//! |---|---|---|
//! | [`Formula`] | an expression as a short program, evaluated for numbers, series and gradients | – |
//! | [`Contour`], [`Surface`] | where a tool touches a formula, and where it stands then | – |
//! | [`Seam`] | position and direction along a seam | – |
//! | [`Positioner`] | which drives bring a seam under the beam, and how far errors of drives move it | M46–M52 |
//! | [`Correction`] | feed ratios of followers to their master | M36–M43 |
//!
//! Nothing allocates after it was made, and every evaluation has a bounded cost.
#![forbid(unsafe_code)]

mod contour;
mod curve;
mod formula;
mod number;
mod positioner;
mod seam;
mod series;
mod shaping;
mod surface;

pub use contour::{Contour, Side};
pub use curve::{Curve, Point};
pub use formula::{Formula, FormulaError, Op};
pub use number::{Function, Gradient, Number};
pub use positioner::{Branch, Drives, NoPose, Positioner, Travel, nearest_turn};
pub use seam::{Meeting, Quadric, Ruled, Seam, SeamCurve};
pub use series::{Series, length};
pub use shaping::Correction;
pub use surface::{Pattern, Surface, Tool};
