//! One control cycle of the whole machine. In: the drive commands that answer the present measurement, the
//! spindle command in force, perhaps what the operator does. Out: the next measurement, and the truth behind
//! it. A torque computed in cycle n − 1 acts from t_n to t_{n+1}.

mod axis;
mod outage;

use machine::Machine;
use protocol::operator::Request;
use protocol::{Axis, Cycle, DriveCommand, Measurement, Panel, PerAxis, SpindleCommand, Truth};

use crate::bus::Bus;
use crate::config::{self, PlantConfig, PlantError};
use crate::cutting::Cutter;
use crate::drive::Trip;
use crate::orders::{Order, Packet};
use crate::scale::Scale;
use crate::scenario::{Scenario, SpindleFault};
use crate::seed::Seed;
use crate::spindle::{self, Spindle};
use crate::timeline::{Moment, Timeline};
use axis::AxisPlant;

/// How fresh the spindle command is.
#[derive(Clone, Copy, Debug, Default)]
struct Freshness {
    /// Cycle of the command in force, and for how many control cycles it has been there.
    cycle: Cycle,
    age: u64,
    /// From this age on it is stale: three ticks of its sender and the one that it takes to come into force.
    stale: u64,
    /// Whether commands come at all; on a bench nobody sends them.
    come: bool,
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
    freshness: Freshness,
    /// Control cycles for which the mains have been off, and for which the drives have torque then.
    outage: u64,
    link_cycles: u64,
    bus: Bus,
    /// What is measured in the present cycle; regulators see of it what the bus has brought.
    fresh: Measurement,
    truth: Truth,
}

impl Plant {
    /// The machine before its first cycle: drives off, axes at home, the spindle at rest somewhere.
    ///
    /// # Errors
    /// [`PlantError`] names the key of `[plant.*]` that cannot be, and why; or an event for an axis that
    /// there is not.
    pub fn new(machine: &Machine, scenario: Scenario, seed: u64) -> Result<Plant, PlantError> {
        let config = PlantConfig::of(machine)?;
        let cycle_s = machine.general.cycle_s;
        let (mut seed, unseen) = (Seed(seed), Seed(seed));
        let own = unseen.branch(Axis::ALL.len() as u64);
        let spindle = Spindle::new(&machine.spindle, config.spindle, cycle_s, &mut seed, &own);
        let (mut axes, mut scales_mm) = (Vec::new(), Vec::new());
        for (axis, belief) in machine.axes() {
            let train = config.axis.get(&axis).cloned().unwrap_or_default();
            let facts = train.facts(belief);
            scales_mm.push(facts.scale_step_mm.zip(belief.scale_step_mm));
            let own = unseen.branch(axis.index() as u64);
            axes.push(AxisPlant::new(
                axis,
                belief,
                &train,
                &facts,
                [cycle_s, seed.fraction()],
                own,
                config.bus.lost_commands,
            )?);
        }
        // Drawn last: with a scale or without, the encoders lie where they lie.
        for (axis, steps_mm) in axes.iter_mut().zip(scales_mm) {
            let homes_mm = [axis.true_home_mm, axis.home_mm];
            axis.scale = steps_mm.map(|steps_mm| Scale::new(steps_mm.into(), homes_mm, seed.fraction()));
        }
        let z_mm = axes.iter().find(|own| own.axis == Axis::Z).map_or(0.0, |z| z.true_home_mm);
        let mut timeline = Timeline::new(cycle_s, config.cutting.rise_s, z_mm);
        timeline.begin_inputs(machine.inputs_with(|_| true), machine.inputs_with(|input| input.initial));
        let cutter = Cutter::new(config.cutting, config.chatter.mode(), machine);
        let freshness = Freshness { stale: 4 * machine.cycles_per_tick(), ..Freshness::default() };
        let link_cycles = (config.power.link_hold_s / cycle_s).round() as u64;
        let (fresh, truth) = (Measurement::default(), Truth::default());
        let bus = Bus::new(0, 0, &fresh);
        let mut plant =
            Plant { axes, spindle, timeline, cutter, freshness, outage: 0, link_cycles, bus, fresh, truth };
        plant.play(scenario)?;
        plant.sample(Cycle(0), &SpindleCommand::default());
        let config::Bus { input_cycles, output_cycles, .. } = config.bus;
        plant.bus = Bus::new(input_cycles, output_cycles, &plant.fresh);
        Ok(plant)
    }

