//! The words of the page. In: rows where a sentence says a figure. Out: paragraphs.

use machine::Machine;

use super::{
    MEDIAN_UM, Row, WORST_UM,
    tables::{Over, from_worst},
};

/// How far X moves in a turn at the fastest of its stroke of 10 mm in 330°: twice the mean (M3), mm.
const PER_TURN_MM: f64 = 2.0 * 10.0 * 360.0 / 330.0;

/// The result in a few sentences; `finer` is the same with a spindle encoder of twice the lines.
pub(super) fn short(rows: &[Row], finer: &[Row]) -> Vec<String> {
    let all = Over::all(rows);
    let held = if all.median <= MEDIAN_UM && all.worst <= WORST_UM { "held" } else { "not held" };
    let mut sentences = vec![format!(
        "Over {} cases the largest servo error of X in the approach is {:.2} µm in the median and {:.2} µm in the worst \
         case; asked for are {MEDIAN_UM:.1} and {WORST_UM:.1} µm: {held}.",
        rows.len(),
        all.median,
        all.worst
    )];
    sentences.extend(from_worst(rows).first().map(|row| {
        format!(
            "Worst case: S {:.0} 1/min, ΔX {:.0} mm in ΔC {:.0}°, override {:.0} %, mass {:+.0} %, friction {:+.0} %, \
             seed {}.",
            row.s_rpm,
            row.delta_x_mm,
            row.delta_c_deg,
            row.override_pct,
            row.mass_error_pct,
            row.friction_error_pct,
            row.seed
        )
    }));
    let finer = Over::all(finer);
    sentences.push(format!(
        "With a spindle encoder of twice the lines the median is {:.2} µm and the worst case {:.2} µm.",
        finer.median, finer.worst
    ));
    sentences
}

/// What was done.
pub(super) fn done(cases: usize) -> Vec<String> {
    vec![
        format!(
            "{cases} passes were cut on the whole machine: ten approaches (spindle 200 to 600 1/min, stroke 2 to 10 mm, \
             made while the spindle turns by 180 to 900°), at four positions of the override knob, with what the \
             controller believes of X off by −15, 0 or +15 % in mass and by −40, 0 or +40 % in friction, each with two \
             seeds. Errors of belief are relative to the truth about the plant; friction is wrong in all its parts, \
             Coulomb, presliding and viscous. The gain of the velocity loop goes with the mass that is believed, as it \
             does in a drive."
        ),
        "The strokes are spread over what the axis can do: the shortest are near its limits of acceleration and jerk at \
         120 %. The ten passes of a condition are one program, so an approach begins with the friction that the one \
         before has left."
            .into(),
    ]
}

/// What it means.
pub(super) fn meaning(machine: &Machine) -> Vec<(&'static str, Vec<String>)> {
    let counts = machine.spindle_counts();
    vec![(
        "What it means",
        vec![
            "With a right mass the error is what the count of the spindle encoder makes of the reference, and what friction \
             does when the axis breaks away and turns. A wrong mass adds an error in the shape of the acceleration, which \
             grows with its peak."
                .into(),
            format!(
                "The encoder weighs most where X moves far in a turn: the stroke of 10 mm in 330° runs at up to {:.1} mm a \
                 turn, which is {:.1} µm for each of {counts:.0} counts. Where a speed gives a whole number of counts in a \
                 control cycle (here every multiple of {:.4} 1/min), their rounding changes as slowly as the ripple of the \
                 spindle, and the observer passes it on. A slower observer would let less of it through, and would follow \
                 a bogged spindle worse.",
                PER_TURN_MM,
                1e3 * PER_TURN_MM / counts,
                60.0 / (counts * machine.general.cycle_s),
            ),
            "A wrong friction changes the beginning of a stroke and hardly the end: the integral of the velocity loop \
             has found the friction by then."
                .into(),
        ],
    )]
}
