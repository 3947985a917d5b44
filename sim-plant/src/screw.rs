//! The screw as it was ground: where the nut stands when the motor has turned so far.
//! In: way of the motor since home, m. Out: way of the nut, m, and how it changes with that of the motor.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | x, n | m | way of the motor (turns times lead) and of the nut, both 0 where the axis is switched on |
//! | h, y | m | home, where nut and motor are at one; where the slide is when it is switched on, mostly h |
//! | q | m | position of the motor, q0 + x |
//! | e | m | how much too far the nut stands: the table, and a wobble once a turn |
//! | a, P | m | size of the wobble and lead of the screw |
//!
//! ```text
//! n = x + e(q) − e(q0),   dn/dx = 1 + e'(q),   e(q) = table(q) + a sin(2π q/P)                       (M72)
//! q0 + e(q0) − e(h) = y
//! ```
//! The screw is built into the machine: wherever one with a reference run is switched on, h is its home.
//! Between its rows the table is a cubic with continuous slope; the slope in a row is that of the parabola
//! through it and its neighbours, at both ends zero, and beyond them the error stays what it is. A
//! controller's table may be another one.

use core::f64::consts::TAU;
use machine::{CLOSEST_MM, MOST_ROWS};

use crate::config::{AxisTrain, PlantError, range};

/// Steepest error, a share of the way.
const STEEPEST: f64 = 0.05;
/// Steps of the iteration that finds q0. Each is more exact by the slope of the error, at worst a seventh.
const INVERSIONS: usize = 24;

/// The error of one screw.
#[derive(Clone, Debug)]
pub(crate) struct ScrewError {
    begins_m: f64,
    /// Errors where it is switched on, and at home.
    at_beginning_m: f64,
    at_home_m: f64,
    /// Where the table begins and ends, m.
    range_m: (f64, f64),
    pieces: Vec<Piece>,
    wobble_m: f64,
    turn_per_m: f64,
}

/// A cubic in the way from its beginning.
#[derive(Clone, Copy, Debug)]
struct Piece {
    from_m: f64,
    cubic: [f64; 4],
}

impl ScrewError {
    /// The screw of an axis; `None` for one without error. `home_mm` is where nut and motor are at one,
    /// `slide_mm` where the slide is when it is switched on; `section` names the axis in errors.
    ///
    /// # Errors
    /// A table that no screw has, by key.
    pub(crate) fn new(
        train: &AxisTrain,
        screw_lead_mm: f64,
        [home_mm, slide_mm]: [f64; 2],
        section: &str,
    ) -> Result<Option<ScrewError>, PlantError> {
        if train.screw_error.is_empty() && train.screw_wobble_um == 0.0 {
            return Ok(None);
        }
        check(train, screw_lead_mm, section)?;
        let rows: Vec<[f64; 2]> = train.screw_error.iter().map(|[mm, um]| [1e-3 * mm, 1e-6 * um]).collect();
        let end = |row: Option<&[f64; 2]>| row.map_or(0.0, |[at, _]| *at);
        let mut screw = ScrewError {
            begins_m: 0.0,
            at_beginning_m: 0.0,
            at_home_m: 0.0,
            range_m: (end(rows.first()), end(rows.last())),
            pieces: pieces(&rows),
            wobble_m: 1e-6 * train.screw_wobble_um,
            turn_per_m: TAU / (1e-3 * screw_lead_mm),
        };
        screw.at_home_m = screw.error(1e-3 * home_mm).0;
        screw.begins_m = 1e-3 * screw.motor_mm(slide_mm);
        screw.at_beginning_m = screw.error(screw.begins_m).0;
        Ok(Some(screw))
    }

    /// Position of the motor for one of the nut, mm of the machine.
    pub(crate) fn motor_mm(&self, nut_mm: f64) -> f64 {
        (0..INVERSIONS).fold(nut_mm, |q, _| nut_mm - 1e3 * (self.error(1e-3 * q).0 - self.at_home_m))
    }

    /// Way of the nut for a way of the motor, m, and its slope.
    #[inline]
    pub(crate) fn nut(&self, x: f64) -> (f64, f64) {
        let (error_m, slope) = self.error(self.begins_m + x);
        (x + (error_m - self.at_beginning_m), 1.0 + slope)
    }

