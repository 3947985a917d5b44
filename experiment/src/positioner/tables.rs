//! Tables of the positioner: bounds beside what was attained and drawn, drives for an accuracy, the seam. In:
//! what was computed. Out: tables.

use rig::observe::DeviationReport;

use super::{ACCURACIES_UM, Computed, LINEAR_SHARE, Required, Row, SIZES_MM, sample::DRAWS};
use report::table::{Column, Place, Table, six, three};

pub(super) fn all(computed: &Computed) -> Vec<Table> {
    vec![bounds(computed), drives(), seam(computed), every(computed).at(Place::Details)]
}

/// Three displacements in µm.
fn um(all: &[f64; 3]) -> String {
    all.map(|um| format!("{um:.2}")).join(" / ")
}

const BOUNDS: [Column<Row>; 7] = [
    Column { name: "part", unit: "mm", cell: |row| six(row.part_mm) },
    Column { name: "slides", unit: "µm", cell: |row| six(1e3 * row.linear_error_mm) },
    Column { name: "angles", unit: "deg", cell: |row| six(row.angular_error_deg) },
    Column { name: "published (9)", unit: "x / y / z µm", cell: |row| um(&row.published_um) },
    Column { name: "tight (M51)", unit: "x / y / z µm", cell: |row| um(&row.tight_um) },
    Column { name: "attained", unit: "x / y / z µm", cell: |row| um(&row.attained_um) },
    Column { name: "drawn, largest", unit: "x / y / z µm", cell: |row| um(&row.sampled_max_um) },
];

/// The errors of the published example over the sizes.
fn bounds(computed: &Computed) -> Table {
    let rows: Vec<Row> = computed.rows.iter().filter(|row| row.is_published()).cloned().collect();
    Table::of("Displacement of the beam on the part by errors of the drives", &BOUNDS, &rows).with_caption(format!(
        "No coordinate of a point, no offset y2 or z2 is larger than the part. Attained: the exact displacement at the \
         poses where M51 says it is largest. Drawn: the largest exact displacement of {DRAWS} points, poses and errors \
         drawn evenly within their limits; those at their ends come nearer to the bound (table of every case)."
    ))
}

fn every(computed: &Computed) -> Table {
    let more: [Column<Row>; 4] = [
        Column { name: "drawn, rms", unit: "x / y / z µm", cell: |row| um(&row.sampled_rms_um) },
        Column { name: "drawn at the ends", unit: "x / y / z µm", cell: |row| um(&row.sampled_ends_max_um) },
        Column { name: "linear − exact", unit: "µm", cell: |row| three(row.linearisation_um) },
        Column { name: "at most (M91)", unit: "µm", cell: |row| three(row.linearisation_bound_um) },
    ];
    let columns: Vec<Column<Row>> = BOUNDS.into_iter().chain(more).collect();
    Table::of("Every case", &columns, &computed.rows).with_caption(
        "Linear − exact: largest difference between M50 and the exact displacement of all points that were drawn.",
    )
}

/// The inverse question: sizes down, accuracies across.
fn drives() -> Table {
    let cell = |size_mm: f64, accuracy_um: f64| {
        let Required { linear_um, angular_deg, .. } = Required::of(accuracy_um, size_mm);
        format!("{} µm, {}″", three(linear_um), three(3600.0 * angular_deg))
    };
    let row = |size_mm: f64| {
        let cells = ACCURACIES_UM.map(|accuracy_um| cell(size_mm, accuracy_um));
        std::iter::once(six(size_mm)).chain(cells).collect()
    };
    let heads = ACCURACIES_UM.map(|um| [format!("within {um} µm"), "slides, angles".into()]);
    Table {
        title: "Drives for a wanted accuracy (M90)".into(),
        caption: format!(
            "Largest error that slides and angles may have so that the beam is off by no more than that along any axis, \
             on a part of that size: the slides use {} % of it. Angles in seconds of arc. A drive that goes to the \
             nearest increment needs increments of twice that or less.",
            100.0 * LINEAR_SHARE
        ),
        head: std::iter::once(["part".into(), "mm".into()]).chain(heads).collect(),
        rows: SIZES_MM.map(row).to_vec(),
        place: Place::Everywhere,
    }
}

/// What the whole machine made of a seam.
fn seam(computed: &Computed) -> Table {
    let report = &computed.seam.report;
    let row = |name: &str, of: &DeviationReport, most: f64, rms: Option<f64>| {
        let off = [of.max_abs_um(), of.rms_um, of.angle_max_deg, most].map(three);
        let rms = rms.map_or("–".into(), three);
        std::iter::once(name.into()).chain(off).chain([rms]).collect()
    };
    let feed = &report.feed;
    let most = feed.true_high_pct.max(-feed.true_low_pct);
    Table {
        title: "A seam in the whole machine".into(),
        caption: format!(
            "A branch of 40 mm on a pipe of 60 mm, all around: {:.0} mm of seam at {} mm/min, {:.1} % of the time at the \
             programmed feed. Off the seam: distance of the beam from it across its direction on the part. Off the \
             bisector: angle between the beam and the bisector of both surfaces. Feed: largest deviation where it is held.",
            report.way_mm, feed.programmed_mm_min, feed.held_pct
        ),
        head: [
            ["the beam", ""],
            ["off the seam", "µm"],
            ["rms", "µm"],
            ["off the bisector", "deg"],
            ["feed off by", "%"],
            ["rms", "%"],
        ]
        .map(|column| column.map(str::to_owned))
        .to_vec(),
        rows: vec![
            row("commanded", &report.commanded, feed.most_pct, None),
            row("true", &report.slide, most, Some(feed.true_rms_pct)),
        ],
        place: Place::Everywhere,
    }
}
