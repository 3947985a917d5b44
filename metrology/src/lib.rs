//! Standard threads: from a name (`M20x2-6g/6H`, `1/4-20 UNC-2A`, `Tr40x14P7`) to the limits that a standard
//! sets to its diameters, and to the profile that they are measured on. In: text. Out: mm, degrees.
//!
//! ```
//! use metrology::{Size, Thread};
//! let thread: Thread = "M20x2-6g".parse()?;
//! let external = thread.limits().external.ok_or("6g is external")?;
//! assert_eq!(external.get(Size::PitchMax), Some(18.663));
//! assert_eq!(external.get(Size::PitchMin), Some(18.503));
//! assert_eq!(thread.profile().flank_deg, [30.0, 30.0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | file | standard |
//! |---|---|
//! | `iso_m.rs`, `grades.rs`, `deviations.rs` | ISO 68-1, 261, 724, 965-1 (M); ISO 5855-1, ASME B1.21M (MJ) |
//! | `trapezoidal.rs` | ISO 2901 … 2904 (Tr) |
//! | `unified.rs`, `series.rs` | ASME B1.1 (UN, UNC, UNF, UNEF, UNS and UNR of each), B1.15 (UNJ of each) |
//! | `acme.rs` | ASME B1.5, general purpose |
//! | `buttress.rs` | ASME B1.9 (BUTT) |
//! | `pipe.rs` | ISO 228-1 (G), ISO 7-1 (R, Rp), ASME B1.20.1 (NPT) |
//! | `basic.rs` | DIN 405 (Rd), BS 84 (BSW), worms of a module: no limits, basic sizes |
//!
//! Tables of limits are made of rounded parts: a formula alone misses them. Where each part is rounded is
//! written in its file, and [`rounding`] holds how.
#![forbid(unsafe_code)]

mod acme;
mod basic;
mod buttress;
mod deviations;
mod grades;
mod iso_m;
mod limits;
mod name;
mod pipe;
mod profile;
pub mod rounding;
mod series;
mod thread;
mod trapezoidal;
mod unified;

pub use limits::{Limits, Member, Side, Size, Unit};
pub use name::{Misread, UNDERSTOOD};
pub use profile::Profile;
pub use thread::Thread;
