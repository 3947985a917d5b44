//! A surface as a job. In: its keys. Out: formulas, the pattern of the paths, one trace; or where the tool
//! cannot go.

use std::fmt::{Display, Formatter};

use protocol::{Axis, Feed, Shape};
use serde::Deserialize;
use shape::{Formula, Pattern, Surface, Tool};

use super::grid::{Grid, Lay, Left};
use super::row::Row;
use super::walk::{Walk, walk};
use super::{CLEARANCE, Fault, Job, Move, Planned, domain, formula, parameter, within};

/// Most paths of a pattern.
const MOST_PATHS: f64 = 100_000.0;

/// What is said where neighbouring paths leave more than ridges.
const NO_OVERLAP: &str = "paths do not overlap, material is left between them";

/// Keys of a surface.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Keys {
    /// Z = ψ(x, y), mm.
    z: String,
    /// Lowest and highest X, mm.
    x: Row<f64, 2>,
    /// Lowest and highest Y, mm.
    y: Row<f64, 2>,
    tool: ToolKeys,
    path: Path,
    /// Height above the highest place of the surface at which the tool moves freely, mm.
    #[serde(default = "clearance")]
    clearance_mm: f64,
}

fn clearance() -> f64 {
    5.0
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ToolKeys {
    kind: ToolKind,
    diameter_mm: f64,
    corner_mm: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum ToolKind {
    Flat,
    Ball,
    Bull,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "pattern", rename_all = "lowercase", deny_unknown_fields)]
enum Path {
    Lines {
        #[serde(default)]
        along: Along,
        step_mm: Option<f64>,
        scallop_mm: Option<f64>,
        #[serde(default)]
        one_way: bool,
    },
    Rings {
        step_mm: Option<f64>,
        scallop_mm: Option<f64>,
    },
    Curve {
        x: String,
        y: String,
        t: Row<f64, 2>,
    },
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Along {
    #[default]
    X,
    Y,
}

/// Plans a surface.
///
/// # Errors
/// What is wrong with a key, or with a place of the surface.
pub(super) fn plan(keys: Keys, job: &Job) -> Result<Planned, Fault> {
    let psi = formula("z", &keys.z, &["x", "y"])?;
    let (x, y) = (domain("x", keys.x.0)?, domain("y", keys.y.0)?);
    let clearance = within("clearance_mm", keys.clearance_mm, [0.01, 1e4], "mm")?;
    let none = Pattern::Curve { t: [0.0, 1.0] };
    let mut surface = Surface { x, y, tool: tool(&keys.tool)?, pattern: none, clear_mm: 0.0 };
    let grid = Grid::new(&surface, &psi)?;
    grid.fits()?;
    let (pattern, curve, mut facts) = paths(&keys.path, &surface, &grid)?;
    surface.pattern = pattern;

    let formulas = match curve {
        None => vec![psi],
        Some([x, y]) => vec![psi, x, y],
    };
    let zero = Formula::default();
    let walk = walk(&surface, [0, 1, 2].map(|slot: usize| formulas.get(slot).unwrap_or(&zero)), job)?;
    grid.touches_nothing_else(&walk.tips)?;
    // What is narrower than the grid is seen where a path goes over it.
    let [_, [.., highest]] = walk.bounds;
    surface.clear_mm = grid.top().max(highest) + clearance;
    facts.insert(0, ("surface", format!("z = {}", keys.z)));
    facts.insert(1, ("tool", keys.tool.to_string()));
    facts.push(("looked at", grid.net()));
    facts.push(("way", format!("{:.1} mm on the surface, {} retracts", walk.cut_mm, walk.retracts)));
    moves(job, &surface, &walk, formulas, facts)
}

/// The cutting end of a tool.
fn tool(keys: &ToolKeys) -> Result<Tool, Fault> {
    let radius_mm = 0.5 * within("tool.diameter_mm", keys.diameter_mm, [0.01, 1000.0], "mm")?;
    let corner_mm = match (keys.kind, keys.corner_mm) {
        (ToolKind::Flat, None) => 0.0,
        (ToolKind::Ball, None) => radius_mm,
        (ToolKind::Bull, Some(corner)) if corner > 0.0 && corner < radius_mm => corner,
        (ToolKind::Bull, Some(corner)) => {
            let message =
                format!("tool.corner_mm = {corner} is not between 0 and the radius, {radius_mm} mm");
            return Err(Fault::new(
                "tool.corner_mm",
                message,
                "a corner of 0 is kind = \"flat\", of the radius a \"ball\"",
            ));
        }
        (ToolKind::Bull, None) => {
            return Err(Fault::new(
                "tool",
                "tool.corner_mm is missing",
                "give the radius of the corner of the bull nose",
            ));
        }
        (_, Some(_)) => {
            return Err(Fault::new("tool.corner_mm", "only a bull nose has tool.corner_mm", "leave it out"));
        }
    };
    Ok(Tool { radius_mm, corner_mm })
}

/// What a path says of itself to people.
type Facts = Vec<(&'static str, String)>;

/// The pattern of the paths, and the formulas of a curve.
fn paths(
    path: &Path,
    surface: &Surface,
    grid: &Grid,
) -> Result<(Pattern, Option<[Formula; 2]>, Facts), Fault> {
    let [wide, high] = [surface.x, surface.y].map(|[low, high]| high - low);
    match path {
        Path::Lines { along, step_mm, scallop_mm, one_way } => {
            let (across, direction) =
                if *along == Along::Y { (wide, [0.0, 1.0]) } else { (high, [1.0, 0.0]) };
            let lay = Lay::Along(direction);
            let step = step(*step_mm, *scallop_mm, lay, surface, grid)?;
            let gaps = gaps(across, step)?;
            let pattern = Pattern::Lines { along_y: *along == Along::Y, count: gaps + 1, zigzag: !one_way };
            let kind = if *one_way { "one way" } else { "zigzag" };
            let name = if *along == Along::Y { "Y" } else { "X" };
            let first = ("path", format!("{} lines along {name}, {kind}", gaps + 1));
            Ok((pattern, None, vec![first, spacing(across / f64::from(gaps), lay, grid)]))
        }
        Path::Rings { step_mm, scallop_mm } => {
            let half = 0.5 * wide.min(high);
            let step = step(*step_mm, *scallop_mm, Lay::Rings, surface, grid)?;
            let count = gaps(half, step)?;
            let first = ("path", format!("{count} rings from the border inwards"));
            let facts = vec![first, spacing(half / f64::from(count), Lay::Rings, grid)];
            Ok((Pattern::Rings { count }, None, facts))
        }
        Path::Curve { x, y, t } => {
            let formulas = [formula("path.x", x, &["t"])?, formula("path.y", y, &["t"])?];
            let t = parameter("path.t", t.0)?;
            let first = ("path", format!("x = {x}, y = {y}, t = {} to {}", t[0], t[1]));
            Ok((Pattern::Curve { t }, Some(formulas), vec![first]))
        }
    }
}

/// Distance of neighbouring paths seen from above, mm: as given, or from the height of the ridges.
fn step(
    step_mm: Option<f64>,
    scallop_mm: Option<f64>,
    lay: Lay,
    surface: &Surface,
    grid: &Grid,
) -> Result<f64, Fault> {
    match (step_mm, scallop_mm) {
        (Some(step), None) => within("path.step_mm", step, [1e-4, 1e4], "mm"),
        (None, Some(height)) => {
            let most = 0.5
                * if surface.tool.corner_mm > 0.0 { surface.tool.corner_mm } else { surface.tool.radius_mm };
            Ok(grid.step(within("path.scallop_mm", height, [1e-6, most], "mm")?, lay))
        }
        (None, None) => {
            let help = "give scallop_mm, the height of the ridges that may be left, or step_mm";
            Err(Fault::new("path", "the distance of the paths is missing", help))
        }
        (Some(_), Some(_)) => {
            let message = "path.step_mm and path.scallop_mm both say how far apart the paths lie";
            Err(Fault::new("path.step_mm", message, "leave one of them out"))
        }
    }
}

/// Gaps of at most `step` that fill a way.
fn gaps(way: f64, step: f64) -> Result<u32, Fault> {
    let gaps = (way / step - 1e-9).ceil().max(1.0);
    if gaps <= MOST_PATHS {
        return Ok(gaps as u32);
    }
    let message = format!("that would be {gaps:.0} paths, and {MOST_PATHS} are allowed");
    Err(Fault::new(
        "path",
        message,
        "give a larger step_mm, or a larger scallop_mm (with a flat end step_mm alone)",
    ))
}

/// How far apart the paths are, and what they leave between them.
fn spacing(step: f64, lay: Lay, grid: &Grid) -> (&'static str, String) {
    let left = match grid.left(step, lay) {
        Left::Ridges(height) => format!("ridges of at most {:.2} µm", 1000.0 * height),
        Left::Steps => "steps where it is steep".into(),
        Left::Material => NO_OVERLAP.into(),
    };
    ("spacing", format!("{step:.4} mm seen from above, {left}"))
}

/// Moves before and behind the work, all of it within the travel.
fn moves(
    job: &Job,
    surface: &Surface,
    walk: &Walk,
    formulas: Vec<Formula>,
    facts: Facts,
) -> Result<Planned, Fault> {
    let axes = [Axis::X, Axis::Y, Axis::Z];
    job.reaches(axes, walk.bounds, ["x", "y", "z"])?;
    job.reaches([Axis::Z], [[walk.bounds[0][2]], [surface.clear_mm]], [CLEARANCE])?;
    let (start, end) = (job.at(axes, walk.start), job.at(axes, walk.end));
    let clear = job.at(axes, [0.0, 0.0, surface.clear_mm])[Axis::Z.index()];
    let approach = job.approach(Axis::Z, clear, 1.0, &start);
    let mut up = end;
    up[Axis::Z.index()] = clear;
    let retract = vec![Move { to: up, feed: Feed::Rapid }];
    let traces = vec![job.trace(Shape::Surface(*surface))];
    let apart = facts.iter().any(|(_, text)| text.ends_with(NO_OVERLAP));
    let help = "give scallop_mm, or a smaller step_mm";
    let apart = apart.then(|| Fault::new("path", NO_OVERLAP, help));
    let warnings = apart.into_iter().chain(walk.pace.warning(job)).collect();
    Ok(Planned { approach, formulas, traces, end, retract, warnings, facts })
}

impl Display for ToolKeys {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match (self.kind, self.corner_mm) {
            (ToolKind::Flat, _) => write!(f, "flat end of {} mm", self.diameter_mm),
            (ToolKind::Ball, _) => write!(f, "ball of {} mm", self.diameter_mm),
            (ToolKind::Bull, corner) => {
                write!(f, "bull nose of {} mm, corner {} mm", self.diameter_mm, corner.unwrap_or_default())
            }
        }
    }
}
