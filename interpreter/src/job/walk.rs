//! Paths walked from leg to leg before anything moves, in the pieces in which the interpolator will walk
//! them. In: a surface and its formulas, mm. Out: the places of the tool, its way, the box it stays in; or
//! where it cannot go on.

use protocol::Axis;
use shape::{Curve, Formula, Leg, PieceError, Plan, Surface, SurfaceCurve, Touch, Walker};

use super::feed::Pace;
use super::grid::{cuts, here, hollow};
use super::{Fault, Job};

/// Places in a path are this share of the larger side of the domain apart, or less.
const APART: f64 = 1.0 / 400.0;
/// Most places that are looked at,
const PLACES: usize = 2_000_000;
/// and most that are kept, evenly, to see what else the tool touches there.
const KEPT: usize = 1 << 18;
/// They lie so far into their shares of a piece: beside the places where its maker compared it with its
/// curve.
pub(super) const BESIDE: f64 = 0.382;
/// A piece lies so near to its curve there, mm: rounding, far above what its maker keeps.
const NEAR_MM: f64 = 1e-6;
/// The direction of the slope jumps where it turns by more than 60° within 0.01 mm.
const JUMP_MM: f64 = 0.01;
const TURNS: f64 = 0.5;

/// What was seen on the way.
#[derive(Clone, Debug)]
pub(super) struct Walk {
    /// Point of contact seen from above, and tip of the tool, mm, at every so many places.
    pub(super) tips: Vec<([f64; 2], [f64; 3])>,
    every: usize,
    places: usize,
    /// Lowest and highest tip, mm.
    pub(super) bounds: [[f64; 3]; 2],
    /// The tip at the start,
    pub(super) start: [f64; 3],
    /// and at the end, mm.
    pub(super) end: [f64; 3],
    /// Way of the tip on the surface, mm.
    pub(super) cut_mm: f64,
    /// The highest feed on it.
    pub(super) pace: Pace<3>,
    /// Retracts between legs.
    pub(super) retracts: u32,
}

/// Walks the pattern of a surface.
///
/// # Errors
/// A place where the path leaves the domain, does not exist, or cannot be followed.
pub(super) fn walk(surface: &Surface, formulas: [&Formula; 3], job: &Job) -> Result<Walk, Fault> {
    let mut walk = Walk {
        tips: Vec::new(),
        every: 1,
        places: 0,
        bounds: [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]],
        start: [f64::NAN; 3],
        end: [f64::NAN; 3],
        cut_mm: 0.0,
        pace: Pace::new(job.machine, [Axis::X, Axis::Y, Axis::Z]),
        retracts: 0,
    };
    for leg in (0..surface.legs()).filter_map(|leg| surface.leg(leg)) {
        match leg {
            Leg::Air { .. } => walk.retracts += 1,
            Leg::Cut(plan) => walk.leg(surface, plan, formulas)?,
        }
    }
    Ok(walk)
}

impl Walk {
    fn leg(&mut self, surface: &Surface, plan: Plan, formulas: [&Formula; 3]) -> Result<(), Fault> {
        let curve = surface.curve(plan, formulas);
        let apart = APART * (surface.x[1] - surface.x[0]).max(surface.y[1] - surface.y[0]);
        let mut walker = Walker::new(plan.t());
        loop {
            let next = walker.next(&curve).map_err(|error| stopped(&curve, formulas[0], plan, error))?;
            let Some(piece) = next else { return Ok(()) };
            let [low, high] = piece.path.bounds();
            for axis in 0..3 {
                self.bounds[0][axis] = self.bounds[0][axis].min(piece.from[axis] + low[axis]);
                self.bounds[1][axis] = self.bounds[1][axis].max(piece.from[axis] + high[axis]);
            }
            if self.tips.is_empty() {
                self.start = piece.from;
            }
            self.end = piece.to;
            self.cut_mm += piece.path.length();
            self.pace.goes_along(&piece.path);
            let places = (piece.path.length() / apart).ceil().max(1.0);
            if self.places as f64 + places > PLACES as f64 {
                return Err(too_long(plan));
            }
            for n in 0..places as usize {
                let s = piece.path.length() * (n as f64 + BESIDE) / places;
                let t = piece.parameter(s);
                let contact = curve.contact(t).map(|axis| axis.value());
                inside(surface, t, contact)?;
                let tip = surface.tip(formulas[0], contact);
                let [gone, ..] = piece.path.at(s);
                if !is_near(piece.from, gone, tip) {
                    return Err(too_fine(plan, contact));
                }
                self.keep((contact, tip));
            }
            inside(surface, piece.t[1], curve.contact(piece.t[1]).map(|axis| axis.value()))?;
        }
    }

