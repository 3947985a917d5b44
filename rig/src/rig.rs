//! The whole machine in one process: the same modules, in the same order, with the same one feedback delay as
//! the processes over iceoryx2, so that both give the same numbers bit for bit.
//!
//! Enters: machine code, a scenario, a seed, wires; each control cycle, perhaps what the operator does at the
//! panel. Leaves, each control cycle: a [`Record`] of it, or the whole [`Exchange`] between the modules.
//!
//! A module can die and hang ([`Rig::kill`], [`Rig::freeze`]), from outside or by the scenario: what it would
//! have sent is missing then, and the others go on.

use machine::Machine;
use protocol::{
    AxisFrame, Doom, DriveCommand, Item, Module, PerAxis, SpindleCommand, Truth, operator::Request,
};
use sim_plant::{Plant, PlantError, Scenario};

use crate::lives::Life;
use crate::modules::Modules;
use crate::observe::Record;
use crate::wires::{Straight, Wires};

/// The machine. `I` is where its machine code comes from: an interpreter, a file, a list. `W` is what lies
/// between its modules.
#[derive(Clone)]
pub struct Rig<I, W = Straight> {
    plant: Plant,
    modules: Modules<I, W>,
}

/// All that went between the modules in one control cycle.
#[derive(Clone, Copy, Debug)]
pub struct Exchange<'a> {
    /// The truth with its measurement, what the regulators said of this cycle, what the interpolator said
    /// last.
    pub record: Record<'a>,
    /// The frame that each regulator got in this cycle: one at a tick, else none.
    pub frames: &'a PerAxis<Option<AxisFrame>>,
    /// The drive commands that the plant goes on with.
    pub drives: &'a PerAxis<DriveCommand>,
    /// The spindle command in force.
    pub spindle: &'a SpindleCommand,
}

impl<I: Iterator<Item = Item>> Rig<I> {
    /// A machine at rest before cycle 0, its wires straight.
    ///
    /// # Errors
    /// [`PlantError`] if the truth about the plant cannot be.
    pub fn new(machine: &Machine, code: I, scenario: Scenario, seed: u64) -> Result<Rig<I>, PlantError> {
        Rig::with_wires(machine, code, scenario, seed, Straight)
    }
}

impl<I: Iterator<Item = Item>, W: Wires> Rig<I, W> {
    /// A machine at rest before cycle 0, with these wires between its modules.
    ///
    /// # Errors
    /// [`PlantError`] if the truth about the plant cannot be.
    pub fn with_wires(
        machine: &Machine,
        code: I,
        scenario: Scenario,
        seed: u64,
        wires: W,
    ) -> Result<Rig<I, W>, PlantError> {
        Ok(Rig { plant: Plant::new(machine, scenario, seed)?, modules: Modules::new(machine, code, wires) })
    }

    /// New controls, which know nothing of what was, on a plant that has been switched on again
    /// ([`Plant::switch_on`]); wires between its modules.
    pub fn on_plant(machine: &Machine, plant: Plant, code: I, wires: W) -> Rig<I, W> {
        Rig { plant, modules: Modules::new(machine, code, wires) }
    }

    /// Mains and controls fail behind the cycle that was last, in whatever happens then: the plant at rest.
    /// `see` is shown every cycle on its way there.
    pub fn lose_power(self, see: impl FnMut(&Truth)) -> Plant {
        let Rig { mut plant, modules } = self;
        plant.lose_power(&modules.drives, &modules.spindle, see);
        plant
    }

    /// A machine to which nothing has happened yet plays a scenario from here on, as if it had played it from
    /// cycle 0: all of its events lie behind the present cycle, and no program has waited for cycle start.
    ///
    /// # Errors
    /// [`PlantError`] if an event is for an axis that there is not.
    pub fn play(&mut self, scenario: Scenario) -> Result<(), PlantError> {
        self.plant.play(scenario)
    }

    /// One control cycle; `observe` sees its record before the plant goes on. What the operator does is on
    /// the panel of the next measurement. False after the last cycle.
    pub fn cycle(&mut self, request: Option<Request>, observe: impl FnOnce(&Record)) -> bool {
        self.exchange(request, |exchange| observe(&exchange.record))
    }

    /// As [`Rig::cycle`], and `observe` sees all that went between the modules.
    pub fn exchange(&mut self, request: Option<Request>, observe: impl FnOnce(&Exchange)) -> bool {
        self.obey();
        let Rig { plant, modules } = self;
        let truth = plant.truth();
        let late = modules.cycle(truth.cycle, &truth.measurement);
        observe(&Exchange {
            record: Record { truth, axes: &modules.seen, machine: &modules.machine_status },
            frames: &modules.frames,
            drives: &modules.drives,
            spindle: &modules.spindle,
        });
        let goes_on = truth.measurement.last == 0;
        (0..late).for_each(|_| plant.note_late());
        plant.tick(&modules.drives, &modules.spindle, request);
        goes_on
    }

    /// Does what the scenario orders in this cycle.
    fn obey(&mut self) {
        match self.plant.truth().doom() {
            Some((Doom::Kill, module)) => self.kill(module),
            Some((Doom::Freeze, module)) => self.freeze(module),
            Some((Doom::Thaw, module)) => self.thaw(module),
            None => {}
        }
        if let Some(packet) = self.plant.packet() {
            self.modules.tamper(&packet);
        }
    }

    /// A module ends, between two cycles: what it has sent still arrives, nothing more comes.
    pub fn kill(&mut self, module: Module) {
        self.modules.turn(module, Life::Dead);
    }

    /// A module stands still: it answers nothing, and its messages wait, as many as its channel holds. An
    /// interpreter that says nothing for a second counts as dead.
    pub fn freeze(&mut self, module: Module) {
        self.modules.turn(module, Life::Frozen);
    }

    /// A frozen module goes on: a few of the messages that wait in each of its cycles, oldest first, until it
    /// has caught up. So its answers are old for a while.
    pub fn thaw(&mut self, module: Module) {
        self.modules.turn(module, Life::Works);
    }

    /// Whether a module has been killed.
    pub fn is_dead(&self, module: Module) -> bool {
        self.modules.life(module) == Some(Life::Dead)
    }

    /// The wires, so that they can be disturbed while the machine runs.
    pub fn wires_mut(&mut self) -> &mut W {
        self.modules.wires_mut()
    }
}
