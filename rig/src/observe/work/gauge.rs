//! What a trace is held against. In: a trace with its formulas, and where the axes are, mm and degrees. Out:
//! how far the tool or the beam is from where it shall be.

use machine::Machine;
use protocol::{Axis, FORMULAS, PerAxis, Position, Shape, Work};
use route::positioner::{drives, geometry};
use shape::{Formula, Positioner, Seam};

use super::outline::Outline;
use super::seam::Beam;
use super::surface::Probe;

/// Where a tool or a beam was seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Seen {
    /// Deviation from the surface, the contour or the seam, mm.
    pub(super) deviation_mm: f64,
    /// Angle between the direction of a seam and the beam, degrees; else 0.
    pub(super) angle_deg: f64,
    /// The point whose speed is the feed, from the zero of the formulas: the tip of the tool, or the beam on
    /// the part, mm.
    pub(super) tip: [f64; 3],
}

/// Measures one trace.
#[derive(Clone, Debug)]
pub(super) enum Gauge {
    Surface(Probe, [Position; 3]),
    Contour(Outline, [Axis; 2], [Position; 3]),
    Seam(Box<SeamGauge>),
}

/// A beam on a seam.
#[derive(Clone, Debug)]
pub(super) struct SeamGauge {
    beam: Beam,
    positioner: Positioner,
    stands: [f64; 2],
    seam: Seam,
    formulas: [Formula; FORMULAS],
}

impl Gauge {
    /// `None` for a seam on a machine that is not a positioner.
    pub(super) fn of(trace: &Work, formulas: &[Formula; FORMULAS], machine: &Machine) -> Option<Gauge> {
        Some(match trace.shape {
            Shape::Surface(surface) => Gauge::Surface(Probe::new(formulas[0], surface.tool), trace.origin),
            Shape::Contour(contour, axes) => {
                Gauge::Contour(Outline::new(formulas[0], contour), axes, trace.origin)
            }
            Shape::Seam(seam) => {
                let config = machine.positioner?;
                let (positioner, stands) = (geometry(&config), config.beam_mm);
                let beam = Beam::new(positioner, stands, seam.t);
                Gauge::Seam(Box::new(SeamGauge { beam, positioner, stands, seam, formulas: *formulas }))
            }
        })
    }

    /// Measures with the axes there; `None` where nothing near enough is found.
    pub(super) fn see(&mut self, axes: &PerAxis<f64>) -> Option<Seen> {
        let from = |origin: &[Position; 3], i: usize, axis: Axis| axes[axis.index()] - origin[i].mm();
        match self {
            Gauge::Surface(probe, origin) => {
                let tip = core::array::from_fn(|i| from(origin, i, [Axis::X, Axis::Y, Axis::Z][i]));
                let touch = probe.touch(tip)?;
                Some(Seen { deviation_mm: touch.deviation_mm, angle_deg: 0.0, tip })
            }
            Gauge::Contour(outline, plane, origin) => {
                let [x, y] = core::array::from_fn(|i| from(origin, i, plane[i]));
                let deviation_mm = outline.deviation_mm([x, y])?;
                Some(Seen { deviation_mm, angle_deg: 0.0, tip: [x, y, 0.0] })
            }
            Gauge::Seam(gauge) => {
                let SeamGauge { beam, positioner, stands, seam, formulas } = &mut **gauge;
                let path = seam.on(formulas, *positioner, *stands);
                let spot = beam.spot(&drives(axes), |t| path.place(t))?;
                Some(Seen { deviation_mm: spot.deviation_mm, angle_deg: spot.angle_deg, tip: spot.point })
            }
        }
    }

    /// Forgets where it was seen last: the tool has been somewhere else.
    pub(super) fn lift(&mut self) {
        match self {
            Gauge::Surface(probe, _) => probe.lift(),
            Gauge::Contour(outline, ..) => outline.lift(),
            Gauge::Seam(gauge) => gauge.beam.lift(),
        }
    }
}
