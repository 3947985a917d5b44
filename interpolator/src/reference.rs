//! Reference runs. In: switch and index of an axis as they are measured, mm. Out: which way is next, at
//! which speed, and when it may end; at last the offset that makes the position of the axis true.
//!
//! | phase | the axis goes | until |
//! |---|---|---|
//! | search | fast towards the switch | it is on |
//! | back off | as fast the other way | it is off |
//! | latch | slowly towards the switch, or the index | it is on, or the first index behind it |
//! | set | nowhere | the measurement has the offset |
//! | home | in rapid motion to `home_mm` | it is there |
//!
//! Each way is a straight line that ends at rest as a jog does whose key is let go. One that stands on its
//! switch begins by backing off; one that has an index alone begins with the last way.

use machine::{AxisConfig, BEYOND_MM, Machine, Method, ReferenceConfig, TURNS};
use protocol::{Axis, AxisReference, Cycle, Fault, Feed, Measurement, PerAxis, Position};

use crate::hand::Jog;

/// Nearer to the switch than this no index is believed to be always the first, a share of a turn.
const TOO_NEAR: f64 = 0.1;
/// The switch goes on again where it was on before, or by so much beyond, mm.
const AGAIN_MM: f64 = 1.0;

/// What is still to be referenced, and the run in hand.
#[derive(Clone, Debug)]
pub(crate) struct References {
    /// Bit n is axis n in the order of the wire.
    open: u8,
    run: Option<Run>,
    /// Where each axis is when its switch or index comes, as it is measured.
    known: PerAxis<Position>,
    /// Who works by hand asks for each; a program begins with all.
    pub(crate) by_hand: bool,
    /// The cycle whose measurement had the offset first.
    shown: Option<Cycle>,
}

/// A reference run.
#[derive(Clone, Copy, Debug)]
struct Run {
    axis: Axis,
    phase: Phase,
    /// What the phase waits for has come.
    came: bool,
    /// Its way has begun.
    under_way: bool,
    /// Where that begins.
    from: Position,
    /// Indexes that had been passed then.
    indexes: u32,
    /// Switch and index as they were when it came: behind it the axis brakes, and may pass the next index.
    marks: AxisReference,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Search,
    BackOff,
    Latch,
    Home,
}

/// What is next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Then {
    /// There is no run in hand.
    Nothing,
    /// A line to a place.
    Way(PerAxis<Position>, Feed),
    /// The axis takes an offset.
    Sets(Axis, Position),
    /// It cannot be referenced.
    Fails(Axis, Fault),
}

impl References {
    /// Of a machine that is switched on.
    pub(crate) fn new(machine: &Machine) -> References {
        let has = |(axis, config): (Axis, &AxisConfig)| u8::from(config.reference.is_some()) << axis.index();
        let mut known = PerAxis::default();
        for (axis, config) in machine.axes() {
            let at_mm = config.reference.map_or(0.0, |reference| reference.measured_mm(config));
            known[axis.index()] = Position::from_mm(at_mm);
        }
        References { open: machine.axes().map(has).sum(), run: None, known, by_hand: false, shown: None }
    }

    /// The axes that are not referenced, bit by bit.
    pub(crate) fn open(&self) -> u8 {
        self.open
    }

    /// The axis that a program begins with.
    pub(crate) fn first(&self, machine: &Machine) -> Option<Axis> {
        let order = |(axis, config): (Axis, &AxisConfig)| {
            let reference = config.reference.filter(|_| self.open >> axis.index() & 1 != 0);
            reference.map(|reference| (reference.sequence, axis))
        };
        machine.axes().filter_map(order).min().map(|(_, axis)| axis)
    }

    /// Whether a run is in hand.
    pub(crate) fn runs(&self) -> bool {
        self.run.is_some()
    }

    /// Whether an axis that is not referenced would go further onto its switch: there its travel ends.
    pub(crate) fn ends_at_switch(
        &self,
        machine: &Machine,
        measurement: &Measurement,
        [here, to]: [&PerAxis<Position>; 2],
    ) -> bool {
        let goes_on = |(axis, config): (Axis, &AxisConfig)| {
            let i = axis.index();
            let has_switch = |reference: &ReferenceConfig| reference.method != Method::Index;
            let reference = config.reference.filter(has_switch).filter(|_| self.open >> i & 1 != 0);
            let onto = |reference: ReferenceConfig| reference.way() * to[i].mm_from(here[i]) > 0.0;
            measurement.axes[i].is_switched() && reference.is_some_and(onto)
        };
        machine.axes().any(goes_on)
    }

