//! What is left of the part while a program cuts it, and what no program should do with it: go through it, or
//! into the chuck, in rapid motion; begin a run-in or end a retract inside it; lead a thread through a
//! shoulder; cut while the spindle stands.
//! In: moves in the coordinates of the part, mm, X a radius. Out: warnings.
//!
//! The stock is kept as a bore and an outer radius at nodes along Z. A feed takes off what lies beyond its
//! point on the side of the free end: `|x| ≥ x_tool, z ≥ z_tool` from outside, `|x| ≤ x_tool, z ≥ z_tool` in
//! a bore. That is more than a groove or a tool for the other hand takes, so there is material that these
//! warnings do not know of, and none that they invent. A cut that begins in front of a tube is of its outside
//! or of its bore: both readings are kept until a move makes sense in one of them alone.

mod thread;

use std::collections::BTreeMap;

use gcode::Problem;
use gcode::problem::{Blame, short};
use machine::{Machine, Part};
use protocol::{Axis, PerAxis, Position};

use crate::frame::Frame;
use crate::thread::Point;

/// Distance of the nodes, mm, and most of them.
const STEP_MM: f64 = 0.05;
const MOST_NODES: f64 = 40_000.0;
/// So far a point is in the material that is in it, mm: nodes and lines are not finer.
const SKIN_MM: f64 = 0.06;
/// Warnings of one program.
const MOST_WARNINGS: u32 = 20;

/// The part as far as it is cut.
#[derive(Clone, Debug)]
pub(crate) struct Stock {
    low_mm: f64,
    step_mm: f64,
    /// Bore and outer radius at each node.
    nodes: Vec<[f64; 2]>,
    /// The same if the first cut from the face of a tube was on the other side than it seems.
    other: Option<Vec<[f64; 2]>>,
    widest_mm: f64,
    chuck_mm: Option<f64>,
    warnings: u32,
}

/// How a move goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Goes {
    /// In rapid motion.
    Rapid,
    /// Cutting, with the spindle turning.
    Cuts,
    /// Cutting, with the spindle standing.
    CutsAtRest,
}

impl Stock {
    /// The part before it is cut.
    pub(crate) fn new(part: &Part) -> Stock {
        let [low_mm, high_mm] = part.ends_mm();
        let intervals = ((high_mm - low_mm) / STEP_MM).ceil().clamp(1.0, MOST_NODES);
        let step_mm = (high_mm - low_mm) / intervals;
        let node = |number: u32| part.radii_mm(low_mm + f64::from(number) * step_mm).unwrap_or([0.0; 2]);
        Stock {
            low_mm,
            step_mm,
            nodes: (0..=intervals as u32).map(node).collect(),
            other: None,
            widest_mm: part.widest_mm(),
            chuck_mm: part.chuck_mm(),
            warnings: 0,
        }
    }

    /// Takes a straight move; a warning if it should not be. `drill_mm` is the radius of a drill, if the tool
    /// has a width.
    pub(crate) fn goes(
        &mut self,
        [from, to]: [Point; 2],
        how: Goes,
        drill_mm: f64,
        frame: &Frame,
    ) -> Option<Box<Problem>> {
        let inside = self.first_inside(&self.nodes, from, to);
        let inside = if how == Goes::Rapid { self.in_both(inside, from, to) } else { inside };
        let warning = match (how, inside) {
            (Goes::Rapid, Some(at)) => Some(warning(
                "rapid-in-stock",
                format!("the rapid goes through the stock at {}", frame.place(at)),
                "go around it, or cut it off first; is the part as it is said to be, and the offset?",
            )),
            (Goes::CutsAtRest, Some(at)) => Some(warning(
                "cut-at-rest",
                format!("the tool cuts into the stock at {}, and the spindle stands", frame.place(at)),
                "start the spindle before, as in G97 S800 M3",
            )),
            _ => self.in_chuck(from, to, frame),
        };
        if how != Goes::Rapid && (inside.is_some() || along_the_axis(from, to)) {
            self.cut(from, to, drill_mm);
        }
        self.told(warning)
    }

    /// Where a rapid is in the material by both readings of the cuts; one that it contradicts is dropped.
    fn in_both(&mut self, inside: Option<Point>, from: Point, to: Point) -> Option<Point> {
        let Some(other) = self.other.take() else { return inside };
        match (inside, self.first_inside(&other, from, to)) {
            (Some(_), None) => {
                self.nodes = other;
                None
            }
            (None, Some(_)) => None,
            _ => {
                self.other = Some(other);
                inside
            }
        }
    }

