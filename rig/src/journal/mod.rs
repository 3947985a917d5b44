//! What a control still has to know when the lights come on again, and how it is written so that a loss of
//! power at any moment leaves it whole.
//!
//! [`Keeper`] sees every control cycle and says when there is something to write: a [`State`]. A [`Book`]
//! writes it on a [`Medium`], [`latest`] reads it back from whatever bytes are there. No damage is an error,
//! it costs what is damaged.
//!
//! | rule | why |
//! |---|---|
//! | every record is a whole state, and none needs another one | a lost record costs its own news only |
//! | a record has one length, a running number and a hash | a torn one is not taken for a record, and what stands behind it is found |
//! | every record is written twice, in two sectors | a sector that goes bad, or a bit that turns over, loses nothing |
//! | nothing is ever written over: the file grows, and once it is long a new one takes its place by its name | there is no moment without a whole file |
//! | what [`Book::sync`] has returned for is confirmed | only the disk knows when it has something |

mod book;
mod keeper;
mod sheet;
mod state;

pub use book::{Book, File, MOST, Medium};
pub use keeper::{Keeper, Origin};
pub use sheet::{Kept, SECTOR, fingerprint, has_other_version, latest};
pub use state::{ACTIONS, Act, Action, State};
