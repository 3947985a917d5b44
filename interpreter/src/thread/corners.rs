//! The windows over which the lead of a chain changes. In: its corners, limits, the speed that they are laid
//! out for. Out: windows of spindle angle, deg from the start point of the helix; which corner has no room.
//!
//! ```text
//! ΔC = q T, T the shortest of M216 on either axis;  from c − ΔC/2 to c + ΔC/2, c the corner
//! a lead that grows from the start: over the run-in
//! a lead that still grows at the end: it stops to in front of the brake, so that this ends where it should,
//!   u = 2 F h/(F + G h + √(F² + G² h²)) turns before the end, h = (ΔC + ΔC_brake)/720,
//!   with the lead F and its growth G at the end                                                     (M221)
//! ```

use motion::{LeadChange, Limits, MOST_CHANGES};
use protocol::{Corner, Corners};

use super::cut::{Along, Cut, Point};
use super::refusal::Refusal;

/// What corners are rounded with.
pub(super) struct Rounds {
    /// Spindle angle per second, deg/s.
    pub(super) q: f64,
    /// Speed of the spindle that this is, 1/s.
    pub(super) turns_per_s: f64,
    /// What the axis across and the axis along may use.
    pub(super) limits: [Limits; 2],
    /// Narrowest window, degrees.
    pub(super) least_deg: f64,
}

/// A corner over its window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rounded {
    /// Where the window begins and how wide it is, degrees from the start point.
    pub(super) c: f64,
    pub(super) dc: f64,
    pub(super) lead: Point,
    pub(super) growth: Point,
}

impl Rounded {
    pub(super) fn end(&self) -> f64 {
        self.c + self.dc
    }
}

/// Corners in their order.
pub(super) struct Windows {
    all: [Option<Rounded>; MOST_CHANGES],
}

impl Rounds {
    /// The narrowest window of a change, degrees.
    pub(super) fn window(&self, along: Along, lead: Point, growth: Point) -> f64 {
        let of = |axis: fn(Along, Point) -> f64, limits: &Limits| {
            let (dv, da) = (axis(along, lead), axis(along, growth));
            let (v, a) = (dv * self.turns_per_s, da * self.turns_per_s * self.turns_per_s);
            LeadChange::shortest(v, a, limits)
        };
        let longest = of(Along::across, &self.limits[0]).max(of(Along::of, &self.limits[1]));
        (self.q * longest).max(self.least_deg)
    }
}

impl Windows {
    /// Those of a cut whose run-in takes so many degrees.
    pub(super) fn of(cut: &Cut, rounds: &Rounds, run_in_dc: f64) -> Windows {
        let mut all = [None; MOST_CHANGES];
        for (window, bend) in all.iter_mut().zip(cut.chain.bends()) {
            let dc = match bend.c_deg {
                0.0 => run_in_dc,
                _ => rounds.window(cut.along, bend.lead, bend.growth),
            };
            let c = bend.c_deg - 0.5 * dc;
            *window = Some(Rounded { c, dc, lead: bend.lead, growth: bend.growth });
        }
        Windows { all }
    }

    /// Adds where the lead stops to grow: in a window that ends at `end`, degrees.
    pub(super) fn stop_growing(&mut self, growth: Point, end: f64, dc: f64) {
        let stops = Point { x: -growth.x, z: -growth.z };
        let window = Rounded { c: end - dc, dc, lead: Point::default(), growth: stops };
        // There is room: the chain has seen to that.
        if let Some(free) = self.all.iter_mut().find(|window| window.is_none()) {
            *free = Some(window);
        }
    }

    fn iter(&self) -> impl Iterator<Item = &Rounded> {
        self.all.iter().flatten()
    }

    /// Whether every window has room behind the run-in, before the next one, and before the thread ends.
    ///
    /// # Errors
    /// The first that has not.
    pub(super) fn check(&self, cut: &Cut, locked: f64, thread_end: f64) -> Result<(), Refusal> {
        let count = cut.chain.bends().len();
        let corners = || self.iter().take(count);
        let behind = corners().skip(1).map(|next| next.c).chain([thread_end]);
        let mut from = locked;
        for (number, (window, until)) in corners().zip(behind).enumerate() {
            let (line, corner) = (self.line(cut, number), window.c + 0.5 * window.dc);
            let grows_from_the_start = corner == 0.0;
            if !grows_from_the_start && window.c < from || window.end() > until {
                let room = if grows_from_the_start { until } else { (corner - from).min(until - corner) };
                let [needs_mm, has_mm] = [window.dc, 2.0 * room.max(0.0)].map(|dc| {
                    let from = cut.gone_mm(corner - 0.5 * dc);
                    cut.gone_mm(corner + 0.5 * dc) - from
                });
                let in_arc = cut.chain.bends().get(number).is_some_and(|bend| bend.within);
                return Err(Refusal::Corner { line, in_arc, needs_deg: window.dc, needs_mm, has_mm });
            }
            from = from.max(window.end());
        }
        Ok(())
    }

    fn line(&self, cut: &Cut, number: usize) -> u32 {
        let bends = cut.chain.bends();
        bends.get(number).or(bends.last()).map_or(0, |bend| bend.line)
    }

    /// Corners of the pass, `turn` degrees from its index to the start point.
    pub(super) fn corners(&self, turn: f64) -> Corners {
        let mut corners = Corners::default();
        for (corner, window) in corners.iter_mut().zip(self.iter()) {
            let Rounded { c, dc, lead, growth } = *window;
            let (c_deg, dc_deg) = (c + turn, dc);
            *corner = Corner { c_deg, dc_deg, x_mm: [lead.x, growth.x], z_mm: [lead.z, growth.z] };
        }
        corners
    }
}

/// How many turns before its end a lead stops to grow (M221): `lead` and `growth` at the end, the windows of
/// the stop and of the brake, degrees.
pub(super) fn stops_before(lead: f64, growth: f64, stop_dc: f64, brake_dc: f64) -> f64 {
    let h = (stop_dc + brake_dc) / 720.0;
    2.0 * lead * h / (lead + growth * h + libm::hypot(lead, growth * h))
}
