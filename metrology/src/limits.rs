//! Limits of a thread: named sizes of its external and its internal member, in mm.

/// Which of the two members of a thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// The screw.
    External,
    /// The nut.
    Internal,
}

/// The unit in which a standard rounds, and in which its tables are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Millimetres, three places.
    Mm,
    /// Inches, four places; five for the tapered pipe thread.
    Inch,
}

/// What is limited, or given. Names of columns are those of the standards, with `d` for external and `D` for
/// internal threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Size {
    /// Largest major diameter, `d_max`.
    MajorMax,
    /// Smallest major diameter, `d_min`, `D_min`.
    MajorMin,
    /// Largest pitch diameter, `d2_max`, `D2_max`.
    PitchMax,
    /// Smallest pitch diameter, `d2_min`, `D2_min`.
    PitchMin,
    /// Largest minor diameter where a flat of the root reaches it, `d1_max`: what a GO gauge needs.
    FlatMinorMax,
    /// Largest minor diameter: of the root of a screw `d3_max`, of the crest of a nut `D1_max`.
    MinorMax,
    /// Smallest minor diameter, `d3_min`, `D1_min`.
    MinorMin,
    /// Largest radius of the root, `R_max`.
    RootRadiusMax,
    /// Smallest radius of the root, `R_min`.
    RootRadiusMin,
    /// Major diameter without limits: at the gauge plane of a taper, or basic; `d`, `D`.
    Major,
    /// Pitch diameter without limits, `d2`, `D2`.
    Pitch,
    /// Minor diameter without limits, `d3` or, on a taper, `d1`; `D1`.
    Minor,
    /// Pitch diameter of a taper at the small end, `E0`.
    SmallEnd,
    /// Pitch diameter of a taper where hand-tight engagement ends, `E1`.
    HandTight,
    /// The same, one turn further, `E1_max`.
    HandTightMax,
    /// The same, one turn less, `E1_min`.
    HandTightMin,
    /// Length of hand-tight engagement, `L1`.
    HandTightLength,
    /// Length of effective thread, `L2`.
    EffectiveLength,
    /// Distance of the gauge plane from the small end of a screw of ISO 7, `L`.
    GaugeLength,
    /// Advance per revolution, `lead`.
    Lead,
    /// Tip diameter of a worm, `da`.
    Tip,
    /// Root diameter of a worm, `df`.
    Root,
    /// Depth of the thread of a worm, `depth`.
    Depth,
    /// Lead angle of a worm, degrees, `gamma_deg`.
    LeadAngle,
    /// Angle of its flanks in an axial plane, degrees, `alpha_ax_deg`.
    AxialAngle,
}

impl Size {
    /// Its key in documents, and its name in tables.
    #[must_use]
    pub fn key(self, side: Side) -> &'static str {
        use Size::*;
        let (external, internal) = match self {
            MajorMax => ("d_max", "D_max"),
            MajorMin => ("d_min", "D_min"),
            PitchMax => ("d2_max", "D2_max"),
            PitchMin => ("d2_min", "D2_min"),
            FlatMinorMax => ("d1_max", "D1_flat_max"),
            MinorMax => ("d3_max", "D1_max"),
            MinorMin => ("d3_min", "D1_min"),
            RootRadiusMax => ("R_max", "R_max"),
            RootRadiusMin => ("R_min", "R_min"),
            Major => ("d", "D"),
            Pitch => ("d2", "D2"),
            Minor => ("d3", "D1"),
            SmallEnd => ("E0", "E0"),
            HandTight => ("E1", "E1"),
            HandTightMax => ("E1_max", "E1_max"),
            HandTightMin => ("E1_min", "E1_min"),
            HandTightLength => ("L1", "L1"),
            EffectiveLength => ("L2", "L2"),
            GaugeLength => ("L", "L"),
            Lead => ("lead", "lead"),
            Tip => ("da", "da"),
            Root => ("df", "df"),
            Depth => ("depth", "depth"),
            LeadAngle => ("gamma_deg", "gamma_deg"),
            AxialAngle => ("alpha_ax_deg", "alpha_ax_deg"),
        };
        match side {
            Side::External => external,
            Side::Internal => internal,
        }
    }
}

impl Size {
    /// What it is, for people.
    #[must_use]
    pub fn text(self) -> &'static str {
        use Size::*;
        match self {
            MajorMax => "largest major diameter",
            MajorMin => "smallest major diameter",
            PitchMax => "largest pitch diameter",
            PitchMin => "smallest pitch diameter",
            FlatMinorMax => "largest minor diameter where a flat of the root begins",
            MinorMax => "largest minor diameter",
            MinorMin => "smallest minor diameter",
            RootRadiusMax => "largest radius of the root",
            RootRadiusMin => "smallest radius of the root",
            Major => "major diameter",
            Pitch => "pitch diameter",
            Minor => "minor diameter",
            SmallEnd => "pitch diameter at the small end",
            HandTight => "pitch diameter where hand-tight engagement ends",
            HandTightMax => "the same, one turn more",
            HandTightMin => "the same, one turn less",
            HandTightLength => "length of hand-tight engagement",
            EffectiveLength => "length of effective thread",
            GaugeLength => "gauge length",
            Lead => "lead",
            Tip => "tip diameter",
            Root => "root diameter",
            Depth => "depth of the thread",
            LeadAngle => "lead angle, degrees",
            AxialAngle => "angle of the flanks in an axial plane, degrees",
        }
    }
}

/// The sizes of one member.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    unit: Unit,
    /// In the unit, in the order of tables.
    sizes: Vec<(Size, f64)>,
}

impl Member {
    /// From sizes in a unit, rounded as its standard does.
    pub(crate) fn new(unit: Unit, sizes: &[(Size, f64)]) -> Member {
        Member { unit, sizes: sizes.to_vec() }
    }

    /// A size in mm; none if the standard does not set it.
    #[must_use]
    pub fn get(&self, size: Size) -> Option<f64> {
        self.sizes_mm().find(|(of, _)| *of == size).map(|(_, mm)| mm)
    }

    /// Every size in mm, in the order of tables. An inch has at most five places, so six are exact.
    pub fn sizes_mm(&self) -> impl Iterator<Item = (Size, f64)> {
        let mm = |value: f64| match self.unit {
            Unit::Mm => value,
            Unit::Inch => (value * 25.4 * 1e6).round() / 1e6,
        };
        self.sizes.iter().map(move |(size, value)| (*size, mm(*value)))
    }

    /// Every size in the unit of the standard.
    pub fn sizes(&self) -> impl Iterator<Item = (Size, f64)> {
        self.sizes.iter().copied()
    }
}

/// What a standard asks of a thread.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// The unit in which the standard rounds.
    pub unit: Unit,
    /// The screw; none if the name is one of a nut.
    pub external: Option<Member>,
    /// The nut; none if the name is one of a screw.
    pub internal: Option<Member>,
}

impl Limits {
    /// Members of one unit.
    pub(crate) fn new(
        unit: Unit,
        external: Option<&[(Size, f64)]>,
        internal: Option<&[(Size, f64)]>,
    ) -> Limits {
        let member = |sizes: Option<&[(Size, f64)]>| sizes.map(|sizes| Member::new(unit, sizes));
        Limits { unit, external: member(external), internal: member(internal) }
    }

    /// The members that there are.
    pub fn members(&self) -> impl Iterator<Item = (Side, &Member)> {
        let external = self.external.iter().map(|member| (Side::External, member));
        external.chain(self.internal.iter().map(|member| (Side::Internal, member)))
    }
}