    fn told(&mut self, warning: Option<Box<Problem>>) -> Option<Box<Problem>> {
        self.warnings += u32::from(warning.is_some());
        warning.filter(|_| self.warnings <= MOST_WARNINGS)
    }

    /// A move that ends deeper in the chuck than it begins.
    fn in_chuck(&self, from: Point, to: Point, frame: &Frame) -> Option<Box<Problem>> {
        let chuck_mm = self.chuck_mm?;
        (to.z < chuck_mm && to.z < from.z).then(|| {
            let [to, chuck] = [to.z, chuck_mm].map(|mm| short(mm / frame.unit()));
            let message =
                format!("the tool goes to Z{to}, and the chuck begins at Z{chuck} ({})", frame.units.name());
            warning("into-chuck", message, "end the move before it, or let more of the stock stand out")
        })
    }

    /// The node nearest to Z, if the stock is there.
    fn node(&self, z: f64) -> Option<usize> {
        let node = ((z - self.low_mm) / self.step_mm).round();
        (node >= 0.0 && node < self.nodes.len() as f64).then_some(node as usize)
    }

    fn is_inside(&self, point: Point) -> bool {
        self.is_inside_of(&self.nodes, point)
    }

    fn is_inside_of(&self, nodes: &[[f64; 2]], point: Point) -> bool {
        let Some([bore, outer]) = self.node(point.z).and_then(|node| nodes.get(node)) else { return false };
        let x = point.x.abs();
        x < outer - SKIN_MM && (*bore == 0.0 || x > bore + SKIN_MM)
    }

    /// Points of a line, no farther apart than the nodes.
    fn points(&self, from: Point, to: Point) -> impl Iterator<Item = Point> + use<> {
        let count =
            (libm::hypot(to.x - from.x, to.z - from.z) / self.step_mm).ceil().clamp(1.0, 2.0 * MOST_NODES);
        (0..=count as u32).map(move |number| {
            let share = f64::from(number) / count;
            Point { x: from.x + (to.x - from.x) * share, z: from.z + (to.z - from.z) * share }
        })
    }

    /// Where a line comes into the material.
    fn first_inside(&self, nodes: &[[f64; 2]], from: Point, to: Point) -> Option<Point> {
        let end_mm = self.low_mm + self.step_mm * (self.nodes.len() - 1) as f64;
        let beside = from.z.max(to.z) < self.low_mm || from.z.min(to.z) > end_mm + self.step_mm;
        let above = from.x.min(to.x) > self.widest_mm || from.x.max(to.x) < -self.widest_mm;
        if beside || above {
            return None;
        }
        self.points(from, to).find(|point| self.is_inside_of(nodes, *point))
    }

    /// Whether a cut begins where neither the outside nor the bore of a tube is.
    fn begins_in_front(&self, from: Point) -> bool {
        let here = self.node(from.z).and_then(|node| self.nodes.get(node));
        let is_tube = self.nodes.iter().any(|[bore, outer]| *bore > 0.0 && outer > bore);
        is_tube && here.is_none_or(|[bore, outer]| outer - bore <= 2.0 * SKIN_MM)
    }

    /// Takes off what a feed cuts.
    fn cut(&mut self, from: Point, to: Point, drill_mm: f64) {
        let way = [from, to];
        let other = match self.other.take() {
            Some(other) => Some(self.less(other, way, drill_mm, false)),
            None => (!along_the_axis(from, to) && self.begins_in_front(from))
                .then(|| self.less(self.nodes.clone(), way, drill_mm, true)),
        };
        let nodes = std::mem::take(&mut self.nodes);
        self.nodes = self.less(nodes, way, drill_mm, false);
        self.other = other.filter(|other| *other != self.nodes);
    }

