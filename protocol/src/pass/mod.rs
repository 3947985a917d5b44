//! A threading pass as one packet: S, C0, ΔC, ΔZ, ΔX of the run-in, the angle where the thread ends, and the
//! same for the run-out. It travels whole, before anything moves (self-contained rule).
//!
//! Angles in degrees of the spindle since the index the pass starts from, growing in the direction of the
//! spindle; lengths in mm; S in 1/min.

mod changes;
mod stored;
mod way_out;

pub use changes::{Changes, Corner, Corners, LeadChange};
use motion::Window;
use serde::{Deserialize, Serialize};
pub use way_out::WayOut;
use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::{
    refused::{Refused, finite},
    units::{Axis, PerAxis, Position},
};

/// What one axis does in a pass, as a function of the spindle angle: a stroke in (M2), a ramp onto its lead
/// (M13), the lead (M14), a brake (M15), and a stroke out (M2). A part that does not occur has length or lead
/// 0; the retract window is given all the same, because it says how long the axis belongs to the pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct AxisLaw {
    /// Where the axis rests before the pass.
    pub start: Position,
    /// Where it rests after the pass.
    pub end: Position,
    /// ΔX: signed stroke of the approach, mm.
    pub stroke_mm: f64,
    /// Angle at which the approach begins.
    pub stroke_c0_deg: f64,
    /// Angle over which it is made, with its unloading.
    pub stroke_dc_deg: f64,
    /// How far the approach goes beyond its stroke, in its direction, and comes back: so the guide is not
    /// left loaded by its friction (M132), mm. 0 for an approach that stops at its stroke.
    pub unload_mm: f64,
    /// Angle over which it comes back, the last of the approach.
    pub unload_dc_deg: f64,
    /// Signed advance of this axis per revolution, mm: where it changes, the first.
    pub lead_mm: f64,
    /// Largest magnitude of a lead that changes, mm; 0 of one that does not.
    pub steepest_mm: f64,
    /// C0: angle at which the run-in begins.
    pub run_in_c0_deg: f64,
    /// ΔC: angle over which the lead is reached.
    pub run_in_dc_deg: f64,
    /// λ of the run-in, (0, 1/2].
    pub run_in_lambda: f64,
    /// Angle at which braking begins.
    pub brake_c_deg: f64,
    /// Angle over which the lead is left.
    pub brake_dc_deg: f64,
    /// λ of the braking, (0, 1/2].
    pub brake_lambda: f64,
    /// Signed stroke of the retract, mm.
    pub retract_mm: f64,
    /// Angle at which the retract begins.
    pub retract_c_deg: f64,
    /// Angle over which it is made.
    pub retract_dc_deg: f64,
}

impl AxisLaw {
    /// Whether the axis has a lead, from the beginning or later.
    pub fn is_led(&self) -> bool {
        self.lead_mm != 0.0 || self.steepest_mm != 0.0
    }

    /// Largest magnitude of its lead, mm.
    pub fn most_lead_mm(&self) -> f64 {
        self.lead_mm.abs().max(self.steepest_mm)
    }

    /// Angle at which the axis begins to move, degrees; 0 for an axis that has no approach and no lead.
    pub fn begins_deg(&self) -> f64 {
        match (self.stroke_mm != 0.0, self.is_led()) {
            (false, false) => 0.0,
            (true, false) => self.stroke_c0_deg,
            (false, true) => self.run_in_c0_deg,
            (true, true) => self.stroke_c0_deg.min(self.run_in_c0_deg),
        }
    }

    /// Angle at which the approach and the run-in are over, degrees.
    pub fn locked_deg(&self) -> f64 {
        let stroke = if self.stroke_mm != 0.0 { self.stroke_c0_deg + self.stroke_dc_deg } else { 0.0 };
        let run_in = if self.is_led() { self.run_in_c0_deg + self.run_in_dc_deg } else { 0.0 };
        stroke.max(run_in)
    }

    /// Angle at which the run-out of this axis begins, degrees. The retract window counts even if its stroke
    /// is 0: an axis that only holds is in the pass as long as the others.
    pub fn leaves_deg(&self) -> f64 {
        if self.is_led() { self.retract_c_deg.min(self.brake_c_deg) } else { self.retract_c_deg }
    }

