//! Axes whose reference run is still to be made: nobody knows where they are. In: what a control cycle shows.
//! Out: why something is not asked of them; how far, and how fast, a jog of one goes, mm and mm/min.

use interpreter::Needs;
use machine::{AxisConfig, General, Method};
use protocol::{Axis, Position};
use rig::observe::Record;

use super::jog::fastest_jog;

/// Those axes, and whether each stands on its switch.
#[derive(Debug, Default)]
pub(super) struct Lost(Vec<(Axis, bool)>);

impl Lost {
    /// One control cycle.
    pub(super) fn look(&mut self, record: &Record) {
        let Record { truth, axes, machine } = record;
        let on = |axis: Axis| truth.measurement.axes[axis.index()].is_switched();
        let lost = axes.iter().map(|(axis, _)| *axis).filter(|axis| machine.is_unreferenced(*axis));
        self.0.clear();
        self.0.extend(lost.map(|axis| (axis, on(axis))));
    }

    /// Whether it is one of them.
    pub(super) fn has(&self, axis: Axis) -> bool {
        self.0.iter().any(|(own, _)| *own == axis)
    }

    /// Why nothing moves but jogs, if there are such axes.
    pub(super) fn why(&self) -> Option<String> {
        let names: Vec<_> = self.0.iter().map(|(axis, _)| axis.name().to_ascii_uppercase()).collect();
        (!names.is_empty()).then(|| match &names[..] {
            [name] => format!("{name} is not referenced and can only be jogged: press Home of it first"),
            _ => format!(
                "{} are not referenced and can only be jogged: press Home of each first",
                names.join(" and ")
            ),
        })
    }

    /// Why a block is not given, if there are such axes and it `needs` to know where they are.
    pub(super) fn refuses(&self, needs: impl FnOnce() -> Option<Needs>) -> Option<String> {
        let why = self.why()?;
        match needs()? {
            Needs::Places => Some(why),
            Needs::Reads => Some(format!("this reads where the axes are, and nobody knows that: {why}")),
            Needs::Surface => self.has(Axis::X).then(|| {
                let why = "G96 turns the spindle by where X is, and nobody knows that";
                format!("{why}: press Home of X first, or give its speed in 1/min, as G97 S300")
            }),
        }
    }

    /// To where one of them jogs at most, and how fast; nothing of any other axis. Nobody knows where its
    /// travel ends but by its switch, at which the jog does; one that has an index alone is within half a
    /// turn of where it believes to be, and stays where it can make its run.
    ///
    /// # Errors
    /// Why it does not go that way.
    pub(super) fn jogs(
        &self,
        (axis, config): (Axis, &AxisConfig),
        general: &General,
        at: Position,
        positive: bool,
    ) -> Option<Result<(Position, f64), String>> {
        let (_, on_switch) = self.0.iter().find(|(own, _)| *own == axis)?;
        let reference = config.reference?;
        let (name, way) = (axis.name().to_ascii_uppercase(), if positive { 1.0 } else { -1.0 });
        let most = (60.0 * reference.search_mm_s.abs()).min(fastest_jog(config));
        let [low, high] = config.travel_mm;
        if reference.method == Method::Index {
            let to = Position::from_mm(reference.run_begins_within(config, general)[usize::from(positive)]);
            let is_there = way * to.mm_from(at) <= 0.0;
            let why = || {
                format!(
                    "{name} is so near to the end of its travel that it could not make its run behind: press Home"
                )
            };
            return Some(if is_there { Err(why()) } else { Ok((to, most)) });
        }
        if *on_switch && way == reference.way() {
            return Some(Err(format!("{name} stands on its switch: jog the other way, or press Home")));
        }
        Some(Ok((at.moved(way * (high - low)), most)))
    }
}
