//! What the page of a run and the terminal say in the same words. In: the summary.

use std::collections::BTreeMap;

use protocol::Fault;

use super::{FaultReport, PassReport, Summary, TapReport};

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

    /// The passes whose tool was in the material while it had to be on the helix: those that are judged.
    pub fn touched(&self) -> impl Iterator<Item = &PassReport> {
        self.passes.iter().filter(|pass| pass.tool.contact_deg > 0.0)
    }

    /// The taps, with what each did.
    pub fn taps(&self) -> impl Iterator<Item = (&PassReport, &TapReport)> {
        self.passes.iter().filter_map(|pass| Some((pass, pass.tap.as_ref()?)))
    }

    /// The passes of threads that were turned: all but taps.
    pub fn turned(&self) -> impl Iterator<Item = &PassReport> + Clone {
        self.passes.iter().filter(|pass| pass.tap.is_none())
    }

    /// Of all taps, µm: how far they are off their helix at most on the way in, while the spindle turns
    /// round and on the way out; and how much they are short of their depth, least and most. `None` without
    /// a tap.
    pub fn taps_at_worst(&self) -> Option<([f64; 3], [f64; 2])> {
        let each = self.taps().map(|(_, tap)| ([tap.in_um, tap.turn_um, tap.out_um], [tap.short_um; 2]));
        each.reduce(|(off, [least, most]), (other, [short, _])| {
            (
                std::array::from_fn(|part| f64::max(off[part], other[part])),
                [least.min(short), most.max(short)],
            )
        })
    }

    /// The turned passes whose tool was in the material while it had to be on the helix.
    pub fn touched_turning(&self) -> impl Iterator<Item = &PassReport> {
        self.touched().filter(|pass| pass.tap.is_none())
    }

    /// How far the turned threads are off at the tool, µm: a pass from its helix, less its mean; passes of
    /// one groove and starts of one thread from each other; the depth at most, and from end to end.
    pub fn at_the_tool(&self) -> [f64; 4] {
        let helix = self.touched_turning().map(|pass| pass.tool.helix_max_abs_um).fold(0.0, f64::max);
        let thread = &self.thread;
        let passes = thread.tool_phase_spread_um.max(thread.tool_start_spread_um);
        [helix, passes, thread.tool_depth_off_um.abs(), thread.tool_depth_um]
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

impl FaultReport {
    /// Of a fault by its number. What is known besides is told in brackets: counts of the spindle encoder,
    /// the regulator concerned.
    pub(super) fn of(cycle: u64, source: String, code: u32, detail: Option<String>) -> FaultReport {
        let told = detail.map_or_else(String::new, |detail| format!(" ({detail})"));
        let (code, text) = match Fault::from_code(code) {
            Some(fault) => (fault.code().into(), format!("{}{told}", fault.text())),
            None => (format!("unknown-{code}"), "a fault that this version does not know".into()),
        };
        FaultReport { cycle, source, code, text }
    }

    /// What is no fault and has to be known.
    pub(super) fn warning(cycle: u64, source: &str, code: &str, text: String) -> FaultReport {
        FaultReport { cycle, source: source.into(), code: code.into(), text }
    }
}
