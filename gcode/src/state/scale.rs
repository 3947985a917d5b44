//! Units of length: those of the machine, and those in force in the program.

use crate::canon::{Pose, Units, X, Y, Z};

/// Inch of LinuxCNC's stand-alone interpreter, mm.
const STAND_ALONE_INCH: f64 = 1.0 / 0.03937007874016;

/// The units of the machine and of the program.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    machine: Units,
    /// mm in one unit of the machine.
    machine_mm: f64,
    program: Units,
}

impl Scale {
    /// `stand_alone`: see [`crate::Options::stand_alone`].
    pub(super) fn new(machine: Units, program: Units, stand_alone: bool) -> Scale {
        let machine_mm = match machine {
            Units::Inch if stand_alone => STAND_ALONE_INCH,
            units => units.mm(),
        };
        Scale { machine, machine_mm, program }
    }

    /// Units of the machine.
    pub(crate) fn machine(&self) -> Units {
        self.machine
    }

    /// G20, G21.
    pub(crate) fn program(&self) -> Units {
        self.program
    }

    /// mm in one unit of the program.
    pub(crate) fn mm(&self) -> f64 {
        self.program.mm()
    }

    /// G20 and G21: the factor by which lengths in program units change.
    pub(crate) fn change(&mut self, program: Units) -> f64 {
        let before = std::mem::replace(&mut self.program, program);
        before.mm() / program.mm()
    }

    /// Multiply machine units by this to get program units.
    pub(crate) fn per_machine_unit(&self) -> f64 {
        self.machine_mm / self.program.mm()
    }

    /// Machine units to program units; angles stay.
    pub(crate) fn to_program(self, lengths: &Pose) -> Pose {
        scaled(lengths, self.per_machine_unit())
    }

    /// Program units to machine units; angles stay.
    pub(crate) fn to_machine(self, lengths: &Pose) -> Pose {
        scaled(lengths, 1.0 / self.per_machine_unit())
    }
}

/// Lengths times a factor, angles as they are.
pub(crate) fn scaled(lengths: &Pose, factor: f64) -> Pose {
    let mut scaled = *lengths;
    for axis in [X, Y, Z] {
        scaled[axis] *= factor;
    }
    scaled
}
