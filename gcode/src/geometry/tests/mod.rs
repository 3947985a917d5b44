//! Geometry on random contours, and by number of its equations.

mod contours;
mod cutting;
mod random;
mod track;
