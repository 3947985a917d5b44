//! G-code to machine code: the interpreter of pitchlock.
//!
//! In: a part program (dialect linuxcnc: words, expressions and modal groups of RS274/NGC, threads by G33 and G76)
//! and a machine file. Out: [`protocol::Item`]s, pulled one at a time, in mm with X a radius; and [`Diagnostic`]s,
//! several for one program, each with its place and a remedy. No word is ignored in silence.
//!
//! ```
//! use interpreter::Interpreter;
//! use protocol::{Code, Machine};
//!
//! let program = "G21 G90 G94\nG0 X12 Z2\nG1 Z-20 F120\nM2\n";
//! let items: Result<Vec<_>, _> = Interpreter::new("part.ngc", program, &Machine::default()).collect();
//! let items = items.expect("the program is right");
//! assert!(matches!(items[1].code, Code::Line { .. }) && items[1].line == 3);
//! assert_eq!(items[2].code, Code::End);
//! ```
//!
//! | module | from | to |
//! |---|---|---|
//! | `source` | text | lines |
//! | `words` | a line | words with values (expressions, parameters) |
//! | `codes`, `block` | words | a block: codes in their modal groups, every word of use |
//! | `execute`, `moves`, `threading` | a block and the modal state | items, in the order of RS274/NGC |
//! | [`thread`] | G33, G76 | passes: laws by spindle angle, proved feasible |
//! | `check` | a program | every diagnostic, every pass, the time it takes |
#![forbid(unsafe_code)]

mod block;
mod check;
mod codes;
mod diagnostic;
mod execute;
mod moves;
pub mod shell;
mod source;
mod state;
pub mod thread;
mod threading;
mod time;
mod words;

pub use check::{Check, check};
pub use diagnostic::{Diagnostic, Severity};
pub use execute::Interpreter;
pub use threading::PassNote;
