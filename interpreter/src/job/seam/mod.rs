//! A seam as a job: under the beam of a positioner. In: its keys, in the frame of the work-holder. Out: moves
//! to where it begins, formulas, one trace for each smooth piece; or why the positioner cannot go there.
//!
//! | module | from | to |
//! |---|---|---|
//! | `meeting` | two surfaces | where they meet |
//! | `spline` | points | polynomials through them |
//! | `travel` | seams | the solution that lies within the travel, and its figures |
//! | `upright` | seams that pass the turn axis closely | the same, with a direction that goes through it |

mod meeting;
mod spline;
mod travel;
mod upright;

use machine::POSITIONER_AXES;
use protocol::{Feed, Position, Shape, Work};
use serde::Deserialize;
use shape::{Branch, Correction, Formula, Op, Seam, SeamCurve};

use super::row::Row;
use super::{Fault, Job, Move, Planned, formula, parameter, within};
use meeting::{Crossing, SurfaceKeys};
use travel::Asked;

/// Farthest a direction may be off.
const MOST_TOLERANCE_DEG: f64 = 5.0;
/// Most points of a seam.
const MOST_POINTS: usize = 2000;

/// Keys of a seam.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Keys {
    /// Formulas of t: position, mm,
    x: Option<String>,
    y: Option<String>,
    z: Option<String>,
    /// and direction.
    direction: Option<Row<String, 3>>,
    /// t at the start and at the end.
    t: Option<Row<f64, 2>>,
    /// Two surfaces.
    first: Option<SurfaceKeys>,
    second: Option<SurfaceKeys>,
    /// Angle about the first at the start and at the end, degrees.
    angle_deg: Option<Row<f64, 2>>,
    /// Direction from the axis of the first in which this angle is 0.
    zero: Option<Row<f64, 3>>,
    /// Where along the axis of the first.
    crossing: Option<Crossing>,
    /// Direction between both normals.
    share: Option<f64>,
    /// Points: x, y, z in mm and the direction.
    points: Option<Vec<Row<f64, 6>>>,
    /// Tilt; without it the solution that is nearest.
    branch: Option<Branch>,
    /// How far the direction may be off where that lets C stand.
    direction_tolerance_deg: Option<f64>,
}

/// What a seam runs along, before it is known how the axes go.
struct Course {
    curves: Vec<(SeamCurve, [f64; 2])>,
    formulas: Vec<Formula>,
    /// In words.
    what: String,
}

/// Plans a seam.
///
/// # Errors
/// What is wrong with a key, or where the positioner cannot go.
pub(super) fn plan(keys: Keys, job: &Job) -> Result<Planned, Fault> {
    if job.correction != Correction::Exact {
        return Err(Fault::new("correction", "a seam is always followed exactly", "leave it out"));
    }
    let course = course(&keys, job.origin_mm)?;
    let rest = POSITIONER_AXES.map(|axis| job.rest[axis.index()].mm());
    let seams: Vec<Seam> = course
        .curves
        .into_iter()
        .map(|(curve, t)| Seam { curve, t, branch: Branch::Negative, idle_beta_deg: rest[3], moved: None })
        .collect();
    let tolerance_deg = keys.direction_tolerance_deg.unwrap_or(0.0);
    within("direction_tolerance_deg", tolerance_deg, [0.0, MOST_TOLERANCE_DEG], "deg")?;
    let asked = Asked { branch: keys.branch, rest, tolerance_deg };
    let found = upright::best(job, &seams, &course.formulas, &asked).map_err(|fault| {
        if fault.key.is_empty() { Fault { key: whole(&keys, job), ..fault } } else { fault }
    })?;

    let place = |at: [f64; 4]| {
        let mut axes = job.rest;
        for (axis, at) in POSITIONER_AXES.into_iter().zip(at) {
            axes[axis.index()] = Position::from_mm(at);
        }
        axes
    };
    let start = place(found.start);
    let approach = if start == job.rest { Vec::new() } else { vec![Move { to: start, feed: Feed::Rapid }] };
    let mut facts = vec![("seam", course.what)];
    facts.extend(found.facts());
    let trace = |seam: &Seam| Work { origin: [Position(0); 3], ..job.trace(Shape::Seam(*seam)) };
    Ok(Planned {
        approach,
        formulas: course.formulas,
        traces: found.seams.iter().map(trace).collect(),
        end: place(found.end),
        retract: Vec::new(),
        warnings: found.warning.into_iter().collect(),
        facts,
    })
}

/// The key that says where all of the seam is.
fn whole(keys: &Keys, job: &Job) -> String {
    let key = match keys {
        _ if job.origin_mm != [0.0; 3] => "origin_mm",
        Keys { points: Some(_), .. } => "points",
        Keys { first: Some(_), .. } => "first",
        _ => "x",
    };
    key.into()
}

