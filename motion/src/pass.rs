//! What one axis does in a threading pass, as a function of the spindle angle: a stroke in (M2), perhaps a
//! little too far and back (M132), a ramp onto its lead (M13), the lead (M14), which may change on the way
//! (M214), a brake (M15), a stroke out (M2); parts may overlap and add up.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | c | deg | spindle angle since the index, growing in the direction of the spindle |
//! | S | 1/min | programmed spindle speed |
//! | p | s | (c - c0) / (6 S), time at programmed speed (M1) |
//! | x | mm | position relative to the start of the pass; v, a, j, dj its derivatives by p |

use crate::{LeadChange, Limits, Ramp, Sample, Stroke};

/// The most changes of lead in one pass.
pub const MOST_CHANGES: usize = 12;

/// A part of a law and the angle at which it begins, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Begins<T> {
    c: f64,
    law: T,
}

/// The law of one axis over a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassLaw {
    deg_per_s: f64,
    approach: Option<Begins<Stroke>>,
    unloading: Option<Begins<Stroke>>,
    run_in: Option<Begins<Ramp>>,
    /// The first of them with their number.
    changes: ([Begins<LeadChange>; MOST_CHANGES], usize),
    brake: Option<Begins<Ramp>>,
    braked_from: f64,
    retract: Option<Begins<Stroke>>,
}

impl PassLaw {
    /// A law that rests; add its parts. S in 1/min, positive.
    ///
    /// # Panics
    /// If S is not positive.
    pub fn new(s_rpm: f64) -> PassLaw {
        assert!(s_rpm > 0.0, "a pass needs a programmed speed");
        PassLaw {
            deg_per_s: 6.0 * s_rpm,
            approach: None,
            unloading: None,
            run_in: None,
            changes: ([Begins { c: 0.0, law: LeadChange::default() }; MOST_CHANGES], 0),
            brake: None,
            braked_from: 0.0,
            retract: None,
        }
    }

    /// Adds the approach: a stroke in mm made over `dc` degrees from angle `c0` (M2).
    pub fn with_approach(mut self, length: f64, c0: f64, dc: f64) -> PassLaw {
        self.approach = Some(Begins { c: c0, law: Stroke::new(length, dc / self.deg_per_s) });
        self
    }

    /// Adds the way back of an approach that goes too far, by a stroke in mm made over `dc` degrees from
    /// angle `c0`, where the approach is over (M132).
    pub fn with_unloading(mut self, length: f64, c0: f64, dc: f64) -> PassLaw {
        self.unloading = Some(Begins { c: c0, law: Stroke::new(length, dc / self.deg_per_s) });
        self
    }

    /// Adds the lead in mm/rev: reached over `dc` degrees from `c0` (M13), kept (M14), left over `brake_dc`
    /// degrees from `brake_c` (M15).
    pub fn with_lead(mut self, lead: f64, run_in: Window, brake: Window) -> PassLaw {
        let v = lead * self.deg_per_s / 360.0;
        let ramp = Ramp::new(v, run_in.dc / self.deg_per_s, run_in.lambda);
        let leave = Ramp::new(v, brake.dc / self.deg_per_s, brake.lambda);
        self.braked_from = ramp.at((brake.c - run_in.c) / self.deg_per_s).s;
        self.run_in = Some(Begins { c: run_in.c, law: ramp });
        self.brake = Some(Begins { c: brake.c, law: leave });
        self
    }

    /// Adds a change of the lead, mm/rev, and of its growth in every turn, mm/rev, over `dc` degrees from
    /// angle `c0` (M214), in the order of their angles. The lead must be there ([`PassLaw::with_lead`]), and
    /// be constant again where it is left.
    ///
    /// # Panics
    /// If there is no lead, the window is empty, or there are more than [`MOST_CHANGES`].
    #[must_use]
    pub fn with_change(mut self, lead: f64, growth: f64, c0: f64, dc: f64) -> PassLaw {
        let turns_per_s = self.deg_per_s / 360.0;
        let law =
            LeadChange::new(lead * turns_per_s, growth * turns_per_s * turns_per_s, dc / self.deg_per_s);
        let (Some(run_in), Some(brake)) = (self.run_in, self.brake) else {
            panic!("a lead has to be there before it changes");
        };
        let (changes, count) = &mut self.changes;
        changes[*count] = Begins { c: c0, law };
        *count += 1;
        let leaves = Sample { a: 0.0, ..self.led(&run_in, brake.c) };
        self.braked_from = leaves.s;
        let (duration, lambda) = (brake.law.duration(), brake.law.lambda());
        self.brake = Some(Begins { c: brake.c, law: Ramp::new(leaves.v, duration, lambda) });
        self
    }

    /// The changes of lead.
    fn changes(&self) -> impl Iterator<Item = &Begins<LeadChange>> {
        self.changes.0.iter().take(self.changes.1)
    }

    /// The run-in with what has changed since, at an angle.
    fn led(&self, run_in: &Begins<Ramp>, c: f64) -> Sample {
        let since = |begins: f64| (c - begins) / self.deg_per_s;
        let led = run_in.law.at(since(run_in.c));
        self.changes().fold(led, |led, change| led + change.law.at(since(change.c)))
    }

