//! What a trace follows, leg by leg: the curve of a leg on the axes of the machine, and where it is in their coordinates.
//! In: a trace, one of its legs, the formulas. Out: a curve of all axes, positions.

use shape::{
    ContourCurve, Curve, Formula, Leg, Place, Plan, Point, SeamCurve, SeamPath, Series, SurfaceCurve, Touch,
};

use crate::{
    Axis, FORMULAS, Machine, PerAxis, Position, Route, Trace, Untraceable, Work, machine::POSITIONER_AXES,
    units::AXES,
};

/// Nearer than this a place is on the path, mm.
const ON_PATH_MM: f64 = 1e-6;

/// Where on a trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spot {
    /// X of the contour, mm.
    Contour(f64),
    /// X and Y of the point of contact, mm.
    Surface([f64; 2]),
    /// Parameter of a curve over a surface, or of a seam.
    Parameter(f64),
}

impl std::fmt::Display for Spot {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Spot::Contour(x) => write!(out, "x = {x:.4}"),
            Spot::Surface([x, y]) => write!(out, "x = {x:.4}, y = {y:.4}"),
            Spot::Parameter(t) => write!(out, "t = {t:.6}"),
        }
    }
}

impl Trace {
    /// How many legs there are.
    pub(crate) fn legs(&self) -> u32 {
        if let Work::Surface(surface) = &self.work { surface.legs() } else { 1 }
    }

    /// Leg `k`, from 0; `None` behind the last.
    pub(crate) fn leg(&self, k: u32) -> Option<Leg> {
        match &self.work {
            Work::Surface(surface) => surface.leg(k),
            Work::Contour(contour, _) => (k == 0).then_some(Leg::Cut(Plan::Curve { t: contour.t() })),
            Work::Seam(seam) => (k == 0).then_some(Leg::Cut(Plan::Curve { t: seam.t })),
        }
    }

    /// The axes that follow, in the order of their curve.
    pub(crate) fn axes(&self) -> &[Axis] {
        match &self.work {
            Work::Contour(_, axes) => axes,
            Work::Surface(_) => &[Axis::X, Axis::Y, Axis::Z],
            Work::Seam(_) => &POSITIONER_AXES,
        }
    }

    /// Machine Z at which a tool moves freely over a surface.
    pub(crate) fn clear(&self) -> Option<Position> {
        let Work::Surface(surface) = &self.work else { return None };
        self.origin.last().map(|z| z.moved(surface.clear_mm))
    }

    /// Where a parameter of a plan is.
    pub(crate) fn spot(&self, plan: &Plan, t: f64) -> Spot {
        match (&self.work, plan) {
            (Work::Contour(..), _) => Spot::Contour(t),
            (_, Plan::Line { from, to }) => {
                let [begin, end] = plan.t();
                let share = (t - begin) / (end - begin);
                Spot::Surface([0, 1].map(|i| from[i] + share * (to[i] - from[i])))
            }
            _ => Spot::Parameter(t),
        }
    }

