//! How round a circle is. In: the arcs of the program that go around at least half, by their lines, and one
//! [`Record`] each control cycle, mm. Out: for every such arc that was travelled, how far the true path was
//! from its radius, µm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | m, R | mm | centre and radius of the program |
//! | c, p | mm | commanded and true position (at the motors) in the plane of the circle |
//! | ψ | degrees | direction of c from m, from the first axis of the plane to the second |
//! | d | µm | deviation: \|p − m\| − R |
//!
//! A circle begins where c lies on it and moves along it while its line is in hand, and ends where c leaves
//! it. A *quadrant* is one of the four directions in which one of the axes turns back; its glitch is the
//! deviation farthest from the mean of the circle within [`QUADRANT_DEG`] of it.

use std::collections::BTreeMap;

use protocol::{Arc, Axis, AxisState, Code, Item, PerAxis, Position};

use super::{CircleReport, Record};

/// A commanded point that is nearer to the circle than this lies on it, mm. Where a rounded corner leads to
/// the circle or away from it, the path leaves it on purpose.
const ON_MM: f64 = 0.000_5;
/// Largest part of the commanded speed that may lead away from the circle.
const AWAY: f64 = 0.02;
/// What counts as a quadrant, degrees to either side.
const QUADRANT_DEG: f64 = 15.0;
/// A circle counts from this angle of travel on, degrees.
const LEAST_DEG: f64 = 170.0;
/// Circles that are reported; a program with more of them is long.
const MOST: usize = 200;
/// Round arcs of a program that are watched for.
const MOST_ARCS: usize = 10_000;

/// A circle of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Circle {
    line: u32,
    plane: [Axis; 2],
    center: [f64; 2],
    radius: f64,
}

/// Where the machine is in the plane of a circle.
struct Place {
    commanded: [f64; 2],
    velocity: [f64; 2],
    position: [f64; 2],
}

/// A circle being travelled.
#[derive(Clone, Copy, Debug)]
struct Lap {
    circle: Circle,
    begin_cycle: u64,
    end_cycle: u64,
    /// Direction of the last point, and how far the commanded point has gone around, degrees.
    psi_deg: f64,
    swept_deg: f64,
    cycles: u64,
    speed_sum: f64,
    /// Sum, lowest and highest deviation, mm.
    sum: f64,
    range: [f64; 2],
    /// Lowest and highest deviation near each quadrant.
    quadrants: [[f64; 2]; 4],
}

/// Watches for circles.
#[derive(Clone, Debug, Default)]
pub(super) struct Circles {
    program: BTreeMap<u32, Vec<Circle>>,
    lap: Option<Lap>,
    reports: Vec<CircleReport>,
}

/// Finds what an [`Observer`](super::Observer) wants to know of a program beforehand: its passes and tools,
/// its formulas and traces, and the arcs that go around at least half. Give it every item in order.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    at: PerAxis<Position>,
    arcs: usize,
}

impl Watch {
    /// Whether the observer wants this item; of a program with very many round arcs not all of them.
    pub fn wants(&mut self, item: &Item) -> bool {
        match item.code {
            Code::Pass(pass) => {
                self.at = pass.axes.map(|law| law.end);
                true
            }
            Code::Line { target, .. } => {
                self.at = target;
                false
            }
            Code::Arc { arc, .. } => {
                let round = self.arcs < MOST_ARCS && is_round(&self.at, &arc);
                (self.at, self.arcs) = (arc.target, self.arcs + usize::from(round));
                round
            }
            Code::Curve { curve, .. } => {
                self.at = curve.target;
                false
            }
            Code::Formula { .. } | Code::Work(_) | Code::Tool { .. } => true,
            _ => false,
        }
    }
}

/// Whether an arc goes around at least half: then its end is not ahead of its start in its own direction.
fn is_round(from: &PerAxis<Position>, arc: &Arc) -> bool {
    let seen = |point: &PerAxis<Position>| {
        let at = |i: usize| point[arc.plane.axes()[i].index()].mm_from(arc.center[i]);
        [at(0), at(1)]
    };
    let ([x0, y0], [x1, y1]) = (seen(from), seen(&arc.target));
    let (sine, square) = (x0 * y1 - y0 * x1, x1 * x1 + y1 * y1);
    arc.turns.unsigned_abs() > 1 || sine * f64::from(arc.turns.signum()) <= 1e-6 * square
}

impl Circles {
    /// The circles of a program. Items other than arcs do not matter.
    pub(super) fn of(items: &[Item]) -> Circles {
        let mut program: BTreeMap<u32, Vec<Circle>> = BTreeMap::new();
        for item in items {
            let Code::Arc { arc, .. } = item.code else { continue };
            let circle = Circle::of(item.line, &arc);
            let of_line = program.entry(item.line).or_default();
            if of_line.len() < MOST && !of_line.contains(&circle) {
                of_line.push(circle);
            }
        }
        Circles { program, ..Circles::default() }
    }

