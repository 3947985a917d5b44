//! What an editor asks of part programs, by the Language Server Protocol. In: its messages. Out: what `check`
//! says of the text as it is typed; what a word means; where a subroutine is; the text as the house writes
//! it; what can be folded.
//!
//! Three threads: one answers the editor and reads no more than a few lines; one answers beside it what every
//! line has to be looked at for; one checks, as soon as nothing has been typed for a tenth of a second, and
//! gives up when something is.

mod blocks;
mod check;
mod fold;
mod format;
mod hover;
mod pages;
mod places;
mod scan;
mod server;
mod settings;
mod text;
mod whole;

pub use format::formatted;
pub use hover::{Around, meaning};
pub use server::serve;
pub use settings::Settings;