    /// Adds the retract: a stroke in mm made over `dc` degrees from angle `c0` (M2).
    pub fn with_retract(mut self, length: f64, c0: f64, dc: f64) -> PassLaw {
        self.retract = Some(Begins { c: c0, law: Stroke::new(length, dc / self.deg_per_s) });
        self
    }

    /// The law at angle `c`, relative to the start of the pass; derivatives by time at programmed speed.
    pub fn at(&self, c: f64) -> Sample {
        let mut x = Sample::default();
        for part in self.approach.iter().chain(&self.unloading) {
            x = x + part.law.at((c - part.c) / self.deg_per_s);
        }
        if let (Some(run_in), Some(brake)) = (&self.run_in, &self.brake) {
            x = x + if c < brake.c {
                self.led(run_in, c)
            } else {
                let mut leaving = brake.law.braking_at((c - brake.c) / self.deg_per_s);
                leaving.s += self.braked_from;
                leaving
            };
        }
        if let Some(part) = &self.retract {
            x = x + part.law.at((c - part.c) / self.deg_per_s);
        }
        x
    }

    /// Bounds of the derivatives at programmed speed: within the run-in, in the thread, and within the
    /// run-out, where parts that overlap add up, whichever is greatest.
    pub fn peak(&self) -> Limits {
        let stroke = |part: &Option<Begins<Stroke>>| part.as_ref().map_or(ZERO, |part| part.law.peak());
        let ramp = |part: &Option<Begins<Ramp>>| part.as_ref().map_or(ZERO, |part| part.law.peak());
        let enter = sum(most(stroke(&self.approach), stroke(&self.unloading)), ramp(&self.run_in));
        let leave = sum(stroke(&self.retract), ramp(&self.brake));
        if self.changes.1 == 0 {
            return most(enter, leave);
        }
        self.peak_with_changes(enter, leave)
    }

    /// The same of a lead that changes. A change adds to the run-in and to the run-out as far as its window
    /// reaches into them; between windows the speed is at its highest at their ends.
    fn peak_with_changes(&self, mut enter: Limits, mut leave: Limits) -> Limits {
        let over = |part: &Option<Begins<Stroke>>| part.map(|part| self.end(part.c, part.law.duration()));
        let run_in = self.run_in.map(|part| self.end(part.c, part.law.duration()));
        let entered = [over(&self.approach), over(&self.unloading), run_in];
        let entered = entered.into_iter().flatten().fold(0.0, f64::max);
        let begins = [self.retract.map(|part| part.c), self.brake.map(|part| part.c)];
        let left = begins.into_iter().flatten().fold(f64::INFINITY, f64::min);
        let braked = self.brake.map_or(0.0, |part| part.law.dv().abs());
        let mut between = ZERO;
        let mut lead = Sample { v: self.run_in.map_or(0.0, |part| part.law.dv()), ..Sample::default() };
        let mut at = entered;
        for Begins { c, law } in self.changes() {
            let (own, end) = (law.peak(), self.end(*c, law.duration()));
            let (bound, next) = about(&lead, (c - at).max(0.0) / self.deg_per_s, law);
            between = most(between, bound);
            if *c < entered {
                enter = sum(enter, own);
            }
            if end > left {
                leave = sum(leave, Limits { v: (bound.v - braked).max(0.0), ..bound });
            }
            (lead, at) = (next, end);
        }
        most(most(enter, leave), between)
    }

    /// Where a part of a law ends, degrees.
    fn end(&self, c: f64, duration: f64) -> f64 {
        c + duration * self.deg_per_s
    }
}

/// Bounds in the window of a change of lead that begins `after` s behind a moment with speed and acceleration
/// `lead`, and both at its end.
fn about(lead: &Sample, after: f64, change: &LeadChange) -> (Limits, Sample) {
    // What rounds off a corner of the speed lies between its sides and this beside it.
    const BESIDE: f64 = 0.1;
    let (own, half) = (change.peak(), 0.5 * change.duration());
    let begins = lead.v + lead.a * after;
    let corner = begins + lead.a * half;
    let behind = corner + change.dv();
    let a = lead.a + change.da();
    let ends = behind + a * half;
    let fastest = [begins, corner, behind, ends].into_iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let beside = BESIDE * change.da().abs() * change.duration();
    let bound = Limits { v: fastest + beside, a: own.a + lead.a.abs(), ..own };
    (bound, Sample { v: ends, a, ..Sample::default() })
}

const ZERO: Limits = Limits { v: 0.0, a: 0.0, j: 0.0, dj: 0.0 };

/// Bounds of what adds up.
fn sum(a: Limits, b: Limits) -> Limits {
    Limits { v: a.v + b.v, a: a.a + b.a, j: a.j + b.j, dj: a.dj + b.dj }
}

/// The greater bounds.
fn most(a: Limits, b: Limits) -> Limits {
    Limits { v: a.v.max(b.v), a: a.a.max(b.a), j: a.j.max(b.j), dj: a.dj.max(b.dj) }
}

/// The spindle angles over which a lead is reached or left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Where it begins, degrees.
    pub c: f64,
    /// How long it is, degrees.
    pub dc: f64,
    /// λ, (0, 1/2].
    pub lambda: f64,
}
