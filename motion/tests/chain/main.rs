//! Chains of blocks: every axis within its limits at every moment, every target reached, on the path, in
//! time.

mod bends;
mod blocks;
mod curve;
mod hold;
mod limits;
mod overlap;
mod pieces;
mod programs;
mod replan;
mod rounded;
mod stand;
mod times;
mod tolerance;
