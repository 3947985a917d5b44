//! The virtual gauge: whether the surface that all passes leave is the thread that was meant. In: where the
//! tip of the tool was each time the spindle went through one of some angles, the shape of its edge, the
//! limits of the thread; mm, degrees. Out: a [`Report`]: measures, and the verdict of GO and NO-GO with
//! reasons.
//!
//! The edge of a threading tool lies in the plane of X and Z. So the section of the part through its axis at
//! an angle is cut only while the spindle is at that angle, and the section is the envelope of the edge at
//! its places there: no approximation is needed, and it does not matter which pass cut what.
//!
//! | file | holds |
//! |---|---|
//! | `nominal/` | what is asked: pitch, flanks, limits; from a name, from numbers |
//! | `edge.rs` | the edge of the tool |
//! | `section.rs` | from places of the tool at one angle to grooves |
//! | `groove.rs` | from a groove to its measures |
//! | `helix.rs` | from grooves at all angles to lead, drunkenness, starts |
//! | `window.rs` | the longest and shortest over any length of a gauge |
//! | `judge.rs`, `causes.rs` | GO, NO-GO, and which cause weighs most |
//! | `blunt.rs` | where the ridge of a thread begins, if it is asked to begin bluntly |
//! | `reason.rs` | that in words |
//! | `drawn/` | a groove as a drawing has it, whatever its lead does, and what was cut held against it |
//! | `pickup.rs` | where a thread that is there lies, from touches of a probe |
#![forbid(unsafe_code)]

mod blunt;
mod causes;
mod drawn;
mod edge;
mod groove;
mod helix;
mod judge;
mod nominal;
pub mod pickup;
mod reason;
mod section;
mod window;

pub use drawn::{Drawn, DrawnReport, DrawnSide, Spot, judge_drawn};
pub use edge::Edge;
pub use judge::{Report, Verdict, judge};
pub use metrology::{Misread, Side};
pub use nominal::{Nominal, NominalError};
pub use reason::{Cause, Check, Reason};
pub use section::{Place, Sections};
