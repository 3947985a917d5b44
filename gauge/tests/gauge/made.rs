//! Threads that are made up. In: limits, an edge, errors in mm. Out: the places of the tip at each angle.
//!
//! The root that gives a pitch diameter follows from the edge alone: there the edge is half a pitch wide.

use gauge::{Edge, Nominal, Place, Sections, Side};

/// Angles at which a thread is looked at.
pub(crate) const STATIONS: usize = 72;

/// What is wrong with a thread; mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Errors {
    /// Per mm along the thread.
    pub(crate) lead: f64,
    /// Amplitude once in a turn, along the axis.
    pub(crate) drunken: f64,
    /// The second start, along the axis.
    pub(crate) start: f64,
    /// Change of the pitch diameter per mm along Z.
    pub(crate) taper: f64,
    /// Amplitude once in a turn, of the radius.
    pub(crate) runout: f64,
    /// A second pass at full depth, along the axis.
    pub(crate) pass: f64,
}

/// A thread.
#[derive(Clone, Debug)]
pub(crate) struct Made {
    pub(crate) nominal: Nominal,
    pub(crate) edge: Edge,
    pub(crate) pitch_diameter_mm: f64,
    pub(crate) length_mm: f64,
    /// Passes go in along a flank of the tool, else radially.
    pub(crate) by_flank: bool,
    pub(crate) errors: Errors,
}

/// The tool that a thread asks for, with a nose that leaves the root where the class has it.
fn edge_of(nominal: &Nominal) -> Edge {
    let is_small = nominal.flank_deg[0] < 20.0 || nominal.side == Side::Internal;
    let nose_mm = nominal.pitch_mm * if is_small { 0.04 } else { 0.1 };
    let flat_mm = if nominal.flank_deg[0] > 20.0 { 0.0 } else { 0.25 * nominal.pitch_mm };
    Edge { flank_deg: nominal.flank_deg, flat_mm, nose_mm }
}

