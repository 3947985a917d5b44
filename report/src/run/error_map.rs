//! How far the finished groove is off its helix and off its depth, over the spindle angle and the turns of
//! the thread. In: rows of the passes that reach full depth, mm and degrees. Out: two maps, µm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | C | deg | true spindle angle since the index of a pass, growing in the direction of the pass |
//! | Cₖ | deg | an angle at which the groove is looked at: 5° k |
//! | a, b | mm | true places of the slides of Z and X |
//! | h(C), x(C) | mm | programmed helix; programmed law of X at full depth |
//! | h₀, F | mm | where the helix lies at C = 0, and its signed lead; h₀′ that of the first pass of the map |
//! | s | – | direction of X out of the material, ±1 |
//! | n | – | turn of the thread |
//!
//! ```text
//! (M163) e = a − h(C),  t = s (b − x(C)),  each at Cₖ by a straight line between two cycles (as M158)
//! (M164) n = ⌊(Cₖ + 360° round((h₀ − h₀′)/F))/360°⌋: one place, at whichever index a pass began
//! ```
//! Where several passes were at one place, the last of those that were programmed deepest there counts.

use std::collections::BTreeMap;

use base64::prelude::{BASE64_STANDARD, Engine as _};
use protocol::{Axis, AxisState};
use rig::observe::{PassReport, Summary};
use rig::trace::Row;
use serde_json::{Value, json};

use super::curves::shown_index;
use super::verdict::um;
use crate::colours::EITHER_WAY;
use crate::paint::{Figure, short, stacked};

/// Angles of a turn at which the groove is looked at.
const STATIONS: usize = 72;
const STATION_DEG: f64 = 360.0 / STATIONS as f64;
/// Rows that are drawn at most; of a longer thread each shows several turns.
const MOST_ROWS: usize = 28;
/// Passes and places count as equally deep within this, mm.
const DEPTH_TOLERANCE_MM: f64 = 0.001;
/// A pass whose Z is programmed farther from its helix than this, mm, is not cut along Z.
const OFF_Z_MM: f64 = 0.1;

/// The groove at one place.
#[derive(Clone, Copy, Debug)]
struct Cell {
    /// How deep the pass was programmed there, mm, growing into the material.
    depth_mm: f64,
    /// Off the helix and off the depth, µm.
    off_um: [f64; 2],
}

/// What a pass did in one cycle.
#[derive(Clone, Copy, Debug)]
struct Seen {
    cycle: u64,
    c_deg: f64,
    cell: Cell,
}

/// The map of one start of a thread.
pub(super) struct ErrorMap {
    /// Whether a pass belongs to it, and by how many turns its index is away from that of the first of them.
    turns: Vec<Option<i64>>,
    /// Starts of the thread.
    starts: usize,
    start: u32,
    cells: BTreeMap<i64, [Option<Cell>; STATIONS]>,
    before: Option<Seen>,
}

impl ErrorMap {
    /// An empty map of the deepest thread of a run.
    pub(super) fn new(summary: &Summary) -> ErrorMap {
        let passes = &summary.passes;
        let deepest = passes.get(shown_index(passes)).filter(|pass| pass.complete);
        let finishes = |pass: &PassReport| {
            deepest.is_some_and(|deepest| {
                pass.complete
                    && pass.depth_mm >= deepest.depth_mm - DEPTH_TOLERANCE_MM
                    && (pass.lead_mm, pass.direction, pass.tool_number)
                        == (deepest.lead_mm, deepest.direction, deepest.tool_number)
                    && outwards(pass) == outwards(deepest)
            })
        };
        let of_thread = passes.iter().filter(|pass| finishes(pass));
        let start = of_thread.clone().map(|pass| pass.start).min().unwrap_or(0);
        let first = of_thread.clone().find(|pass| pass.start == start);
        let turns_of = |pass: &PassReport| {
            let first = first.filter(|_| finishes(pass) && pass.start == start)?;
            Some(((pass.helix_at_index_mm - first.helix_at_index_mm) / pass.lead_mm).round() as i64)
        };
        let mut starts: Vec<u32> = of_thread.map(|pass| pass.start).collect();
        starts.sort_unstable();
        starts.dedup();
        ErrorMap {
            turns: passes.iter().map(turns_of).collect(),
            starts: starts.len(),
            start,
            cells: BTreeMap::new(),
            before: None,
        }
    }

