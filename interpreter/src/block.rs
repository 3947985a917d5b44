//! What is left of the block that a mill cuts, as heights over X and Y, and what no program should do with
//! it: go into it in rapid motion, cut it while the spindle stands. In: moves of the tip in the coordinates
//! of the part, mm. Out: warnings.
//!
//! A feed lowers every cell that the tool may touch to the tip, as if the tool were flat and a little wider.
//! Whether a tool is in what is left is asked of its axis, and of a feed of what a ball of its radius would
//! reach as well. So there is material that these warnings do not know of, and none that they invent. What a
//! tool leaves whose radius nobody said is not known: nothing is warned of any more.

use gcode::Problem;
use gcode::canon::Units;
use gcode::problem::{Blame, short};
use machine::Corners;

use crate::stock::Goes;

/// Cells of the longer side, and the smallest of them, mm.
const CELLS: f64 = 256.0;
const LEAST_MM: f64 = 0.05;
/// So far a tip is in the material that is in it, mm.
const SKIN_MM: f64 = 0.06;
/// So many cells a tool is taken to be wider than it is, or narrower: half the diagonal of a cell, and half
/// a step.
const DOUBT: f64 = 1.25;
/// Most places of one move.
const MOST_PLACES: f64 = 40_000.0;
/// Warnings of one program.
const MOST_WARNINGS: u32 = 20;

/// The block as far as it is cut.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    corners: Corners,
    cell_mm: f64,
    /// Cells along X and Y.
    size: [usize; 2],
    /// Row by row, Y rising.
    heights_mm: Vec<f64>,
    warnings: u32,
    known: bool,
}

impl Block {
    /// The block before it is cut.
    pub(crate) fn new(corners: Corners) -> Block {
        let Corners { low_mm, high_mm } = corners;
        let sides = [0, 1].map(|i| high_mm[i] - low_mm[i]);
        let cell_mm = (sides[0].max(sides[1]) / CELLS).max(LEAST_MM);
        let size = sides.map(|side| (side / cell_mm) as usize + 1);
        let heights_mm = vec![high_mm[2]; size[0] * size[1]];
        Block { corners, cell_mm, size, heights_mm, warnings: 0, known: true }
    }

    /// Takes a straight move of a tool of this radius; a warning if it should not be.
    pub(crate) fn goes(
        &mut self,
        [from, to]: [[f64; 3]; 2],
        how: Goes,
        radius_mm: Option<f64>,
        units: Units,
    ) -> Option<Box<Problem>> {
        if from[2].min(to[2]) >= self.corners.high_mm[2] {
            return None;
        }
        let reach_mm = if how == Goes::Rapid { 0.0 } else { radius_mm.unwrap_or(0.0) };
        let warning = match how {
            Goes::Cuts => None,
            Goes::Rapid => self.first_inside([from, to], reach_mm).map(|at| {
                warning(
                    "rapid-in-stock",
                    format!("the rapid goes through the stock at {}", place(at, units)),
                    "go over it, or cut it off first; is the part as it is said to be, and the offset?",
                )
            }),
            Goes::CutsAtRest => self.first_inside([from, to], reach_mm).map(|at| {
                warning(
                    "cut-at-rest",
                    format!("the tool cuts into the stock at {}, and the spindle stands", place(at, units)),
                    "start the spindle before, as in S3000 M3",
                )
            }),
        };
        if how != Goes::Rapid {
            match radius_mm {
                Some(radius) => self.places([from, to]).for_each(|at| self.lower(at, radius)),
                None => self.forget(),
            }
        }
        self.warnings += u32::from(warning.is_some());
        warning.filter(|_| self.warnings <= MOST_WARNINGS)
    }

    /// Nobody knows what is left from here on.
    pub(crate) fn forget(&mut self) {
        self.heights_mm.fill(f64::NEG_INFINITY);
        self.known = false;
    }

    /// Whether what is left is known.
    pub(crate) fn is_known(&self) -> bool {
        self.known
    }

