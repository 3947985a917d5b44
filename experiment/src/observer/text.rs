//! What is said of the rows. In: rows. Out: paragraphs.

use super::{ASKED_LINES, Case, Row, SEEDS, alone::PHASES, goals::Goal, um};
use crate::stand::Stand;
use report::table::six;

fn row(rows: &[Row], lines: u32, bandwidth_hz: f64, case: Case) -> Option<&Row> {
    rows.iter().find(|row| row.is_of(lines, bandwidth_hz, case))
}

/// What the regulator's observer leaves alone.
fn alone(rows: &[Row], lines: u32, bandwidth_hz: f64, case: Case) -> String {
    um(row(rows, lines, bandwidth_hz, case).map(|row| row.observer_max_abs_um))
}

/// What the observer of the reference leaves.
fn m53(rows: &[Row], lines: u32, bandwidth_hz: f64, case: Case) -> String {
    um(row(rows, lines, bandwidth_hz, case).map(|row| row.m53_max_abs_um))
}

pub(super) fn short(goals: &[Goal], bandwidth_hz: f64) -> Vec<String> {
    let found: Vec<String> =
        goals.iter().map(|goal| format!("{} {}", goal.case.name(), um(goal.found_um))).collect();
    let open: Vec<&str> = goals.iter().filter(|goal| !goal.is_held()).map(|goal| goal.case.name()).collect();
    vec![
        format!(
            "With {ASKED_LINES} lines and {} Hz true Z stays this near to the true helix, in µm: {}.",
            six(bandwidth_hz),
            found.join(", ")
        ),
        if open.is_empty() {
            "Everything that is asked for is held.".into()
        } else {
            format!("What is asked for is held but for: {}.", open.join("; "))
        },
    ]
}

pub(super) fn done(stand: &Stand) -> Vec<String> {
    let cycle_ms = six(1e3 * stand.machine.general.cycle_s);
    let own_hz = six(stand.machine.spindle.observer_hz);
    vec![
        format!(
            "A pass of a thread with a lead of 5 mm is cut on the whole machine, in its control cycle of {cycle_ms} ms, and the \
             true position of Z is compared with the true angle of the spindle. The spindle has ripple, inertia and a \
             drive, and Z has mass and friction. Constant: 500 1/min. Override ramp: to 300 1/min within 0.3 s. Dip: 3 % \
             less within 15 ms. Slow: 0.2 1/min. Force: 200 N along Z come on within 10 ms. The largest error of \
             {SEEDS} seeds counts. At 0.2 1/min a turn takes 300 s, so that case is made once, with the bandwidth of the \
             machine file, {own_hz} Hz."
        ),
        format!(
            "Besides, observers alone are given rounded angles of a spindle whose true angle is known, at 1 kHz as in the \
             reference, and the largest difference is taken as an error of the same helix: the observer of the reference \
             (M53), and that of the regulator, which takes what lies within the rounding of a count more quietly. Each case \
             is made {PHASES} times with the counts of the encoder elsewhere; the tables have the median, the rows the worst, \
             too."
        ),
    ]
}

pub(super) fn meaning(rows: &[Row]) -> Vec<(&'static str, Vec<String>)> {
    vec![("What it means", meant(rows)), ("Beside the reference", vec![compared(rows)])]
}

fn meant(rows: &[Row]) -> Vec<String> {
    vec![
        "A triple pole follows a constant acceleration without error. What it does not follow is the beginning and the end of \
         one: for a step of the acceleration by A the error of the angle is A t²/2 · exp(−2π f t), at most 0.27 A/(2π f)². So \
         twice the bandwidth is a quarter of the error, until the rounding of the encoder is what is left."
            .into(),
        format!(
            "Rounding is averaged over the counts that pass within 1/2πf. A coarse encoder pays for bandwidth: 1024 lines leave {} \
             µm at constant speed with 20 Hz and {} with 40 Hz, 2500 lines {} and {}, 100 lines {} and {}. With fine encoders \
             changes of the spindle's speed are what is left.",
            alone(rows, 1024, 20.0, Case::Constant),
            alone(rows, 1024, 40.0, Case::Constant),
            alone(rows, 2500, 20.0, Case::Constant),
            alone(rows, 2500, 40.0, Case::Constant),
            alone(rows, 100, 20.0, Case::Constant),
            alone(rows, 100, 40.0, Case::Constant),
        ),
        "On the machine there is more than the observer: the ripple of the spindle, and the servo error of Z, which the \
         observer's noise and lag make larger. Z is fed forward with the speed and acceleration at which the estimate itself \
         moves, corrections among them. A speed at which whole counts come in a cycle, as 300 1/min with 2500 lines and 0.5 \
         ms, is bad: rounding does not average out there. A force on Z does not touch the observer: what it leaves is how \
         far Z gives way before its loops answer."
            .into(),
        "Which bandwidth: a faster observer follows a bogged spindle better, a slower one passes less rounding on to the axes; \
         `spindle.observer_hz` chooses."
            .into(),
    ]
}

/// Names what is more than 20 % away from the reference.
fn compared(rows: &[Row]) -> String {
    let apart: Vec<String> = rows
        .iter()
        .filter_map(|row| {
            let printed = row.printed_um?;
            // The reference is printed to a hundredth: what rounds to within 20 % of it is.
            let beyond = (row.m53_max_abs_um - printed).abs() > 0.2 * printed + 0.005;
            let (lines, bandwidth) = (row.lines, six(row.bandwidth_hz));
            let (found, case) = (um(Some(row.m53_max_abs_um)), row.case.name());
            beyond.then(|| format!("{lines} lines, {bandwidth} Hz, {case}: {found} µm for {printed:.2}"))
        })
        .collect();
    let count = rows.iter().filter(|row| row.printed_um.is_some()).count();
    if apart.is_empty() {
        return format!("All {count} figures of the reference are reproduced within 20 %.");
    }
    format!(
        "{} of {count} figures of the reference are reproduced within 20 %. Those that are not: {}. Two things explain them. The \
         speed changes its slope at once here; with 250 000 lines, where nothing is rounded, that alone leaves {}, {} and {} µm \
         in a dip at 20, 30 and 40 Hz, more than the reference has with a real encoder: there the spindle has a drive, which \
         rounds the corners. And at constant speed it depends on the speed how rounding beats with the cycle.",
        count - apart.len(),
        apart.join("; "),
        m53(rows, 250_000, 20.0, Case::Dip),
        m53(rows, 250_000, 30.0, Case::Dip),
        m53(rows, 250_000, 40.0, Case::Dip),
    )
}