    /// What a feed leaves. A cut in a tube is of the surface that it is nearer to, or of the `other` one.
    fn less(
        &self,
        mut nodes: Vec<[f64; 2]>,
        [from, to]: [Point; 2],
        drill_mm: f64,
        other: bool,
    ) -> Vec<[f64; 2]> {
        let along_the_axis = along_the_axis(from, to);
        let last = nodes.len() - 1;
        // What the points at each node leave.
        let mut left = vec![[0.0, f64::INFINITY]; nodes.len()];
        for point in self.points(from, to) {
            let behind = (point.z - self.low_mm) / self.step_mm;
            if behind.round() > last as f64 {
                continue;
            }
            let node = behind.round().max(0.0) as usize;
            let ([bore, outer], x) = (nodes[node], point.x.abs());
            if along_the_axis && drill_mm > 0.0 {
                left[node][0] = drill_mm.max(left[node][0]);
            } else if !along_the_axis && bore > 0.0 && (x < 0.5 * (bore + outer)) != other {
                left[node][0] = x.max(left[node][0]);
            } else {
                left[node][1] = x.min(left[node][1]);
            }
        }
        let mut taken: [f64; 2] = [0.0, f64::INFINITY];
        for (node, left) in nodes.iter_mut().zip(left) {
            taken = [taken[0].max(left[0]), taken[1].min(left[1])];
            *node = [node[0].max(taken[0]), node[1].min(taken[1])];
        }
        nodes
    }
}

/// As a drill goes.
pub(crate) fn along_the_axis(from: Point, to: Point) -> bool {
    from.x.abs() < SKIN_MM && to.x.abs() < SKIN_MM
}

/// Where X and Z of the machine stand, mm.
pub(crate) fn point(axes: &PerAxis<Position>, origin: Point) -> Point {
    let at = |axis: Axis| axes[axis.index()].mm();
    Point { x: at(Axis::X) - origin.x, z: at(Axis::Z) - origin.z }
}

/// The radius of a drill, mm, by the tool table, else by the machine file; 0 if the tool has no width.
pub(crate) fn drill_mm(machine: &Machine, tool: Option<u32>, diameters_mm: &BTreeMap<u32, f64>) -> f64 {
    let width = tool.and_then(|number| machine.tool(number)?.width_mm);
    0.5 * tool.and_then(|number| diameters_mm.get(&number).copied()).or(width).unwrap_or(0.0)
}

