//! The tool path: where the tool really went, told apart by tool and by how it moved. In: rows of the trace.
//! Out: strokes in the plane of the machine, mm, and their picture.

use std::collections::BTreeMap;

use protocol::{Axis, AxisState, Motion};
use rig::observe::Summary;
use rig::trace::Row;
use serde_json::{Value, json};

use crate::colours::of_kind;
use crate::paint::{Figure, axis, strokes};

/// A point is kept when the tool has moved this far since the last one kept, mm; the distance is doubled
/// whenever there are too many points.
const STEP_MM: f64 = 0.02;
const MOST_POINTS: usize = 12_000;

const LATHE_PLANE: [Axis; 2] = [Axis::Z, Axis::X];
const MILL_PLANE: [Axis; 2] = [Axis::X, Axis::Y];

/// How the tool moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Way {
    Rapid,
    Feed,
    Thread,
}

/// A place of the tool, and the line of the program it was led by.
#[derive(Clone, Copy)]
struct Point {
    at: (f64, f64),
    line: u32,
}

/// Points of the path; `None` lifts the pen.
type Stroke = Vec<Option<Point>>;

/// The true path of each tool.
pub(super) struct Path {
    /// To the right and upwards: Z and X of a lathe, X and Y of a mill.
    plane: [Axis; 2],
    strokes: BTreeMap<(u32, Way), Stroke>,
    /// Whose stroke is drawn, and its last point.
    pen: Option<((u32, Way), Point)>,
    step_mm: f64,
    /// The cycle of the row before.
    cycle: Option<u64>,
}

impl Path {
    /// An empty path for a run.
    pub(super) fn new(summary: &Summary) -> Path {
        let mill = summary.limits.contains_key(&Axis::Y);
        Path {
            plane: if mill { MILL_PLANE } else { LATHE_PLANE },
            strokes: BTreeMap::new(),
            pen: None,
            step_mm: STEP_MM,
            cycle: None,
        }
    }

    /// Takes the next row.
    pub(super) fn add(&mut self, row: &Row) {
        let [Some(right), Some(up)] = self.plane.map(|axis| row.axis(axis)) else { return };
        let before = self.cycle.replace(row.cycle);
        if before.is_some() && row.after(before).is_none() {
            self.lift(None);
        }
        let in_pass =
            |state| (AxisState::RunIn..=AxisState::RunOut).contains(&state) || state == AxisState::Leaving;
        let way = match row.led.motion {
            _ if in_pass(right.state) || in_pass(up.state) => Way::Thread,
            Motion::Rapid => Way::Rapid,
            Motion::Feed => Way::Feed,
            // What settles belongs to the motion before it.
            Motion::None => match self.pen {
                Some(((_, way), _)) => way,
                None => return,
            },
        };
        let key = (row.led.tool, way);
        let place = Point { at: (right.true_mm, up.true_mm), line: row.line };
        if let Some((before, last)) = self.pen {
            if before != key {
                // Joins what follows to where the other motion ended.
                self.lift(Some(place));
            } else if libm::hypot(place.at.0 - last.at.0, place.at.1 - last.at.1) < self.step_mm {
                return;
            }
        }
        self.strokes.entry(key).or_default().push(Some(place));
        self.pen = Some((key, place));
        if self.strokes.values().map(Vec::len).sum::<usize>() > MOST_POINTS {
            self.step_mm *= 2.0;
            self.strokes.values_mut().for_each(thin);
        }
    }

    /// Ends a stroke, at a last place if there is one.
    fn lift(&mut self, last: Option<Point>) {
        let Some((key, _)) = self.pen.take() else { return };
        let stroke = self.strokes.entry(key).or_default();
        stroke.extend(last.map(Some));
        stroke.push(None);
    }

    /// The picture.
    pub(super) fn figure(&self) -> Figure {
        let mill = self.plane == MILL_PLANE;
        let (mut right, mut up) =
            if mill { (axis("X (mm)"), axis("Y (mm)")) } else { (axis("Z (mm)"), axis("X, radius (mm)")) };
        up["scaleanchor"] = json!("x");
        let threads = self.strokes.iter().filter(|((_, way), _)| *way == Way::Thread);
        let threads: Vec<_> =
            threads.flat_map(|(_, stroke)| stroke.iter().flatten()).map(|point| point.at).collect();
        if let Some([right_range, up_range]) = around(&threads) {
            (right["range"], up["range"]) = (json!(right_range), json!(up_range));
        }
        let good = if threads.is_empty() {
            "Good: nothing crosses the part in rapid motion."
        } else {
            "Good: every pass enters on a smooth curve, runs straight, and leaves on a smooth curve; nothing crosses the \
             part in rapid motion. The picture opens on the thread; double-click it for the whole way."
        };
        let seen = if mill { "seen along the spindle" } else { "the spindle's axis along X = 0" };
        Figure {
            title: "Tool path".into(),
            caption: format!(
                "Where each tool really went, {seen}, both axes at the same scale: dashed in rapid motion, thin at a \
                 feed, wide in a thread. {good}"
            ),
            alt: format!(
                "Tool path in the plane of {} and {}: {}.",
                self.plane[0],
                self.plane[1],
                self.strokes.keys().map(|key| name(*key)).collect::<Vec<_>>().join(", ")
            ),
            plot: json!({ "data": self.drawn(), "layout": { "xaxis": right, "yaxis": up } }),
            aspect: 0.5,
        }
    }

