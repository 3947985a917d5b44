//! What a tap did in its hole. In: every control cycle the true place of the slide along it, mm, the true
//! angle since the index, degrees, and the true speed, 1/min. Out: a [`TapReport`].
//!
//! The tool is in the hole from where the axis along it is on the helix. What counts is how far it strays
//! from its own mean: where along the hole the whole thread lies is given by the programmed depth.

use protocol::{Axis, Position, ThreadPass, Truth};
use serde::{Deserialize, Serialize};

use super::helix::Helix;
use super::span::Span;

/// The spindle turns round below this share of its programmed speed.
const TURNS_SHARE: f64 = 0.1;
/// A tap that was so near to its depth has been there, degrees of the spindle.
const REACHED_DEG: f64 = 30.0;

/// A tap, in and out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TapReport {
    /// Farthest off the mean of the helix on the way in, µm.
    pub in_um: f64,
    /// While the spindle turned round, below a tenth of its speed, µm.
    pub turn_um: f64,
    /// On the way out, µm.
    pub out_um: f64,
    /// How much less deep than programmed the tool was, µm; negative if deeper.
    pub short_um: f64,
    /// Speed of the way out, as a multiple of S.
    pub return_ratio: f64,
}

/// Watches one tap.
#[derive(Clone)]
pub(super) struct Tapped {
    pass: ThreadPass,
    along: Axis,
    helix: Helix,
    /// In, about the turn, out.
    parts: [Span; 3],
    sum: (f64, f64),
    farthest_deg: f64,
    deepest_mm: Option<f64>,
    before_deg: Option<f64>,
}

impl Tapped {
    /// Of a pass that returns.
    pub(super) fn of(pass: &ThreadPass) -> Option<Tapped> {
        let along = pass.along();
        pass.returns().then(|| Tapped {
            pass: *pass,
            along,
            helix: Helix::of(pass, along),
            parts: [Span::default(); 3],
            sum: (0.0, 0.0),
            farthest_deg: 0.0,
            deepest_mm: None,
            before_deg: None,
        })
    }

    /// Takes a control cycle behind the index of the pass.
    pub(super) fn cycle(&mut self, c_deg: f64, truth: &Truth) {
        let turned_deg = (c_deg - self.before_deg.replace(c_deg).unwrap_or(c_deg)).abs();
        let slide_mm = truth.axes[self.along.index()].slide_mm;
        self.farthest_deg = self.farthest_deg.max(c_deg);
        if self.pass.out.is_free(Position::from_mm(slide_mm)) {
            return;
        }
        let inwards = self.pass.lead_mm.signum();
        let deepest = self
            .deepest_mm
            .map_or(slide_mm, |mm| if (slide_mm - mm) * inwards > 0.0 { slide_mm } else { mm });
        self.deepest_mm = Some(deepest);
        let e = self.helix.error_um(c_deg, slide_mm);
        let rpm = truth.spindle_rpm * self.pass.direction;
        let part = match rpm {
            rpm if rpm.abs() < TURNS_SHARE * self.pass.s_rpm => 1,
            rpm if rpm > 0.0 => 0,
            _ => 2,
        };
        self.parts[part].add(e);
        self.sum = (self.sum.0 + turned_deg, self.sum.1 + turned_deg * e);
    }

    /// Whether the tool was at its depth.
    pub(super) fn was_at_depth(&self) -> bool {
        self.farthest_deg >= self.pass.thread_end_deg - REACHED_DEG
    }

    pub(super) fn report(&self) -> TapReport {
        let mean = if self.sum.0 > 0.0 { self.sum.1 / self.sum.0 } else { 0.0 };
        let off =
            |span: &Span| span.seen().map_or(0.0, |(low, high)| (high - mean).abs().max((low - mean).abs()));
        let [in_um, turn_um, out_um] = [&self.parts[0], &self.parts[1], &self.parts[2]].map(off);
        let law = self.pass.axis(self.along);
        let middle = law.run_in_c0_deg + 0.5 * law.run_in_dc_deg;
        let depth_mm = law.start.mm() + law.lead_mm * (self.pass.thread_end_deg - middle) / 360.0;
        let short_mm = self.deepest_mm.map_or(0.0, |mm| (depth_mm - mm) * law.lead_mm.signum());
        TapReport { in_um, turn_um, out_um, short_um: 1e3 * short_mm, return_ratio: self.pass.return_ratio }
    }
}
