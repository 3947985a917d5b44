//! The machine that is not there: axes with elastic drive trains and friction, CiA 402 drives, a belt-driven
//! spindle, encoders, the operator's panel, and a scenario of what happens to them.
//!
//! Enters, once a control cycle: the [`DriveCommand`](protocol::DriveCommand) of each axis, the
//! [`SpindleCommand`](protocol::SpindleCommand) in force, and perhaps what the operator does. Leaves: the
//! [`Measurement`](protocol::Measurement) the controllers see and the [`Truth`](protocol::Truth) they do not.
//!
//! | file | what it holds |
//! |---|---|
//! | `config` | `[plant.*]` of the machine file: the truth, with its defaults and ranges |
//! | `belief` | what a controller would believe if it knew the truth |
//! | `friction`, `screw`, `drive_train` | motor, screw, slide: the mechanics of one axis |
//! | `scale` | the linear scale at a slide |
//! | `marks` | the switch at a slide and the index on its motor, for its reference run |
//! | `drive_state`, `drive`, `meter` | the drive of one axis: state machine, velocity loop, measured torque |
//! | `spindle`, `reading` | motor, speed loop, ripple; how its encoder and its index are read |
//! | `encoder` | faults of the spindle encoder that a scenario brings |
//! | `bus` | what is under way between drives and regulators |
//! | `breakages` | what else it breaks: drives, counters of the axes, the drive of the spindle |
//! | `orders` | what it wants of whoever runs the machine: modules killed, messages tampered with |
//! | `cutting`, `grooves` | what cutting a thread costs; what earlier passes left in the part |
//! | `chatter` | a tool that gives way, and meets what a turn before left |
//! | `scenario`, `timeline` | what happens, and when |
//! | `plant` | one control cycle of all of it; what becomes of it without controls and mains, and behind that |
//!
//! The same machine, scenario, seed and commands give the same numbers on every computer.
#![forbid(unsafe_code)]

mod belief;
mod breakages;
mod bus;
mod chatter;
mod config;
mod cutting;
mod drive;
mod drive_state;
mod drive_train;
mod encoder;
mod friction;
mod grooves;
mod marks;
mod meter;
mod orders;
mod plant;
mod ramped;
mod reading;
mod scale;
mod scenario;
mod screw;
mod seed;
mod spindle;
mod timeline;

pub use belief::{Belief, current_lag_s, spindle_inertia_kg_m2, spindle_peak, stock_mm};
pub use chatter::{Chatter, ChatterMode, Chip};
pub use config::PlantError;
pub use orders::{Channel, Packet, Tampering};
pub use plant::Plant;
pub use scenario::{Scenario, ScenarioError};
pub use seed::Seed;