    /// What of the way in hand is a jog.
    pub(crate) fn jog(&self) -> Option<Jog> {
        let run = self.run.filter(|run| run.phase != Phase::Home)?;
        Some(if run.came { Jog::LetGo } else { Jog::Pressed })
    }

    /// The run of an axis begins; false if it has none.
    pub(crate) fn begin(&mut self, machine: &Machine, axis: Axis, measurement: &Measurement) -> bool {
        let Some(reference) = machine.axis.get(&axis).and_then(|config| config.reference) else {
            return false;
        };
        let phase = match reference.method {
            Method::Index => Phase::Latch,
            _ if measurement.axes[axis.index()].is_switched() => Phase::BackOff,
            _ => Phase::Search,
        };
        self.open |= 1 << axis.index();
        self.run = Some(Run::anew(axis, phase));
        true
    }

    /// Takes what is measured in a tick.
    pub(crate) fn look(&mut self, machine: &Machine, measurement: &Measurement) {
        let Some(run) = &mut self.run else { return };
        let Some(reference) = machine.axis.get(&run.axis).and_then(|config| config.reference) else { return };
        if run.under_way && !run.came && run.comes(&reference, measurement) {
            (run.came, run.marks) = (true, measurement.references[run.axis.index()]);
        }
    }

    /// What is next of the run in hand. The axes rest here.
    pub(crate) fn then(
        &mut self,
        machine: &Machine,
        measurement: &Measurement,
        here: &PerAxis<Position>,
    ) -> Then {
        let Some(run) = &mut self.run else { return Then::Nothing };
        let axis = run.axis;
        let Some((config, reference)) =
            machine.axis.get(&axis).and_then(|config| Some((config, config.reference?)))
        else {
            return Then::Nothing;
        };
        match (run.phase, run.under_way, run.came) {
            (Phase::Home, true, _) => {
                self.run = None;
                return Then::Nothing;
            }
            (phase, true, false) => {
                return Then::Fails(axis, phase.in_vain(reference.method, run, measurement));
            }
            (Phase::Search, true, true) => *run = Run::anew(axis, Phase::BackOff),
            (Phase::BackOff, true, true) => {
                let backed_off = run.from;
                *run = Run { from: backed_off, ..Run::anew(axis, Phase::Latch) };
            }
            (Phase::Latch, true, true) => {
                return match sets(config, &reference, self.known[axis.index()], &run.marks) {
                    Ok(offset) => Then::Sets(axis, offset),
                    Err(fault) => Then::Fails(axis, fault),
                };
            }
            (_, false, _) => {}
        }
        let at = here[axis.index()];
        let mut target = *here;
        target[axis.index()] = run.target(config, &reference, at);
        run.under_way = true;
        run.from = at;
        run.indexes = measurement.axes[axis.index()].indexes();
        Then::Way(target, run.feed(&reference))
    }

    /// The first cycle whose measurement has the offset of an axis.
    pub(crate) fn shows(&mut self, axis: Axis, offset: Position, measurement: &Measurement) -> Option<Cycle> {
        let now = measurement.references[axis.index()].home_offset == offset;
        self.shown = self.shown.or(Some(measurement.cycle)).filter(|_| now);
        self.shown
    }

    /// The axis is referenced, and goes home.
    pub(crate) fn is_set(&mut self, axis: Axis) {
        self.open &= !(1 << axis.index());
        (self.run, self.shown) = (Some(Run::anew(axis, Phase::Home)), None);
    }
}

impl Run {
    fn anew(axis: Axis, phase: Phase) -> Run {
        let marks = AxisReference::default();
        Run { axis, phase, came: false, under_way: false, from: Position(0), indexes: 0, marks }
    }

    /// Whether what the phase waits for is there.
    fn comes(&self, reference: &ReferenceConfig, measurement: &Measurement) -> bool {
        let measured = &measurement.axes[self.axis.index()];
        match (self.phase, reference.method) {
            (Phase::Search, _) | (Phase::Latch, Method::Switch) => measured.is_switched(),
            (Phase::BackOff, _) => !measured.is_switched(),
            (Phase::Latch, Method::Index) => measured.indexes() != self.indexes,
            (Phase::Latch, Method::SwitchAndIndex) => {
                let passed = measured.indexes() != self.indexes;
                let marks = &measurement.references[self.axis.index()];
                measured.is_switched() && passed && behind_mm(reference, marks) > 0.0
            }
            (Phase::Home, _) => false,
        }
    }