    fn drawn(&self) -> Vec<Value> {
        let mut tools: Vec<u32> = self.strokes.keys().map(|(tool, _)| *tool).collect();
        tools.dedup();
        let draw = |(key, stroke): (&(u32, Way), &Stroke)| {
            let of_tool = tools.iter().position(|tool| *tool == key.0).unwrap_or(0);
            let places: Vec<_> = stroke.iter().map(|point| point.map(|point| point.at)).collect();
            let mut drawn = strokes(&places, &name(*key), of_kind(of_tool), ("x", "y"));
            drawn["meta"] = json!({ "lines": lines(stroke) });
            let (dash, width) = match key.1 {
                Way::Rapid => ("4px,3px", 1.0),
                Way::Feed => ("solid", 1.2),
                Way::Thread => ("solid", 2.0),
            };
            (drawn["line"]["dash"], drawn["line"]["width"]) = (json!(dash), json!(width));
            drawn["line"]["simplify"] = json!(false);
            drawn["connectgaps"] = json!(false);
            drawn
        };
        self.strokes.iter().map(draw).collect()
    }
}

/// The line of each point, as runs: the number of the first point of a run, its line, and so on.
fn lines(stroke: &Stroke) -> Vec<u32> {
    let mut runs: Vec<u32> = Vec::new();
    for (number, point) in (0..).zip(stroke) {
        if let Some(point) = point
            && runs.last() != Some(&point.line)
        {
            runs.extend([number, point.line]);
        }
    }
    runs
}

fn name((tool, way): (u32, Way)) -> String {
    let way = match way {
        Way::Rapid => "rapid",
        Way::Feed => "feed",
        Way::Thread => "thread",
    };
    if tool == 0 { way.into() } else { format!("T{tool} {way}") }
}

/// The ranges to the right and upwards that show points with some room around; `None` if there are none.
fn around(points: &[(f64, f64)]) -> Option<[[f64; 2]; 2]> {
    let range = |of: fn(&(f64, f64)) -> f64| {
        let values = points.iter().map(of);
        let (low, high) = (values.clone().reduce(f64::min)?, values.reduce(f64::max)?);
        let room = 0.15 * (high - low) + 1.0;
        Some([low - room, high + room])
    };
    Some([range(|point| point.0)?, range(|point| point.1)?])
}

/// Leaves out every other point of a path, but not the ends of its strokes.
fn thin<T: Copy>(points: &mut Vec<Option<T>>) {
    let before = std::mem::take(points);
    let inner = |index: usize| {
        let neighbour =
            |other: Option<usize>| other.and_then(|other| before.get(other)).is_some_and(Option::is_some);
        before[index].is_some() && neighbour(index.checked_sub(1)) && neighbour(Some(index + 1))
    };
    let kept = (0..before.len()).filter(|index| index % 2 == 0 || !inner(*index));
    *points = kept.map(|index| before[index]).collect();
}

#[cfg(test)]
mod tests {
    use super::{Point, lines, thin};

    #[test]
    fn points_know_their_lines_by_runs() {
        let point = |line: u32| Some(Point { at: (0.0, 0.0), line });
        let stroke = vec![point(3), point(3), None, point(3), point(7), None, point(3)];
        assert_eq!(lines(&stroke), [0, 3, 4, 7, 6, 3]);
        assert_eq!(lines(&Vec::new()), [0_u32; 0]);
    }

    #[test]
    fn thinning_keeps_the_ends_of_every_stroke() {
        let stroke = |from: i32, to: i32| (from..to).map(|z| Some((f64::from(z), 0.0))).chain([None]);
        let mut points: Vec<_> = stroke(0, 10).chain(stroke(20, 29)).collect();
        thin(&mut points);
        let kept: Vec<_> = points.iter().map(|point| point.map_or(-1, |point| point.0 as i32)).collect();
        assert_eq!(kept, [0, 2, 4, 6, 8, 9, -1, 20, 21, 23, 25, 27, 28, -1]);
    }
}
