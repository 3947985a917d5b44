//! The plant against the physics it claims: drives, spindle, cut, scenarios.

mod belief;
mod cutting;
mod drives;
mod examples;
mod faults;
mod scenarios;
mod spindle;
mod stand;
