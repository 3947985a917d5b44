//! The machine file: what it refuses, and which points, arcs and axes a machine has.

mod arcs;
mod file;
mod kinematics;
mod m_codes;
