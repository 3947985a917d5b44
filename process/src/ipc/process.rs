//! The processes of a machine.

use protocol::Axis;

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

    pub(crate) const COUNT: usize = 4 + protocol::units::AXES;
}
