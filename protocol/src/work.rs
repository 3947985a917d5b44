//! Work that machine code carries as a formula and a pass instead of points: a contour, a surface, a seam.
//!
//! The formulas come before it ([`Code::Formula`](crate::Code::Formula)); the interpolator makes the motion
//! of it.

use serde::{Deserialize, Serialize};
use shape::{Contour, Correction, Meeting, Pattern, Seam, SeamCurve, Surface, Tool};

use crate::{
    refused::{Refused, finite, not_negative, positive},
    units::{Axis, Position},
};

/// Formulas that work may refer to, by their number.
pub const FORMULAS: usize = 6;

/// What is followed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[allow(clippy::large_enum_variant)] // fixed size is the point: the queue holds it by value
pub enum Shape {
    /// A contour in the plane of two axes: master, follower.
    Contour(Contour, [Axis; 2]),
    /// A surface under a tool, on X, Y, Z.
    Surface(Surface),
    /// A seam, on the axes of a positioner.
    Seam(Seam),
}

/// Work to be done from where it begins; the axes rest there when it is reached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Work {
    /// What.
    pub shape: Shape,
    /// Machine position of the zero of the formulas on X, Y, Z (of a contour: on master and follower). Not of
    /// a seam, whose frame is that of the work-holder.
    pub origin: [Position; 3],
    /// Feed along the path of the tool, or of the beam on the part, mm/min.
    pub feed_mm_min: f64,
    /// Largest chord error of an interpolator cycle, mm.
    pub chord_mm: f64,
    /// How followers are led; a seam is followed exactly.
    pub correction: Correction,
}

impl Work {
    /// What a work counts in the progress of a program.
    pub const STEPS: u64 = 1000;
    /// Longest way of a formula, mm or units of its parameter, either side of 0.
    const FAR: f64 = 1e6;
    /// Smallest and largest chord error, mm: as in jobs and machine files.
    pub const CHORD_MM: [f64; 2] = [1e-6, 1.0];
    /// Unit vectors are of length 1, and perpendicular to each other, so nearly.
    const UNIT: f64 = 1e-9;
    /// Most paths over a surface.
    const MOST_PATHS: u32 = 1_000_000;

    /// Refuses what no interpreter sends. Whether the formulas exist and where they lead is seen where it
    /// begins.
    ///
    /// # Errors
    /// Names the field.
    pub fn check(&self) -> Result<(), Refused> {
        positive(self.feed_mm_min, "feed")?;
        let [least, most] = Work::CHORD_MM;
        if !(least..=most).contains(&finite(self.chord_mm, "chord error")?) {
            return Err(Refused::OutOfRange("chord error"));
        }
        match &self.shape {
            Shape::Contour(contour, [master, follower]) => {
                range(&contour.x, "domain of a contour")?;
                not_negative(contour.radius_mm, "radius of a tool")?;
                let plane = master != follower && !master.is_rotary() && !follower.is_rotary();
                if plane { Ok(()) } else { Err(Refused::OutOfRange("axes of a contour")) }
            }
            Shape::Surface(surface) => check_surface(surface),
            Shape::Seam(_) if self.correction != Correction::Exact => {
                Err(Refused::OutOfRange("correction of a seam"))
            }
            Shape::Seam(seam) => {
                range(&seam.t, "domain of a seam")?;
                finite(seam.idle_beta_deg, "seam")?;
                all_finite(seam.moved.as_ref().map_or(&[], |moved| &moved[..]))?;
                match &seam.curve {
                    SeamCurve::Formulas => Ok(()),
                    SeamCurve::Polynomials(coefficients) => all_finite(coefficients.as_flattened()),
                    SeamCurve::Meeting(meeting) => check_meeting(meeting),
                }
            }
        }
    }

    /// The chord error that steps may have if what their correction leaves shall stay within `chord_mm`
    /// (M44), mm. The chord of an exact step l is off by l²/8R. A step along the tangent ends off by l²/2R,
    /// and so may one without the mixed term; with the signs of a surface as printed, by l²/R. What the
    /// others leave at their end is of third order.
    pub fn chord_of_steps(&self) -> f64 {
        let on_surface = matches!(self.shape, Shape::Surface(_));
        let times = match self.correction {
            Correction::None => 4.0,
            Correction::Published if on_surface => 8.0,
            Correction::PublishedSigns if on_surface => 4.0,
            _ => 1.0,
        };
        self.chord_mm / times
    }
}

fn all_finite(numbers: &[f64]) -> Result<(), Refused> {
    numbers.iter().try_for_each(|one| finite(*one, "seam").map(|_| ()))
}

fn check_meeting(Meeting { first, second, share, .. }: &Meeting) -> Result<(), Refused> {
    for vector in [first.at, first.axis, first.zero, second.at, second.axis] {
        all_finite(&vector)?;
    }
    all_finite(&second.c)?;
    all_finite(&[first.radius_mm, first.slope, *share])?;
    let product = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let units = [&first.axis, &first.zero, &second.axis];
    let lengths = units.iter().all(|unit| (product(unit, unit) - 1.0).abs() <= 2.0 * Work::UNIT);
    if lengths && product(&first.axis, &first.zero).abs() <= Work::UNIT {
        Ok(())
    } else {
        Err(Refused::OutOfRange("axes of a seam"))
    }
}

fn check_surface(surface: &Surface) -> Result<(), Refused> {
    let sides = [surface.x, surface.y];
    for side in &sides {
        range(side, "domain of a surface")?;
        if side[0] >= side[1] {
            return Err(Refused::OutOfRange("domain of a surface"));
        }
    }
    let Tool { radius_mm, corner_mm } = surface.tool;
    positive(radius_mm, "radius of a tool")?;
    if not_negative(corner_mm, "corner of a tool").map(|()| corner_mm > radius_mm)? {
        return Err(Refused::OutOfRange("corner of a tool"));
    }
    finite(surface.clear_mm, "clearance")?;
    let (paths, least) = match surface.pattern {
        Pattern::Lines { count, .. } => (count, 2),
        Pattern::Rings { count } => (count, 1),
        Pattern::Curve { t } => return range(&t, "domain of a curve"),
    };
    let is_good = (least..=Work::MOST_PATHS).contains(&paths);
    if is_good { Ok(()) } else { Err(Refused::OutOfRange("number of paths")) }
}

/// Refuses a way that is none, or leads too far.
fn range(range: &[f64; 2], name: &'static str) -> Result<(), Refused> {
    let near = |end: f64| finite(end, name).map(|end| end.abs() <= Work::FAR);
    if near(range[0])? && near(range[1])? && range[0] != range[1] {
        Ok(())
    } else {
        Err(Refused::OutOfRange(name))
    }
}
