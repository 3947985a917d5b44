//! What is said of the rows. In: rows. Out: paragraphs.

use super::{Case, Row, SEEDS, alone::PHASES, um};
use crate::experiment::{stand::Stand, table::six};

fn row(rows: &[Row], lines: u32, bandwidth_hz: f64, case: Case) -> Option<&Row> {
    rows.iter().find(|row| (row.lines, row.bandwidth_hz, row.case) == (lines, bandwidth_hz, case))
}

fn alone(rows: &[Row], lines: u32, bandwidth_hz: f64, case: Case) -> String {
    um(row(rows, lines, bandwidth_hz, case).map(|row| row.helix_max_abs_um))
}

fn cut(rows: &[Row], lines: u32, bandwidth_hz: f64, case: Case) -> String {
    um(row(rows, lines, bandwidth_hz, case).and_then(|row| row.machine_helix_max_abs_um))
}

pub(super) fn short(rows: &[Row]) -> Vec<String> {
    let cases = [Case::Constant, Case::OverrideRamp, Case::Dip];
    let [constant, ramp, dip] = cases.map(|case| alone(rows, 2500, 40.0, case));
    let [cut_constant, cut_ramp, cut_dip] = cases.map(|case| cut(rows, 2500, 40.0, case));
    vec![format!(
        "With 2500 lines and 40 Hz the observer leaves {constant} µm of helix at constant speed, {ramp} in an override ramp \
         and {dip} in a dip; on the whole machine a pass has {cut_constant}, {cut_ramp} and {cut_dip} µm."
    )]
}

pub(super) fn done(stand: &Stand) -> Vec<String> {
    let cycle_ms = six(1e3 * stand.machine.machine.cycle_s);
    vec![
        format!(
            "The observer (M53) is given rounded angles of a spindle whose true angle is known, at 1 kHz as in the \
             reference, and the largest difference is taken as an error of a helix with a lead of 5 mm. Each case is made \
             {PHASES} times with the counts of the encoder elsewhere; the table has the median, the rows the worst, too."
        ),
        format!(
            "Then a pass of a thread with that lead is cut on the whole machine, in its own control cycle of {cycle_ms} ms, and \
             the true position of Z is compared with the true angle of the spindle. There the spindle has ripple, inertia \
             and a drive, and Z has mass and friction. The largest error of {SEEDS} seeds counts. At 0.2 1/min a turn takes \
             300 s, so that case is made once, with the encoder and the observer of the machine file."
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
             µm at constant speed with 20 Hz and {} with 40 Hz, 2500 lines {} and {}. With 100 lines it is micrometres; from \
             some thousand lines on, changes of the spindle's speed are what is left."
            ,
            alone(rows, 1024, 20.0, Case::Constant),
            alone(rows, 1024, 40.0, Case::Constant),
            alone(rows, 2500, 20.0, Case::Constant),
            alone(rows, 2500, 40.0, Case::Constant),
        ),
        format!(
            "Asked of the machine with 2500 lines are 0.6 µm at constant speed, 1.0 in the ramp, 1.2 in the dip and 0.5 at 0.2 1/min. \
             With 40 Hz it has {}, {}, {} and {}.",
            cut(rows, 2500, 40.0, Case::Constant),
            cut(rows, 2500, 40.0, Case::OverrideRamp),
            cut(rows, 2500, 40.0, Case::Dip),
            cut(rows, 2500, 40.0, Case::Slow),
        ),
        "On the machine there is more than the observer: the ripple of the spindle, and the servo error of Z, which the \
         observer's noise and lag make larger. Z is fed forward with the speed and acceleration at which the estimate itself \
         moves, corrections among them; with the observed speed alone an override ramp would cost half as much again. A speed \
         at which whole counts come in a cycle, as 300 1/min with 2500 lines and 0.5 ms, is bad: rounding does not \
         average out there, and the override ramp ends at it. At 0.2 1/min counts come one by one; the machine's observer takes \
         a quarter of its bandwidth then, which the observer of the tables does not."
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
            let beyond = (row.helix_max_abs_um - printed).abs() > 0.2 * printed + 0.005;
            let (lines, bandwidth) = (row.lines, six(row.bandwidth_hz));
            let (found, case) = (um(Some(row.helix_max_abs_um)), row.case.name());
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
         rounds the corners. And at constant speed it depends on the speed how rounding beats with the cycle: 5000 lines and \
         30 Hz leave 0.03 to 0.08 µm between 496 and 507 1/min.",
        count - apart.len(),
        apart.join("; "),
        alone(rows, 250_000, 20.0, Case::Dip),
        alone(rows, 250_000, 30.0, Case::Dip),
        alone(rows, 250_000, 40.0, Case::Dip),
    )
}
