//! How a positioner goes along a seam: both solutions walked before anything moves, in the pieces in which
//! the interpolator will walk them. In: seams, their formulas, where the axes rest, mm and degrees. Out: the
//! solution that stays within the travel and begins nearest to where the axes rest; or why there is none, and
//! where.

use machine::{AxisConfig, Machine, POSITIONER_AXES, PositionerConfig};
use protocol::Axis;
use route::positioner::geometry;
use shape::{Branch, Formula, PieceError, Seam, SeamCurve, SeamPath, Walker};

use super::super::{Fault, Job};

/// Where an axis that goes on along the next seam may be seen beside where it came, mm or degrees.
const JOINED: f64 = 1e-6;
/// Slower than this share of the feed, a rotary axis makes no seam of it.
const SLOWEST_SHARE: f64 = 0.01;
/// Feeds that a rotary axis lowers by less are not worth a word.
const WORTH_A_WORD: f64 = 0.99;
/// Directions that lean less than this are near that of the turn axis, rad.
const NEAR_UPRIGHT: f64 = 0.1;
/// Most pieces that are looked at.
const MOST_PIECES: usize = 1_000_000;

/// One solution.
pub(super) struct Travelled {
    /// The seams with its branch.
    pub(super) seams: Vec<Seam>,
    /// Where the axes stand at the start: X, Y, A, C.
    pub(super) start: [f64; 4],
    /// And at the end.
    pub(super) end: [f64; 4],
    /// What should be known of the feed.
    pub(super) warning: Option<Fault>,
    bounds: [[f64; 2]; 4],
    length_mm: f64,
    /// By what its direction is off, in words.
    pub(super) moved: Option<String>,
    /// The feed that the rotary axes allow at the least, mm/s, that axis, and the place in words.
    pub(super) slowest: (f64, Axis, String),
}

/// What is asked of a solution.
pub(super) struct Asked {
    /// Which it shall be.
    pub(super) branch: Option<Branch>,
    /// Where the axes rest: X, Y, A, C in mm and degrees.
    pub(super) rest: [f64; 4],
    /// How far the direction may be off.
    pub(super) tolerance_deg: f64,
}

/// The solution that is nearest, of those within the travel.
///
/// # Errors
/// The seam does not exist everywhere, leaves the travel in both solutions, or asks too much of a rotary
/// axis.
pub(super) fn nearest(
    job: &Job,
    seams: &[Seam],
    formulas: &[Formula],
    asked: &Asked,
) -> Result<Travelled, Fault> {
    let Asked { branch, rest, .. } = *asked;
    let mut best: Option<(f64, Travelled)> = None;
    let mut refused = None;
    for candidate in Branch::BOTH.into_iter().filter(|one| branch.is_none_or(|wanted| wanted == *one)) {
        match walked(job.machine, seams, formulas, candidate, rest)
            .and_then(|way| way.within_travel(job.machine, rest))
        {
            Ok(way) => {
                let off = (way.start[2] - rest[2]).abs().max((way.start[3] - rest[3]).abs());
                if best.as_ref().is_none_or(|(least, _)| off < *least) {
                    best = Some((off, way));
                }
            }
            Err(fault) => refused = refused.or(Some(fault)),
        }
    }
    let Some((_, way)) = best else {
        return Err(
            refused.unwrap_or_else(|| Fault::new("", "the seam has no solution", "clamp the part otherwise"))
        );
    };
    way.keeps_feed(job.feed_mm_min)
}

