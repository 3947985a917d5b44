//! Offsets as a document, for programs and for the panel; and what somebody may type at the panel.

use std::collections::BTreeMap;

use gcode::canon::Units;
use machine::Machine;
use protocol::Axis;
use serde::Serialize;

use super::{OF_SYSTEM, SYSTEMS, Set, Table, parameter, said::within_a_turn};
use crate::offsets::Target;

/// What `offsets list --json` prints.
#[derive(Serialize)]
pub(super) struct Document<'a> {
    version: u32,
    units: &'a str,
    parameters: Option<String>,
    tools: Option<String>,
    in_force: String,
    systems: Vec<System<'a>>,
    tool_offsets: Vec<OfTool<'a>>,
    /// How many more the table has.
    #[serde(skip_serializing_if = "is_zero")]
    tools_left_out: usize,
}

fn is_zero(number: &usize) -> bool {
    *number == 0
}

#[derive(Serialize)]
struct System<'a> {
    name: &'a str,
    #[serde(flatten)]
    words: BTreeMap<char, f64>,
}

#[derive(Serialize)]
struct OfTool<'a> {
    number: i32,
    pocket: i32,
    #[serde(flatten)]
    words: BTreeMap<char, f64>,
    comment: &'a str,
}

impl Table {
    /// All of it, but no more tools than `most`.
    pub(crate) fn shown(&self, most: usize) -> impl Serialize {
        let systems = SYSTEMS.iter().enumerate().map(|(system, name)| System {
            name,
            words: OF_SYSTEM.map(|letter| (letter, self.value(parameter(system, letter)))).into(),
        });
        let tools = self.tools.iter().flat_map(|table| table.iter()).take(most).map(|tool| OfTool {
            number: tool.number,
            pocket: tool.pocket,
            words: tool.words().into(),
            comment: &tool.comment,
        });
        let all = self.tools.iter().flat_map(|table| table.iter()).count();
        let [parameters, tools_in] =
            self.files.each_ref().map(|path| path.as_ref().map(|path| path.display().to_string()));
        Document {
            version: 1,
            units: self.unit(),
            parameters,
            tools: tools_in,
            in_force: self.in_force(),
            systems: systems.collect(),
            tool_offsets: tools.collect(),
            tools_left_out: all.saturating_sub(most),
        }
    }
}

/// Largest correction of a length that is typed at the panel, mm: wear, and not another tool.
const LARGEST_CORRECTION_MM: f64 = 1.0;

/// What a machine lets somebody type at its panel.
pub(crate) struct Limits<'a>(pub(crate) &'a Machine);

impl Limits<'_> {
    /// Whether these words may be set. `asked` as they were typed, `sets` as they will stand in `table`.
    ///
    /// # Errors
    /// A tool or an axis that the machine has not, a correction that is none, an offset beyond every reach,
    /// more than a turn, a tool wider than the machine.
    pub(crate) fn allow(&self, asked: &[Set], add: bool, sets: &[Set], table: &Table) -> Result<(), String> {
        let mm = if table.units == Units::Inch { 25.4 } else { 1.0 };
        for (typed, Set { target, letter, value }) in asked.iter().zip(sets) {
            let name = target.name();
            is_tool(*target, table)?;
            within_a_turn(*letter, *value, &name)?;
            if add && "XYZUVWD".contains(*letter) && typed.value.abs() * mm > LARGEST_CORRECTION_MM {
                return Err(format!(
                    "{} is no correction: at most {LARGEST_CORRECTION_MM} mm at once; set {letter} of {name} instead",
                    typed.value
                ));
            }
            match letter {
                'D' => self.fits(*value * mm, &name)?,
                'R' | 'I' | 'J' | 'Q' => {}
                _ => self.is_reached(*letter, *value, mm, &name)?,
            }
        }
        Ok(())
    }

    /// An offset of an axis, in units of `mm` mm.
    fn is_reached(&self, letter: char, value: f64, mm: f64, name: &str) -> Result<(), String> {
        let axis = Axis::from_name(&letter.to_string());
        match self.0.axes().find(|(there, _)| Some(*there) == axis) {
            None if value != 0.0 => Err(format!("this machine has no axis {letter}")),
            Some((_, config)) if "XYZ".contains(letter) => {
                let [low, high] = config.travel_mm;
                let most = high - low + low.abs().max(high.abs());
                if value.abs() * mm <= most {
                    return Ok(());
                }
                Err(format!(
                    "{letter}{value} of {name} leads out of every reach: {letter} travels from {low} to {high} mm, so {:.3} \
                     at most",
                    most / mm
                ))
            }
            _ => Ok(()),
        }
    }

    /// A diameter, mm: no tool is wider than the longest travel.
    fn fits(&self, wide_mm: f64, name: &str) -> Result<(), String> {
        let travels = self.0.axes().filter(|(axis, _)| !axis.is_rotary());
        let longest =
            travels.map(|(_, config)| config.travel_mm[1] - config.travel_mm[0]).fold(0.0, f64::max);
        if wide_mm <= longest {
            return Ok(());
        }
        Err(format!(
            "{name} would be {wide_mm} mm wide, and the longest travel of this machine is {longest} mm"
        ))
    }
}

/// A tool that is in the table: one that is typed wrong makes no other.
fn is_tool(target: Target, table: &Table) -> Result<(), String> {
    let Target::Tool(number) = target else { return Ok(()) };
    if table.tools.as_ref().is_some_and(|table| table.find(number).is_some()) {
        return Ok(());
    }
    Err(format!(
        "the tool table has no T{number}: enter it with pitchlock offsets set T{number} X0 --tools FILE, or as a line of \
         that file"
    ))
}
