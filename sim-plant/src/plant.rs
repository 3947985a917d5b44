//! One control cycle of the whole machine. In: the drive commands that answer the present measurement, the
//! spindle command in force, perhaps what the operator does. Out: the next measurement, and the truth behind
//! it. A torque computed in cycle n − 1 acts from t_n to t_{n+1}.

use machine::Machine;
use protocol::operator::Request;
use protocol::{
    Axis, Cycle, DriveCommand, Measurement, PerAxis, Position, SpindleCommand, StatusWord, Truth,
};

use crate::config::{PlantConfig, PlantError};
use crate::cutting::Cutter;
use crate::drive::Drive;
use crate::drive_train::DriveTrain;
use crate::scale::Scale;
use crate::scenario::Scenario;
use crate::seed::Seed;
use crate::spindle::Spindle;
use crate::timeline::{Moment, Timeline};

/// One axis: drive, mechanics, encoder at the motor, perhaps a scale at the slide.
#[derive(Clone, Debug)]
struct AxisPlant {
    axis: Axis,
    home_mm: f64,
    drive: Drive,
    train: DriveTrain,
    /// Torque command computed in the cycle before; `None` without power.
    torque_nm: Option<f64>,
    quantum_mm: f64,
    inverse_cycle: f64,
    /// Where home lies within its count, a share of one.
    encoder_phase: f64,
    count: f64,
    count_before: f64,
    scale: Option<Scale>,
}

/// The simulated machine.
///
/// ```
/// use machine::Machine;
/// use protocol::{Cycle, SpindleCommand};
/// use sim_plant::{Plant, Scenario};
/// let mut plant = Plant::new(&Machine::default(), Scenario::none(), 1)?;
/// let spindle = SpindleCommand { rpm: 600.0, ..SpindleCommand::default() };
/// for _ in 0..4000 {
///     plant.tick(&Default::default(), &spindle, None);
/// }
/// assert_eq!(plant.measurement().cycle, Cycle(4000));
/// assert!((plant.truth().spindle_rpm - 600.0).abs() < 2.0);
/// # Ok::<(), sim_plant::PlantError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Plant {
    axes: Vec<AxisPlant>,
    spindle: Spindle,
    timeline: Timeline,
    cutter: Cutter,
    truth: Truth,
}

impl Plant {
    /// The machine before its first cycle: drives off, axes at home, the spindle at rest somewhere.
    ///
    /// # Errors
    /// [`PlantError`] names the key of `[plant.*]` that cannot be, and why.
    pub fn new(machine: &Machine, scenario: Scenario, seed: u64) -> Result<Plant, PlantError> {
        let config = PlantConfig::of(machine)?;
        let cycle_s = machine.general.cycle_s;
        let mut seed = Seed(seed);
        let spindle = Spindle::new(&machine.spindle, config.spindle, cycle_s, &mut seed);
        let mut axes = Vec::new();
        for (axis, belief) in machine.axes() {
            let train = config.axis.get(&axis).cloned().unwrap_or_default();
            axes.push(AxisPlant {
                axis,
                home_mm: belief.home_mm,
                drive: Drive::new(belief, &train, cycle_s),
                train: DriveTrain::new(&train, axis, belief, cycle_s)?,
                torque_nm: None,
                quantum_mm: belief.screw_lead_mm / f64::from(belief.encoder_counts),
                inverse_cycle: 1.0 / cycle_s,
                encoder_phase: seed.fraction(),
                count: 0.0,
                count_before: 0.0,
                scale: None,
            });
        }
        // Drawn last: with a scale or without, the encoders lie where they lie.
        for axis in &mut axes {
            let step_mm = machine.axis.get(&axis.axis).and_then(|belief| belief.scale_step_mm);
            axis.scale = step_mm.map(|step_mm| Scale::new(step_mm, seed.fraction()));
        }
        let z_mm = machine.axis.get(&Axis::Z).map_or(0.0, |z| z.home_mm);
        let timeline = Timeline::new(scenario, cycle_s, config.cutting.rise_s, z_mm);
        let cutter = Cutter::new(config.cutting, machine);
        let mut plant = Plant { axes, spindle, timeline, cutter, truth: Truth::default() };
        let turns = plant.spindle.turns();
        plant.sample(Cycle(0), turns, &SpindleCommand::default());
        Ok(plant)
    }

    /// What the controllers see in the present cycle; the first is cycle 0.
    pub fn measurement(&self) -> &Measurement {
        &self.truth.measurement
    }

    /// What is true in the present cycle.
    pub fn truth(&self) -> &Truth {
        &self.truth
    }

    /// Numbers, from 1, of the events of the scenario that did not happen yet.
    pub fn pending_events(&self) -> impl Iterator<Item = usize> {
        self.timeline.pending()
    }