    /// Takes the next row of a pass, at an angle since its index (M163).
    pub(super) fn add(&mut self, summary: &Summary, index: usize, c_deg: f64, row: &Row) {
        let Some(turns) = self.turns[index] else { return };
        let pass = &summary.passes[index];
        let seen = seen(summary, pass, c_deg, row);
        let before = std::mem::replace(&mut self.before, seen);
        let (Some(before), Some(now)) = (before, seen) else { return };
        if before.cycle + 1 != now.cycle {
            return;
        }
        let [a, b] = [before.c_deg, now.c_deg].map(|deg| deg / STATION_DEG);
        let (first, last) = (a.min(b).floor() as i64 + 1, a.max(b).floor() as i64);
        for k in (first..=last).take(STATIONS) {
            let share = (k as f64 - a) / (b - a);
            let between = |from: f64, to: f64| from + share * (to - from);
            let cell = Cell {
                depth_mm: between(before.cell.depth_mm, now.cell.depth_mm),
                off_um: [0, 1].map(|i| between(before.cell.off_um[i], now.cell.off_um[i])),
            };
            let turn = self.cells.entry(k.div_euclid(STATIONS as i64) + turns).or_insert([None; STATIONS]);
            let place = &mut turn[k.rem_euclid(STATIONS as i64) as usize];
            if place.is_none_or(|there| cell.depth_mm >= there.depth_mm - DEPTH_TOLERANCE_MM) {
                *place = Some(cell);
            }
        }
    }

    /// How many turns a row of the picture shows.
    fn turns_a_row(&self) -> usize {
        let turns = self.cells.keys().next_back().zip(self.cells.keys().next()).map_or(0, |(b, a)| b - a + 1);
        (turns as usize).div_ceil(MOST_ROWS).max(1)
    }

    /// The rows of one of the maps; of several turns in a row what is farthest off.
    fn rows(&self, of: usize) -> Vec<[Option<f64>; STATIONS]> {
        let Some(first) = self.cells.keys().next() else { return Vec::new() };
        let mut rows: Vec<[Option<f64>; STATIONS]> = Vec::new();
        for (turn, cells) in &self.cells {
            let at = (turn - first) as usize / self.turns_a_row();
            rows.resize(rows.len().max(at + 1), [None; STATIONS]);
            for (place, cell) in rows[at].iter_mut().zip(cells) {
                let off = cell.map(|cell| cell.off_um[of]);
                *place = [*place, off].into_iter().flatten().max_by(|a, b| a.abs().total_cmp(&b.abs()));
            }
        }
        rows
    }

    /// The picture; none if no pass reached its depth.
    pub(super) fn figure(&self) -> Option<Figure> {
        let maps = [self.rows(0), self.rows(1)];
        let [helix, depth] = [worst(&maps[0], 0.0), worst(&maps[1], 0.0)];
        let [along, across] = [mean(&maps[0]), mean(&maps[1])];
        let several = self.turns_a_row();
        let numbers = (0..maps[0].len()).map(|row| (row * several) as f64 + 0.5 * (several + 1) as f64);
        let turns: Vec<f64> = numbers.collect();
        let mut layout = stacked("spindle angle since the index (degrees)", "turn", "turn");
        for side in ["xaxis", "yaxis", "yaxis2"] {
            layout[side]["showgrid"] = json!(false);
        }
        layout["xaxis"]["dtick"] = json!(45);
        let said = if self.starts > 1 {
            format!(" Start {} of {} is shown.", self.start + 1, self.starts)
        } else {
            String::new()
        };
        let rows = if several > 1 {
            format!(" Each row shows {several} turns by what is farthest off.")
        } else {
            String::new()
        };
        (!turns.is_empty()).then(|| Figure {
            title: "Error of the finished groove over angle and turns".into(),
            caption: format!(
                "The slide in the passes at full depth, spring passes included; where there were several, the last of those \
                 that go deepest. Above: along Z off the programmed helix at the true spindle angle, at most {}. \
                 Below: in X off the programmed depth, positive where the groove is too shallow, at most {}. Turns \
                 are counted from where every axis is on its helix.{said}{rows} The colours are pale at the mean, {along:+.2} µm along Z \
                 and {across:+.2} µm in X, by which the whole groove is shifted. Good: pale all over, and the means small. A colour that changes \
                 from turn to turn is a wrong lead or a taper, stripes that stand upright are a drunken thread or a \
                 groove that is not round, a row of its own colour is a disturbance.",
                um(helix),
                um(depth)
            ),
            alt: format!(
                "Two maps of the finished groove over spindle angle and turns of the thread: off the helix at most {}, off \
                 its depth at most {}.",
                um(helix),
                um(depth)
            ),
            plot: json!({
                "data": [map(&maps[0], &turns, "along Z (µm)", "y"), map(&maps[1], &turns, "in X (µm)", "y2")],
                "layout": layout,
            }),
            aspect: 0.7,
        })
    }
}

