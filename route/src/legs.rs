//! What a work follows, leg by leg: the curve of a leg on the axes of the machine, and where it is in their
//! coordinates. In: a work, one of its legs, the formulas. Out: a curve of all axes, positions.

use machine::{Machine, POSITIONER_AXES};
use protocol::{Axis, FORMULAS, PerAxis, Position, Shape, Work, units::AXES};
use shape::{ContourCurve, Curve, Leg, Place, Plan, Point, SeamCurve, SeamPath, Series, SurfaceCurve, Touch};

use crate::{
    positioner::geometry,
    terms::{Formulas, Spot, Unworkable},
};

/// Nearer than this a place is on the path, mm.
const ON_PATH_MM: f64 = 1e-6;

/// A work as legs, and each leg as a curve on the axes of a machine.
pub(crate) trait Legs {
    /// How many legs there are.
    fn legs(&self) -> u32;

    /// Leg `k`, from 0; `None` behind the last.
    fn leg(&self, k: u32) -> Option<Leg>;

    /// The axes that follow, in the order of their curve.
    fn axes(&self) -> &[Axis];

    /// Machine Z at which a tool moves freely over a surface.
    fn clear(&self) -> Option<Position>;

    /// Where a parameter of a plan is.
    fn spot(&self, plan: &Plan, t: f64) -> Spot;

    /// The curve of a plan on the axes of the machine.
    ///
    /// # Errors
    /// [`Unworkable::NoFormula`], [`Unworkable::NoPositioner`].
    fn curve<'a>(
        &'a self,
        plan: Plan,
        formulas: &'a Formulas,
        machine: &Machine,
    ) -> Result<LegCurve<'a>, Unworkable>;

    /// Ways of the axes in a step of a plan from the exact start `from` at the parameter `t` to the exact end
    /// `to`, in the ratios of the correction (M36–M43); none where the start is not on the path.
    fn step(
        &self,
        at: (&Plan, f64),
        formulas: &Formulas,
        machine: &Machine,
        from: &PerAxis<Position>,
        to: &PerAxis<Position>,
    ) -> Option<[f64; 3]>;

    /// Where the axes stand at a point of a track; axes that do not follow it stay where they are.
    fn placed(&self, point: &PerAxis<f64>, at: PerAxis<Position>) -> PerAxis<Position>;
}

impl Legs for Work {
    fn legs(&self) -> u32 {
        if let Shape::Surface(surface) = &self.shape { surface.legs() } else { 1 }
    }

    fn leg(&self, k: u32) -> Option<Leg> {
        match &self.shape {
            Shape::Surface(surface) => surface.leg(k),
            Shape::Contour(contour, _) => (k == 0).then_some(Leg::Cut(Plan::Curve { t: contour.t() })),
            Shape::Seam(seam) => (k == 0).then_some(Leg::Cut(Plan::Curve { t: seam.t })),
        }
    }

    fn axes(&self) -> &[Axis] {
        match &self.shape {
            Shape::Contour(_, axes) => axes,
            Shape::Surface(_) => &[Axis::X, Axis::Y, Axis::Z],
            Shape::Seam(_) => &POSITIONER_AXES,
        }
    }

    fn clear(&self) -> Option<Position> {
        let Shape::Surface(surface) = &self.shape else { return None };
        self.origin.last().map(|z| z.moved(surface.clear_mm))
    }

    fn spot(&self, plan: &Plan, t: f64) -> Spot {
        match (&self.shape, plan) {
            (Shape::Contour(..), _) => Spot::Contour(t),
            (_, Plan::Line { from, to }) => {
                let [begin, end] = plan.t();
                let share = (t - begin) / (end - begin);
                Spot::Surface([0, 1].map(|i| from[i] + share * (to[i] - from[i])))
            }
            _ => Spot::Parameter(t),
        }
    }