    /// Error at a position of the motor, and its slope.
    fn error(&self, q: f64) -> (f64, f64) {
        let (first, last) = self.range_m;
        let at = q.clamp(first, last);
        let after = self.pieces.partition_point(|piece| piece.from_m <= at);
        let (mut error, mut slope) = (0.0, 0.0);
        if let Some(Piece { from_m, cubic: [c0, c1, c2, c3] }) = self.pieces.get(after.max(1) - 1) {
            let u = at - from_m;
            error = c0 + u * (c1 + u * (c2 + u * c3));
            slope = c1 + u * (2.0 * c2 + u * 3.0 * c3);
        }
        if self.wobble_m != 0.0 {
            let (sin, cos) = libm::sincos(q * self.turn_per_m);
            error += self.wobble_m * sin;
            slope += self.wobble_m * self.turn_per_m * cos;
        }
        (error, slope)
    }
}

/// Refuses what is no table, and a wobble steeper than the screw.
fn check(train: &AxisTrain, screw_lead_mm: f64, section: &str) -> Result<(), PlantError> {
    let refuse = |key: String, value: f64, reason: String| Err(PlantError::Value { key, value, reason });
    if train.screw_error.len() == 1 || train.screw_error.len() > MOST_ROWS {
        let reason = format!("rows were found; a table has 2 to {MOST_ROWS} of them, or none");
        return refuse(format!("{section}.screw_error"), train.screw_error.len() as f64, reason);
    }
    let key = |row: usize, column: usize| format!("{section}.screw_error[{row}][{column}]");
    for (row, [mm, um]) in train.screw_error.iter().enumerate() {
        range(&key(row, 0), *mm, -1e5, 1e5)?;
        range(&key(row, 1), *um, -1e3, 1e3)?;
    }
    for (row, pair) in train.screw_error.windows(2).enumerate() {
        let [[before_mm, before_um], [mm, um]] = [pair[0], pair[1]];
        if mm - before_mm < CLOSEST_MM {
            let reason = format!("must be at least {CLOSEST_MM} mm above the row before, {before_mm}");
            return refuse(key(row + 1, 0), mm, reason);
        }
        if (um - before_um).abs() > 1e3 * STEEPEST * (mm - before_mm) {
            let reason =
                format!("differs by more than {} µm for each mm from the row before", 1e3 * STEEPEST);
            return refuse(key(row + 1, 1), um, reason);
        }
    }
    range(&format!("{section}.screw_wobble_um"), train.screw_wobble_um, 0.0, 1e3)?;
    let steepness = 1e-3 * train.screw_wobble_um * TAU / screw_lead_mm;
    if steepness > STEEPEST {
        let highest = 1e3 * STEEPEST * screw_lead_mm / TAU;
        let reason = format!("must be at most {highest:.1} with a lead of {screw_lead_mm} mm");
        return refuse(format!("{section}.screw_wobble_um"), train.screw_wobble_um, reason);
    }
    Ok(())
}

