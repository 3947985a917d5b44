//! Threads that follow each other without a new index, and leads that grow: one path, along which the lead
//! changes at corners. In: legs, each with its end, mm, and its lead. Out: corners by spindle angle. A thread
//! along an arc is several legs (`round.rs`).
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | l | mm | length of a leg along its path |
//! | K, G | mm/rev, mm/rev² | lead along the path where it begins, growth of it in a turn |
//! | n | rev | turns that it takes |
//!
//! ```text
//! l = K n + G n²/2,  so  n = 2 l/(K + √(K² + 2 G l)),  at its end the lead is √(K² + 2 G l)         (M219)
//! ```

use motion::MOST_CHANGES;

use super::cut::{Along, Cut, Point};

/// Leads and growths that differ by less are one, mm.
const SAME: f64 = 1e-12;
/// A line that moves an axis by less does not move it, mm: the quantum of the wire.
pub(super) const NO_WAY: f64 = 1e-9;

/// One thread of a chain, or a piece of one along an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leg {
    /// Line of the program.
    pub(crate) line: u32,
    /// The axis along which it runs.
    pub(crate) along: Along,
    /// Where it ends, mm, X a radius.
    pub(crate) to: Point,
    /// Signed leads where it begins, mm/rev.
    pub(crate) lead: Point,
    /// By how much they grow in every turn, mm/rev².
    pub(crate) growth: Point,
    /// Turns that it takes.
    pub(crate) turns: f64,
    /// It goes on along an arc that a leg before it began.
    pub(crate) within: bool,
}

/// Where the lead changes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bend {
    /// Line of the thread that begins here.
    pub line: u32,
    /// Angle from where the helix goes through the start point, degrees.
    pub c_deg: f64,
    /// Signed jump of the leads, mm/rev.
    pub lead: Point,
    /// The same of their growth in a turn, mm/rev².
    pub growth: Point,
    /// It is no corner of the program: it lies within an arc.
    pub within: bool,
}

/// The corners of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Chain {
    bends: [Bend; MOST_CHANGES],
    count: usize,
    /// Angle at which the path ends.
    end_deg: f64,
}

/// Why legs are no chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Broken {
    /// The lead gets to nothing before the leg ends; after so many mm of it.
    Ends(f64),
    /// There are too many corners.
    TooMany,
    /// An arc takes so many pieces, and a pass has fewer.
    TooRound(usize),
    /// An arc is steeper than 45 degrees against Z in one place, and against X in another.
    Steep,
    /// It does not go on in the direction of the first leg along this axis.
    Turns(Along),
}

impl Leg {
    /// A line from a point: `k_mm` is its lead along the path where it begins, which grows by `growth_mm` in
    /// every turn (M219). It runs along X where it does not move Z.
    ///
    /// # Errors
    /// The lead gets to nothing before it ends.
    pub(crate) fn straight(
        line: u32,
        [from, to]: [Point; 2],
        k_mm: f64,
        growth_mm: f64,
    ) -> Result<Leg, Broken> {
        let way = less(to, from);
        let length = libm::hypot(way.x, way.z);
        let square = k_mm * k_mm + 2.0 * growth_mm * length;
        if square <= 0.0 {
            return Err(Broken::Ends(-0.5 * k_mm * k_mm / growth_mm));
        }
        let turns = 2.0 * length / (k_mm + square.sqrt());
        let direction = times(way, 1.0 / length);
        let (lead, growth) = (times(direction, k_mm), times(direction, growth_mm));
        let along = if way.z.abs() < NO_WAY { Along::X } else { Along::Z };
        Ok(Leg { line, along, to, lead, growth, turns, within: false })
    }

    /// The same with the two axes exchanged: of one along Z the one on a face.
    pub(crate) fn exchanged(self) -> Leg {
        let along = if self.along == Along::Z { Along::X } else { Along::Z };
        let [to, lead, growth] = [self.to, self.lead, self.growth].map(Point::exchanged);
        Leg { along, to, lead, growth, ..self }
    }

    /// Its leads where it ends, mm/rev.
    fn ends(&self) -> Point {
        let grown = times(self.growth, self.turns);
        Point { x: self.lead.x + grown.x, z: self.lead.z + grown.z }
    }
}

/// So many times a direction.
fn times(direction: Point, by: f64) -> Point {
    Point { x: direction.x * by, z: direction.z * by }
}

fn less(one: Point, other: Point) -> Point {
    Point { x: one.x - other.x, z: one.z - other.z }
}

fn is_nothing(point: Point) -> bool {
    point.x.abs() < SAME && point.z.abs() < SAME
}

impl Chain {
    /// The corners of legs that follow each other; none of a single leg of one lead.
    ///
    /// # Errors
    /// There are more corners than a pass can have.
    pub(crate) fn of(legs: &[Leg]) -> Result<Chain, Broken> {
        let mut chain = Chain::default();
        let mut c_deg = 0.0;
        let (mut lead, mut growth) = (None, Point::default());
        for leg in legs {
            let jump = lead.map_or(Point::default(), |lead| less(leg.lead, lead));
            let grows = less(leg.growth, growth);
            chain.bend(Bend { line: leg.line, c_deg, lead: jump, growth: grows, within: leg.within })?;
            (lead, growth) = (Some(leg.ends()), leg.growth);
            c_deg += 360.0 * leg.turns;
        }
        chain.end_deg = c_deg;
        // A brake leaves a lead that is constant: that takes a corner of its own.
        if !is_nothing(growth) && chain.count == MOST_CHANGES {
            return Err(Broken::TooMany);
        }
        Ok(chain)
    }

