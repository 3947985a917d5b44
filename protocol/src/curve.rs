//! A piece of a smooth curve in X, Y, Z, by its length: what the compressor makes of a run of lines. Its
//! start is the end of the item before.
//!
//! In: the start. Out: the path (M84), or why there is none.
//!
//! Targets are counts of 1e-9 mm, a piece of a curve is not: its way from end to end and its derivatives are
//! numbers, so that pieces which share an end agree there to the last digits of these, and rounding to counts
//! bends nothing.

use motion::Path;
use serde::{Deserialize, Serialize};

use crate::{
    refused::{Refused, finite, positive},
    units::{AXES, PerAxis, Position},
};

/// A piece of a curve to a point. Axes other than X, Y, Z stand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Absolute end point of every axis.
    pub target: PerAxis<Position>,
    /// Way of X, Y, Z from start to end, mm.
    pub way: [f64; 3],
    /// Derivatives 1 … 3 of X, Y, Z by the length at the start, mm⁰ … 1/mm²,
    pub start: [[f64; 3]; 3],
    /// and at the end.
    pub end: [[f64; 3]; 3],
    /// Length, mm, > 0.
    pub length_mm: f64,
}

impl Curve {
    /// The way differs so far from that between start and target where both are rounded to a count, mm.
    pub const ROUNDED_MM: f64 = 1e-8;
    /// Axes may rest so far from where a curve begins, mm: at the start of a program they stand where they
    /// stood. The piece leads from there to its target.
    pub const BESIDE_MM: f64 = 0.01;
    /// How much a direction may differ from one of length 1.
    pub const DIRECTED: f64 = 1e-3;

    /// Refuses what is no piece by length.
    ///
    /// # Errors
    /// Names the field.
    pub fn check(&self) -> Result<(), Refused> {
        positive(self.length_mm, "length of a curve")?;
        let values = self.way.iter().chain(self.start.iter().flatten()).chain(self.end.iter().flatten());
        for value in values {
            finite(*value, "derivative of a curve")?;
        }
        for [direction, ..] in [&self.start, &self.end] {
            let size = direction.iter().map(|share| share * share).sum::<f64>().sqrt();
            if (size - 1.0).abs() > Curve::DIRECTED {
                return Err(Refused::OutOfRange("direction of a curve"));
            }
        }
        Ok(())
    }

    /// The path from a start, in the order of the wire.
    ///
    /// # Errors
    /// As [`Curve::check`]; the piece does not lead from there to its target.
    pub fn path(&self, from: &PerAxis<Position>) -> Result<Path<AXES>, Refused> {
        self.check()?;
        let spread = |values: [f64; 3]| -> PerAxis<f64> {
            std::array::from_fn(|axis| values.get(axis).copied().unwrap_or(0.0))
        };
        let mut way = spread(self.way);
        for (axis, way) in way.iter_mut().enumerate() {
            let should = self.target[axis].mm_from(from[axis]);
            let beside = (should - *way).abs();
            if beside > Curve::BESIDE_MM {
                return Err(Refused::OutOfRange("way of a curve"));
            }
            *way = if beside > Curve::ROUNDED_MM { should } else { *way };
        }
        let rest = PerAxis::default();
        let [start, end] = [(rest, self.start), (way, self.end)]
            .map(|(place, [first, second, third])| [place, spread(first), spread(second), spread(third)]);
        Path::piece(&start, &end, self.length_mm).ok_or(Refused::OutOfRange("length of a curve"))
    }
}