    /// Angle from which the axis is at rest again, degrees.
    pub fn done_deg(&self) -> f64 {
        let brake = if self.is_led() { self.brake_c_deg + self.brake_dc_deg } else { 0.0 };
        brake.max(self.retract_c_deg + self.retract_dc_deg).max(self.locked_deg())
    }

    /// Where an axis of a pass that returns is at an angle (degrees), and whether the spindle has turned
    /// round: it goes out by the way that it came in.
    pub fn returning(&self, angle_deg: f64, turned: bool) -> Returning {
        let locked_deg = self.run_in_c0_deg + self.run_in_dc_deg;
        match angle_deg {
            c if c < self.run_in_c0_deg => Returning::AtStart,
            c if c < locked_deg && turned => Returning::RunsOut,
            c if c < locked_deg => Returning::RunsIn,
            c if c < self.brake_c_deg => Returning::OnHelix,
            _ => Returning::Beyond,
        }
    }

    /// The law as a function of the spindle angle, relative to `start`. S in 1/min.
    ///
    /// # Panics
    /// If S is not positive: check the packet first. If the lead changes: [`AxisLaw::changing`] knows how.
    pub fn law(&self, s_rpm: f64) -> motion::PassLaw {
        assert!(self.steepest_mm == 0.0, "a lead that changes is known with its changes");
        self.changing(s_rpm, &Changes::default())
    }

    /// The same with the changes of its lead.
    ///
    /// # Panics
    /// If S is not positive: check the packet first.
    pub fn changing(&self, s_rpm: f64, changes: &Changes) -> motion::PassLaw {
        let mut law = motion::PassLaw::new(s_rpm);
        if self.stroke_mm != 0.0 {
            let dc = self.stroke_dc_deg - self.unload_dc_deg;
            law = law.with_approach(self.stroke_mm + self.unload_mm, self.stroke_c0_deg, dc);
        }
        if self.unload_mm != 0.0 {
            let back = self.stroke_c0_deg + self.stroke_dc_deg - self.unload_dc_deg;
            law = law.with_unloading(-self.unload_mm, back, self.unload_dc_deg);
        }
        if self.is_led() {
            let run_in = Window { c: self.run_in_c0_deg, dc: self.run_in_dc_deg, lambda: self.run_in_lambda };
            let brake = Window { c: self.brake_c_deg, dc: self.brake_dc_deg, lambda: self.brake_lambda };
            law = law.with_lead(self.lead_mm, run_in, brake);
        }
        if self.steepest_mm != 0.0 {
            law = changes.iter().fold(law, |law, change| {
                law.with_change(change.lead_mm, change.growth_mm, change.c_deg, change.dc_deg)
            });
        }
        if self.retract_mm != 0.0 {
            law = law.with_retract(self.retract_mm, self.retract_c_deg, self.retract_dc_deg);
        }
        law
    }

    /// Refuses a law that no regulator could evaluate.
    ///
    /// # Errors
    /// Names the first field that is not finite or out of range.
    pub fn check(&self) -> Result<(), Refused> {
        const MM: f64 = 1e5;
        const DEG: f64 = 1e9;
        let lengths =
            [(self.stroke_mm, "stroke"), (self.lead_mm, "lead"), (self.retract_mm, "retract stroke")];
        for (length, name) in lengths {
            if finite(length, name)?.abs() > MM {
                return Err(Refused::OutOfRange(name));
            }
        }
        let led = if self.is_led() { 1.0 } else { 0.0 };
        if !(0.0..=MM).contains(&finite(self.steepest_mm, "steepest lead")?) {
            return Err(Refused::OutOfRange("steepest lead"));
        }
        let windows = [
            (self.stroke_mm, self.stroke_c0_deg, self.stroke_dc_deg, "approach angle"),
            (led, self.run_in_c0_deg, self.run_in_dc_deg, "run-in angle"),
            (led, self.brake_c_deg, self.brake_dc_deg, "braking angle"),
            (self.retract_mm, self.retract_c_deg, self.retract_dc_deg, "retract angle"),
        ];
        for (length, c0, dc, name) in windows {
            let (c0, dc) = (finite(c0, name)?, finite(dc, name)?);
            let shortest = if length == 0.0 { 0.0 } else { 1e-6 };
            if !(0.0..DEG).contains(&c0) || !(shortest..DEG).contains(&dc) {
                return Err(Refused::OutOfRange(name));
            }
        }
        for (lambda, name) in [(self.run_in_lambda, "run-in lambda"), (self.brake_lambda, "braking lambda")] {
            if self.is_led() && !(1e-6..=0.5).contains(&finite(lambda, name)?) {
                return Err(Refused::OutOfRange(name));
            }
        }
        let unload = (finite(self.unload_mm, "unloading")?, finite(self.unload_dc_deg, "unloading angle")?);
        if unload != (0.0, 0.0) {
            let room = 1e-6..=self.stroke_dc_deg - 1e-6;
            if self.stroke_mm * unload.0 <= 0.0 || unload.0.abs() > MM || !room.contains(&unload.1) {
                return Err(Refused::OutOfRange("unloading"));
            }
        }
        let runs = self.run_in_c0_deg + self.run_in_dc_deg;
        if self.is_led() && self.brake_c_deg < runs {
            return Err(Refused::OutOfRange("braking angle"));
        }
        Ok(())
    }
}