    /// The curve of a plan on the axes of the machine.
    ///
    /// # Errors
    /// [`Untraceable::NoFormula`], [`Untraceable::NoPositioner`].
    pub(crate) fn track<'a>(
        &'a self,
        plan: Plan,
        formulas: &'a Formulas,
        machine: &Machine,
    ) -> Result<Track<'a>, Untraceable> {
        let followed = match &self.work {
            Work::Contour(contour, _) => Followed::Contour(contour.curve(formulas.get(0)?)),
            Work::Surface(surface) => {
                let [x, y] = if matches!(plan, Plan::Curve { .. }) { [1, 2] } else { [0, 0] };
                let formulas = [formulas.get(0)?, formulas.get(x)?, formulas.get(y)?];
                Followed::Surface(surface.curve(plan, formulas))
            }
            Work::Seam(seam) => {
                if matches!(seam.curve, SeamCurve::Formulas) {
                    (0..FORMULAS).try_for_each(|slot| formulas.get(slot).map(|_| ()))?;
                }
                let positioner = machine.positioner.as_ref().ok_or(Untraceable::NoPositioner)?;
                Followed::Seam(seam.on(&formulas.all, positioner.geometry(), positioner.beam_mm))
            }
        };
        Ok(Track { followed, axes: self.axes() })
    }

    /// Where the axes are led in a step whose exact end is `to`: the one of the largest way goes there, the others follow in
    /// the ratios of the correction (M36–M43) from the exact start `from`, at the parameter `t` of a plan. Exactly, where the
    /// start is not on the path itself: in a corner that is rounded.
    pub fn led(
        &self,
        route: &Route,
        (plan, t): (&Plan, f64),
        from: &PerAxis<Position>,
        to: &PerAxis<Position>,
    ) -> PerAxis<Position> {
        let Some(step) = self.step(route, plan, t, from, to) else { return *to };
        let mut led = *to;
        for (axis, way) in self.axes().iter().zip(step) {
            led[axis.index()] = from[axis.index()].moved(way);
        }
        led
    }

    fn step(
        &self,
        route: &Route,
        plan: &Plan,
        t: f64,
        from: &PerAxis<Position>,
        to: &PerAxis<Position>,
    ) -> Option<[f64; 3]> {
        let track = self.track(*plan, &route.formulas, &route.machine).ok()?;
        let surface = match (&track.followed, &self.work) {
            (Followed::Contour(_), _) => None,
            (Followed::Surface(curve), Work::Surface(surface)) => {
                let contact = curve.contact(t).map(|series| series.value());
                Some(Touch::at(route.formulas.get(0).ok()?, contact).under(&surface.tool)?)
            }
            _ => return None,
        };
        let point = track.at(t);
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

    /// Where the axes stand at a point of a track; axes that do not follow it stay where they are.
    pub(crate) fn placed(&self, point: &PerAxis<f64>, mut at: PerAxis<Position>) -> PerAxis<Position> {
        let seam = matches!(self.work, Work::Seam(_));
        for (k, axis) in self.axes().iter().enumerate() {
            let origin = self.origin.get(k).filter(|_| !seam).copied().unwrap_or_default();
            at[axis.index()] = origin.moved(point[axis.index()]);
        }
        at
    }
}

/// A leg of a trace as a curve of every axis, from the zero of the formulas; mm and degrees. Axes that do not follow it
/// stand at 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Track<'a> {
    followed: Followed<'a>,
    axes: &'a [Axis],
}

#[derive(Clone, Copy, Debug)]
enum Followed<'a> {
    Contour(ContourCurve<'a>),
    Surface(SurfaceCurve<'a>),
    Seam(SeamPath<'a>),
}

/// What traces refer to by number.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Formulas {
    all: [Formula; FORMULAS],
    given: [bool; FORMULAS],
}

impl Formulas {
    pub(crate) fn set(&mut self, slot: usize, formula: Formula) {
        if let (Some(place), Some(given)) = (self.all.get_mut(slot), self.given.get_mut(slot)) {
            (*place, *given) = (formula, true);
        }
    }

    fn get(&self, slot: usize) -> Result<&Formula, Untraceable> {
        let given = self.given.get(slot).is_some_and(|given| *given);
        self.all.get(slot).filter(|_| given).ok_or(Untraceable::NoFormula(slot))
    }
}

impl Curve<AXES> for Track<'_> {
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

impl Track<'_> {
    /// What belongs to the axes of a curve, in the order of the wire.
    fn spread<const N: usize>(&self, point: &Point<N>) -> Point<AXES> {
        let mut all = PerAxis::default();
        for (axis, own) in self.axes.iter().zip(point.axes) {
            all[axis.index()] = own;
        }
        Point { axes: all, tip: point.tip }
    }
}
