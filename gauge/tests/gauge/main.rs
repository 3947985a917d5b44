//! The virtual gauge against threads that are made up, right and wrong on purpose.

mod blunt;
mod border;
mod counterpart;
mod drawn;
mod made;
mod named;
mod pickup;
mod properties;
mod verdicts;
mod wires;