    fn bend(&mut self, bend: Bend) -> Result<(), Broken> {
        if is_nothing(bend.lead) && is_nothing(bend.growth) {
            return Ok(());
        }
        *self.bends.get_mut(self.count).ok_or(Broken::TooMany)? = bend;
        self.count += 1;
        Ok(())
    }

    /// The corners.
    pub fn bends(&self) -> &[Bend] {
        &self.bends[..self.count]
    }
}

impl Cut {
    /// Angle at which the path ends, degrees.
    pub(crate) fn end_deg(&self) -> f64 {
        match self.chain.bends() {
            [] => 360.0 * (self.to_mm - self.starts_mm()) / self.lead_mm(),
            _ => self.chain.end_deg,
        }
    }

    /// Where the path is at an angle, from its start, mm; and the leads and their growths there.
    pub(crate) fn at(&self, c_deg: f64) -> [Point; 3] {
        let (mut way, mut lead, mut growth, mut at) = (Point::default(), self.lead, Point::default(), 0.0);
        let go = |way: &mut Point, lead: &mut Point, growth: Point, turns: f64| {
            way.x += (lead.x + 0.5 * growth.x * turns) * turns;
            way.z += (lead.z + 0.5 * growth.z * turns) * turns;
            (lead.x, lead.z) = (lead.x + growth.x * turns, lead.z + growth.z * turns);
        };
        for bend in self.chain.bends().iter().filter(|bend| bend.c_deg <= c_deg) {
            go(&mut way, &mut lead, growth, (bend.c_deg - at) / 360.0);
            (lead.x, lead.z) = (lead.x + bend.lead.x, lead.z + bend.lead.z);
            (growth.x, growth.z) = (growth.x + bend.growth.x, growth.z + bend.growth.z);
            at = bend.c_deg;
        }
        go(&mut way, &mut lead, growth, (c_deg - at) / 360.0);
        [way, lead, growth]
    }

    /// How far the path has gone along the thread at an angle, mm, not signed.
    pub(crate) fn gone_mm(&self, c_deg: f64) -> f64 {
        match self.chain.bends() {
            [] => c_deg * self.lead_mm().abs() / 360.0,
            _ => self.along.of(self.at(c_deg)[0]) * self.lead_mm().signum(),
        }
    }

    /// Leads at its end, mm/rev, and their growths.
    pub(crate) fn at_its_end(&self) -> [Point; 2] {
        match self.chain.bends() {
            [] => [self.lead, Point::default()],
            _ => {
                let [_, lead, growth] = self.at(self.end_deg());
                [lead, growth]
            }
        }
    }

    /// Largest magnitudes of the leads, mm/rev.
    pub(crate) fn most_lead(&self) -> Point {
        let mut most = Point { x: self.lead.x.abs(), z: self.lead.z.abs() };
        let mut see = |lead: Point| most = Point { x: most.x.max(lead.x.abs()), z: most.z.max(lead.z.abs()) };
        for bend in self.chain.bends() {
            let [_, behind, _] = self.at(bend.c_deg);
            see(behind);
            see(less(behind, bend.lead));
        }
        see(self.at_its_end()[0]);
        most
    }

    /// Whether the axis that lifts the tool follows the helix anywhere.
    pub(crate) fn rises(&self) -> bool {
        self.along.across(self.most_lead()) != 0.0
    }
}

/// How a corner is rounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerNote {
    /// Line of the thread that begins there.
    pub line: u32,
    /// Place on the machine, mm: X a radius, Z.
    pub at_mm: [f64; 2],
    /// Angle over which the lead changes, degrees.
    pub window_deg: f64,
    /// Largest distance from the programmed corner, mm.
    pub off_mm: f64,
}

/// How the corners of a chain are rounded in the pass that was laid out for it (M220).
pub(crate) fn rounded(cut: &Cut, pass: &protocol::ThreadPass) -> Vec<CornerNote> {
    const LOOKS: u32 = 64;
    let axes = [Along::X.axis(), Along::Z.axis()];
    let changes = axes.map(|axis| pass.changes(axis));
    let note = |(bend, corner): (&Bend, &protocol::Corner)| {
        let off = |look: u32| {
            let c = corner.c_deg + corner.dc_deg * f64::from(look) / f64::from(LOOKS);
            let [x, z] = changes.map(|changes| changes.way_mm(c) - changes.programmed_mm(c));
            libm::hypot(x, z)
        };
        let [way, ..] = cut.at(bend.c_deg);
        CornerNote {
            line: bend.line,
            at_mm: [cut.from.x + way.x, cut.from.z + way.z],
            window_deg: corner.dc_deg,
            off_mm: (0..=LOOKS).map(off).fold(0.0, f64::max),
        }
    };
    // Where a lead grows from the start, or stops to grow before its end, is no corner of the program.
    let corners = cut.chain.bends().iter().zip(pass.corners());
    corners.filter(|(bend, _)| bend.c_deg > 0.0 && !bend.within).map(note).collect()
}
