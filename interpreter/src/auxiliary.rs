//! Tool, coolant, outputs. In: what calls and jobs ask for. Out: a code where something changes.

use gcode::problem::Blame;
use gcode::{Call, Problem};
use machine::{Machine, OutputFault, OutputRefused};
use protocol::{Code, Set};

use crate::reach::Done;

/// What is in the spindle and what cools, as it was sent last.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Auxiliary {
    tool: Option<u32>,
    mist: bool,
    flood: bool,
}

impl Auxiliary {
    /// T, M6, M61: a tool that has been found in the machine file.
    pub(crate) fn select_tool(&mut self, number: u32) -> Option<Code> {
        (self.tool.replace(number) != Some(number)).then_some(Code::Tool { number })
    }

    /// The tool that was selected last.
    pub(crate) fn tool(&self) -> Option<u32> {
        self.tool
    }

    /// M7, M8, M9.
    pub(crate) fn cools(&mut self, call: &Call<'_>) -> Option<Code> {
        match call {
            Call::MistOn | Call::MistOff => self.coolant(matches!(call, Call::MistOn), self.flood),
            _ => self.coolant(self.mist, matches!(call, Call::FloodOn)),
        }
    }

    /// Both kinds of coolant.
    pub(crate) fn coolant(&mut self, mist: bool, flood: bool) -> Option<Code> {
        let before = (self.mist, self.flood);
        (self.mist, self.flood) = (mist, flood);
        (before != (mist, flood)).then_some(Code::Coolant { mist, flood })
    }
}

/// Refuses a tool that the machine file does not have, if it has any. 0 empties the spindle.
pub(crate) fn find_tool(number: u32, machine: &Machine) -> Done {
    let tools = &machine.tools;
    if tools.is_empty() || number == 0 || tools.keys().any(|name| name.parse() == Ok(number)) {
        return Ok(());
    }
    let known: Vec<&str> = tools.keys().map(String::as_str).collect();
    let message = format!("tool {number} is not in the machine file");
    let help = format!("tools there: {}; add [tools.{number}] for this one", known.join(", "));
    Err(Problem::error("unknown-tool", Blame::Word('T'), message, help))
}

/// An output is set, if the call says so. What the machine cannot do is refused, and what waits for
/// standstill while the spindle turns.
pub(crate) fn output(
    call: &Call<'_>,
    machine: &Machine,
    spindle_turns: bool,
) -> Result<Option<Code>, Box<Problem>> {
    let (number, set, in_step) = match *call {
        Call::SetAuxOutputBit(number, on) => (number, Set::Digital(on), false),
        Call::SetMotionOutputBit(number, on) => (number, Set::Digital(on), true),
        Call::SetAuxOutputValue(number, value) => (number, Set::Analog(value), false),
        Call::SetMotionOutputValue(number, value) => (number, Set::Analog(value), true),
        _ => return Ok(None),
    };
    if let Some(OutputRefused { fault, message, help }) = machine.refuses_output(number, set, in_step) {
        let code = match fault {
            OutputFault::Unknown => "unknown-output",
            OutputFault::NeedsStandstill => "needs-standstill",
            OutputFault::OutOfRange => "bad-value",
        };
        return Err(Problem::error(code, Blame::Block, message, help));
    }
    match (set, machine.output(number)) {
        (Set::Digital(_), Some(output)) if output.standstill && spindle_turns => {
            let message = format!(
                "output {number}, {}, changes at standstill only, and the spindle turns",
                output.name
            );
            let help =
                "stop it with M5 in a block before; standstill = true in the machine file asks for that";
            Err(Problem::error("needs-standstill", Blame::Block, message, help))
        }
        _ => Ok(u8::try_from(number).ok().map(|number| Code::Output { number, set, in_step })),
    }
}