/// Walks all seams one behind the other.
fn walked(
    machine: &Machine,
    seams: &[Seam],
    formulas: &[Formula],
    branch: Branch,
    rest: [f64; 4],
) -> Result<Travelled, Fault> {
    let Some(positioner) = &machine.positioner else {
        return Err(Fault::new("kind", "the machine has no [positioner]", "choose another machine file"));
    };
    let mut way = Travelled {
        seams: Vec::with_capacity(seams.len()),
        start: rest,
        end: rest,
        warning: None,
        bounds: [[f64::INFINITY, f64::NEG_INFINITY]; 4],
        length_mm: 0.0,
        moved: None,
        slowest: (f64::INFINITY, Axis::C, String::new()),
    };
    let mut pieces = 0;
    for (index, seam) in seams.iter().enumerate() {
        let mut seam = Seam { branch, idle_beta_deg: way.end[3], ..*seam };
        if index > 0 {
            seam.branch = on(&seam, formulas, positioner).branch_near(seam.t[0], &way.end);
        }
        let path = on(&seam, formulas, positioner);
        let place = |t: f64| place(&seam, index, t);
        let mut walker = Walker::new(seam.t).standing(way.end);
        while let Some(span) = walker.next(&path).map_err(|error| stopped(&seam, &path, &place, error))? {
            pieces += 1;
            if pieces > MOST_PIECES {
                return Err(Fault::new(
                    "",
                    "the seam is too long to be looked at",
                    "make several jobs of it",
                ));
            }
            if pieces == 1 {
                way.start = span.from;
            } else if span.t[0] == seam.t[0] {
                way.joins(&span.from, &place(span.t[0]))?;
            }
            let length = span.path.length();
            let [low, high] = span.path.bounds();
            for (i, bounds) in way.bounds.iter_mut().enumerate() {
                *bounds = [bounds[0].min(span.from[i] + low[i]), bounds[1].max(span.from[i] + high[i])];
            }
            // What goes far beyond it is not looked at to its end.
            way.keeps_travel(machine, false, || format!(" at {}", place(span.t[1])))?;
            for share in [0.0, 0.5, 1.0] {
                let [_, slope, ..] = span.path.at(share * length);
                way.turns(machine, &slope, || place(span.t[0] + share * (span.t[1] - span.t[0])));
            }
            (way.end, way.length_mm) = (span.to, way.length_mm + length);
        }
        way.seams.push(seam);
    }
    Ok(way)
}

/// A seam on the positioner.
pub(super) fn on<'a>(seam: &'a Seam, formulas: &'a [Formula], positioner: &PositionerConfig) -> SeamPath<'a> {
    seam.on(formulas, geometry(positioner), positioner.beam_mm)
}

/// A place of a seam in words.
pub(super) fn place(seam: &Seam, index: usize, t: f64) -> String {
    match seam.curve {
        SeamCurve::Formulas => format!("t = {t:.4}"),
        SeamCurve::Meeting(_) => format!("{:.2} deg", t.to_degrees()),
        SeamCurve::Polynomials(_) if t <= 0.0 => format!("point {}", index + 1),
        SeamCurve::Polynomials(_) if t >= 1.0 => format!("point {}", index + 2),
        SeamCurve::Polynomials(_) => format!("the way from point {} to {}", index + 1, index + 2),
    }
}

impl Travelled {
    /// Refuses a jump from one seam to the next.
    fn joins(&self, from: &[f64; 4], place: &str) -> Result<(), Fault> {
        let jump = self.end.iter().zip(from).map(|(end, from)| (end - from).abs()).fold(0.0, f64::max);
        if jump <= JOINED {
            return Ok(());
        }
        let message = format!(
            "the axes would jump by {jump:.3} at {place}: the direction is that of the turn axis there"
        );
        Err(Fault::new("", message, UPRIGHT))
    }

    /// Takes note of the feed at which a rotary axis turns as fast as it can; slopes in degrees a mm.
    fn turns(&mut self, machine: &Machine, slope: &[f64; 4], place: impl Fn() -> String) {
        for (axis, slope) in POSITIONER_AXES.into_iter().zip(slope) {
            let Some(config) = machine.axis.get(&axis).filter(|_| axis.is_rotary()) else { continue };
            let feed = config.velocity_mm_s / slope.abs();
            if feed < self.slowest.0 {
                self.slowest = (feed, axis, place());
            }
        }
    }

    /// The same by the whole turns of A and C that are nearest to rest, within their travel.
    fn within_travel(mut self, machine: &Machine, rest: [f64; 4]) -> Result<Travelled, Fault> {
        let configs = POSITIONER_AXES.map(|axis| machine.axis.get(&axis));
        for i in [2, 3] {
            let Some(AxisConfig { travel_mm: [low, high], .. }) = configs[i] else { continue };
            let [least, most] = self.bounds[i];
            let (first, last) = (((low - least) / 360.0).ceil(), ((high - most) / 360.0).floor());
            if first <= last {
                let turns = 360.0 * ((rest[i] - self.start[i]) / 360.0).round().clamp(first, last);
                self.start[i] += turns;
                self.end[i] += turns;
                self.bounds[i] = self.bounds[i].map(|angle| angle + turns);
                if i == 3 {
                    self.seams.iter_mut().for_each(|seam| seam.idle_beta_deg += turns);
                }
            }
        }
        self.keeps_travel(machine, true, String::new)?;
        Ok(self)
    }

