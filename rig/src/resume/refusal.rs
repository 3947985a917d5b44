//! Why a program is not gone on with, with the place and what to do instead. Places are in mm of the machine.

use machine::{Kinematics, Machine};
use protocol::{Axis, PerAxis, Position};

use super::MOST;

/// Why a program is not gone on with.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// Nothing is left of it.
    #[error("its program came to its end: there is nothing to go on with")]
    Complete,
    /// The kinematics are those of a positioner, which does nothing but jobs.
    #[error("a positioner cannot go on with a program: start its job again")]
    Positioner,
    /// It was broken off in a work.
    #[error(
        "it was broken off at the contour, surface or seam of line {line}, which can only be begun anew: start that job \
         again"
    )]
    Work {
        /// Line of the program.
        line: u32,
    },
    /// A tap stands in its hole.
    #[error(
        "the tap of line {line} may stand in its hole: turn it out by hand together with the spindle, bring it to where it \
         starts, then try again"
    )]
    Tap {
        /// Line of the program.
        line: u32,
    },
    /// The journal is of another program.
    #[error("the journal knows more of it than it has: the program is not the one that was run")]
    OtherProgram,
    /// The pass that is open is another one.
    #[error(
        "the journal has pass {open} open, the program {next} next: the program is not the one that was run"
    )]
    OtherPass {
        /// By the journal.
        open: u32,
        /// By the program.
        next: u32,
    },
    /// The axes stand where the program does not lead.
    #[error(
        "the axes stand at {here} mm, where the program does not lead from line {line} on: bring the tool by hand to where \
         it begins there, {begins} mm of the machine"
    )]
    Elsewhere {
        /// Where they are measured.
        here: Place,
        /// Line at which the program would begin.
        line: u32,
        /// Where it begins there.
        begins: Place,
    },
    /// The tool table makes another program of it.
    #[error(
        "with this tool table line {line} makes another move, and not the same one elsewhere: only X and Z of its tools may \
         differ from those of the run; with another radius or orientation start it from its beginning"
    )]
    OtherPath {
        /// Line of the program.
        line: u32,
    },
    /// A tool is too different.
    #[error(
        "with this tool table the tool stands X {x_mm:+.3} Z {z_mm:+.3} mm from where the one before stood, which is too far to \
         go there unseen: put in one that is within 5 mm of it, or start the program from its beginning"
    )]
    AnotherTool {
        /// Difference along X (a radius).
        x_mm: f64,
        /// Difference along Z.
        z_mm: f64,
    },
    /// Two tools of threads differ each in its way.
    #[error(
        "with this tool table two tools that cut threads from there on are each changed otherwise: go on with one of them \
         changed, or start the program from its beginning"
    )]
    TwoTools,
    /// Nothing is left of the journal, and another tool may be in the holder.
    #[error(
        "its journal has no whole record, and the axes stand where the program leads {} in line {} and {} in line {}: nobody \
         knows which one is in the holder. Run the program from its beginning, or what is left of it as a program of its own",
        named(tools[0].1), tools[0].0, named(tools[1].1), tools[1].0
    )]
    WhichTool {
        /// Line and tool, twice.
        tools: [(u32, Option<u32>); 2],
    },
    /// Nothing is left of the journal, and the run was one with another tool table.
    #[error(
        "its journal has no whole record, and it went on with another tool table than the run before: nobody knows whether the \
         new tool is in the holder. Run the program from its beginning, or what is left of it as a program of its own"
    )]
    WhichTable,
    /// The contour is too long.
    #[error(
        "the contour that begins in line {line} has more than {MOST} moves before the one that was broken off: begin \
         in it with a program of its own"
    )]
    TooLong {
        /// Line of its first move.
        line: u32,
    },
}

/// A place in coordinates of the machine, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// X: of a lathe a radius.
    pub x_mm: f64,
    /// Y, which a lathe does not have.
    pub y_mm: Option<f64>,
    /// Z.
    pub z_mm: f64,
}

impl Place {
    /// Where the axes of a machine are.
    pub fn of(machine: &Machine, axes: &PerAxis<Position>) -> Place {
        let [x_mm, y_mm, z_mm] = [Axis::X, Axis::Y, Axis::Z].map(|axis| axes[axis.index()].mm());
        let is_lathe = machine.general.kinematics == Kinematics::Lathe;
        Place { x_mm, y_mm: (!is_lathe).then_some(y_mm), z_mm }
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Place { x_mm, y_mm, z_mm } = self;
        write!(f, "X {x_mm:.3} ")?;
        y_mm.iter().try_for_each(|y_mm| write!(f, "Y {y_mm:.3} "))?;
        write!(f, "Z {z_mm:.3}")
    }
}

fn named(tool: Option<u32>) -> String {
    tool.map_or_else(|| "no tool".into(), |number| format!("tool {number}"))
}
