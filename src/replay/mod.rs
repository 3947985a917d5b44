//! `pitchlock replay` and `pitchlock diff`: runs that are made again from their folders.

mod again;
mod differ;
mod folder;
mod left;
mod picture;

pub(crate) use again::{HELP, ReplayArgs, replay};
pub(crate) use differ::{DiffArgs, HELP_DIFF, diff};
pub(crate) use folder::{Again, Recorded};
pub(crate) use left::Left;
