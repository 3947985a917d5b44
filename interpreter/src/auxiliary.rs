//! Tool, coolant, outputs, inputs. In: what calls and jobs ask for. Out: a code where something changes.

use gcode::problem::{Blame, short};
use gcode::{Call, Problem};
use machine::{Machine, SignalFault, SignalRefused};
use protocol::{Code, Set, Until};

use crate::reach::{Done, LONGEST_DWELL};

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

/// Refuses a tool that somebody puts in while the spindle turns.
pub(crate) fn may_change(machine: &Machine, spindle_turns: bool) -> Done {
    if machine.general.tool_change.is_automatic() || !spindle_turns {
        return Ok(());
    }
    let message = "tools are put in by hand, and the spindle turns";
    let help =
        "stop it with M5 in a block before; tool_change = \"by-hand\" in the machine file asks for that";
    Err(Problem::error("needs-standstill", Blame::Word('T'), message, help))
}

/// What M66 waits for by its L.
const UNTIL: [(u8, Until); 4] = [(1, Until::Rise), (2, Until::Fall), (3, Until::High), (4, Until::Low)];

/// L of M66 for what is waited for.
pub(crate) fn as_l(until: Until) -> u8 {
    UNTIL.iter().find(|(_, known)| *known == until).map_or(0, |(l, _)| *l)
}

/// An output is set or an input waited for, if the call says so. What the machine cannot do is refused, and
/// an output that waits for standstill while the spindle turns.
pub(crate) fn signal(
    call: &Call<'_>,
    machine: &Machine,
    spindle_turns: bool,
) -> Result<Option<Code>, Box<Problem>> {
    // Of numbers that no machine has, one stands for all: it is refused by name.
    let number = |number: u32| u8::try_from(number).unwrap_or(u8::MAX);
    let code = match *call {
        Call::SetAuxOutputBit(index, on) => {
            Code::Output { number: number(index), set: Set::Digital(on), in_step: false }
        }
        Call::SetMotionOutputBit(index, on) => {
            Code::Output { number: number(index), set: Set::Digital(on), in_step: true }
        }
        Call::SetAuxOutputValue(index, value) => {
            Code::Output { number: number(index), set: Set::Analog(value), in_step: false }
        }
        Call::SetMotionOutputValue(index, value) => {
            Code::Output { number: number(index), set: Set::Analog(value), in_step: true }
        }
        Call::WaitInput { index, wait, timeout: within_s, .. } => {
            let Some((_, until)) = UNTIL.iter().find(|(l, _)| *l == wait) else { return Ok(None) };
            if !(within_s > 0.0 && within_s <= LONGEST_DWELL) {
                let message = format!("M66 cannot wait {} s", short(within_s));
                let help = format!("give Q above 0 and up to {LONGEST_DWELL} seconds");
                return Err(Problem::error("bad-value", Blame::Word('Q'), message, help));
            }
            Code::Await { input: number(index), until: *until, within_s }
        }
        _ => return Ok(None),
    };
    if let Some(SignalRefused { fault, message, help }) = machine.refuses(&code) {
        let name = match (fault, code) {
            (SignalFault::Unknown, Code::Await { .. }) => "unknown-input",
            (SignalFault::Unknown, _) => "unknown-output",
            (SignalFault::NeedsStandstill, _) => "needs-standstill",
            (SignalFault::OutOfRange, _) => "bad-value",
        };
        return Err(Problem::error(name, Blame::Block, message, help));
    }
    let Code::Output { number, set: Set::Digital(_), .. } = code else { return Ok(Some(code)) };
    match machine.output(number.into()) {
        Some(output) if output.standstill && spindle_turns => {
            let message = format!(
                "output {number}, {}, changes at standstill only, and the spindle turns",
                output.name
            );
            let help =
                "stop it with M5 in a block before; standstill = true in the machine file asks for that";
            Err(Problem::error("needs-standstill", Blame::Block, message, help))
        }
        _ => Ok(Some(code)),
    }
}
