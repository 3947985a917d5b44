//! Beside the reference values in 50 digits (`shaping.json`). In: the works that are in that file. Out: a
//! table, µm. Each figure is that of the last step of its case; a test compares every row of the file.

use shape::Correction;

use super::{Computed, name, steps};
use report::table::{Column, Table};

/// What of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Error {
    Next,
    Accumulated,
}

/// Work, what, correction, reference value in µm.
pub(super) type Printed = (&'static str, Error, Correction, f64);

pub(super) const PRINTED: [Printed; 14] = [
    ("c1", Error::Next, Correction::None, -2.6865509719214042),
    ("c1", Error::Next, Correction::PublishedSigns, 0.8529600028471097),
    ("c1", Error::Accumulated, Correction::None, -936.2904979442596),
    ("c1", Error::Accumulated, Correction::PublishedSigns, 0.37548993659974045),
    ("c2", Error::Next, Correction::None, 2.599885612375488),
    ("c2", Error::Next, Correction::PublishedSigns, -0.009484077959848475),
    ("c2", Error::Accumulated, Correction::None, 69.35213123433611),
    ("c2", Error::Accumulated, Correction::PublishedSigns, 1.1890263916228703),
    ("quad_twist", Error::Next, Correction::None, -3.16585),
    ("quad_twist", Error::Next, Correction::PublishedSigns, -1.3897734590200008),
    ("quad_twist", Error::Next, Correction::Mixed, 0.00024996813512753323),
    ("sin_cos", Error::Next, Correction::None, 6.645731360649834),
    ("sin_cos", Error::Next, Correction::PublishedSigns, 0.3746076867771837),
    ("sin_cos", Error::Next, Correction::Mixed, 0.08196385404609835),
];

/// A reference value and ours, µm.
pub(super) struct Pair {
    printed: Printed,
    here: f64,
}

/// The figure here that belongs to a reference value, µm; `None` if the work is not there.
fn here(computed: &Computed, (work, error, correction, _): &Printed) -> Option<f64> {
    let work = computed.work(work)?;
    let values = match error {
        Error::Next => steps::next_points(work, *correction, work.text.h_mm, true),
        Error::Accumulated => steps::misses(work, *correction, work.text.h_mm, true).1,
    };
    values.last().map(|(_, error)| 1e3 * error)
}

pub(super) fn pairs(computed: &Computed) -> Vec<Pair> {
    let pair = |printed: &Printed| Some(Pair { printed: *printed, here: here(computed, printed)? });
    PRINTED.iter().filter_map(pair).collect()
}

impl Pair {
    pub(super) fn difference(&self) -> f64 {
        self.here - self.printed.3
    }
}

pub(super) fn table(computed: &Computed) -> Table {
    let columns: [Column<Pair>; 6] = [
        Column { name: "work", unit: "", cell: |pair| pair.printed.0.into() },
        Column {
            name: "error",
            unit: "",
            cell: |pair| match pair.printed.1 {
                Error::Next => "next point".into(),
                Error::Accumulated => "accumulated".into(),
            },
        },
        Column { name: "correction", unit: "", cell: |pair| name(pair.printed.2).into() },
        Column { name: "reference", unit: "µm", cell: |pair| format!("{:.9}", pair.printed.3) },
        Column { name: "here", unit: "µm", cell: |pair| format!("{:.9}", pair.here) },
        Column { name: "difference", unit: "µm", cell: |pair| format!("{:.0e}", pair.difference()) },
    ];
    Table::of("Beside reference values of 50 digits", &columns, &pairs(computed)).with_caption(
        "The last step of each case with the step that is shown first: the errors with their signs. Differences are the \
         rounding of positions in double precision.",
    )
}
