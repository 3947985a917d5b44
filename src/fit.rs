//! Whether machine code suits a machine. In: items of a file, in their order. Out: what does not suit
//! its limits.

use machine::Machine;
use protocol::{ByHand, Code, Item, PerAxis, Position};
use route::{Course, Route};

/// Whether machine code suits the limits of a machine of the same name that has changed since.
pub(crate) struct Fit<'m> {
    machine: &'m Machine,
    at: PerAxis<Position>,
    route: Route,
    /// A jog is in hand: before a reference run it may lead beyond the travel that is believed.
    jogs: bool,
    /// A trace that cannot be followed was met: why is seen where its time is told.
    lost: bool,
}

impl Fit<'_> {
    /// At home, before the first item.
    pub(crate) fn new(machine: &Machine) -> Fit<'_> {
        Fit { machine, at: machine.home(), route: Route::new(machine), jogs: false, lost: false }
    }

    /// Takes the next item; why it does not suit.
    pub(crate) fn item(&mut self, Item { line, code }: &Item) -> Option<String> {
        if self.lost {
            return None;
        }
        let referenced = self.machine.axes().all(|(_, config)| config.reference.is_none());
        if let Code::ByHand(by_hand) = code {
            self.jogs = matches!(by_hand, ByHand::Begins { jogs: true, .. });
        }
        let free = self.jogs && !referenced;
        let Fit { machine, at, route, .. } = self;
        let what = match code {
            Code::Pass(pass) if !machine.can_follow(pass) => "a pass its axes cannot follow",
            Code::Line { target, .. } if !free && !machine.can_reach(target) => "a move beyond its travel",
            Code::Arc { arc, .. } if !machine.can_turn(at, arc) => {
                "an arc that leaves its travel, or that is not an arc"
            }
            Code::Curve { curve, .. } if !machine.can_curve(at, curve) => "a curve beyond its travel",
            Code::Line { .. } | Code::Arc { .. } | Code::Curve { .. } | Code::ByHand(_) => {
                let begins = if let Code::ByHand(ByHand::Begins { at, .. }) = code { Some(at) } else { None };
                *at = *code.target().or(begins).unwrap_or(at);
                return None;
            }
            Code::Pass(pass) => {
                machine.axes().for_each(|(axis, _)| at[axis.index()] = pass.axis(axis).end);
                return None;
            }
            Code::Output { .. } | Code::Await { .. } => {
                let refused = machine.refuses(code)?;
                return Some(format!("line {line} of the program: {}; {}", refused.message, refused.help));
            }
            Code::Formula { slot, formula } => {
                route.set_formula(*slot, *formula);
                return None;
            }
            Code::Work(trace) => {
                match Course::new(route, *line, trace, at).and_then(|tracer| tracer.end(route)) {
                    Ok(end) => *at = end,
                    Err(_) => self.lost = true,
                }
                return None;
            }
            _ => return None,
        };
        Some(changed(what, *line))
    }
}

/// What is said of an item that does not.
pub(crate) fn changed(what: &str, line: u32) -> String {
    format!("{what} (line {line} of the program): the machine has changed, compile the program again")
}

#[cfg(test)]
mod tests {
    use machine::{Machine, SMALL_MILL};
    use protocol::{Arc, Axis, Code, Feed, Item, PerAxis, Plane, Position, Set, Shape, Work};
    use shape::{Contour, Correction, Formula, Op, Side};

    use super::Fit;

    /// A straight contour along X, and half a circle from its end: an arc from there, and none from anywhere
    /// else.
    #[test]
    fn an_arc_behind_a_trace_begins_where_the_trace_ends() {
        let machine = Machine::from_toml(SMALL_MILL).expect("a mill");
        let at = |x: f64, y: f64| {
            let mut at = PerAxis::default();
            (at[0], at[1]) = (Position::from_mm(x), Position::from_mm(y));
            at
        };
        let formula = Formula::new(&[Op::Variable(0), Op::Constant(0.0), Op::Mul]).expect("a formula");
        let half = |x: f64| {
            let (target, center) = (at(x, 30.0), [Position::from_mm(x), Position::from_mm(20.0)]);
            let arc = Arc { plane: Plane::ALL[0], target, center, turns: 1 };
            Code::Arc { arc, feed: Feed::PerMinute(1000.0) }
        };
        let origin = [10.0, 10.0, 0.0].map(Position::from_mm);
        let work =
            Shape::Contour(Contour { x: [0.0, 20.0], radius_mm: 0.0, side: Side::On }, [Axis::X, Axis::Y]);
        let trace =
            Work { shape: work, origin, feed_mm_min: 1000.0, chord_mm: 0.001, correction: Correction::Exact };
        let codes = |x: f64| {
            let start = Code::Line { target: at(10.0, 10.0), feed: Feed::Rapid };
            let codes = [start, Code::Formula { slot: 0, formula }, Code::Work(trace), half(x)];
            (1..).zip(codes).map(|(line, code)| Item { line, code }).collect::<Vec<_>>()
        };
        let judged = |codes: Vec<Item>| {
            let mut fit = Fit::new(&machine);
            codes.iter().find_map(|item| fit.item(item))
        };
        assert_eq!(judged(codes(30.0)), None);
        let refused = judged(codes(10.0)).expect("the circle of 10 mm does not begin there");
        assert!(refused.contains("line 4"), "{refused}");
        let on = Code::Output { number: 3, set: Set::Digital(true), in_step: false };
        let refused = judged(vec![Item { line: 7, code: on }]).expect("this mill has no outputs");
        assert!(refused.contains("line 7") && refused.contains("add [outputs.3]"), "{refused}");
    }
}
