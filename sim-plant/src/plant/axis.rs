//! One axis of the machine: drive, mechanics, encoder, scale, and what it is referenced by. In: its command
//! and the force on it, cycle by cycle. Out: what is measured of it.

use machine::AxisConfig;
use protocol::{Axis, AxisMeasurement, AxisReference, Cycle, DriveCommand, Position, StatusWord};

use crate::PlantError;
use crate::breakages::AxisBreakage;
use crate::config::{AxisTrain, Facts};
use crate::drive::Drive;
use crate::drive_train::{Acting, DriveTrain};
use crate::marks::Marks;
use crate::meter::Meter;
use crate::scale::Scale;
use crate::seed::Seed;

/// One axis: drive, mechanics, encoder at the motor, perhaps a scale at the slide.
#[derive(Clone, Debug)]
pub(super) struct AxisPlant {
    pub(super) axis: Axis,
    /// Where the axis was referenced, as the controller believes and as it is.
    pub(super) home_mm: f64,
    pub(super) true_home_mm: f64,
    pub(super) drive: Drive,
    pub(super) train: DriveTrain,
    meter: Meter,
    /// Torque command computed in the cycle before; `None` without power.
    torque_nm: Option<f64>,
    /// A count, as the controller believes and as it is.
    quantum_mm: f64,
    true_quantum_mm: f64,
    inverse_cycle: f64,
    /// Where home lies within its count, a share of one.
    encoder_phase: f64,
    /// Counts that the counter has jumped by.
    jumped: f64,
    count: f64,
    count_before: f64,
    pub(super) scale: Option<Scale>,
    /// By what it is referenced, if it is.
    marks: Option<Marks>,
    /// What is told of that, and the positions before the offset was added.
    pub(super) reference: AxisReference,
    switch: bool,
    indexes: u32,
    latched: [Position; 2],
    /// Where the motor was a cycle ago, mm from where it began, and the slide.
    before_mm: [f64; 2],
}

impl AxisPlant {
    /// An axis at home, its drive off. `own` is what is drawn for it alone.
    pub(super) fn new(
        axis: Axis,
        belief: &AxisConfig,
        train: &AxisTrain,
        facts: &Facts,
        [cycle_s, encoder_phase]: [f64; 2],
        mut own: Seed,
        lost_commands: u32,
    ) -> Result<AxisPlant, PlantError> {
        let drawn = own.clone();
        let drives = DriveTrain::new(train, axis, facts, cycle_s, &mut own)?;
        let marks = Marks::of(belief, train, facts, &drives, encoder_phase, &drawn);
        Ok(AxisPlant {
            axis,
            home_mm: belief.home_mm,
            true_home_mm: facts.home_mm,
            drive: Drive::new(belief, train, lost_commands, cycle_s),
            train: drives,
            meter: Meter::new(train.torque_noise_nm, train.torque_step_nm, own),
            torque_nm: None,
            quantum_mm: belief.screw_lead_mm / f64::from(belief.encoder_counts),
            true_quantum_mm: facts.screw_lead_mm / f64::from(facts.encoder_counts),
            inverse_cycle: 1.0 / cycle_s,
            encoder_phase,
            jumped: 0.0,
            count: 0.0,
            count_before: 0.0,
            scale: None,
            marks,
            reference: AxisReference::default(),
            switch: false,
            indexes: 0,
            latched: [Position::default(); 2],
            before_mm: [0.0, facts.home_mm],
        })
    }

    /// What is measured of the axis in a cycle, with the offset that its drive adds.
    pub(super) fn measured(&self, now: Cycle) -> AxisMeasurement {
        let offset = self.reference.home_offset;
        let position = self.position();
        let scale = self.scale.map_or(position, |scale| scale.position(self.slide_mm()));
        let StatusWord(word) = self.drive.status_word();
        AxisMeasurement {
            position: moved(position, offset),
            scale: moved(scale, offset),
            torque_nm: self.meter.show(now, self.train.motion().torque_nm),
            status_word: u32::from(word),
            signals: AxisMeasurement::signals(self.switch, self.indexes),
        }
    }

