//! What is said of the rows. In: rows. Out: paragraphs.

use super::{
    Row,
    reference::{Beside, PRINTED, Printed, as_there},
    span, um,
};

fn with(rows: &[Row], quantum_mm: Option<f64>) -> Option<&Row> {
    rows.iter().find(|row| row.quantum_mm == quantum_mm)
}

fn approach(rows: &[Row], quantum_mm: Option<f64>) -> String {
    with(rows, quantum_mm).map_or("–".into(), |row| span(row.approach_min_um, row.approach_max_um))
}

fn noise(rows: &[Row], quantum_mm: Option<f64>) -> String {
    with(rows, quantum_mm).map_or("–".into(), |row| super::nm(row.torque_noise_nm))
}

pub(super) fn short(rows: &[Row]) -> Vec<String> {
    vec![format!(
        "Differences of positions in steps of 1 µm leave {} µm of servo error in the approach, and the torque steps by \
         {} N·m. From 1e-5 mm on nothing more is gained: {} µm and {} N·m; what is left is the delay of holding a \
         position, not its resolution. The law itself, neither rounded nor held, leaves {} µm and {} N·m.",
        approach(rows, Some(1e-3)),
        noise(rows, Some(1e-3)),
        approach(rows, Some(1e-6)),
        noise(rows, Some(1e-6)),
        approach(rows, None),
        noise(rows, None)
    )]
}

pub(super) fn done() -> Vec<String> {
    vec![
        "X makes the approach of the published experiment on the whole machine: 5 mm in one turn of the spindle at 300 \
         1/min. Its regulator sees positions in steps of a quantum. It makes the speed by a first difference of them \
         and the acceleration by a second, each about the lead of its feedforward, and holds the reference and its \
         output for two control cycles. The last line has the law itself, as the machine normally does. Servo errors \
         are the analytic reference minus the measurement at the instant of measuring."
            .into(),
        "The published method asks how fine positions, speeds, accelerations and jerks have to be. Its figures are \
         computed by the library that also serves the machine, and tests compare them with reference values of fifty \
         digits."
            .into(),
    ]
}

pub(super) fn meaning(rows: &[Row], beside: &[Beside]) -> Vec<(&'static str, Vec<String>)> {
    vec![
        ("What it means", result(rows)),
        ("Beside the reference simulation", compared(beside)),
        ("What is done about it here", here()),
    ]
}

fn result(rows: &[Row]) -> Vec<String> {
    vec![
        "The n-th difference of rounded positions errs by up to 2ⁿ⁻¹ counts per cycleⁿ, with an rms of 0.41, 0.71 and \
         1.29 (M28). A count of 1 µm at 1 kHz is 0.7 m/s² rms of acceleration, as much as the approach has itself. The \
         torque noise follows from this alone (M77, the line in the picture): it is proportional to the quantum until \
         it reaches the limit of the drive above, and the noise of the encoders below."
            .into(),
        format!(
            "The servo error is less touched, because the mass of the axis swallows most of the noise: {} µm with 1e-3 \
             mm, {} µm with 1e-4 mm, {} µm with 1e-5 mm. Finer steps matter for what is differenced once more, the jerk.",
            approach(rows, Some(1e-3)),
            approach(rows, Some(1e-4)),
            approach(rows, Some(1e-5))
        ),
    ]
}

/// A figure here over that of the reference.
fn ratio(rows: &[Row], quantum_mm: f64, here: fn(&Row) -> f64, there: fn(&Printed) -> f64) -> String {
    let printed = PRINTED.iter().find(|printed| printed.quantum_mm == Some(quantum_mm));
    let pair = with(rows, Some(quantum_mm)).zip(printed);
    pair.map_or("–".into(), |(row, printed)| format!("{:.2}", here(row) / there(printed)))
}

fn compared(beside: &[Beside]) -> Vec<String> {
    let there = as_there(beside);
    let end = |longer_s: f64| {
        let found = beside.iter().find(|beside| beside.longer_s == longer_s);
        found.and_then(|beside| with(&beside.rows, Some(1e-6))).map_or("–".into(), |row| um(row.end_um))
    };
    let fine = |longer_s: f64| {
        let found = beside.iter().find(|beside| beside.longer_s == longer_s);
        found.map_or("–".into(), |beside| approach(&beside.rows, Some(1e-6)))
    };
    vec![
        format!(
            "The reference says that what remains with fine positions, −2.7 … +2.4 µm, is the hold of 1 ms. It is the delay \
             of the hold. With the leads of the machine file the approach stays within {} µm and ends at {} µm; with leads \
             that are longer by 0.25 ms, which is by how much a hold of two cycles delays more than one of one, within {} \
             µm and at {} µm; with 0.5 ms more within {} µm and at {} µm. The reference ends at +0.5 µm, so its leads were \
             also longer.",
            fine(0.0),
            end(0.0),
            fine(0.25e-3),
            end(0.25e-3),
            fine(0.5e-3),
            end(0.5e-3)
        ),
        format!(
            "So the table beside the reference has leads 0.5 ms longer. With fine positions, 1e-6 mm, the span of its servo \
             errors is {} times that of the reference, and at 1e-4 mm the torque noise {} times. With coarser positions \
             chance rules: the reference shows one pass, and with 1e-2 mm, where the torque runs into its limit, the ten \
             seeds reach from {} to {} µm.",
            ratio(there, 1e-6, |row| row.approach_max_um - row.approach_min_um, |printed| {
                printed.approach_um[1] - printed.approach_um[0]
            }),
            ratio(there, 1e-4, |row| row.torque_noise_nm, |printed| printed.noise_nm),
            with(there, Some(1e-2)).map_or("–".into(), |row| um(row.approach_lowest_um)),
            with(there, Some(1e-2)).map_or("–".into(), |row| um(row.approach_highest_um))
        ),
        "The torque noise of the reference is the step of the torque that is asked for, from one held position to the \
         next; taken so, it agrees. The torque of the motor, behind the lag of its current loop, steps by about half \
         of it."
            .into(),
    ]
}

fn here() -> Vec<String> {
    vec![
        "Nothing is differenced. A setpoint carries position, speed and acceleration, a pass carries its law; both are \
         evaluated in double precision, each derivative in closed form. Positions on the wire are counts of 1e-9 mm: \
         even a jerk made by differences of them would be finer than the published step at the limits of this machine."
            .into(),
    ]
}
