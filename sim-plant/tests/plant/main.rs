//! The plant against the physics it claims: drives, spindle, cut, scenarios.

mod belief;
mod cutting;
mod drives;
mod examples;
mod facts;
mod faults;
mod motors;
mod scenarios;
mod spindle;
mod stand;