    /// An answer to the present measurement came too late; the drive goes on with the one before.
    pub fn note_late(&mut self) {
        self.truth.late_answers += 1;
    }

    /// One control cycle: takes the answers to the present measurement, the spindle command in force and
    /// perhaps what the operator does, and goes on to the next cycle. A command with `finished` makes that
    /// measurement the last.
    pub fn tick(
        &mut self,
        drives: &PerAxis<DriveCommand>,
        spindle: &SpindleCommand,
        request: Option<Request>,
    ) {
        let now = self.truth.cycle;
        for axis in &mut self.axes {
            let index = axis.axis.index();
            axis.advance(now, &drives[index], self.truth.axes[index].force_n);
        }
        let turns_before = self.spindle.turns();
        let [load_nm, ..] = self.timeline.burdens();
        self.spindle.advance(spindle.rpm, load_nm + self.truth.cut.torque_nm);
        if let Some(request) = request {
            self.timeline.operate(request);
        }
        self.sample(now.after(1), turns_before, spindle);
    }

    /// Writes the truth of a cycle, and what is measured of it.
    fn sample(&mut self, now: Cycle, turns_before: f64, command: &SpindleCommand) {
        self.truth.cycle = now;
        self.truth.spindle_deg = 360.0 * self.spindle.turns();
        self.truth.spindle_rpm = self.spindle.rpm();
        self.truth.spindle_torque_nm = self.spindle.torque_nm();
        let measurement = &mut self.truth.measurement;
        measurement.cycle = now;
        measurement.last = u32::from(command.finished != 0);
        self.spindle.measure(turns_before, now, self.timeline.encoder(), measurement);
        for axis in &self.axes {
            let index = axis.axis.index();
            let motion = axis.train.motion();
            let (nut_m, nut_m_s) = axis.train.nut();
            let slide_mm = axis.home_mm + 1e3 * motion.slide_m;
            let measured = &mut self.truth.measurement.axes[index];
            measured.position = axis.position();
            measured.scale = axis.scale.map_or(measured.position, |scale| scale.position(slide_mm));
            measured.torque_nm = motion.torque_nm;
            let StatusWord(word) = axis.drive.status_word();
            measured.status_word = u32::from(word);
            let truth = &mut self.truth.axes[index];
            truth.motor_mm = axis.home_mm + 1e3 * nut_m;
            truth.slide_mm = slide_mm;
            truth.velocity_mm_s = 1e3 * nut_m_s;
            truth.torque_nm = motion.torque_nm;
        }
        let index = (self.truth.measurement.index_number > 0)
            .then(|| (360.0 * self.spindle.index_turn(), self.truth.measurement.index_cycle));
        let moment = Moment {
            cycle: now,
            z_mm: self.truth.axes[Axis::Z.index()].slide_mm,
            spindle_deg: self.truth.spindle_deg,
            spindle_rpm: self.truth.spindle_rpm,
            index,
        };
        self.timeline.advance(&moment, command);
        self.truth.measurement.panel = self.timeline.panel();
        self.cut(command);
    }

    /// What the cut and the scenario do to the slides until the next cycle.
    fn cut(&mut self, command: &SpindleCommand) {
        let place =
            |axis| self.axes.iter().find(|own| own.axis == axis).map_or(0.0, AxisPlant::slide_ahead_mm);
        self.truth.cut = self.cutter.cut(command, place(Axis::X), place(Axis::Z));
        let [_, axial_n, radial_n] = self.timeline.burdens();
        let [out, against] = self.cutter.directions();
        self.truth.axes[Axis::X.index()].force_n = radial_n + out * self.truth.cut.radial_n;
        self.truth.axes[Axis::Z.index()].force_n = axial_n + against * self.truth.cut.axial_n;
    }
}

impl AxisPlant {
    fn advance(&mut self, now: Cycle, command: &DriveCommand, force_n: f64) {
        let v_meas = (self.count - self.count_before) * self.quantum_mm * self.inverse_cycle;
        let answer = self.drive.answer(now, command, v_meas);
        // Power comes with the first torque; it goes at once, and the brake with it.
        let acting = answer.and(self.torque_nm);
        self.train.advance(acting, force_n);
        self.torque_nm = answer;
        self.count_before = self.count;
        let motor_mm = 1e3 * self.train.motion().motor_m;
        self.count = (motor_mm / self.quantum_mm + self.encoder_phase).floor();
    }

    /// Where the slide will be in the middle of the cycle that begins, mm.
    fn slide_ahead_mm(&self) -> f64 {
        let motion = self.train.motion();
        self.home_mm + 1e3 * (motion.slide_m + 0.5 * motion.slide_m_s / self.inverse_cycle)
    }

    /// Middle of the count.
    fn position(&self) -> Position {
        Position::from_mm(self.home_mm + (self.count + 0.5 - self.encoder_phase) * self.quantum_mm)
    }
}