/// The direction of X out of the material; of a pass without an approach that of work outside.
fn outwards(pass: &PassReport) -> f64 {
    if pass.delta_x_mm > 0.0 { -1.0 } else { 1.0 }
}

/// Where a pass is in a cycle, on its helix, at its depth, and in the stock if that is known.
fn seen(summary: &Summary, pass: &PassReport, c_deg: f64, row: &Row) -> Option<Seen> {
    let (x, z) = (row.axis(Axis::X)?, row.axis(Axis::Z)?);
    let helix_mm = pass.helix_mm(c_deg);
    let is_led = [x, z].iter().all(|axis| axis.state == AxisState::Locked);
    if !is_led || (z.programmed - helix_mm).abs() > OFF_Z_MM {
        return None;
    }
    if let (Some(stock), Some([_, zero])) = (&summary.stock, pass.origin_mm) {
        let [front, back] = [stock.rows_mm.last()?[0], stock.rows_mm.first()?[0]];
        if !(back..=front).contains(&(helix_mm - zero)) {
            return None;
        }
    }
    let s = outwards(pass);
    let off_um = [1e3 * (z.slide - helix_mm), 1e3 * s * (x.slide - x.programmed)];
    Some(Seen { cycle: row.cycle, c_deg, cell: Cell { depth_mm: -s * x.programmed, off_um } })
}

fn mean(rows: &[[Option<f64>; STATIONS]]) -> f64 {
    let numbers = rows.iter().flatten().flatten();
    numbers.clone().sum::<f64>() / numbers.count().max(1) as f64
}

/// How far anything is from a value.
fn worst(rows: &[[Option<f64>; STATIONS]], from_um: f64) -> f64 {
    rows.iter().flatten().flatten().fold(0.0, |worst, off| worst.max((off - from_um).abs()))
}

/// One map as a trace, packed as columns are; nothing is drawn where there is no number.
fn map(rows: &[[Option<f64>; STATIONS]], turns: &[f64], title: &str, y: &str) -> Value {
    let numbers = rows.iter().flatten().map(|off| off.map_or(f32::NAN, |off| off as f32));
    let bytes: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
    let z = json!({ "dtype": "f4", "bdata": BASE64_STANDARD.encode(bytes), "shape": format!("{},{STATIONS}", rows.len()) });
    let mean_um = mean(rows);
    let reach_um = worst(rows, mean_um).max(0.1);
    let middle = if y == "y" { 0.77 } else { 0.23 };
    json!({ "type": "heatmap", "x0": 0, "dx": STATION_DEG, "y": turns, "z": z, "zmin": short(mean_um - reach_um), "zmax": short(mean_um + reach_um),
            "colorscale": EITHER_WAY, "hoverongaps": false, "xaxis": "x", "yaxis": y,
            "hovertemplate": "turn %{y}, %{x}°: %{z:.2f} µm<extra></extra>",
            "colorbar": { "title": { "text": title, "side": "right" }, "thickness": 12, "len": 0.48, "y": middle } })
}

#[cfg(test)]
mod tests {
    use protocol::Motion;
    use rig::observe::{Led, Traced};
    use rig::trace::{AxisRow, CutRow};

    use super::*;

    const LEAD_MM: f64 = -2.0;
    const CYCLES: u64 = 1200;
    const CYCLE_DEG: f64 = 2.7;

    fn pass(number: u32, depth_mm: f64, turns: f64) -> PassReport {
        PassReport {
            pass: number,
            lead_mm: LEAD_MM,
            direction: 1.0,
            delta_x_mm: -1.0 - depth_mm,
            depth_mm,
            helix_at_index_mm: 4.0 + LEAD_MM * turns,
            complete: true,
            ..PassReport::default()
        }
    }