/// Name, side, flank, pitch, starts, pitch diameters, crest, root for GO.
type Row = (&'static str, Side, f64, f64, u32, [f64; 2], [Option<f64>; 2], Option<f64>);

/// Threads of several standards, with the limits of their tables.
pub(crate) fn threads() -> Vec<Made> {
    use Side::{External, Internal};
    let rows: [Row; 6] = [
        ("M20x2-6g", External, 30.0, 2.0, 1, [18.503, 18.663], [Some(19.682), Some(19.962)], Some(17.797)),
        ("M6-6g", External, 30.0, 1.0, 1, [5.212, 5.324], [Some(5.794), Some(5.974)], Some(4.891)),
        ("M20x2-6H", Internal, 30.0, 2.0, 1, [18.701, 18.913], [Some(17.835), Some(18.21)], Some(20.0)),
        ("Tr40x14P7-7e", External, 15.0, 7.0, 2, [36.02, 36.375], [Some(39.58), Some(40.0)], Some(33.0)),
        ("BSW 1/2-12", External, 27.5, 2.1167, 1, [11.2, 11.345], [None, None], None),
        ("1/4-20 UNC-2A", External, 30.0, 1.27, 1, [5.4026, 5.4966], [None, Some(6.3221)], Some(4.95)),
    ];
    let made = |(at, row): (usize, Row)| {
        let (name, side, flank, pitch_mm, starts, pitch_diameter_mm, crest_mm, root_go_mm) = row;
        let nominal = Nominal {
            name: name.into(),
            side,
            flank_deg: [flank; 2],
            pitch_mm,
            starts,
            grows: at % 2 == 1,
            pitch_diameter_mm,
            crest_mm,
            root_go_mm,
            root_mm: [None; 2],
            taper: 0.0,
            plane_mm: 0.0,
            gauge_mm: 10.0 * pitch_mm,
            tap_mm: None,
            blunt_turns: None,
            left_out: &[],
        };
        nominal.check().expect("a gauge can be made");
        Made {
            edge: edge_of(&nominal),
            pitch_diameter_mm: 0.5 * (pitch_diameter_mm[0] + pitch_diameter_mm[1]),
            length_mm: 14.0 * pitch_mm * f64::from(starts).sqrt(),
            by_flank: at % 3 != 0,
            errors: Errors::default(),
            nominal,
        }
    };
    rows.into_iter().enumerate().map(made).collect()
}

/// A cone of 1:16, as NPT 1/2-14, in a class by numbers.
pub(crate) fn cone() -> Made {
    let [thread, ..] = &threads()[..] else { unreachable!("there are threads") };
    let mut made = thread.clone();
    made.nominal = Nominal {
        name: "1/2-14 NPT".into(),
        pitch_mm: 25.4 / 14.0,
        pitch_diameter_mm: [19.65, 19.88],
        crest_mm: [None; 2],
        root_go_mm: None,
        taper: -1.0 / 16.0,
        plane_mm: -8.0,
        ..made.nominal
    };
    made.edge = edge_of(&made.nominal);
    made.pitch_diameter_mm = 19.772;
    made.errors.taper = made.nominal.taper;
    made
}

impl Made {
    /// 1 of a screw, −1 of a nut.
    pub(crate) fn sign(&self) -> f64 {
        if self.nominal.side == Side::External { 1.0 } else { -1.0 }
    }

    /// The limits of GO and NO-GO.
    pub(crate) fn limits(&self) -> [f64; 2] {
        let [low, high] = self.nominal.pitch_diameter_mm;
        if self.sign() > 0.0 { [high, low] } else { [low, high] }
    }

    /// Sets the pitch diameter: so much more material than at the limit of GO, in diameter.
    pub(crate) fn above_go(mut self, mm: f64) -> Made {
        self.pitch_diameter_mm = self.limits()[0] + self.sign() * mm;
        self
    }

    /// The same over the limit of NO-GO.
    pub(crate) fn above_no_go(mut self, mm: f64) -> Made {
        self.pitch_diameter_mm = self.limits()[1] + self.sign() * mm;
        self
    }

    pub(crate) fn with(mut self, errors: Errors) -> Made {
        self.errors = errors;
        self
    }

    /// Tangents of both flanks together, as asked.
    pub(crate) fn tangent(&self) -> f64 {
        self.nominal.flank_deg.iter().map(|deg| libm::tan(deg.to_radians())).sum()
    }

    /// Diameter of the material that there is.
    pub(crate) fn crest_mm(&self) -> Option<f64> {
        let [low, high] = self.nominal.crest_mm;
        Some(0.5 * (low? + high?))
    }

    /// How far the tip lies below the pitch line, mm.
    pub(crate) fn below_mm(&self) -> f64 {
        let Edge { flank_deg, flat_mm, nose_mm } = self.edge;
        let (mut t, mut beside) = (0.0, flat_mm);
        for deg in flank_deg {
            let (sin, cos) = libm::sincos(deg.to_radians());
            t += sin / cos;
            beside += nose_mm * cos - nose_mm * (1.0 - sin) * sin / cos;
        }
        let s = 0.5 * self.nominal.taper;
        let product: f64 = self.nominal.flank_deg.iter().map(|deg| libm::tan(deg.to_radians())).product();
        (0.5 * self.nominal.pitch_mm * (1.0 - s * s * product) - beside) / t
    }

    /// The places of the tip.
    pub(crate) fn sections(&self) -> Sections {
        let Nominal { pitch_mm, starts, grows, .. } = self.nominal;
        let lead = pitch_mm * f64::from(starts) * if grows { 1.0 } else { -1.0 };
        let turn = starts as i32 + 2;
        let grooves = -turn..(self.length_mm / pitch_mm) as i32 + turn;
        let station = |j: usize| {
            let turn = j as f64 / STATIONS as f64;
            let angle = core::f64::consts::TAU * turn;
            let all = grooves.clone().map(|i| (i, -0.3 * pitch_mm - f64::from(i) * pitch_mm + lead * turn));
            all.flat_map(|(i, even)| self.groove(i, even, angle)).collect()
        };
        Sections { edges: vec![self.edge], stations: (0..STATIONS).map(station).collect() }
    }

    /// The passes of a groove at an angle; the places of a real tool are not in the order of their depth.
    fn groove(&self, i: i32, even: f64, angle: f64) -> Vec<Place> {
        let Errors { lead, drunken, start, taper, runout, pass } = self.errors;
        let second = i.rem_euclid(2) == 1 && self.nominal.starts > 1;
        let z = even
            + lead * (even + 0.5 * self.length_mm)
            + drunken * libm::sin(angle)
            + if second { start } else { 0.0 };
        let middle = if taper == self.nominal.taper { self.nominal.plane_mm } else { -0.5 * self.length_mm };
        let r = 0.5 * self.pitch_diameter_mm + 0.5 * taper * (z - middle) + runout * libm::cos(angle);
        let tip = r - self.sign() * self.below_mm();
        let infeed = if self.by_flank { libm::tan(self.edge.flank_deg[1].to_radians()) } else { 0.0 };
        let passes = [0.0, 0.45, 0.25, 0.1, 0.0];
        let place = |(at, share): (usize, &f64)| {
            let missing = share * self.nominal.pitch_mm;
            let beside = if at == 4 { pass } else { 0.0 };
            let radius_mm = tip + self.sign() * missing;
            Place { z_mm: z + infeed * missing + beside, radius_mm, edge: 0 }
        };
        passes.iter().enumerate().map(place).collect()
    }

    /// Where it is at full depth.
    pub(crate) fn full_mm(&self) -> [f64; 2] {
        [-self.length_mm, 0.0]
    }

    /// What the gauge says.
    pub(crate) fn judged(&self) -> gauge::Report {
        gauge::judge(&self.nominal, &self.sections(), self.full_mm(), self.crest_mm())
    }
}