/// Where an axis is in a pass that returns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Returning {
    /// At rest where the pass starts and ends.
    AtStart,
    /// On its way to the lead.
    RunsIn,
    /// On the helix, inwards or outwards.
    OnHelix,
    /// Farther in than any spindle that obeys gets: the law brakes there.
    Beyond,
    /// On its way from the lead to rest, with the spindle turned round.
    RunsOut,
}

/// Refuses a programmed speed that no spindle has.
///
/// # Errors
/// S is not finite or not between 0.001 and 1,000,000 1/min, the latter excluded.
pub fn check_speed(s_rpm: f64) -> Result<(), Refused> {
    if (1e-3..1e6).contains(&finite(s_rpm, "S")?) { Ok(()) } else { Err(Refused::OutOfRange("S")) }
}

/// One pass of a thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(into = "stored::Stored", from = "stored::Stored")]
pub struct ThreadPass {
    /// Running number in the program, from 1.
    pub pass: u32,
    /// Which start of a multi-start thread, from 0.
    pub start: u32,
    /// S: programmed spindle speed, 1/min, positive. Never the actual one.
    pub s_rpm: f64,
    /// +1 for M3, -1 for M4: the direction in which C grows.
    pub direction: f64,
    /// Start angle of this start, degrees: the helix goes through the start point at this angle (mod 360).
    pub start_angle_deg: f64,
    /// Lead along the thread axis, mm/rev, signed by direction of motion.
    pub lead_mm: f64,
    /// Angle at which the thread ends: the first run-out of any axis begins; of a pass that returns, the
    /// programmed depth, which the spindle turns round at.
    pub thread_end_deg: f64,
    /// Highest actual speed as a multiple of S that every axis can follow (M7, M11).
    pub max_ratio: f64,
    /// Radial depth of this pass below the crest, mm (for display).
    pub depth_mm: f64,
    /// How the tool leaves before the end.
    pub out: WayOut,
    /// Of a pass that returns: speed of the way out as a multiple of S, 0.1 to 10; else 0.
    pub return_ratio: f64,
    /// Of a pass that returns: how long the spindle stands at the depth, s, 0 to 1000.
    pub dwell_s: f64,
    /// The law of each axis; axes that do not exist stay zero.
    pub axes: PerAxis<AxisLaw>,
    /// Where leads change.
    pub corners: Corners,
}

impl ThreadPass {
    /// The law of one axis.
    pub fn axis(&self, axis: Axis) -> &AxisLaw {
        &self.axes[axis.index()]
    }

    /// The same as a function of the spindle angle, relative to its start.
    ///
    /// # Panics
    /// If S is not positive: check the pass first.
    pub fn law(&self, axis: Axis) -> motion::PassLaw {
        self.axis(axis).changing(self.s_rpm, &self.changes(axis))
    }

    /// The changes of the lead of an axis.
    pub fn changes(&self, axis: Axis) -> Changes {
        Changes::of(&self.corners, axis)
    }

    /// The corners that there are.
    pub fn corners(&self) -> impl Iterator<Item = &Corner> {
        self.corners.iter().take_while(|corner| corner.dc_deg != 0.0)
    }

