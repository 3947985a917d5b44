//! What is cut, as functions of a parameter: formulas, surfaces under a tool, seams on a positioner. Pure
//! mathematics, no state of the machine, no I/O.
//!
//! | part | holds | equations |
//! |---|---|---|
//! | [`Formula`] | an expression as a short program, evaluated for numbers, series and gradients | – |
//! | [`Contour`], [`Surface`] | where a tool touches a formula, and where it stands then | M87, M88 |
//! | [`Touch`] | how closely a tool fits a surface, and the ridge it leaves | M89 |
//! | [`Seam`] | position and direction along a seam | – |
//! | [`Positioner`] | which drives bring a seam under the beam, and how far errors of drives move it | M46–M52 |
//! | [`Correction`], [`Place`] | feed ratios of followers to their master | M36–M43 |
//! | [`chord_feed`], [`radius`], [`Touch::under`] | feed within a chord error, the surface that a tool moves on | M44, M45, M93 |
//! | [`Walker`], [`Piece`] | from a curve to pieces by length that a chain can plan | M86 |
//!
//! Nothing allocates after it was made, and every evaluation has a bounded cost.
#![forbid(unsafe_code)]

mod compressor;
mod contour;
mod curvature;
mod curve;
mod fit;
mod formula;
mod number;
mod pattern;
mod piece;
mod positioner;
mod seam;
mod series;
mod shaping;
mod surface;
mod tool;

pub use compressor::{Bow, Compressor, Course, Leeway};
pub use contour::{Contour, ContourCurve, Side};
pub use curvature::{chord_feed, master_feed, radius, tangent_feed};
pub use curve::{Curve, Point};
pub use fit::{Parting, Touch};
pub use formula::{Formula, FormulaError, Op};
pub use number::{Function, Gradient, Number};
pub use pattern::{Leg, Pattern, Plan};
pub use piece::{Clock, Piece, PieceError, Walked, Walker};
pub use positioner::{Branch, DriveErrors, Drives, Positioner};
pub use seam::{Meeting, Quadric, Ruled, Seam, SeamCurve, SeamPath};
pub use series::{Series, length};
pub use shaping::{Correction, FOLLOWERS, Place, Section, Sections, leader};
pub use surface::{Surface, SurfaceCurve};
pub use tool::Tool;
