//! Changes of lead in a pass: corners where one thread follows another, and leads that grow. In: corners of a
//! pass, mm/rev, degrees since its index. Out: what they are to one axis; refusals.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | c, dc | deg | where the window of a change begins; how wide it is, the corner lies in its middle |
//! | L | mm/rev | by how much the lead jumps there, signed |
//! | G | mm/rev² | by how much its growth in a turn does |
//!
//! ```text
//! (M217) lead of an axis behind corners c₁ … cₙ:  F + Σ Lᵢ + Σ Gᵢ (C − cᵢ)/360
//! ```

use motion::MOST_CHANGES;
use zerocopy::{FromBytes, Immutable, IntoBytes};

use super::AxisLaw;
use crate::{
    refused::{Refused, finite},
    units::Axis,
};

/// A change of the lead of one axis, over a window of angle about a corner (M214).
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct LeadChange {
    /// Angle at which it begins.
    pub c_deg: f64,
    /// Angle over which it is made; 0 of a change that there is not.
    pub dc_deg: f64,
    /// Signed jump of the lead, mm/rev.
    pub lead_mm: f64,
    /// Signed jump of what the lead grows by in a turn, mm/rev².
    pub growth_mm: f64,
}

/// The changes of the lead of one axis, in their order; those that there are not stand behind.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct Changes(pub [LeadChange; MOST_CHANGES]);

/// A corner of a pass: both axes change their leads over one window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Corner {
    /// Angle at which the change begins.
    pub c_deg: f64,
    /// Angle over which it is made; 0 of a corner that there is not.
    pub dc_deg: f64,
    /// Jump of the lead of X, mm/rev, and of its growth, mm/rev².
    pub x_mm: [f64; 2],
    /// The same of Z.
    pub z_mm: [f64; 2],
}

/// The corners of a pass, in their order; those that there are not stand behind.
pub type Corners = [Corner; MOST_CHANGES];

impl LeadChange {
    /// Where the corner lies, degrees.
    pub fn corner_deg(&self) -> f64 {
        self.c_deg + 0.5 * self.dc_deg
    }
}

impl Corner {
    /// What it is to an axis; no axis but X and Z has a lead that changes.
    fn of(&self, axis: Axis) -> LeadChange {
        let [lead_mm, growth_mm] = match axis {
            Axis::X => self.x_mm,
            Axis::Z => self.z_mm,
            _ => return LeadChange::default(),
        };
        LeadChange { c_deg: self.c_deg, dc_deg: self.dc_deg, lead_mm, growth_mm }
    }
}

impl Changes {
    /// Those of an axis in a pass with corners.
    pub fn of(corners: &Corners, axis: Axis) -> Changes {
        Changes(corners.map(|corner| corner.of(axis)))
    }

    /// The changes that there are.
    pub fn iter(&self) -> impl Iterator<Item = &LeadChange> {
        self.0.iter().take_while(|change| change.dc_deg != 0.0)
    }

    /// Way that the changes made add up to an angle, mm, as the law rounds their corners (M214).
    pub fn way_mm(&self, c_deg: f64) -> f64 {
        let way = |change: &LeadChange| {
            let turns = change.dc_deg / 360.0;
            let law = motion::LeadChange::new(change.lead_mm, change.growth_mm, turns);
            law.at((c_deg - change.c_deg) / 360.0).s
        };
        self.iter().map(way).sum()
    }

    /// The same with sharp corners, as they are programmed.
    pub fn programmed_mm(&self, c_deg: f64) -> f64 {
        let way = |change: &LeadChange| {
            let turns = ((c_deg - change.corner_deg()) / 360.0).max(0.0);
            (change.lead_mm + 0.5 * change.growth_mm * turns) * turns
        };
        self.iter().map(way).sum()
    }

    /// Largest magnitude of the lead of an axis that begins with `lead_mm`, whose run-in ends at `locked_deg`
    /// (M217), mm/rev; 0 if it never changes.
    pub fn steepest_mm(&self, lead_mm: f64, locked_deg: f64) -> f64 {
        if self.iter().all(|change| (change.lead_mm, change.growth_mm) == (0.0, 0.0)) {
            return 0.0;
        }
        let (mut lead, mut growth, mut at, mut most) = (lead_mm, 0.0, locked_deg, lead_mm.abs());
        for change in self.iter() {
            let half = change.dc_deg / 720.0;
            let begins = lead + growth * (change.c_deg - at).max(0.0) / 360.0;
            let corner = begins + growth * half;
            growth += change.growth_mm;
            lead = corner + change.lead_mm + growth * half;
            at = change.c_deg + change.dc_deg;
            let leads = [begins, corner, corner + change.lead_mm, lead];
            most = leads.into_iter().fold(most, |most, lead| most.max(lead.abs()));
        }
        most
    }

    /// Refuses changes that no regulator could follow with a law.
    ///
    /// # Errors
    /// Names the first field that is not finite or out of range, or that the law contradicts.
    pub(crate) fn check(&self, law: &AxisLaw) -> Result<(), Refused> {
        const MM: f64 = 1e5;
        const NARROWEST_DEG: f64 = 1e-6;
        const SAME: f64 = 1e-9;
        let (mut from, mut growth) = (law.run_in_c0_deg, 0.0);
        for change in self.iter() {
            let (c, dc) = (finite(change.c_deg, "corner")?, finite(change.dc_deg, "corner")?);
            if c < from || dc < NARROWEST_DEG || law.is_led() && c + dc > law.brake_c_deg {
                return Err(Refused::OutOfRange("corner"));
            }
            for value in [change.lead_mm, change.growth_mm] {
                if finite(value, "change of lead")?.abs() > MM {
                    return Err(Refused::OutOfRange("change of lead"));
                }
            }
            growth += change.growth_mm;
            from = c + dc;
        }
        let there = self.iter().count();
        if self.0[there..].iter().any(|change| *change != LeadChange::default()) {
            return Err(Refused::OutOfRange("corner"));
        }
        // A brake leaves a lead that is constant.
        if growth.abs() > SAME {
            return Err(Refused::OutOfRange("growth of the lead"));
        }
        let locked_deg = law.run_in_c0_deg + law.run_in_dc_deg;
        let steepest = self.steepest_mm(law.lead_mm, locked_deg);
        let same = (steepest - law.steepest_mm).abs() <= SAME * steepest.abs();
        if same && steepest <= MM { Ok(()) } else { Err(Refused::OutOfRange("steepest lead")) }
    }
}