/// The cubics between rows of position and error, m.
fn pieces(rows: &[[f64; 2]]) -> Vec<Piece> {
    let secant = |[[q0, e0], [q1, e1]]: [[f64; 2]; 2]| (e1 - e0) / (q1 - q0);
    let inner = rows.windows(3).map(|rows| {
        let [before, here, after] = [rows[0], rows[1], rows[2]];
        let (left, right) = (here[0] - before[0], after[0] - here[0]);
        (secant([before, here]) * right + secant([here, after]) * left) / (left + right)
    });
    let slopes: Vec<f64> = core::iter::once(0.0).chain(inner).chain([0.0]).collect();
    let pairs = rows.windows(2).zip(slopes.windows(2));
    pairs
        .map(|(ends, slopes)| {
            let ([from, to], [m0, m1]) = ([ends[0], ends[1]], [slopes[0], slopes[1]]);
            let (length, mean) = (to[0] - from[0], secant([from, to]));
            let c2 = (3.0 * mean - 2.0 * m0 - m1) / length;
            let c3 = (m0 + m1 - 2.0 * mean) / (length * length);
            Piece { from_m: from[0], cubic: [from[1], m0, c2, c3] }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn screw(rows: &[[f64; 2]], wobble_um: f64, home_mm: f64) -> Result<Option<ScrewError>, PlantError> {
        let train =
            AxisTrain { screw_error: rows.to_vec(), screw_wobble_um: wobble_um, ..AxisTrain::default() };
        ScrewError::new(&train, 5.0, [home_mm; 2], "plant.axis.z")
    }

    const ROWS: [[f64; 2]; 4] = [[-300.0, 4.0], [-100.0, -11.0], [0.0, 0.0], [50.0, 7.5]];

    #[test]
    fn the_nut_is_off_by_the_table_less_what_it_is_at_home() {
        let screw = screw(&ROWS, 0.0, 100.0).unwrap().unwrap();
        for [mm, um] in ROWS {
            let way = 1e-3 * (mm - 100.0);
            let off_um = 1e6 * (screw.nut(way).0 - way);
            assert!((off_um - (um - 7.5)).abs() < 1e-6, "{off_um} µm at {mm} mm");
        }
        let beyond = screw.nut(-0.5);
        assert!((1e6 * (beyond.0 + 0.5) - (4.0 - 7.5)).abs() < 1e-6 && beyond.1 == 1.0, "{beyond:?}");
        assert_eq!(screw.nut(0.0), (0.0, 1.0));
    }

    #[test]
    fn the_slope_is_that_of_the_way_and_goes_on_through_the_rows() {
        let screw = screw(&ROWS, 2.0, 100.0).unwrap().unwrap();
        for step in 0..900 {
            let (x, h) = (-0.45 + 5e-4 * f64::from(step), 1e-7);
            let slope = (screw.nut(x + h).0 - screw.nut(x - h).0) / (2.0 * h);
            assert!((screw.nut(x).1 - slope).abs() < 1e-6, "{slope} at {x} m");
        }
    }

    #[test]
    fn wherever_it_is_switched_on_the_screw_is_the_same() {
        let train = AxisTrain { screw_error: ROWS.to_vec(), screw_wobble_um: 30.0, ..AxisTrain::default() };
        let at_home = screw(&ROWS, 30.0, 100.0).unwrap().unwrap();
        for step in 0..60 {
            let slide_mm = 40.0 + 1.7 * f64::from(step);
            let screw = ScrewError::new(&train, 5.0, [100.0, slide_mm], "z").unwrap().unwrap();
            let motor_mm = screw.motor_mm(slide_mm);
            for way_mm in [0.0, -3.1, 7.9] {
                let there_mm = slide_mm + 1e3 * screw.nut(1e-3 * way_mm).0;
                let same_mm = 100.0 + 1e3 * at_home.nut(1e-3 * (motor_mm + way_mm - 100.0)).0;
                assert!((there_mm - same_mm).abs() < 1e-9, "{there_mm} and {same_mm} mm from {slide_mm}");
            }
        }
        assert_eq!(at_home.motor_mm(100.0), 100.0);
    }

    #[test]
    fn a_wobble_comes_once_a_turn() {
        let screw = screw(&[], 3.0, 0.0).unwrap().unwrap();
        for (way_mm, um) in [(1.25, 3.0), (2.5, 0.0), (3.75, -3.0), (5.0, 0.0), (-1.25, -3.0)] {
            let off_um = 1e6 * screw.nut(1e-3 * way_mm).0 - 1e3 * way_mm;
            assert!((off_um - um).abs() < 1e-6, "{off_um} µm after {way_mm} mm");
        }
    }

    #[test]
    fn refuses_what_is_no_table() {
        for (rows, wobble_um, expected) in [
            (&[[0.0, 1.0]][..], 0.0, "plant.axis.z.screw_error = 1: rows were found; a table has 2 to 256"),
            (&[[0.0, 1.0], [0.0, 2.0]], 0.0, "plant.axis.z.screw_error[1][0] = 0: must be at least"),
            (&[[0.0, 1.0], [f64::NAN, 2.0]], 0.0, "plant.axis.z.screw_error[1][0] = NaN: must lie between"),
            (
                &[[0.0, 1.0], [1.0, 52.0]],
                0.0,
                "plant.axis.z.screw_error[1][1] = 52: differs by more than 50 µm",
            ),
            (&[], 45.0, "plant.axis.z.screw_wobble_um = 45: must be at most 39.8 with a lead of 5 mm"),
        ] {
            let message = screw(rows, wobble_um, 0.0).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}");
        }
        assert!(screw(&[], 0.0, 0.0).unwrap().is_none());
    }
}
