//! The error of a screw as the machine file has it: where the slide stands too far, as a smooth function of
//! position. In: rows of position in mm, rising, and error in µm. Out: error in mm and its first two
//! derivatives by position.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | s | mm | position of the axis |
//! | e, e′, e″ | mm, –, 1/mm | error and its derivatives by s |
//!
//! Between two rows e is the polynomial of fifth degree that has, in each row, the slope and the curvature of
//! the parabola through that row and its two neighbours; in the first row and the last one both are zero, and
//! beyond them e stays what it is there. So e″ is continuous everywhere, and a table of a parabola gives that
//! parabola back.

/// A table of errors.
#[derive(Clone, Debug)]
pub struct Screw {
    pieces: Vec<Piece>,
}

/// From one row to the next.
#[derive(Clone, Copy, Debug)]
struct Piece {
    from_mm: f64,
    length_mm: f64,
    /// Coefficients in u = (s − from)/length, the constant one first, mm.
    quintic: [f64; 6],
}

/// Slope and curvature in a row.
#[derive(Clone, Copy, Debug, Default)]
struct Shape {
    slope: f64,
    curvature: f64,
}

impl Screw {
    /// The error that rows `[mm, µm]` describe; `None` if there are fewer than two, which describe none.
    /// Positions rise.
    pub fn new(rows: &[[f64; 2]]) -> Option<Screw> {
        let shapes =
            |i: usize| match (i.checked_sub(1).and_then(|i| rows.get(i)), rows.get(i), rows.get(i + 1)) {
                (Some(before), Some(row), Some(after)) => parabola(before, row, after),
                _ => Shape::default(),
            };
        let piece = |(i, ends): (usize, &[[f64; 2]])| match ends {
            [from, to] => Some(Piece::new(from, shapes(i), to, shapes(i + 1))),
            _ => None,
        };
        let pieces: Vec<_> = rows.windows(2).enumerate().filter_map(piece).collect();
        (!pieces.is_empty()).then_some(Screw { pieces })
    }

    /// e, e′, e″ at a position.
    pub fn error(&self, s: f64) -> [f64; 3] {
        let begun = self.pieces.partition_point(|piece| piece.from_mm <= s);
        self.pieces.get(begun.saturating_sub(1)).map_or([0.0; 3], |piece| piece.at(s))
    }
}

/// Slope and curvature, in the middle one, of the parabola through three rows.
fn parabola(before: &[f64; 2], row: &[f64; 2], after: &[f64; 2]) -> Shape {
    let (left, right) = (row[0] - before[0], after[0] - row[0]);
    let (rise, next) = ((row[1] - before[1]) / left * 1e-3, (after[1] - row[1]) / right * 1e-3);
    Shape {
        slope: (rise * right + next * left) / (left + right),
        curvature: 2.0 * (next - rise) / (left + right),
    }
}

impl Piece {
    fn new(from: &[f64; 2], begin: Shape, to: &[f64; 2], end: Shape) -> Piece {
        let h = to[0] - from[0];
        let rise = (to[1] - from[1]) * 1e-3;
        let (v0, v1) = (begin.slope * h, end.slope * h);
        let (a0, a1) = (begin.curvature * h * h, end.curvature * h * h);
        let quintic = [
            from[1] * 1e-3,
            v0,
            0.5 * a0,
            10.0 * rise - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1,
            -15.0 * rise + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1,
            6.0 * rise - 3.0 * (v0 + v1) + 0.5 * (a1 - a0),
        ];
        Piece { from_mm: from[0], length_mm: h, quintic }
    }

    /// Before the piece and behind it, its ends.
    fn at(&self, s: f64) -> [f64; 3] {
        let (h, [c0, c1, c2, c3, c4, c5]) = (self.length_mm, self.quintic);
        let u = ((s - self.from_mm) / h).clamp(0.0, 1.0);
        [
            c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5)))),
            (c1 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)))) / h,
            (2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5))) / (h * h),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::Screw;

    const ROWS: [[f64; 2]; 6] =
        [[-300.0, 4.0], [-220.0, -6.0], [-100.0, -11.0], [-20.0, 0.0], [50.0, 7.5], [180.0, 2.0]];

    #[test]
    fn goes_through_its_rows_and_stays_beyond_them() {
        let screw = Screw::new(&ROWS).expect("a table");
        for [mm, um] in ROWS {
            assert!((screw.error(mm)[0] - 1e-3 * um).abs() < 1e-15, "{mm}");
        }
        for (mm, um) in [(-1e4, 4.0), (-300.0, 4.0), (180.0, 2.0), (1e4, 2.0)] {
            let [e, slope, curvature] = screw.error(mm);
            assert!((e - 1e-3 * um).abs() < 1e-15 && slope.abs() < 1e-15 && curvature.abs() < 1e-15, "{mm}");
        }
    }

    #[test]
    fn derivatives_are_those_of_the_error_and_go_on_through_the_rows() {
        let (screw, h) = (Screw::new(&ROWS).expect("a table"), 1e-3);
        for step in 0..5200 {
            let s = -310.0 + 0.1 * f64::from(step);
            let ([before, ..], [e, slope, curvature], [after, ..]) =
                (screw.error(s - h), screw.error(s), screw.error(s + h));
            assert!(((after - before) / (2.0 * h) - slope).abs() < 1e-11, "slope at {s}");
            assert!(
                ((screw.error(s + h)[1] - screw.error(s - h)[1]) / (2.0 * h) - curvature).abs() < 1e-9,
                "{s}"
            );
            assert!(e.abs() < 0.0125, "{e} at {s}: no more than a little beyond the rows");
        }
    }

    #[test]
    fn gives_a_line_and_a_parabola_back() {
        for (square, line) in [(0.0, 0.02), (1e-4, -0.01)] {
            let um = |mm: f64| square * mm * mm + line * mm;
            let rows: Vec<_> = [-90.0, -70.0, -20.0, 0.0, 35.0, 60.0, 90.0].map(|mm| [mm, um(mm)]).to_vec();
            let screw = Screw::new(&rows).expect("a table");
            for step in 0..130 {
                let s = -70.0 + f64::from(step);
                let [e, slope, curvature] = screw.error(s);
                assert!((1e3 * e - um(s)).abs() < 1e-12, "{s}");
                assert!((1e3 * slope - (2.0 * square * s + line)).abs() < 1e-13, "{s}");
                assert!((1e3 * curvature - 2.0 * square).abs() < 1e-14, "{s}");
            }
        }
    }

    #[test]
    fn fewer_than_two_rows_are_no_error() {
        assert!(Screw::new(&[]).is_none() && Screw::new(&[[1.0, 2.0]]).is_none());
    }
}
