//! The insert that a program is written for, beside the tool that the machine file has. In: comments such as
//! `(thread_insert, A60 R0.144)`, passes. Out: a warning where the tool that cuts them is another one: the
//! thread would have another depth than it needs.

use gcode::problem::{Blame, short};
use gcode::{Place, Problem};
use machine::Insert;

use super::Translator;
use crate::reach::Done;

/// What the program said, and of which tool that was told.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Written {
    insert: Option<Insert>,
    told: Option<Option<u32>>,
}

impl Translator {
    /// A comment may describe the insert.
    pub(super) fn take_insert(&mut self, text: &str) -> Done {
        let wrong = |error: machine::InsertError| {
            let help = "write (thread_insert, A60 R0.144 W0.25): degrees between the flanks, nose, flat tip";
            Problem::error("bad-insert", Blame::Block, error.to_string(), help)
        };
        if let Some(insert) = Insert::from_comment(text, self.modal.frame.unit()).map_err(wrong)? {
            self.gauged.written = Written { insert: Some(insert), told: None };
            self.read_in_units("the insert");
        }
        Ok(())
    }

    /// A pass is cut with the tool in hand.
    pub(super) fn insert_cuts(&mut self, place: Place) {
        let number = self.auxiliary.tool();
        let Some(insert) = self.gauged.written.insert.filter(|_| self.gauged.written.told != Some(number))
        else {
            return;
        };
        self.gauged.written.told = Some(number);
        let tool = number.and_then(|number| self.machine.tool(number));
        let Some(found) = insert.differs(tool) else { return };
        let Insert { angle_deg, nose_mm, width_mm } = insert;
        let [angle, nose, width] = [angle_deg, nose_mm, width_mm].map(short);
        let shape = format!("{angle} degrees, nose {nose} mm, flat {width} mm");
        let flat = if width_mm == 0.0 { String::new() } else { format!(", width_mm = {width}") };
        let described = |number: u32| {
            format!(
                "write [tools.{number}] with a name, angle_deg = {angle}, nose_mm = {nose}{flat} into the machine file: the gauge \
                 goes by that, and not by (thread_insert, ...)"
            )
        };
        let (message, help) = match (tool, number) {
            (Some(_), Some(number)) => (
                format!(
                    "the thread is written for another insert: tool {number} of the machine file has {found}"
                ),
                format!(
                    "mount an insert of {shape} and say so in [tools.{number}]; or write the program again for the one \
                     that is there (pitchlock thread)"
                ),
            ),
            (_, Some(number)) => (
                format!(
                    "nobody described tool {number}, which is taken to be sharp: the thread is written for {shape}"
                ),
                described(number),
            ),
            (_, None) => (
                format!(
                    "the program calls for no tool, and one that is sharp is taken: the thread is written for {shape}"
                ),
                format!("call for a tool, such as T1, and {}", described(1)),
            ),
        };
        self.output.report(place, *Problem::warning("other-insert", Blame::Line(place.line), message, help));
    }
}
