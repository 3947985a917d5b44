//! A test stand: a plant whose drives are switched on and told velocities, without any controller.
#![allow(dead_code, unreachable_pub)] // each test file uses its part

use machine::Machine;
use protocol::{Axis, ControlWord, DriveCommand, DriveState, PerAxis, SpindleCommand, Truth};
use sim_plant::{Plant, Scenario};

pub struct Stand {
    pub plant: Plant,
    pub spindle: SpindleCommand,
    /// Target velocities of X and Z, mm/s, and torque offsets, N·m.
    pub velocity: [f64; 2],
    pub offset: [f64; 2],
    /// Control word instead of the one that leads to operation.
    pub word: Option<u32>,
}

impl Stand {
    pub fn new(machine: &Machine, scenario: Scenario, seed: u64) -> Stand {
        let plant = Plant::new(machine, scenario, seed).expect("the machines of the tests can be built");
        let spindle = SpindleCommand::default();
        Stand { plant, spindle, velocity: [0.0; 2], offset: [0.0; 2], word: None }
    }

    /// The small lathe, nothing happens.
    pub fn lathe() -> Stand {
        Stand::new(&Machine::plain(), Scenario::none(), 1)
    }

    pub fn playing(scenario: &str) -> Stand {
        Stand::new(
            &Machine::plain(),
            Scenario::from_toml(scenario).expect("the scenarios of the tests are sound"),
            1,
        )
    }

    pub fn state(&self, axis: Axis) -> DriveState {
        self.plant.measurement().axes[axis.index()].drive().state().expect("a drive reports a state")
    }

    pub fn truth(&self) -> &Truth {
        self.plant.truth()
    }

    pub fn tick(&mut self) -> &Truth {
        let mut drives: PerAxis<DriveCommand> = Default::default();
        for (slot, axis) in [Axis::X, Axis::Z].into_iter().enumerate() {
            let measured = &self.plant.measurement().axes[axis.index()];
            let towards = measured.drive().towards_operation();
            drives[axis.index()] = DriveCommand {
                cycle: self.plant.measurement().cycle,
                control_word: self.word.unwrap_or(towards.unwrap_or(ControlWord::DisableVoltage) as u32),
                target_velocity_mm_s: self.velocity[slot],
                torque_offset_nm: self.offset[slot],
                ..DriveCommand::default()
            };
        }
        let spindle = self.spindle;
        self.plant.tick(&drives, &spindle, None);
        self.plant.truth()
    }

    pub fn run(&mut self, cycles: u32) -> &mut Stand {
        for _ in 0..cycles {
            self.tick();
        }
        self
    }

    /// Drives on, at rest.
    pub fn enabled() -> Stand {
        let mut stand = Stand::lathe();
        stand.run(10);
        assert_eq!(
            (stand.state(Axis::X), stand.state(Axis::Z)),
            (DriveState::OperationEnabled, DriveState::OperationEnabled)
        );
        stand
    }
}
