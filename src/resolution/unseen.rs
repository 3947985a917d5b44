//! What encoders do not see, because it lies behind them: lost motion and the error of the screw. In: needs
//! of the axes. Out: how much of it there is, as the machine file has it, and how exactly it has to be known.
//!
//! The controller takes both off as far as the machine file is right (M68), so what a part gets of them is
//! what that is wrong by: it is given the step of position (M30). An axis with a scale sees both.

use machine::screw::Screw;

use super::{Asked, needs::AxisNeeds};
use report::table::three;

/// Places between the ends of travel at which the error of a screw is looked at.
const PLACES: u32 = 1000;

/// One cause of one axis.
pub(super) struct Unseen<'a> {
    pub(super) needs: &'a AxisNeeds,
    pub(super) cause: Cause,
    /// How much it is, mm or degrees: of a screw from the least to the largest error within the travel.
    pub(super) size: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cause {
    LostMotion,
    Screw,
}

impl Cause {
    pub(super) fn name(self) -> &'static str {
        match self {
            Cause::LostMotion => "lost motion",
            Cause::Screw => "screw",
        }
    }
}

impl Unseen<'_> {
    /// The step that is needed: so exactly it has to be known.
    pub(super) fn within(&self) -> f64 {
        self.needs.required.position_mm
    }

    /// Whether the accuracy depends on it, and not on counts alone.
    pub(super) fn limits(&self) -> bool {
        self.size > self.within()
    }

    /// How much it is, and how exactly it has to be known.
    fn sentence(&self) -> String {
        let Unseen { needs, cause, size } = self;
        let (name, unit) = (needs.name(), needs.unit());
        let counts = three(size / needs.encoder.increment_mm());
        let key = match cause {
            Cause::LostMotion => format!("backlash_{unit}"),
            Cause::Screw => "screw_error".into(),
        };
        format!(
            "{name}: its {} of {} {unit}, {counts} counts, limits the accuracy: axis.{}.{key} has to be right within {} {unit}",
            cause.name(),
            three(*size),
            name.to_lowercase(),
            three(self.within())
        )
    }
}

/// All that the machine file tells.
pub(super) fn of(asked: &Asked) -> Vec<Unseen<'_>> {
    let blind = asked.axes.iter().filter_map(|needs| {
        let (_, config) = needs.axis.as_ref().filter(|(_, config)| config.scale_step_mm.is_none())?;
        Some((needs, config))
    });
    let causes = blind.flat_map(|(needs, config)| {
        let screw = Screw::new(&config.screw_error).map_or(0.0, |screw| range(&screw, config.travel_mm));
        [(Cause::LostMotion, config.backlash_mm), (Cause::Screw, screw)].map(|(cause, size)| Unseen {
            needs,
            cause,
            size,
        })
    });
    causes.filter(|unseen| unseen.size > 0.0).collect()
}

/// From the least to the largest error of a screw, mm or degrees.
fn range(screw: &Screw, [from, to]: [f64; 2]) -> f64 {
    let place = |n: u32| from + (to - from) * f64::from(n) / f64::from(PLACES);
    let errors = (0..=PLACES).map(|n| screw.error(place(n))[0]);
    let [low, high] =
        errors.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], e| [low.min(e), high.max(e)]);
    high - low
}

/// What limits the accuracy besides counts, and of which screws nothing is known.
pub(super) fn sentences(asked: &Asked, unseen: &[Unseen]) -> Vec<String> {
    let limits: Vec<&Unseen> = unseen.iter().filter(|unseen| unseen.limits()).collect();
    let mut lines: Vec<String> = limits.iter().map(|unseen| unseen.sentence()).collect();
    if limits.iter().any(|unseen| unseen.cause == Cause::LostMotion) {
        lines.push(
            "where an axis reverses, all of its lost motion is missing until the motor has crossed it".into(),
        );
    }
    let unknown = |needs: &&AxisNeeds| {
        let config = needs.axis.as_ref().map(|(_, config)| config);
        needs.unit() == "mm" && config.is_some_and(|c| c.scale_step_mm.is_none() && c.screw_error.is_empty())
    };
    let unknown: Vec<String> = asked.axes.iter().filter(unknown).map(AxisNeeds::name).collect();
    if !unknown.is_empty() {
        lines.push(format!(
            "{}: nothing is known of the error of the screw (screw_error); grade 5 of ISO 3408 allows 23 µm in 300 mm",
            unknown.join(", ")
        ));
    }
    lines
}