    /// Takes one control cycle.
    pub(super) fn cycle(&mut self, record: &Record) {
        let (now, line) = (record.truth.cycle.0, record.machine.line);
        let begun = self.program.get(&line).map_or(&[][..], Vec::as_slice);
        if self.lap.is_none() && begun.is_empty() {
            return;
        }
        if let Some(lap) = &mut self.lap {
            let again = begun.iter().any(|circle| circle.follows(&lap.circle));
            if let Some(place) = lap.circle.place(record).filter(|_| !again) {
                return lap.cycle(now, &place);
            }
            keep(&mut self.reports, lap.report());
        }
        self.lap =
            begun.iter().copied().find_map(|circle| Some(Lap::new(circle, now, &circle.place(record)?)));
    }

    /// Ends the observation.
    pub(super) fn finish(mut self, cycle_s: f64) -> Vec<CircleReport> {
        keep(&mut self.reports, self.lap.and_then(|lap| lap.report()));
        for report in &mut self.reports {
            report.t_s = report.begin_cycle as f64 * cycle_s;
        }
        self.reports
    }
}

fn keep(reports: &mut Vec<CircleReport>, report: Option<CircleReport>) {
    if reports.len() < MOST {
        reports.extend(report);
    }
}

impl Circle {
    fn of(line: u32, arc: &Arc) -> Circle {
        let plane = arc.plane.axes();
        let center = arc.center.map(Position::mm);
        let [x, y] = [0, 1].map(|i| arc.target[plane[i].index()].mm_from(arc.center[i]));
        Circle { line, plane, center, radius: libm::hypot(x, y) }
    }

    /// Whether this is another time around the same circle, by another line.
    fn follows(&self, before: &Circle) -> bool {
        self.line != before.line && *self == Circle { line: self.line, ..*before }
    }

    /// Where the machine is, seen from the centre, if it is on the circle and moves along it in timed motion.
    fn place(&self, record: &Record) -> Option<Place> {
        let mut place = Place { commanded: [0.0; 2], velocity: [0.0; 2], position: [0.0; 2] };
        for (i, axis) in self.plane.into_iter().enumerate() {
            let (_, status) = record.axes.iter().find(|(other, _)| *other == axis)?;
            if status.state() != AxisState::Streaming {
                return None;
            }
            place.commanded[i] = status.commanded_mm - self.center[i];
            place.velocity[i] = status.velocity_mm_s;
            place.position[i] = record.truth.axes[axis.index()].motor_mm - self.center[i];
        }
        let ([x, y], [vx, vy]) = (place.commanded, place.velocity);
        let (distance, speed) = (libm::hypot(x, y), libm::hypot(vx, vy));
        let along = (x * vx + y * vy).abs() <= AWAY * distance * speed;
        (along && (distance - self.radius).abs() <= ON_MM).then_some(place)
    }
}

impl Lap {
    fn new(circle: Circle, now: u64, place: &Place) -> Lap {
        let nothing = [f64::INFINITY, f64::NEG_INFINITY];
        let mut lap = Lap {
            circle,
            begin_cycle: now,
            end_cycle: now,
            psi_deg: place.psi_deg(),
            swept_deg: 0.0,
            cycles: 0,
            speed_sum: 0.0,
            sum: 0.0,
            range: nothing,
            quadrants: [nothing; 4],
        };
        lap.cycle(now, place);
        lap
    }

    fn cycle(&mut self, now: u64, place: &Place) {
        let psi = place.psi_deg();
        let step = psi - self.psi_deg;
        self.swept_deg += step - 360.0 * (step / 360.0).round();
        (self.psi_deg, self.end_cycle) = (psi, now);
        let [vx, vy] = place.velocity;
        self.speed_sum += libm::hypot(vx, vy);
        self.cycles += 1;
        let [x, y] = place.position;
        let deviation = libm::hypot(x, y) - self.circle.radius;
        self.sum += deviation;
        widen(&mut self.range, deviation);
        let nearest = (psi / 90.0).round();
        if (psi - 90.0 * nearest).abs() <= QUADRANT_DEG
            && let Some(quadrant) = self.quadrants.get_mut(nearest.rem_euclid(4.0) as usize)
        {
            widen(quadrant, deviation);
        }
    }

    /// `None` if too little of the circle was travelled.
    fn report(&self) -> Option<CircleReport> {
        if self.swept_deg.abs() < LEAST_DEG {
            return None;
        }
        let cycles = self.cycles as f64;
        let mean = self.sum / cycles;
        let glitch = |[low, high]: [f64; 2]| match (low <= high, mean - low > high - mean) {
            (false, _) => 0.0, // not travelled
            (true, true) => 1e3 * (low - mean),
            (true, false) => 1e3 * (high - mean),
        };
        Some(CircleReport {
            line: self.circle.line,
            plane: self.circle.plane,
            center_mm: self.circle.center,
            radius_mm: self.circle.radius,
            feed_mm_min: 60.0 * self.speed_sum / cycles,
            swept_deg: self.swept_deg,
            t_s: 0.0,
            begin_cycle: self.begin_cycle,
            end_cycle: self.end_cycle,
            round_max_um: 1e3 * self.range[1].abs().max(self.range[0].abs()),
            mean_um: 1e3 * mean,
            quadrants_um: self.quadrants.map(glitch),
        })
    }
}

impl Place {
    fn psi_deg(&self) -> f64 {
        libm::atan2(self.commanded[1], self.commanded[0]).to_degrees()
    }
}

fn widen(range: &mut [f64; 2], value: f64) {
    *range = [range[0].min(value), range[1].max(value)];
}
