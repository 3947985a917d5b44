//! A plane contour as a job. In: its keys. Out: its formula, one trace; or where the tool cannot go.
//!
//! On a mill y is a formula of x, and Z stands still; on a lathe x, a radius, is a formula of z, and the tool
//! comes along X.

use machine::Kinematics;
use protocol::{Axis, Feed, Position, Shape};
use serde::Deserialize;
use shape::{Contour, Curve, Formula, Gradient, Side, Touch, Walker};

use super::feed::Pace;
use super::row::Row;
use super::walk::{BESIDE, is_near};
use super::{CLEARANCE, Fault, Job, Move, Planned, formula, parameter, within};

/// Least places that are looked at.
const LEAST: f64 = 4000.0;
/// Places along the radius of the tool,
const ALONG_RADIUS: f64 = 8.0;
/// unless there would be more of them.
const MOST: f64 = 1e6;
/// Places where a piece is compared with the contour are this share of the way along the first axis apart, or
/// less.
const APART: f64 = 1.0 / 400.0;
/// Most of them.
const LOOKS: f64 = 2e6;
/// The tool may stand so deep in the contour, mm: rounding, far below the chord error.
const TOUCHES_MM: f64 = 1e-6;

/// Keys of a contour.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Keys {
    x: Option<Coordinate>,
    y: Option<Coordinate>,
    z: Option<Coordinate>,
    #[serde(default)]
    tool: ToolKeys,
    /// Of a mill: Z of the tip of the tool from the zero of the formula, mm.
    depth_z_mm: Option<f64>,
    /// Way from the part to where the tool moves freely, mm.
    #[serde(default = "clearance")]
    clearance_mm: f64,
}

fn clearance() -> f64 {
    5.0
}

