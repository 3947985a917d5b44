//! Published limits beside ours: how far they are apart, and which differ as they are known to.

use std::collections::BTreeMap;

use metrology::{Limits, Side, Thread, Unit};

/// Published sizes of one member by their keys.
pub(crate) type Sizes = BTreeMap<String, f64>;

/// One published size beside ours.
pub(crate) struct Cell {
    pub(crate) id: String,
    pub(crate) standard: String,
    pub(crate) key: String,
    pub(crate) published: f64,
    pub(crate) ours: f64,
    pub(crate) unit: Unit,
}

impl Cell {
    /// How far apart they are, µm.
    pub(crate) fn apart_um(&self) -> f64 {
        let um = if self.unit == Unit::Inch { 25_400.0 } else { 1000.0 };
        um * (self.published - self.ours).abs()
    }

    /// Whether they are the same in the last place that is printed.
    pub(crate) fn agrees(&self) -> bool {
        let places = match (self.unit, self.key.as_str()) {
            (Unit::Mm, key) if key.ends_with("_deg") => 1e-6,
            (Unit::Mm, "lead") => 1e-4,
            (Unit::Inch, "E0" | "E1") => 1e-5,
            (Unit::Inch, _) => 1e-4,
            (Unit::Mm, _) => 1e-3,
        };
        (self.published - self.ours).abs() < 0.51 * places
    }
}

/// The published sizes of a thread beside ours, in the unit of the standard.
///
/// # Panics
/// If the name is not understood, or a size is not set.
pub(crate) fn cells(id: &str, external: Option<&Sizes>, internal: Option<&Sizes>) -> Vec<Cell> {
    let thread: Thread = id.parse().unwrap_or_else(|misread| panic!("{id}: {misread}"));
    let limits = thread.limits();
    let sides = [(Side::External, external), (Side::Internal, internal)];
    let published = sides.into_iter().filter_map(|(side, sizes)| Some((side, sizes?)));
    let cell = |(side, key, published): (Side, &String, &f64)| Cell {
        id: id.to_owned(),
        standard: thread.standard().to_owned(),
        key: key.clone(),
        published: *published,
        ours: ours(&limits, side, key).unwrap_or_else(|| panic!("{id} has no {key}")),
        unit: limits.unit,
    };
    published
        .flat_map(|(side, sizes)| sizes.iter().map(move |(key, value)| (side, key, value)))
        .map(cell)
        .collect()
}

fn ours(limits: &Limits, side: Side, key: &str) -> Option<f64> {
    let (_, member) = limits.members().find(|(of, _)| *of == side)?;
    member.sizes().find(|(size, _)| size.key(side) == key).map(|(_, value)| value)
}

impl std::fmt::Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {} published {} ours {}", self.id, self.key, self.published, self.ours)
    }
}