    /// Places of a line, half a cell apart.
    fn places(&self, [from, to]: [[f64; 3]; 2]) -> impl Iterator<Item = [f64; 3]> + use<> {
        let way = [0, 1, 2].map(|i| to[i] - from[i]);
        let length = way.iter().map(|mm| mm * mm).sum::<f64>().sqrt();
        let count = (2.0 * length / self.cell_mm).ceil().clamp(1.0, MOST_PLACES);
        (0..=count as u32).map(move |number| {
            let share = f64::from(number) / count;
            [0, 1, 2].map(|i| from[i] + share * way[i])
        })
    }

    /// Cells within a distance of a place, and how far their middles are from it.
    fn around(&self, [x, y, _]: [f64; 3], reach_mm: f64) -> impl Iterator<Item = (usize, f64)> + use<> {
        let Corners { low_mm, .. } = self.corners;
        let (cell_mm, size) = (self.cell_mm, self.size);
        let span = |i: usize, middle: f64| {
            let cell = |mm: f64| (mm - low_mm[i]) / cell_mm - 0.5;
            let first = cell(middle - reach_mm).ceil().max(0.0) as usize;
            let end = (cell(middle + reach_mm).floor() + 1.0).clamp(0.0, size[i] as f64) as usize;
            first..end
        };
        let columns = span(0, x);
        span(1, y).flat_map(move |row| {
            let dy = low_mm[1] + (row as f64 + 0.5) * cell_mm - y;
            columns.clone().filter_map(move |column| {
                let dx = low_mm[0] + (column as f64 + 0.5) * cell_mm - x;
                let rho = libm::hypot(dx, dy);
                (rho <= reach_mm).then_some((row * size[0] + column, rho))
            })
        })
    }

    fn lower(&mut self, at: [f64; 3], radius_mm: f64) {
        if at[2] < self.corners.high_mm[2] {
            for (cell, _) in self.around(at, radius_mm + DOUBT * self.cell_mm) {
                self.heights_mm[cell] = self.heights_mm[cell].min(at[2]);
            }
        }
    }

    /// Where a line comes into the material.
    fn first_inside(&self, line: [[f64; 3]; 2], radius_mm: f64) -> Option<[f64; 3]> {
        self.places(line).find(|at| self.is_inside(*at, radius_mm))
    }

    fn is_inside(&self, at: [f64; 3], radius_mm: f64) -> bool {
        let [x, y, z] = at;
        let Corners { low_mm, high_mm } = self.corners;
        if z >= high_mm[2] - SKIN_MM {
            return false;
        }
        // Below the block is the table, not the part.
        let is_left = |cell: usize, tip: f64| self.heights_mm[cell] > tip.max(low_mm[2]) + SKIN_MM;
        let within = [x, y]
            .iter()
            .zip(low_mm.iter().zip(high_mm))
            .all(|(at, (low, high))| (low + SKIN_MM..=high - SKIN_MM).contains(at));
        if within {
            let cell = |i: usize, mm: f64| (((mm - low_mm[i]) / self.cell_mm) as usize).min(self.size[i] - 1);
            if is_left(cell(1, y) * self.size[0] + cell(0, x), z) {
                return true;
            }
        }
        let narrow = radius_mm - DOUBT * self.cell_mm;
        let rise = |rho: f64| radius_mm - (radius_mm * radius_mm - rho * rho).max(0.0).sqrt();
        narrow > 0.0 && self.around(at, narrow).any(|(cell, rho)| is_left(cell, z + rise(rho)))
    }
}

fn place(at: [f64; 3], units: Units) -> String {
    let [x, y, z] = at.map(|mm| short(mm / units.mm()));
    format!("X{x} Y{y} Z{z} of the part ({})", units.name())
}

