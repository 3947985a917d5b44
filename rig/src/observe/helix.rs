//! How far a tool lies from the helix that the program means. In: true positions in mm and spindle angles in
//! degrees. Out: errors in µm, their mean and slope over the thread.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | C | deg | true spindle angle since the true index of the pass, growing in the direction of the pass |
//! | C_s | deg | start angle of the pass, on the turn in which the run-in has its middle (phase rule) |
//! | z_s | mm | programmed start point (plus an approach stroke along the thread, if there is one) |
//! | F | mm/rev | signed lead |
//! | e | µm | position minus helix |
//! | u | rev | turns since the first sample of the thread |
//! | w | rev | weight of a sample: the turn since the sample before it |
//!
//! ```text
//! z_helix(C) = z_s + F (C − C_s)/360       the prolonged helix goes through the programmed start point;
//!                                          where the lead changes, plus what that adds (M214)
//! phase = Σ w e / Σ w                      mean over the angle, so a spindle that dwells does not weigh more
//! slope = Σ w (u − ū)(e − ē) / Σ w (u − ū)²        least squares
//! ```

use protocol::{Axis, AxisLaw, Changes, ThreadPass};

/// The helix of one axis in one pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Helix {
    start_mm: f64,
    start_deg: f64,
    lead_mm: f64,
    changes: Changes,
}

impl Helix {
    /// The helix through the programmed start point at the programmed start angle. The law only says on which
    /// turn: a run-in whose middle misses the start angle (phase rule) shows as a phase error.
    pub(super) fn of(pass: &ThreadPass, axis: Axis) -> Helix {
        let law: &AxisLaw = pass.axis(axis);
        let middle = law.run_in_c0_deg + 0.5 * law.run_in_dc_deg;
        let turns = ((middle - pass.start_angle_deg) / 360.0).round();
        Helix {
            start_mm: law.start.mm() + law.stroke_mm,
            start_deg: pass.start_angle_deg + 360.0 * turns,
            lead_mm: law.lead_mm,
            changes: pass.changes(axis),
        }
    }

    /// Where it lies at the index, mm.
    pub(super) fn at_index_mm(&self) -> f64 {
        self.start_mm - self.lead_mm * self.start_deg / 360.0
    }

    /// Where it lies at an angle, mm.
    pub(super) fn at_mm(&self, c_deg: f64) -> f64 {
        self.start_mm + self.lead_mm * (c_deg - self.start_deg) / 360.0 + self.changes.way_mm(c_deg)
    }

    /// The same with sharp corners, mm.
    pub(super) fn programmed_mm(&self, c_deg: f64) -> f64 {
        self.start_mm + self.lead_mm * (c_deg - self.start_deg) / 360.0 + self.changes.programmed_mm(c_deg)
    }

    /// Error of a position at angle `c_deg`, µm.
    pub(super) fn error_um(&self, c_deg: f64, position_mm: f64) -> f64 {
        1e3 * (position_mm - self.at_mm(c_deg))
    }
}

/// Mean, slope and largest magnitude of an error over a thread, without keeping its samples.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LineFit {
    /// Angles of the first sample and of the sample before, degrees.
    range: Option<(f64, f64)>,
    w: f64,
    wu: f64,
    we: f64,
    wuu: f64,
    wue: f64,
    max_abs: f64,
    last: f64,
}

impl LineFit {
    /// Takes the error at an angle.
    pub(super) fn add(&mut self, c_deg: f64, e: f64) {
        self.max_abs = self.max_abs.max(e.abs());
        self.last = e;
        let (first, before) = self.range.unwrap_or((c_deg, c_deg));
        self.range = Some((first, c_deg));
        let (u, w) = ((c_deg - first) / 360.0, (c_deg - before).abs() / 360.0);
        self.w += w;
        self.wu += w * u;
        self.we += w * e;
        self.wuu += w * u * u;
        self.wue += w * u * e;
    }

    /// Largest magnitude; 0 without samples.
    pub(super) fn max_abs(&self) -> f64 {
        self.max_abs
    }

    /// Mean over the angle; the last sample if the spindle did not turn.
    pub(super) fn mean(&self) -> f64 {
        if self.w > 0.0 { self.we / self.w } else { self.last }
    }

    /// Slope per turn; 0 if the samples do not span an angle.
    pub(super) fn slope(&self) -> f64 {
        if self.w <= 0.0 {
            return 0.0;
        }
        let (mean_u, mean_e) = (self.wu / self.w, self.we / self.w);
        let (spread, common) = (self.wuu - self.wu * mean_u, self.wue - self.wu * mean_e);
        if spread > 0.0 { common / spread } else { 0.0 }
    }
}