/// A coordinate of the contour: what the other is a formula of, or that formula.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged, expecting = "expected a formula in quotes, or start and end such as [0, 100]")]
enum Coordinate {
    Range(Row<f64, 2>),
    Formula(String),
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct ToolKeys {
    #[serde(default)]
    diameter_mm: f64,
    #[serde(default)]
    side: Side,
}

/// How a contour lies on a machine.
#[derive(Clone, Copy)]
struct Plane<'a> {
    /// Master and follower.
    axes: [Axis; 2],
    /// Their keys.
    names: [&'static str; 2],
    range: [f64; 2],
    formula: &'a str,
    /// Of a mill: Z of the tip, mm.
    depth: Option<f64>,
}

/// Plans a contour.
///
/// # Errors
/// What is wrong with a key, or with a place of the contour.
pub(super) fn plan(keys: Keys, job: &Job) -> Result<Planned, Fault> {
    let plane = plane(&keys, job)?;
    let [name, value] = plane.names;
    let f = formula(value, plane.formula, &[name])?;
    let radius_mm = 0.5 * within("tool.diameter_mm", keys.tool.diameter_mm, [0.0, 1000.0], "mm")?;
    if (keys.tool.side == Side::On) != (radius_mm == 0.0) {
        let help =
            "give tool.side = \"left\" or \"right\", as seen along the path, with a diameter; or neither";
        return Err(Fault::new("tool", "a side and a diameter of the tool go together", help));
    }
    let clearance = within("clearance_mm", keys.clearance_mm, [0.01, 1e4], "mm")?;
    let contour = Contour { x: parameter(name, plane.range)?, radius_mm, side: keys.tool.side };
    fits(&contour, &f, name)?;
    let Walked { start, end, bounds, way, pace } = walk(&contour, &f, &plane, job)?;
    touches_nothing_else(&contour, &f, name)?;
    job.reaches(plane.axes, bounds, plane.names)?;

    // The axis along which the tool comes, where it is clear of the part, and on which side that is.
    let (across, clear, sign) = match plane.depth {
        Some(depth) => (Axis::Z, depth.max(0.0) + clearance, 1.0),
        None if contour.above_mm() < 0.0 => (Axis::X, bounds[0][1] - clearance, -1.0),
        None => (Axis::X, bounds[1][1] + clearance, 1.0),
    };
    if let Some(depth) = plane.depth {
        job.reaches([across], [[depth]; 2], ["depth_z_mm"])?;
    }
    job.reaches([across], [[plane.depth.unwrap_or(clear)], [clear]], [CLEARANCE])?;
    let place = |on: [f64; 2]| {
        let mut place = job.at(plane.axes, on);
        if let Some(depth) = plane.depth {
            place[across.index()] = job.at([across], [depth])[across.index()];
        }
        place
    };
    let (start, end) = (place(start), place(end));
    let clear = job.at([across], [clear])[across.index()];
    let mut up = end;
    up[across.index()] = clear;
    let [master, follower] = plane.axes.map(|axis| Position::from_mm(job.zero(axis)));
    let mut trace = job.trace(Shape::Contour(contour, plane.axes));
    trace.origin = [master, follower, Position::default()];
    let tool = match contour.side {
        Side::On => "on the contour".into(),
        Side::Left => format!("{} mm, left of the contour", keys.tool.diameter_mm),
        Side::Right => format!("{} mm, right of the contour", keys.tool.diameter_mm),
    };
    let [from, to] = contour.x;
    let facts = vec![
        ("contour", format!("{value} = {}, {name} = {from} to {to}", plane.formula)),
        ("tool", tool),
        ("looked at", format!("{} places along {name}", gaps(&contour) + 1)),
        ("way", format!("{way:.1} mm")),
    ];
    let approach = job.approach(across, clear, sign, &start);
    let retract = vec![Move { to: up, feed: Feed::Rapid }];
    Ok(Planned {
        approach,
        formulas: vec![f],
        traces: vec![trace],
        end,
        retract,
        warnings: pace.warning(job).into_iter().collect(),
        facts,
    })
}

/// Which key is the formula, and on which axes it lies.
fn plane<'a>(keys: &'a Keys, job: &Job) -> Result<Plane<'a>, Fault> {
    use Coordinate::{Formula, Range};
    let refuse = |key, message: &str, help: &str| Err(Fault::new(key, message, help));
    let depth_help = "give Z of the tip of the tool from the zero of the formula, as in depth_z_mm = -2";
    match (job.machine.general.kinematics, &keys.x, &keys.y, &keys.z) {
        (Kinematics::Mill, Some(Range(range)), Some(Formula(formula)), None) => {
            let Some(depth) = keys.depth_z_mm else { return refuse("", "depth_z_mm is missing", depth_help) };
            let depth = Some(within("depth_z_mm", depth, [-1e4, 1e4], "mm")?);
            Ok(Plane { axes: [Axis::X, Axis::Y], names: ["x", "y"], range: range.0, formula, depth })
        }
        (Kinematics::Lathe, Some(Formula(formula)), None, Some(Range(range))) => {
            if keys.depth_z_mm.is_some() {
                return refuse("depth_z_mm", "a contour on a lathe has no depth_z_mm", "leave it out");
            }
            Ok(Plane { axes: [Axis::Z, Axis::X], names: ["z", "x"], range: range.0, formula, depth: None })
        }
        (Kinematics::Mill, ..) => refuse(
            "",
            "on a mill y is a formula of x, and x goes from start to end",
            "write for example y = \"20*sin(x/15)\" and x = [0, 100]",
        ),
        (Kinematics::Lathe, ..) => refuse(
            "",
            "on a lathe x, a radius, is a formula of z, and z goes from start to end",
            "write for example x = \"20 - z^2/200\" and z = [0, -40]",
        ),
        _ => refuse("kind", "a contour needs a mill or a lathe", "choose the machine file of one"),
    }
}

/// What was seen on the way, mm.
struct Walked {
    start: [f64; 2],
    end: [f64; 2],
    bounds: [[f64; 2]; 2],
    way: f64,
    pace: Pace<2>,
}

