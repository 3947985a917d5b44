//! A surface looked at on a grid over its domain. In: formula, domain, tool, mm. Out: where it does not
//! exist, where the tool does not fit, how far apart its paths may lie, and what else of it a tool would
//! touch.
//!
//! What is finer than the grid is not seen. Its nodes are an eighth of the radius of the tool apart, or
//! nearer.

use shape::{Formula, Parting, Surface, Tool, Touch};

use super::Fault;

/// Least cells along a side.
const LEAST: f64 = 200.0;
/// Cells along the radius of the tool,
const ALONG_RADIUS: f64 = 8.0;
/// unless there would be more than these along both sides.
const MOST: f64 = 1e6;
/// Steepest slope.
const STEEPEST: f64 = 1e6;
/// A tool may stand so deep in the surface, mm: rounding, far below the chord error.
const TOUCHES_MM: f64 = 1e-6;
/// Of the distance at which the tool just comes to all places, most that the height of ridges asks for.
const OVERLAP: f64 = 0.95;
/// Places that are compared with the end of the tool, most.
const LOOKS: usize = 40_000_000;

/// How neighbouring paths lie to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lay {
    /// Parallel, in this direction seen from above.
    Along([f64; 2]),
    /// Ring in ring, along X and Y.
    Rings,
}

impl Lay {
    /// Directions of the paths.
    fn directions(&self) -> Vec<[f64; 2]> {
        match *self {
            Lay::Along(direction) => vec![direction],
            Lay::Rings => vec![[1.0, 0.0], [0.0, 1.0]],
        }
    }
}

/// What is left between neighbouring paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Left {
    /// Ridges of at most this height, mm.
    Ridges(f64),
    /// Steps: somewhere the paths lie farther apart than the corner of the tool is round.
    Steps,
    /// Material: somewhere the tool does not come at all.
    Material,
}

/// Heights of a surface and its curvatures at the nodes of a grid.
pub(super) struct Grid {
    surface: Surface,
    /// Cells along X and Y.
    cells: [usize; 2],
    nodes: Vec<Touch>,
}

impl Grid {
    /// Looks at all of a surface.
    ///
    /// # Errors
    /// A place where it, a slope or a curvature does not exist.
    pub(super) fn new(surface: &Surface, formula: &Formula) -> Result<Grid, Fault> {
        let cells = cells(surface);
        let mut grid = Grid { surface: *surface, cells, nodes: Vec::new() };
        grid.nodes.reserve_exact((cells[0] + 1) * (cells[1] + 1));
        for row in 0..=cells[1] {
            grid.nodes.extend(
                (0..=cells[0]).map(|column| Touch::at(formula, place(surface, cells, [column, row]))),
            );
        }
        let upright = |touch: &Touch| touch.slope.iter().any(|one| one.abs() > STEEPEST);
        if let Some(n) = grid.nodes.iter().position(|touch| touch.is_finite() && upright(touch)) {
            let [x, y] = grid.at(n);
            let message = format!("the surface is as good as upright at {}", here(x, y));
            return Err(Fault::new("z", message, "choose x and y without that place"));
        }
        match grid.nodes.iter().position(|touch| !touch.is_finite()).map(|n| grid.at(n)) {
            None => Ok(grid),
            Some([x, y]) => Err(Fault::new(
                "z",
                format!("the surface, its slope or its curvature does not exist at {}", here(x, y)),
                "choose x and y so that the formula is smooth all over them",
            )),
        }
    }

    /// Where a node is, mm.
    fn at(&self, n: usize) -> [f64; 2] {
        let columns = self.cells[0] + 1;
        place(&self.surface, self.cells, [n % columns, n / columns])
    }

    /// What was looked at, in words.
    pub(super) fn net(&self) -> String {
        let [x, y] = [self.surface.x, self.surface.y].map(|[low, high]| high - low);
        let [columns, rows] = self.cells;
        let (wide, high) = (x / columns as f64, y / rows as f64);
        format!("{} x {} places, {wide:.3} mm x {high:.3} mm apart", columns + 1, rows + 1)
    }