    fn curve<'a>(
        &'a self,
        plan: Plan,
        formulas: &'a Formulas,
        machine: &Machine,
    ) -> Result<LegCurve<'a>, Unworkable> {
        let followed = match &self.shape {
            Shape::Contour(contour, _) => Followed::Contour(contour.curve(formulas.get(0)?)),
            Shape::Surface(surface) => {
                let [x, y] = if matches!(plan, Plan::Curve { .. }) { [1, 2] } else { [0, 0] };
                let formulas = [formulas.get(0)?, formulas.get(x)?, formulas.get(y)?];
                Followed::Surface(surface.curve(plan, formulas))
            }
            Shape::Seam(seam) => {
                if matches!(seam.curve, SeamCurve::Formulas) {
                    (0..FORMULAS).try_for_each(|slot| formulas.get(slot).map(|_| ()))?;
                }
                let positioner = machine.positioner.as_ref().ok_or(Unworkable::NoPositioner)?;
                Followed::Seam(seam.on(&formulas.all, geometry(positioner), positioner.beam_mm))
            }
        };
        Ok(LegCurve { followed, axes: self.axes() })
    }

    fn step(
        &self,
        (plan, t): (&Plan, f64),
        formulas: &Formulas,
        machine: &Machine,
        from: &PerAxis<Position>,
        to: &PerAxis<Position>,
    ) -> Option<[f64; 3]> {
        let curve = self.curve(*plan, formulas, machine).ok()?;
        let surface = match (&curve.followed, &self.shape) {
            (Followed::Contour(_), _) => None,
            (Followed::Surface(curve), Shape::Surface(surface)) => {
                let contact = curve.contact(t).map(|series| series.value());
                Some(Touch::at(formulas.get(0).ok()?, contact).under(&surface.tool)?)
            }
            _ => return None,
        };
        let point = curve.at(t);
        let there = self.placed(&point.axes.map(|axis| axis.value()), *from);
        let (mut path, mut exact) = ([Series::default(); 3], [0.0; 3]);
        for ((axis, path), exact) in self.axes().iter().zip(&mut path).zip(&mut exact) {
            let i = axis.index();
            if from[i].mm_from(there[i]).abs() > ON_PATH_MM {
                return None;
            }
            (*path, *exact) = (point.axes[i], to[i].mm_from(from[i]));
        }
        Some(Place { path, surface }.step(self.correction, exact))
    }

    fn placed(&self, point: &PerAxis<f64>, mut at: PerAxis<Position>) -> PerAxis<Position> {
        let seam = matches!(self.shape, Shape::Seam(_));
        for (k, axis) in self.axes().iter().enumerate() {
            let origin = self.origin.get(k).filter(|_| !seam).copied().unwrap_or_default();
            at[axis.index()] = origin.moved(point[axis.index()]);
        }
        at
    }
}

/// A leg of a work as a curve of every axis, from the zero of the formulas; mm and degrees. Axes that do not
/// follow it stand at 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LegCurve<'a> {
    followed: Followed<'a>,
    axes: &'a [Axis],
}

#[derive(Clone, Copy, Debug)]
enum Followed<'a> {
    Contour(ContourCurve<'a>),
    Surface(SurfaceCurve<'a>),
    Seam(SeamPath<'a>),
}

impl Curve<AXES> for LegCurve<'_> {
    fn at(&self, t: f64) -> Point<AXES> {
        match &self.followed {
            Followed::Contour(curve) => self.spread(&curve.at(t)),
            Followed::Surface(curve) => self.spread(&curve.at(t)),
            Followed::Seam(curve) => self.spread(&curve.at(t)),
        }
    }

    fn near(&self, t: f64, here: &PerAxis<f64>) -> Point<AXES> {
        let Followed::Seam(curve) = &self.followed else { return self.at(t) };
        self.spread(&curve.near(t, &POSITIONER_AXES.map(|axis| here[axis.index()])))
    }
}

impl LegCurve<'_> {
    /// What belongs to the axes of a curve, in the order of the wire.
    fn spread<const N: usize>(&self, point: &Point<N>) -> Point<AXES> {
        let mut all = PerAxis::default();
        for (axis, own) in self.axes.iter().zip(point.axes) {
            all[axis.index()] = own;
        }
        Point { axes: all, tip: point.tip }
    }
}