fn warning(code: &'static str, message: String, help: &str) -> Box<Problem> {
    Problem::warning(code, Blame::Block, message, help)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block() -> Block {
        Block::new(Corners { low_mm: [0.0, 0.0, -20.0], high_mm: [100.0, 60.0, 0.0] })
    }

    fn code(warning: Option<Box<Problem>>) -> &'static str {
        warning.map_or("", |warning| warning.code)
    }

    fn rapid(block: &mut Block, from: [f64; 3], to: [f64; 3]) -> &'static str {
        code(block.goes([from, to], Goes::Rapid, Some(5.0), Units::Millimetre))
    }

    #[test]
    fn a_rapid_may_go_where_nothing_is_or_is_left() {
        let mut part = block();
        assert_eq!(rapid(&mut part, [-50.0, 30.0, 50.0], [50.0, 30.0, 0.1]), "");
        assert_eq!(rapid(&mut part, [-10.0, 30.0, -5.0], [-10.0, 90.0, -5.0]), "", "beside it");
        assert_eq!(rapid(&mut part, [50.0, 30.0, 5.0], [50.0, 30.0, -1.0]), "rapid-in-stock");
        assert_eq!(rapid(&mut part, [-10.0, 30.0, -5.0], [110.0, 30.0, -5.0]), "rapid-in-stock");
        assert_eq!(
            code(part.goes(
                [[-10.0, 30.0, -5.0], [110.0, 30.0, -5.0]],
                Goes::Cuts,
                Some(5.0),
                Units::Millimetre
            )),
            ""
        );
        assert_eq!(rapid(&mut part, [110.0, 30.0, -5.0], [-10.0, 30.0, -5.0]), "", "it has been cut off");
        assert_eq!(rapid(&mut part, [-10.0, 34.9, -5.0], [110.0, 34.9, -5.0]), "", "and beside its axis");
        assert_eq!(rapid(&mut part, [50.0, 30.0, -5.0], [50.0, 40.0, -5.0]), "rapid-in-stock");
        assert_eq!(rapid(&mut part, [50.0, 30.0, 2.0], [50.0, 30.0, -5.2]), "rapid-in-stock");
    }

    #[test]
    fn a_drill_may_come_back_into_its_hole() {
        let mut part = block();
        for depth in [-3.0, -6.0, -30.0] {
            let bottom = [20.0, 20.0, depth];
            assert_eq!(
                code(part.goes([[20.0, 20.0, 2.0], bottom], Goes::Cuts, Some(2.5), Units::Millimetre)),
                ""
            );
            assert_eq!(rapid(&mut part, bottom, [20.0, 20.0, 2.0]), "");
            assert_eq!(rapid(&mut part, [20.0, 20.0, 2.0], bottom), "");
        }
    }

    #[test]
    fn nothing_is_cut_while_the_spindle_stands() {
        let mut part = block();
        let beside = [[-3.0, -20.0, -5.0], [-3.0, 80.0, -5.0]];
        assert_eq!(
            code(part.goes(beside, Goes::CutsAtRest, Some(2.9), Units::Millimetre)),
            "",
            "it passes by"
        );
        assert_eq!(
            code(part.goes(beside, Goes::CutsAtRest, Some(5.0), Units::Millimetre)),
            "cut-at-rest",
            "with its flank"
        );
        assert_eq!(
            code(part.goes(beside, Goes::CutsAtRest, Some(5.0), Units::Millimetre)),
            "",
            "nothing is left there"
        );
    }

    #[test]
    fn of_a_tool_that_nobody_describes_nobody_knows_what_it_leaves() {
        let mut part = block();
        assert_eq!(
            code(part.goes(
                [[50.0, 30.0, 5.0], [50.0, 30.0, -1.0]],
                Goes::CutsAtRest,
                None,
                Units::Millimetre
            )),
            "cut-at-rest"
        );
        assert_eq!(rapid(&mut part, [10.0, 10.0, 5.0], [10.0, 10.0, -1.0]), "");
    }

    #[test]
    fn a_program_is_warned_a_number_of_times_and_no_more() {
        let mut part = block();
        let mut warned = || rapid(&mut part, [50.0, 30.0, 5.0], [50.0, 30.0, -1.0]) == "rapid-in-stock";
        assert_eq!((0..100).filter(|_| warned()).count(), 20);
    }
}
