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
        let name = number.map_or("the tool".into(), |number| format!("tool {number} of the machine file"));
        let Insert { angle_deg, nose_mm, width_mm } = insert;
        let message = format!("the thread is written for another insert: {name} has {found}");
        let help = format!(
            "mount an insert of {} degrees, nose {} mm, flat {} mm and say so in [tools]; or write the program again for \
             the one that is there (pitchlock thread)",
            short(angle_deg),
            short(nose_mm),
            short(width_mm)
        );
        self.output.report(place, *Problem::warning("other-insert", Blame::Line(place.line), message, help));
    }
}