    /// Keeps a place, and half of all as soon as they are too many.
    fn keep(&mut self, place: ([f64; 2], [f64; 3])) {
        if self.places.is_multiple_of(self.every) {
            if self.tips.len() == KEPT {
                let mut n = 0;
                self.tips.retain(|_| {
                    n += 1;
                    n % 2 == 1
                });
                self.every *= 2;
            }
            if self.places.is_multiple_of(self.every) {
                self.tips.push(place);
            }
        }
        self.places += 1;
    }
}

/// Whether a piece that starts at `from` is where the tool should be after a way.
pub(super) fn is_near<const N: usize>(from: [f64; N], gone: [f64; N], should: [f64; N]) -> bool {
    (0..N).all(|axis| (from[axis] + gone[axis] - should[axis]).abs() <= NEAR_MM)
}

fn too_long(plan: Plan) -> Fault {
    let message = format!("the path is too long to be looked at: more than {PLACES} places");
    let help = match plan {
        Plan::Line { .. } => "give a larger step_mm or scallop_mm, or several jobs",
        Plan::Curve { .. } => "give a shorter range of t, or several jobs",
    };
    Fault::new("path", message, help)
}

fn too_fine(plan: Plan, [x, y]: [f64; 2]) -> Fault {
    let message = format!("finer detail than the pieces of the path follow, at {}", here(x, y));
    let help = "leave it out: what is narrower than 0.1 mm is beyond any tool";
    Fault::new(if matches!(plan, Plan::Line { .. }) { "z" } else { "path" }, message, help)
}

/// Refuses a place outside of the domain: what the tool does there was not looked at.
fn inside(surface: &Surface, t: f64, [x, y]: [f64; 2]) -> Result<(), Fault> {
    let within = |[low, high]: [f64; 2], at: f64| {
        let rounding = 1e-9 * (high - low);
        (low - rounding..=high + rounding).contains(&at)
    };
    if within(surface.x, x) && within(surface.y, y) {
        return Ok(());
    }
    let message = format!("the path leaves the surface at t = {t:.4}, {}", here(x, y));
    Err(Fault::new("path", message, "keep the path within x and y, or make them larger"))
}

/// Why the path ends before it should.
fn stopped(curve: &SurfaceCurve, formula: &Formula, plan: Plan, error: PieceError) -> Fault {
    let t = error.t();
    let point = curve.at(t);
    let [x, y] = curve.contact(t).map(|axis| axis.value());
    let speed = point.tip.iter().map(|axis| axis.derivative(1).abs()).fold(1e-9, f64::max);
    let beside = |sign: f64| curve.contact(t + sign * JUMP_MM / speed).map(|axis| axis.value());
    let touches = [-1.0, 1.0].map(|sign| (beside(sign), Touch::at(formula, beside(sign))));
    let [[a, b], [c, d]] =
        touches.map(|(_, touch)| touch.slope).map(|[x, y]| [x, y].map(|slope| slope / libm::hypot(x, y)));
    let cosine = a * c + b * d;
    if !curve.tool().is_ball() && (cosine.is_nan() || cosine < TURNS) {
        let message = format!(
            "the surface is level near {}: there a tool that is not a ball touches it with all of its end, and its path jumps",
            here(x, y)
        );
        let help = "take kind = \"ball\", or a path that keeps clear of that place";
        return Fault::new("tool", message, help);
    }
    // A tool that is too large would go back where its path goes on.
    if let Some((at, touch)) = touches.iter().find(|(_, touch)| cuts(curve.tool(), touch)) {
        return hollow(*at, touch);
    }
    let at = if matches!(plan, Plan::Curve { .. }) { format!("t = {t:.4}, ") } else { String::new() };
    let why = match error {
        PieceError::NotFinite { .. } => "it has no finite value or slope",
        PieceError::StandsStill { .. } => "it stands still",
        PieceError::Unresolved { .. } => "it bends too sharply",
    };
    let message = format!("the path of the tool cannot be followed at {at}{}: {why} there", here(x, y));
    match plan {
        Plan::Line { .. } => {
            Fault::new("z", message, "choose x and y so that the surface is smooth all over them")
        }
        Plan::Curve { .. } => {
            Fault::new("path", message, "choose x, y and t of the path so that it is smooth")
        }
    }
}
