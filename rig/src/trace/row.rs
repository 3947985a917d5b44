//! One control cycle as a row of columns. In: a record of the run. Out: cells of eight bytes, in one order
//! for every file. Positions in mm, angles in degrees, speeds of the spindle in 1/min, of axes in mm/sⁿ,
//! torques in N·m; degrees for mm where an axis is rotary.

use protocol::{Axis, AxisState, Motion};

use super::{columns::columns, thin::STRIDE};
use crate::observe::{Led, Observer, Record, Traced, TracedPoint, contour_error_mm};

/// One axis in one control cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisRow {
    /// Where the program wants it: in a pass the law at the true spindle angle, otherwise as commanded.
    pub programmed: f64,
    /// Commanded position at the sample instant.
    pub commanded: f64,
    /// Measured position.
    pub measured: f64,
    /// True position at the motor.
    pub true_mm: f64,
    /// Commanded speed, mm/s.
    pub velocity: f64,
    /// Commanded acceleration, mm/s².
    pub acceleration: f64,
    /// Commanded jerk, mm/s³.
    pub jerk: f64,
    /// Commanded minus measured position at the sample instant.
    pub servo_error: f64,
    /// True torque of the motor, N·m.
    pub torque: f64,
    /// State of the regulator.
    pub state: AxisState,
    /// True position of the slide behind the elastic mode.
    pub slide: f64,
    /// Force on the slide, in the direction of the axis, N.
    pub force: f64,
}

/// What is cut in one control cycle (M74–M76), and what drives the spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CutRow {
    /// Chip area, mm².
    pub area: f64,
    /// Tangential force, N.
    pub force: f64,
    /// Torque that holds the spindle back, N·m.
    pub torque: f64,
    /// True torque of the spindle motor, N·m, signed.
    pub motor_torque: f64,
}

/// One control cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The cycle.
    pub cycle: u64,
    /// Time on the machine, s.
    pub t_s: f64,
    /// True spindle angle, unwrapped.
    pub spindle_true_deg: f64,
    /// Counts of the spindle encoder, unwrapped.
    pub spindle_counts: i64,
    /// True spindle speed, signed.
    pub spindle_rpm: f64,
    /// Spindle override on the panel, per cent.
    pub override_pct: f64,
    /// The axes in the order of the wire.
    pub axes: Vec<(Axis, AxisRow)>,
    /// Pass that the axes are armed for or cut; 0 in timed motion.
    pub pass: u32,
    /// Line of the part program.
    pub line: u32,
    /// What is cut.
    pub cut: CutRow,
    /// What was measured of a contour, a surface or a seam.
    pub traced: Traced,
    /// The tool, and how its commanded position moves.
    pub led: Led,
}

impl Row {
    /// The row of a record that `observer` has just taken; `cycle_s` is the control cycle.
    pub fn of(record: &Record, observer: &Observer, cycle_s: f64) -> Row {
        let truth = record.truth;
        let axis_row = |(axis, status): &(Axis, protocol::AxisStatus)| {
            let place = &truth.axes[axis.index()];
            let row = AxisRow {
                programmed: observer.programmed_mm(record, *axis),
                commanded: status.commanded_mm,
                measured: truth.measurement.axes[axis.index()].position.mm(),
                true_mm: place.motor_mm,
                velocity: status.velocity_mm_s,
                acceleration: status.acceleration_mm_s2,
                jerk: status.jerk_mm_s3,
                servo_error: status.servo_error_mm,
                torque: place.torque_nm,
                state: status.state(),
                slide: place.slide_mm,
                force: place.force_n,
            };
            (*axis, row)
        };
        let in_pass = |(_, status): &&(Axis, protocol::AxisStatus)| status.state().is_in_pass();
        Row {
            cycle: truth.cycle.0,
            t_s: truth.cycle.0 as f64 * cycle_s,
            spindle_true_deg: truth.spindle_deg,
            spindle_counts: truth.measurement.spindle_count,
            spindle_rpm: truth.spindle_rpm,
            override_pct: truth.measurement.panel.spindle_override_pct,
            axes: record.axes.iter().map(axis_row).collect(),
            pass: record.axes.iter().find(in_pass).map_or(0, |(_, status)| status.pass),
            line: record.machine.line,
            cut: CutRow {
                area: truth.cut.area_mm2,
                force: truth.cut.force_n,
                torque: truth.cut.torque_nm,
                motor_torque: truth.spindle_torque_nm,
            },
            traced: observer.traced(),
            led: observer.led(),
        }
    }