    /// Where the way of the phase ends at the latest.
    fn target(&self, config: &AxisConfig, reference: &ReferenceConfig, at: Position) -> Position {
        let [low, high] = config.travel_mm;
        let way = reference.way();
        let turns_mm = if reference.method == Method::Switch { 0.0 } else { TURNS * config.screw_lead_mm };
        match self.phase {
            Phase::Search => at.moved(way * (high - low + BEYOND_MM)),
            Phase::BackOff => {
                let end_mm = if way > 0.0 { high } else { low };
                let cam_mm = (end_mm - reference.position_mm).abs() + turns_mm;
                at.moved(-way * (cam_mm + BEYOND_MM))
            }
            Phase::Latch if reference.method == Method::Index => at.moved(way * turns_mm),
            Phase::Latch => self.from.moved(way * (AGAIN_MM + turns_mm)),
            Phase::Home => Position::from_mm(config.home_mm),
        }
    }

    fn feed(&self, reference: &ReferenceConfig) -> Feed {
        match self.phase {
            Phase::Search | Phase::BackOff => Feed::PerMinute(60.0 * reference.search_mm_s.abs()),
            Phase::Latch => Feed::PerMinute(60.0 * reference.latch_mm_s),
            Phase::Home => Feed::Rapid,
        }
    }
}

impl Phase {
    /// What it means that the way is over.
    fn in_vain(self, method: Method, run: &Run, measurement: &Measurement) -> Fault {
        let on = measurement.axes[run.axis.index()].is_switched();
        match (self, method) {
            (Phase::BackOff, _) => Fault::SwitchNotReleased,
            (Phase::Latch, Method::Index) => Fault::IndexNotFound,
            (Phase::Latch, Method::SwitchAndIndex) if on => Fault::IndexNotFound,
            _ => Fault::SwitchNotFound,
        }
    }
}

/// How far the last index lies behind where the switch went on, in the direction of the search, mm.
fn behind_mm(reference: &ReferenceConfig, marks: &AxisReference) -> f64 {
    marks.indexed_at.mm_from(marks.switched_at) * reference.way()
}

/// The offset that makes the latched position what it is `known` to be. The first index behind the switch
/// counts, and the one that was latched is the last of those that one look found: one comes with every turn.
///
/// # Errors
/// The switch does not tell one index from the next.
fn sets(
    config: &AxisConfig,
    reference: &ReferenceConfig,
    known: Position,
    marks: &AxisReference,
) -> Result<Position, Fault> {
    let lead_mm = config.screw_lead_mm;
    let off_mm = match reference.method {
        Method::Switch => known.mm_from(marks.switched_at),
        Method::SwitchAndIndex => {
            let turns = behind_mm(reference, marks) / lead_mm;
            let more = turns.floor();
            if !(TOO_NEAR..=1.0 - TOO_NEAR).contains(&(turns - more)) {
                return Err(Fault::IndexTooNear);
            }
            known.mm_from(marks.indexed_at) + reference.way() * more * lead_mm
        }
        Method::Index => {
            let off_mm = known.mm_from(marks.indexed_at);
            off_mm - lead_mm * (off_mm / lead_mm).round()
        }
    };
    Ok(marks.home_offset.moved(off_mm))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The offset that a switch at `switched` and an index so many mm behind it give.
    fn offset_mm(way: f64, behind_mm: f64) -> Result<f64, Fault> {
        let machine = Machine::plain();
        let method = Method::SwitchAndIndex;
        let reference = ReferenceConfig {
            method,
            position_mm: 66.0,
            search_mm_s: way * 25.0,
            latch_mm_s: 25.0,
            sequence: 0,
        };
        let switched_at = Position::from_mm(63.0);
        let marks = AxisReference {
            home_offset: Position::from_mm(0.25),
            switched_at,
            indexed_at: switched_at.moved(way * behind_mm),
        };
        let known = Position::from_mm(reference.position_mm);
        sets(&machine.axis[&Axis::X], &reference, known, &marks).map(|offset| offset.mm())
    }

    #[test]
    fn of_the_indexes_that_one_look_finds_the_first_counts() {
        for way in [1.0, -1.0] {
            for turns in 0..4 {
                let more_mm = 5.0 * f64::from(turns);
                let first = offset_mm(way, 2.0).expect("it is far from the switch");
                assert!((first - (0.25 + 66.0 - (63.0 + way * 2.0))).abs() < 1e-9, "{first}");
                let found = offset_mm(way, 2.0 + more_mm).expect("it is as far");
                assert!((found - first).abs() < 1e-9, "{turns} turns later: {found}, {first}");
                for near_mm in [0.3, 4.7] {
                    assert_eq!(
                        offset_mm(way, near_mm + more_mm),
                        Err(Fault::IndexTooNear),
                        "{turns} turns later"
                    );
                }
            }
        }
    }
}
