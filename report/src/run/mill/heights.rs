//! Heights of the part that the tools leave. In: the way of the tools, mm. Out: for each cell of a grid the
//! height of its middle, the tool that cut it, and the deviation there.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | R, c | mm | radius of the tool, and of its corner: 0 of a flat end mill, R of a ball |
//! | ρ | mm | distance of a place from the axis of the tool |
//! | h | mm | how far the tool is above its tip at ρ |
//! | z | mm | its tip |
//! | H | mm | height of the part: H₀ of the stock |
//! | s | mm | step along the way |
//! | L, q | mm, mm | length of the way, side of a cell |
//!
//! (M165) h = 0 for ρ ≤ R − c; c − √(c² − (ρ − R + c)²) for R − c < ρ ≤ R
//! (M166) H = min(H₀, min over the way of z + h(ρ) where ρ ≤ R)
//! (M167) s = max(q/2, π R² L / q² / N): N cells are lowered at most, however long the way and wide the tool
//! (M168) nobody says what the stock is: X and Y of all feeds ± R, of surfaces without R; from the lowest
//! feed up to the highest at which the tool is fed sideways. Else it is a block

use std::collections::BTreeMap;

use rig::observe::Summary;

use super::job::JobTool;
use super::way::{Point, Way};

/// Cells of the longer and of the shorter side, at most.
const CELLS: [f64; 2] = [200.0, 150.0];
/// N of (M167).
const MOST: f64 = 3e8;
/// What is taken for the diameter of a tool that nobody describes, mm.
pub(super) const ASSUMED_MM: f64 = 6.0;
/// Below the lowest cut this share of the depth is shown as material.
const FLOOR: f64 = 0.25;
/// The tool goes sideways, not down, where it goes farther than this share of its way.
const SIDEWAYS: f64 = 0.5;

/// A tool that cut.
#[derive(Clone, Debug)]
pub(super) struct Cutter {
    pub(super) number: u32,
    pub(super) name: String,
    pub(super) radius_mm: f64,
    /// Whether anybody said how wide it is.
    pub(super) known: bool,
    /// Of a flat end mill nothing, of a ball its radius.
    pub(super) corner_mm: f64,
}

impl Cutter {
    /// How far the tool is above its tip at a distance from its axis (M165).
    pub(super) fn rise_mm(&self, rho: f64) -> Option<f64> {
        let (r, c) = (self.radius_mm, self.corner_mm);
        let beyond = (rho - r + c).max(0.0);
        (rho <= r).then(|| c - (c * c - beyond * beyond).max(0.0).sqrt())
    }
}

/// The part as heights over a grid.
pub(super) struct Heights {
    pub(super) from_mm: [f64; 2],
    pub(super) cell_mm: f64,
    pub(super) size: [usize; 2],
    pub(super) top_mm: f64,
    pub(super) floor_mm: f64,
    /// Row by row, Y rising.
    pub(super) z_mm: Vec<f64>,
    /// Which of the cutters cut it last, from 1; 0 where the stock stands.
    pub(super) cut_by: Vec<u8>,
    pub(super) deviation_um: Vec<Option<f64>>,
    pub(super) cutters: Vec<Cutter>,
    /// What X and Y of the stock are (M168); nothing if the program says what it is.
    pub(super) beside: Option<&'static str>,
}

/// The tools of a way, in the order of their numbers.
fn cutters(summary: &Summary, points: &[Point], job: Option<JobTool>) -> Vec<Cutter> {
    let mut used: BTreeMap<u32, ()> = BTreeMap::new();
    points.iter().filter(|point| point.fed).for_each(|point| {
        used.insert(point.tool, ());
    });
    // A job says the tool that it cuts with: of several tools nobody knows which.
    let job = job.filter(|_| used.len() == 1);
    let cutter = |number: u32| {
        let note = summary.tools.get(&number);
        let noted = note.and_then(rig::observe::ToolNote::drill_mm);
        let diameter = job.map(|tool| tool.diameter_mm).or(noted);
        let name = note.map(|note| note.name.clone()).unwrap_or_default();
        let radius_mm = 0.5 * diameter.unwrap_or(ASSUMED_MM);
        let named = if name.to_lowercase().contains("ball") { radius_mm } else { 0.0 };
        let corner_mm = job.map_or(named, |tool| tool.corner_mm);
        Cutter { number, name, radius_mm, known: diameter.is_some(), corner_mm }
    };
    used.into_keys().map(cutter).collect()
}

/// Lowest and highest corner of the stock that nobody described (M168).
fn stock(way: &Way, cutters: &[Cutter]) -> Option<[[f64; 3]; 2]> {
    let points = &way.points;
    let radius = |tool: u32| {
        let cutter = cutters.iter().find(|cutter| cutter.number == tool && !way.surfaces());
        cutter.map_or(0.0, |cutter| cutter.radius_mm)
    };
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let mut sideways = false;
    for two in points.windows(2).filter(|two| two[1].fed) {
        let (from, to, r) = (two[0].at, two[1].at, radius(two[1].tool));
        let way = [0, 1, 2].map(|i| to[i] - from[i]);
        low[2] = low[2].min(to[2]);
        if libm::hypot(way[0], way[1]) > SIDEWAYS * way[2].abs() {
            sideways = true;
            high[2] = high[2].max(to[2]);
            for i in 0..2 {
                low[i] = low[i].min(from[i].min(to[i]) - r);
                high[i] = high[i].max(from[i].max(to[i]) + r);
            }
        }
    }
    sideways.then_some([low, high])
}

