//! A program that is read and not executed. In: its items of machine code, one by one. Out: what is in force
//! behind them, and where they leave the axes.

use std::collections::BTreeMap;

use machine::Machine;
use protocol::{Axis, Code, Item, PathMode, PerAxis, Position, Set};

/// What is in force at a place of a program, as its items say it: nothing is guessed.
#[derive(Clone, Debug)]
pub struct Modal {
    /// Items before the place, what they count in the progress of the program, and how many are passes.
    pub items: u64,
    /// See there.
    pub steps: u64,
    /// See there.
    pub passes: u32,
    /// Where the axes are led before it.
    pub at: PerAxis<Position>,
    /// The highest that Z has been led, home at first.
    pub top: Position,
    /// Number of the tool; `None` if the program has selected none.
    pub tool: Option<u32>,
    /// Spindle, coolant and path, as the last item that said so.
    pub spindle: Option<Code>,
    /// See there.
    pub coolant: Option<Code>,
    /// See there.
    pub path: PathMode,
    /// How the speed of the spindle is varied, as the last item that said so.
    pub variation: Option<Code>,
    /// Formulas, by their number.
    pub formulas: BTreeMap<u8, Code>,
    /// Outputs that the program has set, with their numbers, in the order in which they got what they are.
    pub outputs: Vec<(u8, Set)>,
}

impl Modal {
    /// Before the first item: a machine at home.
    pub fn new(machine: &Machine) -> Modal {
        Modal {
            items: 0,
            steps: 0,
            passes: 0,
            at: machine.home(),
            top: machine.home()[Axis::Z.index()],
            tool: None,
            spindle: None,
            coolant: None,
            path: PathMode::Blend { tolerance_mm: machine.path.tolerance_mm, merge_mm: 0.0 },
            variation: None,
            formulas: BTreeMap::new(),
            outputs: Vec::new(),
        }
    }

    /// Behind one more item.
    pub fn take(&mut self, item: &Item) {
        self.items += 1;
        self.steps += item.steps();
        match item.code {
            Code::Tool { number } => self.tool = Some(number),
            Code::Spindle { .. } => self.spindle = Some(item.code),
            Code::Coolant { .. } => self.coolant = Some(item.code),
            Code::PathMode(mode) => self.path = mode,
            Code::Variation(_) => self.variation = Some(item.code),
            Code::Formula { slot, .. } => {
                self.formulas.insert(slot, item.code);
            }
            Code::Output { number, set, .. } => {
                let same = |(other, before): &(u8, Set)| {
                    *other == number && matches!(before, Set::Digital(_)) == matches!(set, Set::Digital(_))
                };
                self.outputs.retain(|output| !same(output));
                self.outputs.push((number, set));
            }
            Code::Pass(_) => self.passes += 1,
            _ => {}
        }
        self.at = end(item, &self.at);
        self.top = self.top.max(self.at[Axis::Z.index()]);
    }
}

/// Where an item leaves the axes that stand here before it.
pub fn end(item: &Item, here: &PerAxis<Position>) -> PerAxis<Position> {
    match &item.code {
        code if code.target().is_some() => code.target().copied().unwrap_or(*here),
        Code::Pass(pass) => pass.axes.map(|law| law.end),
        _ => *here,
    }
}

/// The axes that carry a tool along a path.
pub const LINEAR: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

/// How far apart two places are, mm.
pub fn apart_mm(one: &PerAxis<Position>, other: &PerAxis<Position>) -> f64 {
    let [x, y, z] = LINEAR.map(|axis| one[axis.index()].mm_from(other[axis.index()]));
    libm::hypot(libm::hypot(x, y), z)
}