/// What the keys say, moved by the place of the part on the work-holder, mm.
fn course(keys: &Keys, origin: [f64; 3]) -> Result<Course, Fault> {
    let curve =
        [keys.x.is_some(), keys.y.is_some(), keys.z.is_some(), keys.direction.is_some(), keys.t.is_some()];
    let surfaces =
        [keys.first.is_some(), keys.second.is_some(), keys.angle_deg.is_some(), keys.zero.is_some()];
    let surfaces = surfaces.iter().any(|given| *given) || keys.crossing.is_some() || keys.share.is_some();
    let curve = curve.iter().any(|given| *given);
    match (curve, surfaces, &keys.points) {
        (true, false, None) => formulas(keys, origin),
        (false, true, None) => surfaces_of(keys, origin),
        (false, false, Some(points)) => points_of(points, origin),
        _ => {
            let message = "a seam is given in one of three ways";
            let help = "give x, y, z, direction and t; or first and second; or points";
            Err(Fault::new("", message, help))
        }
    }
}

fn missing(key: &str, help: &str) -> Fault {
    Fault::new("", format!("{key} is missing"), help)
}

/// A curve of t.
fn formulas(keys: &Keys, origin: [f64; 3]) -> Result<Course, Fault> {
    let help = "give x, y, z and direction as formulas of t, and t = [start, end]";
    let given = |key: &str, text: &Option<String>| text.clone().ok_or_else(|| missing(key, help));
    let at = [given("x", &keys.x)?, given("y", &keys.y)?, given("z", &keys.z)?];
    let Row(direction) = keys.direction.clone().ok_or_else(|| missing("direction", help))?;
    let t = parameter("t", keys.t.ok_or_else(|| missing("t", help))?.0)?;
    let mut formulas = Vec::new();
    for ((key, text), mm) in ["x", "y", "z"].into_iter().zip(&at).zip(origin) {
        formulas.push(moved(key, &formula(key, text, &["t"])?, mm)?);
    }
    for text in &direction {
        // The place within one of three texts cannot be shown: the whole key is to blame.
        formulas.push(formula("direction", text, &["t"]).map_err(|fault| Fault { part: None, ..fault })?);
    }
    let what = format!("x = {}, y = {}, z = {}, t = {} to {}", at[0], at[1], at[2], t[0], t[1]);
    Ok(Course { curves: vec![(SeamCurve::Formulas, t)], formulas, what })
}

/// A formula and a number added to it.
fn moved(key: &str, formula: &Formula, mm: f64) -> Result<Formula, Fault> {
    if mm == 0.0 {
        return Ok(*formula);
    }
    let ops: Vec<Op> = formula.ops().chain([Op::Constant(mm), Op::Add]).collect();
    Formula::new(&ops).map_err(|error| {
        Fault::new(key, format!("the formula has {error} with origin_mm in it"), "write it shorter")
    })
}

fn surfaces_of(keys: &Keys, origin: [f64; 3]) -> Result<Course, Fault> {
    let help = "give both surfaces, as in \
                first = { kind = \"cylinder\", at_mm = [0, 0, 50], axis = [0, 0, 1], diameter_mm = 40 }";
    let first = keys.first.as_ref().ok_or_else(|| missing("first", help))?;
    let second = keys.second.as_ref().ok_or_else(|| missing("second", help))?;
    let share = within("share", keys.share.unwrap_or(0.5), [0.0, 1.0], "")?;
    let crossing = keys.crossing.unwrap_or_default();
    let mut meeting = meeting::of(first, second, keys.zero.map(|Row(zero)| zero), crossing, share)?;
    for (i, mm) in origin.into_iter().enumerate() {
        meeting.first.at[i] += mm;
        meeting.second.at[i] += mm;
    }
    let angle = parameter("angle_deg", keys.angle_deg.map_or([0.0, 360.0], |Row(angle)| angle))?;
    let what = format!("{first} meets {second}, {} to {} deg", angle[0], angle[1]);
    Ok(Course {
        curves: vec![(SeamCurve::Meeting(meeting), angle.map(f64::to_radians))],
        formulas: Vec::new(),
        what,
    })
}

fn points_of(points: &[Row<f64, 6>], origin: [f64; 3]) -> Result<Course, Fault> {
    if !(2..=MOST_POINTS).contains(&points.len()) {
        let message = format!("a seam cannot have {} points", points.len());
        return Err(Fault::new("points", message, format!("give 2 to {MOST_POINTS}")));
    }
    let mut places = Vec::with_capacity(points.len());
    for (index, point) in points.iter().enumerate() {
        let [x, y, z, lx, ly, lz] = point.0;
        let length = (lx * lx + ly * ly + lz * lz).sqrt();
        if !(length > 1e-9 && length < 1e9 && [x, y, z].iter().all(|mm| mm.abs() < 1e5)) {
            let message = format!("point {} has no place or no direction", index + 1);
            return Err(Fault::new("points", message, "give x, y, z in mm and a direction that is not 0"));
        }
        let [ox, oy, oz] = origin;
        places.push([x + ox, y + oy, z + oz, lx / length, ly / length, lz / length]);
    }
    let pieces = spline::through(&places).ok_or_else(|| {
        let apart = |pair: &[[f64; 6]]| (0..3).map(|i| (pair[1][i] - pair[0][i]).abs()).fold(0.0, f64::max);
        let apart = places.windows(2).map(apart).enumerate();
        let closest = apart.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(index, _)| index);
        let message = format!("points {} and {} are one", closest + 1, closest + 2);
        Fault::new("points", message, "leave one of them out")
    })?;
    let curves = pieces.into_iter().map(|piece| (SeamCurve::Polynomials(piece), [0.0, 1.0])).collect();
    Ok(Course { curves, formulas: Vec::new(), what: format!("through {} points", points.len()) })
}
