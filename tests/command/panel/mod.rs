//! The panel: whom it lets in, that the machine does not notice it, that what was pressed is repeated, and
//! what a browser makes of it.

mod browser;
mod bursts;
mod by_hand;
mod client;
mod figures;
mod from;
mod hostile;
mod pictures;
mod playback;
mod reference;
mod scope;
mod tables;
mod tasks;
mod terminal;
mod tool;
mod watched;
mod written_api;