fn warning(code: &'static str, message: String, help: &str) -> Box<Problem> {
    Problem::warning(code, Blame::Block, message, help)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stock(text: &str) -> Stock {
        Stock::new(&Part::from_comment(text, 1.0).expect("a part").expect("a part"))
    }

    fn at(x: f64, z: f64) -> Point {
        Point { x, z }
    }

    fn code(warning: Option<Box<Problem>>) -> &'static str {
        warning.map_or("", |warning| warning.code)
    }

    fn goes(stock: &mut Stock, ends: [Point; 2], how: Goes) -> &'static str {
        code(stock.goes(ends, how, 0.0, &Frame::new()))
    }

    #[test]
    fn a_rapid_may_go_where_nothing_is_or_is_left() {
        let mut bar = stock("part, bar D40 L60 C-55");
        let mut rapid = |from, to| goes(&mut bar, [from, to], Goes::Rapid);
        assert_eq!(rapid(at(60.0, 100.0), at(20.0, 2.0)), "");
        assert_eq!(rapid(at(20.0, 2.0), at(20.0, -30.0)), "", "along the surface");
        assert_eq!(rapid(at(18.0, 2.0), at(18.0, -0.5)), "rapid-in-stock");
        assert_eq!(rapid(at(30.0, 5.0), at(5.0, -10.0)), "rapid-in-stock");
        assert_eq!(rapid(at(30.0, -20.0), at(30.0, -56.0)), "into-chuck");
        assert_eq!(goes(&mut bar, [at(18.0, 2.0), at(18.0, -30.0)], Goes::Cuts), "");
        let mut rapid = |from, to| goes(&mut bar, [from, to], Goes::Rapid);
        assert_eq!(rapid(at(18.0, 2.0), at(18.0, -30.0)), "", "it has been cut off");
        assert_eq!(rapid(at(19.0, -29.0), at(19.0, -31.0)), "rapid-in-stock");
        assert_eq!(rapid(at(17.0, 2.0), at(17.0, -1.0)), "rapid-in-stock");
    }

    #[test]
    fn a_face_is_gone_when_it_has_been_cut() {
        let mut bar = stock("part, bar D40 L60 Z1");
        assert_eq!(goes(&mut bar, [at(22.0, 0.0), at(-0.8, 0.0)], Goes::Cuts), "");
        assert_eq!(goes(&mut bar, [at(-0.8, 0.0), at(-0.8, 1.0)], Goes::Rapid), "");
        assert_eq!(goes(&mut bar, [at(10.0, 2.0), at(10.0, 0.0)], Goes::Rapid), "");
        assert_eq!(goes(&mut bar, [at(10.0, 2.0), at(10.0, -0.2)], Goes::Rapid), "rapid-in-stock");
    }

    #[test]
    fn a_bore_is_cut_from_within_and_leaves_the_outside() {
        let mut tube = stock("part, tube D40 I20 L60");
        assert_eq!(goes(&mut tube, [at(9.0, 2.0), at(9.0, -50.0)], Goes::Rapid), "", "in the bore");
        goes(&mut tube, [at(12.0, 2.0), at(12.0, -20.0)], Goes::Cuts);
        assert_eq!(goes(&mut tube, [at(11.5, 2.0), at(11.5, -19.0)], Goes::Rapid), "");
        assert_eq!(goes(&mut tube, [at(11.5, 2.0), at(11.5, -21.0)], Goes::Rapid), "rapid-in-stock");
        assert_eq!(goes(&mut tube, [at(19.0, 2.0), at(19.0, -1.0)], Goes::Rapid), "rapid-in-stock");
    }

    #[test]
    fn a_tube_is_turned_deeper_than_half_of_its_wall() {
        let turned = || {
            let mut tube = stock("part, tube D40 I20 L60");
            assert_eq!(goes(&mut tube, [at(14.0, 2.0), at(14.0, -20.0)], Goes::Cuts), "");
            tube
        };
        // Out and back: the outside was turned, and what is within is there.
        let mut tube = turned();
        assert_eq!(goes(&mut tube, [at(14.0, -20.0), at(22.0, -20.0)], Goes::Rapid), "");
        assert_eq!(goes(&mut tube, [at(14.5, 2.0), at(14.5, -19.0)], Goes::Rapid), "");
        assert_eq!(goes(&mut tube, [at(12.0, 2.0), at(12.0, -19.0)], Goes::Rapid), "rapid-in-stock");
        // Towards the axis and out: it was bored.
        let mut tube = turned();
        assert_eq!(goes(&mut tube, [at(14.0, -20.0), at(9.0, -20.0)], Goes::Rapid), "");
        assert_eq!(goes(&mut tube, [at(14.5, 2.0), at(14.5, -19.0)], Goes::Rapid), "rapid-in-stock");
        // Through either of them.
        let mut tube = turned();
        assert_eq!(goes(&mut tube, [at(22.0, -30.0), at(9.0, -30.0)], Goes::Rapid), "rapid-in-stock");
    }

    #[test]
    fn a_tube_is_drilled_as_wide_as_nobody_knows() {
        let mut tube = stock("part, tube D40 I10 L60");
        goes(&mut tube, [at(0.0, 2.0), at(0.0, -30.0)], Goes::Cuts);
        assert_eq!(goes(&mut tube, [at(7.0, 2.0), at(7.0, -29.0)], Goes::Rapid), "");
    }

    #[test]
    fn a_drill_leaves_a_hole_of_its_width() {
        let mut bar = stock("part, bar D40 L60");
        bar.goes([at(0.0, 2.0), at(0.0, -30.0)], Goes::Cuts, 6.0, &Frame::new());
        assert_eq!(goes(&mut bar, [at(5.0, 2.0), at(5.0, -29.0)], Goes::Rapid), "");
        assert_eq!(goes(&mut bar, [at(7.0, 2.0), at(7.0, -29.0)], Goes::Rapid), "rapid-in-stock");
        // Of one whose width nobody knows all of the stock above may be gone.
        let mut bar = stock("part, bar D40 L60");
        goes(&mut bar, [at(0.0, 2.0), at(0.0, -30.0)], Goes::Cuts);
        assert_eq!(goes(&mut bar, [at(7.0, 2.0), at(7.0, -29.0)], Goes::Rapid), "");
    }

    #[test]
    fn nothing_is_cut_while_the_spindle_stands() {
        let mut bar = stock("part, bar D40 L60");
        assert_eq!(goes(&mut bar, [at(21.0, 2.0), at(21.0, -30.0)], Goes::CutsAtRest), "");
        assert_eq!(goes(&mut bar, [at(18.0, 2.0), at(18.0, -30.0)], Goes::CutsAtRest), "cut-at-rest");
    }

    #[test]
    fn a_program_is_warned_a_number_of_times_and_no_more() {
        let mut bar = stock("part, bar D40 L60");
        let mut warned = || !goes(&mut bar, [at(5.0, 2.0), at(5.0, -30.0)], Goes::Rapid).is_empty();
        assert_eq!((0..100).filter(|_| warned()).count(), 20);
    }
}
