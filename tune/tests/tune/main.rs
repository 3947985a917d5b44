//! Identification of the simulated plant, and what cannot be identified.

mod plant;
mod refusals;