    /// One axis of the row.
    pub fn axis(&self, axis: Axis) -> Option<&AxisRow> {
        self.axes.iter().find(|(other, _)| *other == axis).map(|(_, row)| row)
    }

    /// Distance of the true position (linear axes, at the motors) from the commanded path, mm; `None` if the
    /// axes stand or are not in timed motion.
    pub fn contour_error_mm(&self) -> Option<f64> {
        let linear = self.axes.iter().filter(|(axis, _)| !axis.is_rotary());
        let streaming = self.axes.iter().all(|(_, row)| row.state == AxisState::Streaming);
        let error = contour_error_mm(linear.map(|(_, row)| (row.true_mm - row.commanded, row.velocity)));
        error.filter(|_| streaming)
    }

    /// How far the tool is from where it was commanded to be, mm: normal to its path, or from the contour,
    /// surface or seam that it cuts.
    pub(super) fn off_mm(&self) -> f64 {
        let path = self.contour_error_mm().unwrap_or(0.0);
        path.max(self.traced.slide.deviation_mm.abs())
    }

    /// By how many cycles this row comes after the one of a cycle, as far as the two belong together.
    pub fn after(&self, before: Option<u64>) -> Option<u64> {
        let apart = self.cycle.checked_sub(before?)?;
        (1..=STRIDE).contains(&apart).then_some(apart)
    }

    /// The first column in which two rows of one machine differ in any bit, and what stands there.
    pub fn first_difference(&self, other: &Row) -> Option<(String, [f64; 2])> {
        let cells = |row: &Row| {
            let mut cells = Vec::new();
            row.cells(|cell| cells.push(cell.bits()));
            cells
        };
        let axes: Vec<Axis> = self.axes.iter().map(|(axis, _)| *axis).collect();
        let mut pairs = columns(&axes).into_iter().zip(cells(self).into_iter().zip(cells(other)));
        let (name, (one, other)) = pairs.find(|(_, (one, other))| one.0 != other.0)?;
        Some((name, [one.1, other.1]))
    }

    /// All of it as numbers in the order of [`columns`]: states and motion by their codes.
    pub fn numbers(&self, mut put: impl FnMut(f64)) {
        self.cells(|cell| put(cell.bits().1));
    }

