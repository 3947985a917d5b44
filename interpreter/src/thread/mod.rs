//! Threads: from the words of G33 and G76 to passes, each a law of every axis by spindle angle.
//!
//! | file | what it decides |
//! |---|---|
//! | `cut.rs` | what one pass shall cut, in mm: the geometry, free of speeds and limits |
//! | `blunt.rs` | a blunt start: passes that take the beginning of the ridge away |
//! | `chain.rs` | threads that follow each other: where the lead changes along the path |
//! | `round.rs` | a thread along an arc, as pieces of a chain |
//! | `corners.rs` | the windows over which it does |
//! | `cycle.rs` | the cuts of a G76 cycle |
//! | `chamfer.rs` | the plans of a cycle, and what becomes of a chamfer that X cannot follow |
//! | `single.rs` | the cut of a G33 block |
//! | `plan.rs` | the law of a cut: windows, phase, run-out, highest speed |
//! | `infeed.rs` | how much deeper each pass goes than the last one, and whose edge rubs |
//! | `limits.rs` | what the axes of a cut can do |
//! | `way_out.rs` | how the tool leaves a pass before its end |
//! | `flank.rs` | when Z may begin to brake behind a retracting tool |
//! | `policy.rs` | what makes the tool leave a thread, as the program says it |
//! | `refusal.rs` | why a cut has no law, and which speed would give it one |
//! | `starts.rs` | which start of a multi-start thread a pass belongs to |
//! | `table.rs` | the leads along a thread, as the program says them |
//! | `varied.rs` | how the speed of the spindle is varied in a pass, as the program says it |

mod blunt;
mod chain;
mod chamfer;
mod corners;
mod cut;
mod cycle;
mod flank;
mod infeed;
mod limits;
mod plan;
mod policy;
mod refusal;
mod round;
mod single;
mod starts;
mod table;
mod varied;
mod way_out;

pub(crate) use blunt::Blunt;
pub use blunt::BluntNote;
pub use chain::{Bend, Chain, CornerNote};
pub(crate) use chain::{Leg, rounded};
pub(crate) use chamfer::plans;
pub use cut::{Along, Cut, Point, Taper};
pub(crate) use cycle::{Cycle, MOST_PASSES};
pub(crate) use infeed::Infeeds;
pub(crate) use plan::VELOCITY_RESERVE;
pub use plan::{Plan, plan};
pub(crate) use policy::Policy;
pub use refusal::Refusal;
pub(crate) use refusal::highest_of_tap;
pub(crate) use round::Round;
pub(crate) use single::{Next, Single};
pub(crate) use starts::Starts;
pub(crate) use table::Table;
pub(crate) use varied::{Said, top_share, varied};