    /// The map of passes, each that far off its helix and its depth at an angle, µm.
    fn map_of(passes: &[PassReport], off_um: impl Fn(&PassReport, f64) -> [f64; 2]) -> ErrorMap {
        let summary = Summary { passes: passes.to_vec(), ..Summary::default() };
        let mut map = ErrorMap::new(&summary);
        for (index, pass) in passes.iter().enumerate() {
            for cycle in 0..CYCLES {
                let c = 300.0 + CYCLE_DEG * cycle as f64;
                let [e, shallow] = off_um(pass, c);
                let axis = |programmed: f64, off: f64| AxisRow {
                    programmed,
                    commanded: programmed,
                    measured: programmed,
                    true_mm: programmed,
                    velocity: 0.0,
                    acceleration: 0.0,
                    jerk: 0.0,
                    servo_error: 0.0,
                    torque: 0.0,
                    state: AxisState::Locked,
                    slide: programmed + 1e-3 * off,
                    force: 0.0,
                };
                let helix = pass.helix_at_index_mm + LEAD_MM * c / 360.0;
                let row = Row {
                    cycle: 10_000 * index as u64 + cycle,
                    t_s: 0.0,
                    spindle_true_deg: c,
                    spindle_counts: 0,
                    spindle_rpm: 900.0,
                    override_pct: 100.0,
                    axes: vec![(Axis::X, axis(10.0 - pass.depth_mm, shallow)), (Axis::Z, axis(helix, e))],
                    pass: pass.pass,
                    line: 1,
                    cut: CutRow::default(),
                    traced: Traced::default(),
                    led: Led { tool: 3, motion: Motion::None },
                };
                map.add(&summary, index, c, &row);
            }
        }
        map
    }

    fn all(map: &ErrorMap, of: usize) -> Vec<f64> {
        map.rows(of).iter().flatten().flatten().copied().collect()
    }

    #[test]
    fn a_perfect_pass_is_a_map_of_zeros() {
        let map = map_of(&[pass(1, 1.2, 0.0)], |_, _| [0.0, 0.0]);
        let turned = (300.0, 300.0 + CYCLE_DEG * (CYCLES - 1) as f64);
        let places = (turned.1 / STATION_DEG).floor() - (turned.0 / STATION_DEG).floor();
        for of in [0, 1] {
            assert_eq!(all(&map, of).len(), places as usize, "every place once, none left out");
            assert!(all(&map, of).iter().all(|off| off.abs() < 1e-6));
        }
    }

    /// Half a turn is at an angle of its own, whatever the turn: 3 µm at 90°, −3 µm at 270°.
    #[test]
    fn a_drunken_pass_has_its_error_where_it_is() {
        let drunken = |c: f64| 3.0 * libm::sin(c.to_radians());
        let map = map_of(&[pass(1, 1.2, 0.0)], |_, c| [drunken(c), -0.5]);
        for row in &map.rows(0)[1..9] {
            for (k, off) in row.iter().enumerate() {
                let off = off.expect("a whole turn");
                assert!((off - drunken(STATION_DEG * k as f64)).abs() < 0.002, "{k}: {off}");
            }
        }
        assert!(all(&map, 1).iter().all(|off| (off + 0.5).abs() < 1e-6), "outside, −X is too deep");
    }

    /// A pass that is not deep enough does not count, a spring pass hides the one before, on whichever index
    /// it began; a pass of the other start has its own groove.
    #[test]
    fn the_last_of_the_deepest_passes_counts() {
        let other_start = PassReport { start: 1, ..pass(4, 1.2, 0.5) };
        let cut_off = PassReport { complete: false, ..pass(5, 1.2, 0.0) };
        let passes = [pass(1, 0.8, 0.0), pass(2, 1.2, 0.0), pass(3, 1.2, 2.0), other_start, cut_off];
        let map = map_of(&passes, |pass, _| [f64::from(pass.pass), 0.0]);
        let rows = map.rows(0);
        let seen = |turn: usize| rows[turn][20].map(f64::round);
        assert_eq!(seen(1), Some(2.0), "where only the second pass was");
        assert_eq!(seen(5), Some(3.0));
        assert!(all(&map, 0).iter().all(|off| [2.0, 3.0].contains(&off.round())));
        let caption = map.figure().expect("a figure").caption;
        assert!(caption.contains("Start 1 of 2 is shown."), "{caption}");
    }

    #[test]
    fn without_a_pass_there_is_no_map() {
        assert!(map_of(&[], |_, _| [0.0, 0.0]).figure().is_none());
    }
}