    /// Where the slide truly is, mm.
    fn slide_mm(&self) -> f64 {
        self.true_home_mm + 1e3 * self.train.motion().slide_m
    }
    /// Something breaks.
    pub(super) fn suffer(&mut self, breakage: &AxisBreakage) {
        breakage.trip.into_iter().for_each(|trip| self.drive.trip(trip));
        self.jumped += (breakage.jump_mm / self.quantum_mm).round();
    }

    /// What acts on the mechanics until the next cycle, when the drive has a command.
    /// It has been under way for `late` cycles.
    pub(super) fn acting(&mut self, now: Cycle, late: u64, command: &DriveCommand, force_n: f64) -> Acting {
        if self.reference.home_offset != command.home_offset {
            self.reference.home_offset = command.home_offset;
            self.tell_reference();
        }
        let v_meas = (self.count - self.count_before) * self.quantum_mm * self.inverse_cycle;
        let answer = self.drive.answer(now, late, command, v_meas);
        // Power comes with the first torque; it goes at once, and the brake with it.
        let command_nm = answer.and(self.torque_nm);
        self.torque_nm = answer;
        Acting { command_nm, force_n }
    }

    /// The encoder counts on to where the motor has come.
    pub(super) fn count(&mut self) {
        self.count_before = self.count;
        let motor_mm = 1e3 * self.train.motion().motor_m;
        self.count = (motor_mm / self.true_quantum_mm + self.encoder_phase).floor();
        self.pass_marks(motor_mm);
        if self.jumped != 0.0 {
            self.count += self.jumped;
        }
    }

    /// What switch and index say of the cycle that is over, before its count jumps.
    fn pass_marks(&mut self, motor_mm: f64) {
        let slide_mm = self.slide_mm();
        let [motor_before_mm, slide_before_mm] = std::mem::replace(&mut self.before_mm, [motor_mm, slide_mm]);
        let Some(marks) = &mut self.marks else { return };
        let passed = marks.pass(slide_mm, self.count);
        self.switch = passed.on;
        let between = |share: f64, from_mm: f64, to_mm: f64| from_mm + share * (to_mm - from_mm);
        let latched = |share: f64, edge: Option<f64>| match self.scale {
            Some(scale) => scale.position(between(share, slide_before_mm, slide_mm)),
            None => {
                let count =
                    between(share, motor_before_mm, motor_mm) / self.true_quantum_mm + self.encoder_phase;
                self.position_of(edge.unwrap_or(count.floor() + 0.5) + self.jumped)
            }
        };
        let switched = passed.switched.map(|share| latched(share, None));
        let indexed = passed.indexed.map(|(share, edge)| latched(share, Some(edge)));
        self.indexes = self.indexes.wrapping_add(u32::from(indexed.is_some()));
        let [switched_before, indexed_before] = self.latched;
        self.latched = [switched.unwrap_or(switched_before), indexed.unwrap_or(indexed_before)];
        self.tell_reference();
    }

    /// Positions are told with the offset.
    fn tell_reference(&mut self) {
        let offset = self.reference.home_offset;
        [self.reference.switched_at, self.reference.indexed_at] = self.latched.map(|at| moved(at, offset));
    }

    /// Where the slide will be in the middle of the cycle that begins, mm.
    pub(super) fn slide_ahead_mm(&self) -> f64 {
        let motion = self.train.motion();
        self.true_home_mm + 1e3 * (motion.slide_m + 0.5 * motion.slide_m_s / self.inverse_cycle)
    }

    /// Middle of the count, as the controller takes it (M116).
    fn position(&self) -> Position {
        self.position_of(self.count + 0.5)
    }

    /// A place among the counts, before any offset.
    fn position_of(&self, count: f64) -> Position {
        Position::from_mm(self.home_mm + (count - self.encoder_phase) * self.quantum_mm)
    }

    /// Switched on again: what the drive was told is gone, and where the axis was counted to is not.
    pub(super) fn switch_on(&mut self) {
        self.drive.switch_on();
        (self.torque_nm, self.jumped) = (None, 0.0);
        (self.reference, self.latched, self.indexes) = Default::default();
        self.count();
        self.count_before = self.count;
    }
}

/// A position with an offset.
fn moved(position: Position, offset: Position) -> Position {
    Position(position.0.saturating_add(offset.0))
}