impl Heights {
    /// What the way leaves; `None` if nothing was fed sideways.
    pub(super) fn of(summary: &Summary, way: &Way, job: Option<JobTool>) -> Option<Heights> {
        let points = &way.points;
        let cutters = cutters(summary, points, job);
        let block = summary.stock.as_ref().and_then(|stock| stock.block_mm);
        let fed = || points.iter().any(|point| point.fed);
        let [low, high] = block.filter(|_| fed()).or_else(|| stock(way, &cutters))?;
        let sides = [high[0] - low[0], high[1] - low[1]];
        let (long, short) = (sides[0].max(sides[1]), sides[0].min(sides[1]));
        let cell_mm = (long / CELLS[0]).max(short / CELLS[1]).max(1e-3);
        let size = sides.map(|side| (side / cell_mm).ceil() as usize + 1);
        let cells = size[0] * size[1];
        let depth = (high[2] - low[2]).max(0.05 * long);
        let mut heights = Heights {
            from_mm: [low[0], low[1]],
            cell_mm,
            size,
            top_mm: high[2],
            floor_mm: if block.is_some() { low[2] } else { low[2] - FLOOR * depth },
            z_mm: vec![high[2]; cells],
            cut_by: vec![0; cells],
            deviation_um: vec![None; cells],
            cutters,
            beside: block.is_none().then_some(if way.surfaces() {
                "the tip where it cuts the surfaces"
            } else {
                "all feeds with the radius of the tool"
            }),
        };
        heights.sweep(points);
        Some(heights)
    }

    /// Takes off what the tools go through, with steps as (M167) has them.
    fn sweep(&mut self, points: &[Point]) {
        let length: f64 = points.windows(2).map(|two| distance(two[0].at, two[1].at)).sum();
        let widest = self.cutters.iter().map(|cutter| cutter.radius_mm).fold(0.0, f64::max);
        let covered = core::f64::consts::PI * (widest / self.cell_mm) * (widest / self.cell_mm);
        let step = (0.5 * self.cell_mm).max(covered * length / MOST);
        let mut since = step;
        for two in points.windows(2).filter(|two| two[0].tool == two[1].tool) {
            let place = self.cutters.iter().position(|cutter| cutter.number == two[1].tool);
            let Some(place) = place else { continue };
            let cutter = self.cutters[place].clone();
            let way = distance(two[0].at, two[1].at);
            let mut gone = (step - since).max(0.0);
            while gone <= way {
                let share = if way > 0.0 { gone / way } else { 1.0 };
                let at = [0, 1, 2].map(|i| two[0].at[i] + share * (two[1].at[i] - two[0].at[i]));
                self.lower(&cutter, place, at);
                gone += step;
            }
            since = way - (gone - step);
            if let Some(um) = two[1].deviation_um {
                self.note(two[1].at, um);
            }
        }
    }

    /// The cells under the tool at a place (M166).
    fn lower(&mut self, cutter: &Cutter, place: usize, [x, y, z]: [f64; 3]) {
        if z >= self.top_mm {
            return;
        }
        let reach = |i: usize, middle: f64| {
            let cell = |mm: f64| (mm - self.from_mm[i]) / self.cell_mm;
            let (from, to) =
                (cell(middle - cutter.radius_mm).ceil(), cell(middle + cutter.radius_mm).floor());
            (from.max(0.0) as usize, to.min((self.size[i] - 1) as f64))
        };
        let (columns, rows) = (reach(0, x), reach(1, y));
        if columns.1 < 0.0 || rows.1 < 0.0 {
            return;
        }
        for row in rows.0..=rows.1 as usize {
            let dy = self.from_mm[1] + row as f64 * self.cell_mm - y;
            for column in columns.0..=columns.1 as usize {
                let dx = self.from_mm[0] + column as f64 * self.cell_mm - x;
                let Some(rise) = cutter.rise_mm(libm::sqrt(dx * dx + dy * dy)) else { continue };
                let cell = row * self.size[0] + column;
                if z + rise < self.z_mm[cell] {
                    self.z_mm[cell] = z + rise;
                    self.cut_by[cell] = (place + 1).min(255) as u8;
                }
            }
        }
    }

    /// The deviation where the tip is: the largest of its cell.
    fn note(&mut self, at: [f64; 3], um: f64) {
        let [column, row] = [0, 1].map(|i| ((at[i] - self.from_mm[i]) / self.cell_mm).round());
        if column < 0.0 || row < 0.0 || column as usize >= self.size[0] || row as usize >= self.size[1] {
            return;
        }
        let cell = &mut self.deviation_um[row as usize * self.size[0] + column as usize];
        *cell = Some(cell.filter(|before| before.abs() > um.abs()).unwrap_or(um));
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    libm::sqrt((0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum())
}