    /// The row of such numbers, of a machine with these axes.
    ///
    /// # Errors
    /// Some are missing, or are not codes.
    pub fn from_numbers(axes: &[Axis], numbers: &[f64]) -> Result<Row, &'static str> {
        Row::from_cells(axes, &mut Numbers(numbers.iter()))
    }

    /// The cells in the order of [`columns`].
    pub(super) fn cells(&self, mut put: impl FnMut(Cell)) {
        let Row { t_s, spindle_true_deg, spindle_rpm, override_pct, .. } = *self;
        put(Cell::Count(self.cycle as i64));
        [t_s, spindle_true_deg].into_iter().for_each(|value| put(Cell::Real(value)));
        put(Cell::Count(self.spindle_counts));
        [spindle_rpm, override_pct].into_iter().for_each(|value| put(Cell::Real(value)));
        for (_, axis) in &self.axes {
            let AxisRow { programmed, commanded, measured, true_mm, velocity, acceleration, jerk, .. } =
                *axis;
            [programmed, commanded, measured, true_mm, velocity, acceleration, jerk]
                .into_iter()
                .for_each(|value| put(Cell::Real(value)));
            [axis.servo_error, axis.torque].into_iter().for_each(|value| put(Cell::Real(value)));
            put(Cell::State(axis.state));
        }
        put(Cell::Count(i64::from(self.pass)));
        put(Cell::Count(i64::from(self.line)));
        self.axes.iter().for_each(|(_, axis)| put(Cell::Real(axis.slide)));
        self.axes.iter().for_each(|(_, axis)| put(Cell::Real(axis.force)));
        let CutRow { area, force, torque, motor_torque } = self.cut;
        [area, force, torque, motor_torque].into_iter().for_each(|value| put(Cell::Real(value)));
        let Traced { trace, commanded, slide } = self.traced;
        put(Cell::Count(i64::from(trace)));
        for TracedPoint { deviation_mm, angle_deg, feed_mm_min } in [commanded, slide] {
            [deviation_mm, angle_deg, feed_mm_min].into_iter().for_each(|value| put(Cell::Real(value)));
        }
        put(Cell::Count(i64::from(self.led.tool)));
        put(Cell::Motion(self.led.motion));
    }

    /// The row of cells in the order of [`columns`].
    pub(super) fn from_cells<E>(axes: &[Axis], cells: &mut impl Cells<Error = E>) -> Result<Row, E> {
        let mut row = Row {
            cycle: cells.count()? as u64,
            t_s: cells.real()?,
            spindle_true_deg: cells.real()?,
            spindle_counts: cells.count()?,
            spindle_rpm: cells.real()?,
            override_pct: cells.real()?,
            axes: Vec::with_capacity(axes.len()),
            pass: 0,
            line: 0,
            cut: CutRow::default(),
            traced: Traced::default(),
            led: Led::default(),
        };
        for axis in axes {
            let axis_row = AxisRow {
                programmed: cells.real()?,
                commanded: cells.real()?,
                measured: cells.real()?,
                true_mm: cells.real()?,
                velocity: cells.real()?,
                acceleration: cells.real()?,
                jerk: cells.real()?,
                servo_error: cells.real()?,
                torque: cells.real()?,
                state: cells.state()?,
                slide: 0.0,
                force: 0.0,
            };
            row.axes.push((*axis, axis_row));
        }
        (row.pass, row.line) = (cells.count()? as u32, cells.count()? as u32);
        for (_, axis) in &mut row.axes {
            axis.slide = cells.real()?;
        }
        for (_, axis) in &mut row.axes {
            axis.force = cells.real()?;
        }
        let CutRow { area, force, torque, motor_torque } = &mut row.cut;
        for value in [area, force, torque, motor_torque] {
            *value = cells.real()?;
        }
        row.traced.trace = cells.count()? as u32;
        for point in [&mut row.traced.commanded, &mut row.traced.slide] {
            (point.deviation_mm, point.angle_deg) = (cells.real()?, cells.real()?);
            point.feed_mm_min = cells.real()?;
        }
        row.led = Led { tool: cells.count()? as u32, motion: cells.motion()? };
        Ok(row)
    }
}

/// One value of a row.
#[derive(Clone, Copy)]
pub(super) enum Cell {
    Count(i64),
    Real(f64),
    State(AxisState),
    Motion(Motion),
}

impl Cell {
    /// All of its bits, and what it is as a number.
    fn bits(self) -> (u64, f64) {
        match self {
            Cell::Count(count) => (count as u64, count as f64),
            Cell::Real(value) => (value.to_bits(), value),
            Cell::State(state) => (state as u64, f64::from(state as u32)),
            Cell::Motion(motion) => (motion as u64, f64::from(motion as u32)),
        }
    }
}

/// Where cells come from, in order.
pub(super) trait Cells {
    type Error;
    fn count(&mut self) -> Result<i64, Self::Error>;
    fn real(&mut self) -> Result<f64, Self::Error>;
    fn state(&mut self) -> Result<AxisState, Self::Error>;
    fn motion(&mut self) -> Result<Motion, Self::Error>;
}

/// The cells of a row of numbers.
struct Numbers<'a>(std::slice::Iter<'a, f64>);

impl Cells for Numbers<'_> {
    type Error = &'static str;

    fn count(&mut self) -> Result<i64, &'static str> {
        self.real().map(|number| number as i64)
    }

    fn real(&mut self) -> Result<f64, &'static str> {
        self.0.next().copied().ok_or("a row is too short")
    }

    fn state(&mut self) -> Result<AxisState, &'static str> {
        AxisState::from_code(self.real()? as u32).map_err(|_| "a row holds an unknown state")
    }

    fn motion(&mut self) -> Result<Motion, &'static str> {
        Motion::from_code(self.real()? as u32).map_err(|_| "a row holds an unknown motion")
    }
}