    /// Refuses what takes a linear or a rotary axis beyond its travel; `at`: where that was seen.
    fn keeps_travel(&self, machine: &Machine, is_rotary: bool, at: impl Fn() -> String) -> Result<(), Fault> {
        for (axis, [least, most]) in POSITIONER_AXES.into_iter().zip(self.bounds) {
            let config = machine.axis.get(&axis).filter(|_| axis.is_rotary() == is_rotary);
            let Some(AxisConfig { travel_mm: [low, high], .. }) = config else { continue };
            if least < *low || most > *high {
                let (unit, at) = (axis.unit(), at());
                let message = format!(
                    "the seam takes {axis} from {least:.3} to {most:.3} {unit}{at}; axis.{}.travel_{unit} is [{low}, {high}]",
                    axis.name()
                );
                let help = "clamp the part otherwise (origin_mm, z2_mm), turn the seam, or weld it in parts";
                return Err(Fault::new("", message, help));
            }
        }
        Ok(())
    }

    /// Warns where a rotary axis lowers the feed, and refuses where next to nothing of it is left.
    fn keeps_feed(mut self, feed_mm_min: f64) -> Result<Travelled, Fault> {
        let (slowest, axis, place) = &self.slowest;
        let share = slowest * 60.0 / feed_mm_min;
        if share >= WORTH_A_WORD {
            return Ok(self);
        }
        let message = format!(
            "at {place} {axis} turns so fast that the feed falls to {:.1} mm/min: the direction is near that of the turn axis",
            slowest * 60.0
        );
        let fault = Fault::new("feed_mm_min", message, UPRIGHT);
        if share < SLOWEST_SHARE {
            return Err(fault);
        }
        self.warning = Some(fault);
        Ok(self)
    }

    /// In figures, for people.
    pub(super) fn facts(&self) -> Vec<(&'static str, String)> {
        let range =
            |i: usize, unit: &str| format!("{:.3} to {:.3} {unit}", self.bounds[i][0], self.bounds[i][1]);
        let mut facts = vec![
            ("way", format!("{:.3} mm", self.length_mm)),
            ("X", range(0, "mm")),
            ("Y", range(1, "mm")),
            ("A", range(2, "deg")),
            ("C", range(3, "deg")),
        ];
        facts.extend(self.moved.iter().map(|told| ("direction", told.clone())));
        facts
    }
}

/// What to do where a direction is near that of the turn axis.
const UPRIGHT: &str = "tilt the part on the work-holder, choose a direction that keeps clear of the turn axis, or let it be off a little (direction_tolerance_deg)";

/// Why the seam cannot be followed.
fn stopped(seam: &Seam, path: &SeamPath, place: &impl Fn(f64) -> String, error: PieceError) -> Fault {
    let at = place(error.t());
    let [point, direction] = path.place(error.t());
    let value = |vector: [shape::Series; 3]| vector.map(|c| c.value());
    let (point, direction) = (value(point), value(direction));
    let length = libm::hypot(libm::hypot(direction[0], direction[1]), direction[2]);
    let flat = libm::hypot(direction[0], direction[1]);
    let (message, help) = match error {
        _ if !point.iter().all(|mm| mm.is_finite()) => (
            format!("there is no seam at {at}"),
            "of two surfaces: the first one does not reach the second there, so give the thinner one first",
        ),
        _ if length.is_nan() || length <= 1e-12 => {
            (format!("the direction has no length at {at}"), "give a direction everywhere")
        }
        _ if flat < 1e-6 * length => {
            let message =
                format!("the direction stands still in that of the turn axis at {at}: C has no place there");
            (message, UPRIGHT)
        }
        PieceError::NotFinite { .. } => (
            format!("the seam is not smooth at {at}"),
            "end it there; of two surfaces: they must not touch without crossing",
        ),
        PieceError::StandsStill { .. } => {
            (format!("the seam stands still at {at}"), "choose another parameter, or leave this place out")
        }
        PieceError::Unresolved { .. } if flat < NEAR_UPRIGHT * length => {
            let off = libm::atan2(flat, direction[2].abs()).to_degrees();
            let message = format!(
                "C would have to turn too sharply at {at}: the direction is {off:.4} deg off the turn axis"
            );
            (message, UPRIGHT)
        }
        PieceError::Unresolved { .. } => (
            format!("the seam bends too sharply at {at}"),
            "make it smooth, its direction nowhere 0; of two surfaces: they only touch there, so give the thinner one first",
        ),
    };
    let key = match seam.curve {
        SeamCurve::Formulas => "direction",
        SeamCurve::Polynomials(_) => "points",
        SeamCurve::Meeting(_) => "second",
    };
    Fault::new(key, message, help)
}
