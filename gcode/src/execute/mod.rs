//! A block becomes calls, in the order of RS274/NGC.
//!
//! ```text
//! comment · feed mode · F · S · T · M62-M68 (M66 first) · M6 · M61 · spindle mode (G96, G97) · spindle (M3 M4 M5 M19)
//! M7 M8 M9 · M48-M53 · M70-M73 (saving first, restoring last) · G4 · plane · units · G7 G8 · G40-G42 · G43 G49 · G54-G59.3
//! G61 G64 · G90 G91 · G98 G99 · G10 G28 G30 G52 G92 · motion (modified by G53) · M0 M1 M2 M30 M60
//! ```
//!
//! | file | what it executes |
//! |---|---|
//! | `check.rs` | refuses blocks whose words no code uses or whose codes contradict |
//! | `modes.rs` | planes, units, distance, feed, path, retract modes; M70 to M73 |
//! | `spindle.rs`, `tool.rs`, `outputs.rs` | S M3-M5 M19 G96 G97; T M6 M61 G43 G49 G10 L1; coolant, M48-M53, M62-M68 |
//! | `coordinates.rs` | G10 L2 L20, G28 G30, G52, G54-G59.3, G92 |
//! | `system.rs` | parameters that tell the state (#5400.., #<_x>, ...) |
//! | `straight.rs`, `arc.rs` | G0 G1 G53 polar points; G2 G3 |
//! | `threading.rs` | G33 G33.1 G76 |
//! | `cycles/` | G73 G74 G80 to G89 |
//! | `roughing/` | G70 G71 G72 |
//! | `compensation/` | G40 to G42.1: contour offset by the radius of the tool |
//! | `stop.rs` | M0 M1 M60, M2 M30, end of the tape |

pub mod compensation;
pub mod cycles;
pub(crate) mod output;
