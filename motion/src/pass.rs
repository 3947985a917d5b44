//! What one axis does in a threading pass, as a function of the spindle angle: a stroke in (M2), perhaps a
//! little too far and back (M132), a ramp onto
//! its lead (M13), the lead (M14), a brake (M15), a stroke out (M2); parts may overlap and add up.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | c | deg | spindle angle since the index, growing in the direction of the spindle |
//! | S | 1/min | programmed spindle speed |
//! | p | s | (c - c0) / (6 S), time at programmed speed (M1) |
//! | x | mm | position relative to the start of the pass; v, a, j, dj its derivatives by p |

use crate::{Limits, Ramp, Sample, Stroke};

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
                run_in.law.at((c - run_in.c) / self.deg_per_s)
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

    /// Bounds of the derivatives at programmed speed: within the run-in and within the run-out, where parts
    /// that overlap add up, whichever is greater.
    pub fn peak(&self) -> Limits {
        let zero = Limits { v: 0.0, a: 0.0, j: 0.0, dj: 0.0 };
        let stroke = |part: &Option<Begins<Stroke>>| part.as_ref().map_or(zero, |part| part.law.peak());
        let ramp = |part: &Option<Begins<Ramp>>| part.as_ref().map_or(zero, |part| part.law.peak());
        let sum = |a: Limits, b: Limits| Limits { v: a.v + b.v, a: a.a + b.a, j: a.j + b.j, dj: a.dj + b.dj };
        let most = |a: Limits, b: Limits| Limits {
            v: a.v.max(b.v),
            a: a.a.max(b.a),
            j: a.j.max(b.j),
            dj: a.dj.max(b.dj),
        };
        let enter = sum(most(stroke(&self.approach), stroke(&self.unloading)), ramp(&self.run_in));
        let leave = sum(stroke(&self.retract), ramp(&self.brake));
        most(enter, leave)
    }
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
