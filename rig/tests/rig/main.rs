//! The machine in one process: what it cuts, how its operator is obeyed, how it takes disturbed wires.

#![allow(clippy::print_stdout)] // `-- --nocapture` shows the figures behind a verdict

mod blunt;
mod by_hand;
mod chains;
mod cones;
mod contour;
mod corrections;
mod gauge;
mod ground;
mod held;
mod hostile;
mod inputs;
mod journal;
mod leaving;
mod led;
mod left;
mod lost;
mod machine_code;
mod magnets;
mod milled;
mod moments;
mod operator;
mod orders;
mod outage;
mod outputs;
mod packets;
mod phases;
mod poles;
mod presses;
mod reactions;
mod references;
mod resume;
mod rings;
mod rotary;
mod stand;
mod standstill;
mod supervisor;
mod tapping;
mod traces;
mod trial;
mod turned;
mod varied;
mod wires;