    /// Plays a scenario from here on; so far there was none. Its events lie behind the present cycle.
    ///
    /// # Errors
    /// [`PlantError`] if an event is for an axis or an input that there is not.
    pub fn play(&mut self, scenario: Scenario) -> Result<(), PlantError> {
        let there = |axis: Axis| self.axes.iter().any(|own| own.axis == axis);
        if let Some((event, axis)) = scenario.axes().find(|(_, axis)| !there(*axis)) {
            return Err(PlantError::NoAxisToActOn { event, axis: axis.name() });
        }
        let inputs = self.timeline.known_inputs();
        if let Some((event, number)) = scenario.inputs().find(|(_, number)| inputs >> number & 1 == 0) {
            return Err(PlantError::NoInputToActOn { event, number });
        }
        self.timeline.play(scenario);
        Ok(())
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

    /// The messages that the scenario wants tampered with from this cycle on, by whoever runs the machine.
    /// Whom it wants killed or frozen is in the truth ([`Truth::doom`]).
    pub fn packet(&self) -> Option<Packet> {
        match self.timeline.order() {
            Some(Order::Packet(packet)) => Some(packet),
            _ => None,
        }
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
        self.break_axes();
        let late = self.bus.output_cycles();
        let drives = self.bus.commanded(drives);
        for axes in self.axes.chunks_mut(2) {
            let acting = |own: &mut AxisPlant| {
                let index = own.axis.index();
                own.acting(now, late, &drives[index], self.truth.axes[index].force_n)
            };
            match axes {
                [one, other] => {
                    let (here, there) = (acting(one), acting(other));
                    one.train.advance_both(here, &mut other.train, there);
                }
                _ => axes.iter_mut().for_each(|own| {
                    let here = acting(own);
                    own.train.advance(here);
                }),
            }
            axes.iter_mut().for_each(AxisPlant::count);
        }
        let [load_nm, ..] = self.timeline.burdens();
        let fault = self.timeline.breakages().spindle();
        let jam_nm = if fault == Some(SpindleFault::Jam) { self.spindle.jam_nm() } else { 0.0 };
        let drive = self.spindle_drive(spindle, fault);
        self.spindle.advance(drive, load_nm + self.truth.cut.torque_nm + jam_nm);
        let opens = spindle.finished == SpindleCommand::EMERGENCY_STOP;
        for request in request.into_iter().chain(opens.then_some(Request::EmergencyStop)) {
            self.timeline.operate(request);
        }
        self.sample(now.after(1), spindle);
    }

    /// What the scenario breaks at the axes, and the end of their link without mains.
    fn break_axes(&mut self) {
        if let Some(breakages) = self.timeline.breakages().take() {
            self.axes.iter_mut().for_each(|axis| axis.suffer(&breakages[axis.axis.index()]));
        }
        if self.truth.measurement.panel.pressed(Panel::POWER_LOST) {
            self.outage += 1;
            if self.outage > self.link_cycles {
                self.axes.iter_mut().for_each(|axis| axis.drive.trip(Trip::TorqueLost));
            }
        }
    }

    /// What the drive of the spindle does. By itself: with the emergency stop it brakes on its ramp, and one
    /// that does not obey loses its torque; without mains it has none; and when nobody commands it any more
    /// it brakes as soon as no axis follows its regulator.
    fn spindle_drive(&mut self, command: &SpindleCommand, fault: Option<SpindleFault>) -> spindle::Drive {
        use spindle::Drive;
        let panel = &self.truth.measurement.panel;
        let stopped = panel.pressed(Panel::EMERGENCY_STOP);
        let deserted =
            self.freshness.is_stale(command) && !self.axes.iter().any(|axis| axis.drive.is_enabled());
        let rpm = if stopped || deserted { 0.0 } else { command.rpm };
        match fault {
            _ if panel.pressed(Panel::POWER_LOST) => Drive::Coasts,
            Some(SpindleFault::Stall) => Drive::Coasts,
            Some(SpindleFault::Runaway | SpindleFault::Reversal) if stopped => Drive::Coasts,
            Some(SpindleFault::Runaway) => Drive::RunsAway(command.rpm),
            Some(SpindleFault::Reversal) => Drive::To(-rpm),
            Some(SpindleFault::Jam) | None => Drive::To(rpm),
        }
    }

    /// Writes the truth of a cycle, and what is measured of it.
    fn sample(&mut self, now: Cycle, command: &SpindleCommand) {
        self.truth.cycle = now;
        self.truth.spindle_deg = 360.0 * self.spindle.turns();
        self.truth.spindle_rpm = self.spindle.rpm();
        self.truth.spindle_torque_nm = self.spindle.torque_nm();
        let measurement = &mut self.fresh;
        measurement.cycle = now;
        measurement.last = u32::from(command.is_last());
        self.spindle.measure(now, self.timeline.encoder(), measurement);
        for axis in &self.axes {
            let index = axis.axis.index();
            let motion = axis.train.motion();
            let (nut_m, nut_m_s) = axis.train.nut();
            let slide_mm = axis.true_home_mm + 1e3 * motion.slide_m;
            self.fresh.axes[index] = axis.measured(now);
            self.fresh.references[index] = axis.reference;
            let truth = &mut self.truth.axes[index];
            truth.motor_mm = axis.true_home_mm + 1e3 * nut_m;
            truth.slide_mm = slide_mm;
            // With a tool that gives way, where the tool is.
            if let (Axis::X, Some(bent_mm)) = (axis.axis, self.cutter.bent_mm()) {
                truth.slide_mm += bent_mm;
            }
            truth.velocity_mm_s = 1e3 * nut_m_s;
            truth.torque_nm = axis.train.torque_nm();
        }
        let index = (self.fresh.index_number > 0)
            .then(|| (360.0 * self.spindle.index_turn(), self.fresh.index_cycle));
        let moment = Moment {
            cycle: now,
            z_mm: self.truth.axes[Axis::Z.index()].slide_mm,
            spindle_deg: self.truth.spindle_deg,
            spindle_rpm: self.truth.spindle_rpm,
            index,
        };
        self.timeline.advance(&moment, command);
        self.fresh.panel = self.timeline.panel();
        self.fresh.inputs = self.timeline.inputs();
        self.truth.measurement = self.bus.measured(&self.fresh);
        (self.truth.doom, self.truth.doomed) = match self.timeline.order() {
            Some(Order::Doom(doom, module)) => (doom as u32, module.code()),
            _ => (0, 0),
        };
        let told = self.timeline.pending().take_while(|event| *event <= u64::BITS as usize);
        self.truth.pending = told.fold(0, |bits, event| bits | 1 << (event - 1));
        self.cut(command);
    }

    /// What the cut and the scenario do to the slides until the next cycle.
    fn cut(&mut self, command: &SpindleCommand) {
        let place =
            |axis| self.axes.iter().find(|own| own.axis == axis).map_or(0.0, AxisPlant::slide_ahead_mm);
        let turned = self.spindle.rpm() / 60.0 * self.spindle.cycle_s();
        self.truth.cut = self.cutter.cut(command, place(Axis::X), place(Axis::Z), turned);
        let [_, axial_n, radial_n] = self.timeline.burdens();
        let [out, against] = self.cutter.directions();
        self.truth.axes[Axis::X.index()].force_n = radial_n + out * self.truth.cut.radial_n;
        self.truth.axes[Axis::Z.index()].force_n = axial_n + against * self.truth.cut.axial_n;
        for axis in self.axes.iter().map(|own| own.axis) {
            if let Some(force_n) = self.timeline.breakages().spike_n(axis) {
                let truth = &mut self.truth.axes[axis.index()];
                let steady_n = if matches!(axis, Axis::X | Axis::Z) { truth.force_n } else { 0.0 };
                truth.force_n = steady_n + force_n;
            }
        }
    }
}

impl Freshness {
    /// Before the first command.
    fn anew(self) -> Freshness {
        Freshness { stale: self.stale, ..Freshness::default() }
    }

    /// Whether the command in force has not been followed by another for too long. Asked once a cycle.
    fn is_stale(&mut self, command: &SpindleCommand) -> bool {
        self.come |= command.cycle != self.cycle;
        self.age = if command.cycle == self.cycle { self.age + 1 } else { 0 };
        self.cycle = command.cycle;
        self.come && self.age > self.stale
    }
}
