//! The command as its user sees it: arguments, refusals, exit status, pages, run folders; its processes and
//! their deaths.

#[path = "../shop/mod.rs"]
mod shop;

mod always_true;
mod bounds;
mod campaign;
mod canon;
mod certify;
mod check;
mod command_line;
mod computer;
mod deaths;
mod determinism;
mod dialects;
mod drawn;
mod editor;
mod endings;
mod experiments;
mod first_hour;
mod from_line;
mod gauge;
mod jobs;
mod journal;
mod known;
mod memory;
mod milled;
mod offsets;
mod pace;
mod panel;
mod part;
mod pick_up;
mod processes;
mod real_time;
mod references;
mod replay;
mod resolution;
mod resume;
mod retooled;
mod signals;
mod stood;
mod straight_lines;
mod strangers;
mod thread;
mod traces;
mod tune;
mod users;
mod written;
