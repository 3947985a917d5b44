//! The processes of a machine.

use protocol::{Axis, Module};

/// A process of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Process {
    /// `pitchlock run`: starts, watches, records.
    Launcher,
    /// G-code to machine code.
    Interpreter,
    /// Machine code to axis commands.
    Interpolator,
    /// Spindle, axes, drives.
    Plant,
    /// One axis.
    Regulator(Axis),
}

impl Process {
    /// Everybody but the launcher, for a machine with these axes.
    pub fn members(axes: &[Axis]) -> Vec<Process> {
        let mut members = vec![Process::Interpreter, Process::Interpolator, Process::Plant];
        members.extend(axes.iter().map(|axis| Process::Regulator(*axis)));
        members
    }

    /// The name used in channels and in `summary.json`.
    pub fn name(self) -> String {
        match self {
            Process::Launcher => "launcher".into(),
            Process::Interpreter => "interpreter".into(),
            Process::Interpolator => "interpolator".into(),
            Process::Plant => "sim-plant".into(),
            Process::Regulator(axis) => format!("regulator-{}", axis.name()),
        }
    }

    /// The module that runs in it, of those that run beside the plant.
    pub fn module(self) -> Option<Module> {
        match self {
            Process::Launcher | Process::Plant => None,
            Process::Interpreter => Some(Module::Interpreter),
            Process::Interpolator => Some(Module::Interpolator),
            Process::Regulator(axis) => Some(Module::Regulator(axis)),
        }
    }

    /// The process of a module.
    pub fn of(module: Module) -> Process {
        match module {
            Module::Interpreter => Process::Interpreter,
            Module::Interpolator => Process::Interpolator,
            Module::Regulator(axis) => Process::Regulator(axis),
        }
    }

    /// A small number of its own, below [`Process::COUNT`].
    pub(crate) fn number(self) -> usize {
        match self {
            Process::Launcher => 0,
            Process::Interpreter => 1,
            Process::Interpolator => 2,
            Process::Plant => 3,
            Process::Regulator(axis) => 4 + axis.index(),
        }
    }

    /// The process of a name.
    pub fn from_name(name: &str) -> Option<Process> {
        if name == Process::Plant.name() {
            return Some(Process::Plant);
        }
        Module::from_name(name).map(Process::of)
    }

    pub(crate) const COUNT: usize = 4 + protocol::units::AXES;
}
