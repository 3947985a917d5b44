//! What the page of a run and the terminal say in the same words. In: the summary.

use std::collections::BTreeMap;

use super::{PassReport, Summary};

impl Summary {
    /// The last attempt at each pass, in the order of the program: one that was left may have been entered
    /// again.
    pub fn last_attempts(&self) -> impl Iterator<Item = &PassReport> + use<'_> {
        let last: BTreeMap<u32, &PassReport> = self.passes.iter().map(|pass| (pass.pass, pass)).collect();
        last.into_values()
    }

    /// The last attempt at each pass of which one did not come to its end.
    pub fn interrupted(&self) -> impl Iterator<Item = &PassReport> {
        let broken =
            |last: &&PassReport| self.passes.iter().any(|one| one.pass == last.pass && !one.complete);
        self.last_attempts().filter(broken)
    }

    /// How often the spindle did not get the override that was asked for; nothing if it always did.
    pub fn overrides_held(&self) -> Option<String> {
        let often = match self.overrides_clamped {
            0 => return None,
            1 => "once".into(),
            n => format!("{n} times"),
        };
        Some(format!(
            "held {often} below what was asked: by the highest override or speed of the machine, by what the pass \
             allows, or because of the load in it"
        ))
    }
}