    /// The axis along which the thread runs: Z, on a cone too; X of a thread on a face, where Z lifts the
    /// tool and may follow an arc.
    pub fn along(&self) -> Axis {
        let lifts_z = self.out.axis as usize == Axis::Z.index();
        if lifts_z != self.returns() { Axis::X } else { Axis::Z }
    }

    /// Whether it is a tap: in and out again on one helix, through the reversal of the spindle.
    pub fn returns(&self) -> bool {
        self.out.on(WayOut::RETURNS)
    }

    /// Angle from which every axis is at rest again, degrees; of a pass that returns, where its law would be
    /// over if the spindle did not turn round.
    pub fn done_deg(&self) -> f64 {
        self.axes.iter().map(AxisLaw::done_deg).fold(0.0, f64::max)
    }

    /// Whether the tool cuts away from an axis of the part at `axis_x_mm`, as in a bore; `None` of a pass
    /// that moves X neither in nor out.
    pub fn cuts_outwards(&self, axis_x_mm: f64) -> Option<bool> {
        let law = self.axis(Axis::X);
        let infeed = if law.stroke_mm == 0.0 { -law.retract_mm } else { law.stroke_mm };
        let outwards = infeed * (law.start.mm() + law.stroke_mm - axis_x_mm).signum();
        (outwards != 0.0).then_some(outwards > 0.0)
    }

    /// Refuses a pass that cannot be cut.
    ///
    /// # Errors
    /// Names the first field that is not finite or out of range.
    pub fn check(&self) -> Result<(), Refused> {
        check_speed(self.s_rpm)?;
        if self.direction.abs() != 1.0 {
            return Err(Refused::OutOfRange("spindle direction"));
        }
        finite(self.start_angle_deg, "start angle")?;
        finite(self.lead_mm, "lead")?;
        finite(self.thread_end_deg, "thread end")?;
        finite(self.depth_mm, "depth")?;
        if finite(self.max_ratio, "highest ratio")? < 1.0 {
            return Err(Refused::OutOfRange("highest ratio"));
        }
        self.out.check()?;
        self.axes.iter().try_for_each(AxisLaw::check)?;
        Axis::ALL.iter().try_for_each(|axis| self.changes(*axis).check(self.axis(*axis)))?;
        self.check_return()
    }

    /// Refuses a pass that returns where its windows, its turn or its way out are none of one helix.
    fn check_return(&self) -> Result<(), Refused> {
        let (ratio, dwell) = (finite(self.return_ratio, "return")?, finite(self.dwell_s, "dwell")?);
        if !self.returns() {
            return if (ratio, dwell) == (0.0, 0.0) { Ok(()) } else { Err(Refused::OutOfRange("return")) };
        }
        let along = self.axes.iter().position(|law| law.lead_mm != 0.0).unwrap_or(crate::units::AXES);
        let Some(lead) = self.axes.get(along) else { return Err(Refused::OutOfRange("lead")) };
        let windows = |law: &AxisLaw| [law.run_in_c0_deg, law.run_in_dc_deg, law.brake_c_deg];
        let alone = self.axes.iter().enumerate().all(|(axis, law)| {
            let follows = axis == along || law.lead_mm == 0.0 && law.start == law.end;
            let apart = *law != AxisLaw::default() && windows(law) != windows(lead);
            follows && !apart && law.stroke_mm == 0.0 && law.retract_mm == 0.0
        });
        let on_helix = lead.run_in_c0_deg + lead.run_in_dc_deg..=lead.brake_c_deg;
        match () {
            () if !(0.1..=10.0).contains(&ratio) => Err(Refused::OutOfRange("speed of the way out")),
            () if self.corners().next().is_some() => Err(Refused::OutOfRange("corner")),
            () if !(0.0..=1000.0).contains(&dwell) => Err(Refused::OutOfRange("dwell")),
            () if !on_helix.contains(&self.thread_end_deg) => Err(Refused::OutOfRange("turn of the spindle")),
            () if !alone || self.out.axis as usize != along || lead.start != lead.end => {
                Err(Refused::OutOfRange("way back"))
            }
            () => Ok(()),
        }
    }
}
