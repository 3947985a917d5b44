//! Roughing and finishing along contours: the geometry on random contours, and programs.

mod cutting;
mod geometry;
mod programs;
mod random;
