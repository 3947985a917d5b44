//! What is said of the positioner. In: what was computed. Out: paragraphs.

use super::{Computed, LINEAR_SHARE, Row, sample::DRAWS};
use report::table::three;

/// Goals of the seam.
const SEAM_UM: f64 = 10.0;
const BISECTOR_DEG: f64 = 0.01;

fn um(all: &[f64; 3]) -> String {
    all.map(|um| format!("{um:.1}")).join(", ")
}

pub(super) fn short(computed: &Computed) -> Vec<String> {
    let example = computed.example().map(|row| {
        format!(
            "Slides within 30 µm and angles within 0.0014°, a part of 200 mm: the beam is off by at most {} µm along x, y \
             and z (published: {}). Poses that attain it are known; {} points drawn at random stay within {}.",
            um(&row.tight_um),
            um(&row.published_um),
            DRAWS,
            um(&row.sampled_max_um)
        )
    });
    let report = &computed.seam.report;
    let (off_um, off_deg) = (report.slide.max_abs_um(), report.slide.angle_max_deg);
    let verdict = |is_met: bool| if is_met { "met" } else { "missed" };
    let seam = format!(
        "A seam between two cylinders on the whole machine: the true beam is off the seam by at most {off_um:.2} µm (goal {SEAM_UM}: \
         {}), off the bisector by {off_deg:.4}° (goal {BISECTOR_DEG}: {}). Its feed on the part lies within 1 % for {:.2} % of the \
         time; for moments, where an axis turns back and takes up its lost motion, it is off by up to {:.1} %. As commanded it \
         is constant within {} %.",
        verdict(off_um <= SEAM_UM),
        verdict(off_deg <= BISECTOR_DEG),
        report.feed.true_held_pct,
        report.feed.true_high_pct.max(-report.feed.true_low_pct),
        three(report.feed.most_pct)
    );
    example.into_iter().chain([seam]).collect()
}

pub(super) fn done() -> Vec<String> {
    vec![
        "A beam stands still; two slides and two rotary axes bring the part under it, so that the seam is where the beam is \
         and looks along it. Each drive is off by a little. The kinematics (M46, M47) are linearised (M50), bounded for all \
         poses and points (M51, M52), and the bounds held against exact differences of positions: at the poses that the \
         bounds name, and at random with a seed."
            .into(),
        "The other way around (M90): from an accuracy and a size of the part follow the largest errors that slides and \
         angles may have."
            .into(),
        "Then a seam is welded in the whole machine: interpreter, interpolator, four regulators, drives, screws and worms \
         with backlash. An observer of the truth, which no controller sees, measures how far the beam is from the seam and \
         from the bisector of its two surfaces."
            .into(),
    ]
}

pub(super) fn meaning(computed: &Computed) -> Vec<(&'static str, Vec<String>)> {
    let rows: Vec<&Row> = computed.rows.iter().collect();
    vec![
        ("What it means", bounds(&rows)),
        ("Requirements for drives", requirements(computed)),
        ("The seam", seam(computed)),
    ]
}

/// Largest and smallest of a ratio over all rows.
fn range(rows: &[&Row], of: impl Fn(&Row) -> f64) -> (f64, f64) {
    let all = rows.iter().map(|row| of(row));
    all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), one| (low.min(one), high.max(one)))
}

fn bounds(rows: &[&Row]) -> Vec<String> {
    let (attained, _) = range(rows, |row| row.attained_um[2] / row.tight_um[2]);
    let (_, published) = range(rows, |row| row.attained_um[2] / row.published_um[2]);
    let (low, high) = range(rows, |row| row.sampled_max_um[2] / row.tight_um[2]);
    let (_, ends) = range(rows, |row| row.sampled_ends_max_um[2] / row.tight_um[2]);
    let (_, neglected) = range(rows, |row| row.linearisation_um / row.tight_um[0]);
    vec![
        format!(
            "The tight bound is one: along z its factor √5 + √2 is attained to {attained:.5} in every case, where the \
             published factor 2 + √2 + 1/√2 is used to {published:.3} at most. Along x both are √2. Random draws are a poor \
             proof: evenly drawn, the largest of {DRAWS} comes to {low:.2} … {high:.2} of the bound, and to {ends:.3} with \
             sizes and errors at their ends."
        ),
        format!(
            "The linear displacement is good enough: it differs from the exact one by {} of the bound at most, and never by \
             more than M91 says.",
            three(neglected)
        ),
    ]
}

fn requirements(computed: &Computed) -> Vec<String> {
    let example = computed.example().and_then(|row| row.required.iter().find(|one| one.accuracy_um == 10.0));
    example.map_or_else(Vec::new, |needed| {
        vec![format!(
            "Angles decide. For 10 µm on a part of 200 mm, {:.0} % of it for the slides, these may be off by {} µm and the \
             angles by {} seconds of arc; a point lies up to 3.65 times the size of the part away from where its turning \
             is felt. Half the part, twice the angle. Whoever knows the offsets and the part uses M52, which needs no \
             common size.",
            100.0 * LINEAR_SHARE,
            three(needed.linear_um),
            three(3600.0 * needed.angular_deg)
        )]
    })
}

fn seam(computed: &Computed) -> Vec<String> {
    let report = &computed.seam.report;
    let [x, y, z] = report.slide.worst_mm;
    let used = report.limits_used.iter().map(|(axis, used)| {
        let most = used.velocity_pct.max(used.acceleration_pct).max(used.jerk_pct).max(used.jerk_rate_pct);
        format!("{axis} {most:.0} %")
    });
    vec![
        format!(
            "What is commanded lies on the seam within {} µm and on the bisector within {} °: the law follows the curve \
             itself, not chords of it. What is left is of the machine: {:.2} µm rms, most near ({x:.1}, {y:.1}, {z:.1}) mm; \
             axes turn back there against their backlash and friction.",
            three(report.commanded.max_abs_um()),
            three(report.commanded.angle_max_deg),
            report.slide.rms_um
        ),
        format!(
            "Limits of the axes that were used, most of speed, acceleration, jerk and its rate: {}.",
            used.collect::<Vec<_>>().join(", ")
        ),
    ]
}