/// Goes along the contour in the pieces in which the interpolator will.
fn walk(contour: &Contour, f: &Formula, plane: &Plane, job: &Job) -> Result<Walked, Fault> {
    let [name, value] = plane.names;
    let curve = contour.curve(f);
    let mut walker = Walker::new(contour.t());
    let start = curve.at(contour.x[0]).axes.map(|axis| axis.value());
    let (mut looks, apart) = (0.0, APART * (contour.x[1] - contour.x[0]).abs());
    let mut walked = Walked {
        start,
        end: start,
        bounds: [start, start],
        way: 0.0,
        pace: Pace::new(job.machine, plane.axes),
    };
    loop {
        let next = walker.next(&curve).map_err(|error| {
            let at = error.t();
            let message = format!("{value} cannot be followed at {name} = {at:.4}: its slope is infinite there, or it bends too sharply");
            Fault::new(value, message, format!("choose {name} so that {value} is smooth all over it"))
        })?;
        let Some(span) = next else { return Ok(walked) };
        let [low, high] = span.path.bounds();
        for axis in 0..2 {
            walked.bounds[0][axis] = walked.bounds[0][axis].min(span.from[axis] + low[axis]);
            walked.bounds[1][axis] = walked.bounds[1][axis].max(span.from[axis] + high[axis]);
        }
        walked.pace.goes_along(&span.path);
        (walked.end, walked.way) = (span.to, walked.way + span.path.length());
        let places = (span.path.length() / apart).ceil().max(1.0);
        looks += places;
        if looks > LOOKS {
            let message = format!("{value} is too long to be looked at: more than {LOOKS} places");
            return Err(Fault::new(value, message, format!("choose {name} shorter, or write several jobs")));
        }
        for n in 0..places as usize {
            let s = span.path.length() * (n as f64 + BESIDE) / places;
            let (t, [gone, ..]) = (span.parameter(s), span.path.at(s));
            if !is_near(span.from, gone, curve.at(t).axes.map(|axis| axis.value())) {
                let message = format!("finer detail than the pieces of the path follow, at {name} = {t:.4}");
                let help = "leave it out: what is narrower than 0.1 mm is beyond any tool";
                return Err(Fault::new(value, message, help));
            }
        }
    }
}

/// How many gaps there are between the places that are looked at.
fn gaps(contour: &Contour) -> usize {
    let [from, to] = contour.x;
    let wanted =
        if contour.radius_mm > 0.0 { ALONG_RADIUS * (to - from).abs() / contour.radius_mm } else { 0.0 };
    wanted.ceil().clamp(LEAST, MOST) as usize
}

/// Places along the contour.
fn places(contour: &Contour) -> impl Iterator<Item = f64> + use<> {
    let ([from, to], gaps) = (contour.x, gaps(contour));
    (0..=gaps).map(move |n| from + (to - from) * n as f64 / gaps as f64)
}

/// Refuses a tool that is larger than the contour is hollow.
fn fits(contour: &Contour, f: &Formula, name: &str) -> Result<(), Fault> {
    let above = contour.above_mm();
    let bent = |x: f64| {
        let touch = Touch::at(f, [x, 0.0]);
        let square = 1.0 + touch.slope[0] * touch.slope[0];
        touch.second[0] / (square * square.sqrt())
    };
    let worst = places(contour).map(|x| (x, above * bent(x))).max_by(|a, b| a.1.total_cmp(&b.1));
    match worst {
        Some((x, share)) if share >= 1.0 => {
            let hollow = contour.radius_mm / share;
            let message = format!(
                "the tool is too large for the contour at {name} = {x:.4}, which is hollow with a radius of {hollow:.3} mm there"
            );
            let help = format!("take a diameter below {:.3} mm", 2.0 * hollow);
            Err(Fault::new("tool.diameter_mm", message, help))
        }
        _ => Ok(()),
    }
}

/// Refuses a tool that also touches the contour elsewhere.
fn touches_nothing_else(contour: &Contour, f: &Formula, name: &str) -> Result<(), Fault> {
    let curve = contour.curve(f);
    let points: Vec<[f64; 2]> = places(contour).map(|x| [x, height(f, x)]).collect();
    let radius = contour.radius_mm;
    let near = (radius / (contour.x[1] - contour.x[0]).abs() * gaps(contour) as f64).ceil() as usize;
    for (n, [x, _]) in points.iter().enumerate() {
        let [cx, cy] = curve.at(*x).axes.map(|axis| axis.value());
        // The centre is at most a radius beside the contact, what it touches another one.
        let around = n.saturating_sub(2 * near)..(n + 2 * near + 1).min(points.len());
        for [px, py] in points.get(around).unwrap_or_default() {
            let (dx, dy) = (px - cx, py - cy);
            if dx * dx + dy * dy > radius * radius {
                continue;
            }
            let depth = radius - libm::hypot(dx, dy);
            if depth > TOUCHES_MM {
                let message = format!(
                    "the tool that touches the contour at {name} = {x:.4} cuts into it at {name} = {px:.4}, {depth:.4} mm deep"
                );
                let help = format!("take a smaller tool, or choose {name} without that place");
                return Err(Fault::new("tool.diameter_mm", message, help));
            }
        }
    }
    Ok(())
}

fn height(f: &Formula, x: f64) -> f64 {
    let Gradient { value, .. } = f.eval(Gradient::variables(x, 0.0));
    value
}
