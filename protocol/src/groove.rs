//! The groove that a pass cuts, told to the plant: a simulated machine has no stock, so the program says
//! where the surface is that the tool goes into. No controller reads it.
//!
//! ```text
//! crest(z) = crest_mm + slope z,    depth of a tool at (x, z) = into (x − crest(z))
//! ```

use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::{
    pass::ThreadPass,
    refused::{Refused, finite},
    units::Axis,
};

/// Which groove is being cut, and the surface it is cut into; all zero if none is.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct Groove {
    /// Which start of a multi-start thread, from 0.
    pub start: u32,
    /// Zero.
    pub reserved: u32,
    /// Advance of Z per revolution, mm, signed by the direction of motion.
    pub lead_mm: f64,
    /// Radius of the crest where Z of the machine is 0, mm.
    pub crest_mm: f64,
    /// Growth of that radius along Z; 0 on a cylinder.
    pub slope: f64,
    /// Direction of X into the material: -1 outside, +1 inside a bore; 0 if nothing is cut.
    pub into: f64,
}

impl Groove {
    /// The groove of a pass. A pass that does not know its depth (G33), that goes neither in nor out, or that
    /// does not run along Z has none.
    pub fn of(pass: &ThreadPass) -> Groove {
        let (x, z) = (pass.axis(Axis::X), pass.axis(Axis::Z));
        let inwards = if x.stroke_mm != 0.0 { x.stroke_mm } else { -x.retract_mm };
        if !(pass.depth_mm > 0.0 && inwards != 0.0 && z.lead_mm != 0.0) {
            return Groove::default();
        }
        let into = inwards.signum();
        let slope = x.lead_mm / z.lead_mm;
        // The prolonged helix goes through the start point of Z with X at depth.
        let crest_at_start = x.start.mm() + x.stroke_mm - into * pass.depth_mm;
        Groove {
            start: pass.start,
            reserved: 0,
            lead_mm: z.lead_mm,
            crest_mm: crest_at_start - slope * (z.start.mm() + z.stroke_mm),
            slope,
            into,
        }
    }

    /// How far a tool reaches in the direction into the material, with the cone taken off, mm: the same along
    /// a thread of one depth.
    pub fn reach_mm(&self, x_mm: f64, z_mm: f64) -> f64 {
        self.into * (x_mm - self.slope * z_mm)
    }

    /// Depth of a tool below the crest, mm; negative outside the material.
    pub fn depth_mm(&self, x_mm: f64, z_mm: f64) -> f64 {
        self.reach_mm(x_mm, z_mm) - self.into * self.crest_mm
    }

    /// Refuses a groove with numbers that are none.
    ///
    /// # Errors
    /// [`Refused::NotFinite`], [`Refused::OutOfRange`] for a direction other than -1, 0 or 1.
    pub fn check(&self) -> Result<(), Refused> {
        finite(self.lead_mm, "lead of the groove")?;
        finite(self.crest_mm, "crest of the groove")?;
        finite(self.slope, "slope of the groove")?;
        if [-1.0, 0.0, 1.0].contains(&self.into) {
            Ok(())
        } else {
            Err(Refused::OutOfRange("direction into"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{pass::AxisLaw, units::Position};

    /// A pass 0.4 mm deep from X 12, Z 5 along -Z.
    fn pass(stroke_mm: f64, retract_mm: f64, lead_x: f64) -> ThreadPass {
        let mut pass = ThreadPass { start: 2, depth_mm: 0.4, ..ThreadPass::default() };
        let start = Position::from_mm(12.0);
        pass.axes[Axis::X.index()] =
            AxisLaw { start, stroke_mm, retract_mm, lead_mm: lead_x, ..AxisLaw::default() };
        pass.axes[Axis::Z.index()] =
            AxisLaw { start: Position::from_mm(5.0), lead_mm: -2.0, ..AxisLaw::default() };
        pass
    }

    #[test]
    fn the_tool_at_depth_is_as_deep_as_the_pass_says() {
        for (stroke, lead_x) in [(-1.4, 0.0), (1.4, 0.0), (-1.4, 0.0625), (1.4, -0.0625)] {
            let groove = Groove::of(&pass(stroke, -stroke, lead_x));
            assert_eq!((groove.start, groove.into), (2, f64::signum(stroke)));
            for turns in [0.0, 3.0, 7.5] {
                let (x, z) = (12.0 + stroke + turns * lead_x, 5.0 - 2.0 * turns);
                assert!((groove.depth_mm(x, z) - 0.4).abs() < 1e-12, "{groove:?} after {turns} turns");
                assert!((groove.depth_mm(x - stroke, z) + 1.0).abs() < 1e-12, "the way back is out");
            }
            assert!(groove.check().is_ok());
        }
    }

    #[test]
    fn a_tool_that_stands_at_depth_is_known_by_its_way_out() {
        let groove = Groove::of(&pass(0.0, 2.0, 0.0));
        assert_eq!(groove.into, -1.0);
        assert!((groove.depth_mm(12.0, 0.0) - 0.4).abs() < 1e-12);
    }

    #[test]
    fn what_does_not_say_where_the_crest_is_has_no_groove() {
        let known = pass(-1.4, 1.4, 0.0);
        for depth_mm in [0.0, -1.0, f64::NAN] {
            assert_eq!(Groove::of(&ThreadPass { depth_mm, ..known }), Groove::default());
        }
        assert_eq!(Groove::of(&pass(0.0, 0.0, 0.0)), Groove::default());
        let mut along_x = known;
        along_x.axes[Axis::Z.index()].lead_mm = 0.0;
        assert_eq!(Groove::of(&along_x), Groove::default());
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        let groove = Groove::of(&pass(-1.4, 1.4, 0.0));
        assert!(Groove { crest_mm: f64::NAN, ..groove }.check().is_err());
        assert!(Groove { into: 0.5, ..groove }.check().is_err());
        assert!(Groove::default().check().is_ok());
    }
}