    /// Z of its highest node, mm.
    pub(super) fn top(&self) -> f64 {
        self.nodes.iter().map(|touch| touch.z).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Refuses a tool that cuts into the surface beside the place where it touches (M89).
    pub(super) fn fits(&self) -> Result<(), Fault> {
        let tool = &self.surface.tool;
        let worst = self.nodes.iter().enumerate().filter(|(_, touch)| cuts(tool, touch));
        match worst.max_by(|(_, a), (_, b)| a.hollow().total_cmp(&b.hollow())) {
            Some((n, touch)) => Err(hollow(self.at(n), touch)),
            None => Ok(()),
        }
    }

    /// Largest distance of paths, seen from above, that leaves no ridge higher than `height_mm`, mm.
    pub(super) fn step(&self, height_mm: f64, lay: Lay) -> f64 {
        let steps = self.partings(lay).map(|(parting, spread)| parting.distance(height_mm) / spread);
        steps.filter(|step| step.is_finite()).fold(OVERLAP * self.widest(lay), f64::min)
    }

    /// What is left between paths at a distance, seen from above, mm.
    pub(super) fn left(&self, step_mm: f64, lay: Lay) -> Left {
        let is_apart = |(parting, spread): &(Parting, f64)| !parting.overlaps(step_mm * spread);
        let is_apart = self.partings(lay).any(|one| is_apart(&one));
        if step_mm >= self.widest(lay) || (is_apart && self.surface.tool.is_ball()) {
            return Left::Material;
        }
        if is_apart {
            return Left::Steps;
        }
        let heights = self.partings(lay).map(|(parting, spread)| parting.height(step_mm * spread));
        Left::Ridges(heights.filter(|height| height.is_finite()).fold(0.0, f64::max))
    }

    /// Distance of paths at which the tool just comes to all places between them, mm.
    fn widest(&self, lay: Lay) -> f64 {
        let level = Touch { z: 0.0, slope: [0.0; 2], second: [0.0; 3] };
        let spread = if lay == Lay::Rings { level.spread_in_corners([1.0, 0.0]) } else { 1.0 };
        2.0 * self.surface.tool.radius_mm / spread
    }

    /// How fast the tool and the surface part at all nodes, and the distance on the surface of paths 1 mm
    /// apart.
    fn partings(&self, lay: Lay) -> impl Iterator<Item = (Parting, f64)> {
        let tool = &self.surface.tool;
        lay.directions().into_iter().flat_map(move |along| {
            self.nodes.iter().map(move |touch| {
                let spread =
                    if lay == Lay::Rings { touch.spread_in_corners(along) } else { touch.spread(along) };
                (touch.parting(tool, along), spread)
            })
        })
    }

    /// Refuses a tool that also touches the surface elsewhere. `tips`: where it stands, by the point of
    /// contact.
    pub(super) fn touches_nothing_else(&self, tips: &[([f64; 2], [f64; 3])]) -> Result<(), Fault> {
        let tool = &self.surface.tool;
        let [columns, rows] = [(self.surface.x, self.cells[0]), (self.surface.y, self.cells[1])]
            .map(|(side, cells)| Nodes::new(side, cells, tool.radius_mm));
        let stride = (tips.len() * columns.most * rows.most).div_ceil(LOOKS).max(1);
        for (contact, tip) in tips.iter().step_by(stride) {
            for row in rows.near(tip[1]) {
                for column in columns.near(tip[0]) {
                    let Some(touch) = self.nodes.get(row * (self.cells[0] + 1) + column) else { continue };
                    let at = place(&self.surface, self.cells, [column, row]);
                    let depth = depth(tool, tip, &at, touch.z);
                    if depth > TOUCHES_MM {
                        return Err(elsewhere(contact, &at, depth));
                    }
                }
            }
        }
        Ok(())
    }
}

/// Cells along X and Y: enough for the tool, or as many as there may be.
fn cells(surface: &Surface) -> [usize; 2] {
    let wanted = [surface.x, surface.y]
        .map(|[low, high]| (ALONG_RADIUS * (high - low) / surface.tool.radius_mm).ceil().max(LEAST));
    let less = (MOST / (wanted[0] * wanted[1])).sqrt().min(1.0);
    wanted.map(|cells| (cells * less).clamp(LEAST, MOST / LEAST) as usize)
}

/// Where the node in a column and a row is, mm.
fn place(surface: &Surface, cells: [usize; 2], node: [usize; 2]) -> [f64; 2] {
    let share = |side: usize, [low, high]: [f64; 2]| {
        let share = node[side] as f64 / cells[side] as f64;
        low * (1.0 - share) + high * share
    };
    [share(0, surface.x), share(1, surface.y)]
}

/// Nodes along a side, and how many of them are near a place.
struct Nodes {
    low: f64,
    cell: f64,
    cells: usize,
    reach: f64,
    most: usize,
}

impl Nodes {
    fn new([low, high]: [f64; 2], cells: usize, reach: f64) -> Nodes {
        let cell = (high - low) / cells as f64;
        Nodes { low, cell, cells, reach, most: ((2.0 * reach / cell) as usize).min(cells) + 1 }
    }

    fn near(&self, at: f64) -> std::ops::Range<usize> {
        let node = |at: f64| ((at - self.low) / self.cell).clamp(0.0, self.cells as f64);
        node(at - self.reach).ceil() as usize..node(at + self.reach).floor() as usize + 1
    }
}

/// Whether a tool cuts into the surface beside the place where it touches (M89).
pub(super) fn cuts(tool: &Tool, touch: &Touch) -> bool {
    let touches_beside_its_tip = tool.is_ball() || touch.level() > 0.0;
    touch.is_finite() && touches_beside_its_tip && touch.parting(tool, [1.0, 0.0]).gouges()
}

/// What is said where it does.
pub(super) fn hollow([x, y]: [f64; 2], touch: &Touch) -> Fault {
    let hollow = 1.0 / touch.hollow();
    let message = format!(
        "the tool cuts into the surface beside the place where it touches it, at {}: the surface is hollow there with a \
         radius of {hollow:.3} mm",
        here(x, y)
    );
    let help = format!(
        "take a ball with a diameter below {:.3} mm, or choose x and y without that place",
        2.0 * hollow
    );
    Fault::new("tool", message, help)
}

/// How deep a place lies in the end of a tool, mm.
fn depth(tool: &Tool, tip: &[f64; 3], at: &[f64; 2], z: f64) -> f64 {
    let beside = libm::hypot(at[0] - tip[0], at[1] - tip[1]);
    tool.height(beside).map_or(f64::NEG_INFINITY, |height| z - tip[2] - height)
}

fn elsewhere(contact: &[f64; 2], at: &[f64; 2], depth: f64) -> Fault {
    let message = format!(
        "the tool that touches the surface at {} cuts into it at {}, {depth:.4} mm deep",
        here(contact[0], contact[1]),
        here(at[0], at[1])
    );
    Fault::new("tool", message, "take a smaller tool, or choose x and y without that place")
}

/// A place in words.
pub(super) fn here(x: f64, y: f64) -> String {
    format!("x = {x:.4}, y = {y:.4}")
}
