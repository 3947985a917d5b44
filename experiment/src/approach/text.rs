//! The words of the page. In: measured passes where a sentence says a figure. Out: paragraphs and captions.

use machine::{Feedforward, Machine};
use protocol::Axis;
use sim_plant::Belief;

use super::{Done, goals::Goal, micrometres};
use report::table::six;

/// The result in a few sentences.
pub(super) fn short(done: &[Done], goals: &[Goal]) -> Vec<String> {
    let [approach, end, depth, thread, tuned_approach, tuned_end, tuned_depth, tuned_thread] =
        [0, 1, 2, 3, 4, 5, 6, 7]
            .map(|n| goals.get(n).map_or_else(String::new, |goal| micrometres(goal.measured)));
    let at_100 = |structure: Feedforward| {
        let rows = done.iter().map(|done| &done.row).filter(|row| row.structure == structure && !row.tuned);
        let errors = rows.filter(|row| row.override_pct == 100.0);
        micrometres(errors.map(|row| row.approach_max_um.max(-row.approach_min_um)).fold(0.0, f64::max))
    };
    let open: Vec<&str> = goals.iter().filter(|goal| !goal.is_held()).map(|goal| goal.what).collect();
    vec![
        format!(
            "With every feedforward from the law, each at its own lead, X stays within ±{approach} µm in the approach, \
             ±{end} µm at its end, ±{depth} µm in the thread from its beginning and ±{thread} µm from one turn on, at \
             every override from 40 to 120 % and over ten seeds; after pitchlock tune within ±{tuned_approach}, \
             ±{tuned_end}, ±{tuned_depth} and ±{tuned_thread} µm."
        ),
        format!(
            "Published are ±8 µm. Differences of positions of 1 µm, the structure that explains that band, leave ±{} µm at \
             100 % (speed and acceleration) and ±{} µm (speed alone); the position loop alone leaves {} µm.",
            at_100(Feedforward::DifferenceVa),
            at_100(Feedforward::DifferenceV),
            at_100(Feedforward::None)
        ),
        if open.is_empty() {
            "Everything that is asked for is held.".into()
        } else {
            format!("What is asked for is held but for: {}.", open.join("; "))
        },
    ]
}

/// What was done.
pub(super) fn done(machine: &Machine, truth: &Belief) -> Vec<String> {
    let percent = |believed: f64, true_value: f64| format!("{:+.0} %", 100.0 * (believed / true_value - 1.0));
    let believed = machine.axis.get(&Axis::X).map_or_else(String::new, |x| {
        let (mass, friction) = (percent(x.mass_kg, truth.mass_kg), percent(x.coulomb_n, truth.coulomb_n));
        format!("The controller believes the mass of X to be off by {mass} and its friction by {friction}.")
    });
    let paragraphs = [
        "The whole machine runs a program of one pass: the spindle turns at 300 1/min, X moves 5 mm to depth while the \
         spindle turns by 360° (peak acceleration 1 m/s²), and Z cuts six turns of a thread with a lead of 5 mm. The \
         machine code is the same in every case; the override knob stands at its place from the start.",
        &believed,
        "Six structures of feedforward (key feedforward of [axis.x]) are compared. none: the position loop alone. \
         difference-v and difference-va: references rounded to 1 µm and held for 1 ms, speed (and acceleration) by \
         their differences, as in a control whose position loop runs at 1 kHz on positions of an interpolator. \
         analytic-v: the speed of the law. analytic-va-no-lead: speed and acceleration of the law at the instant of \
         measuring. full: speed and acceleration of the law, each ahead by the delay of its way to the motor, and \
         friction with presliding.",
        "Servo error: analytic reference at the observed spindle angle minus measured position, both of the same \
         instant, in every control cycle. End: the first cycle after the stroke. At depth: from the end on. Thread: \
         from one turn after the end, when the approach has died away. Limits of supervision are widened for the \
         structures that are made only to be compared with.",
    ];
    paragraphs.into_iter().map(str::to_owned).collect()
}

/// What it means.
pub(super) fn meaning(machine: &Machine) -> Vec<(&'static str, Vec<String>)> {
    let counts = machine.spindle_counts();
    let whole_rpm = six(60.0 / (counts * machine.general.cycle_s));
    vec![
        (
            "Where the ±8 µm come from",
            vec![
                "A speed that is the difference of two positions is the speed of half a cycle ago, and it is held for \
                 a cycle more. At 1 m/s² and 1 kHz that is a speed 0.5 to 1 mm/s too low or too high: the velocity \
                 loop takes it for a missing acceleration, and the position loop has to make up for it. This is the \
                 part in the shape of the acceleration, and the reason why the error at the end has a sign."
                    .into(),
                "Rounding to 1 µm makes steps of 1 mm/s in a speed by differences at 1 kHz, and of 1 m/s² in an \
                 acceleration: as much as the law has at its peak. The loops filter it, and a few micrometres remain, \
                 together with most of the noise of the torque."
                    .into(),
                format!(
                    "The angle of the spindle comes in counts, and a count is a step of the reference: X moves 10 mm a \
                     turn at its fastest, which is {} µm for each of {counts} counts. The observer smooths what is faster \
                     than its bandwidth. At speeds where the encoder gives a whole number of counts in a control cycle \
                     (on this machine every multiple of {whole_rpm} 1/min) the rounding of the counts changes slowly, and \
                     the observer cannot tell it from motion. This part does not come from the structure, and a finer \
                     encoder takes it away.",
                    six(1e4 / counts)
                ),
                "The published band does not shrink with the override, where a missing acceleration would shrink with \
                 the square of the speed. That speaks for a part that does not depend on speed in that axis, \
                 quantisation or the breaking away of friction; it is a conclusion, not a measurement."
                    .into(),
            ],
        ),
        (
            "What it means",
            vec![
                "First in order is the alignment in time of the speed that is fed forward, then an acceleration that is \
                 missing or wrong, then the count of the spindle encoder times the bandwidth of the observer, then \
                 friction, then the encoder of the axis. The table of structures takes them away one after the other."
                    .into(),
                "The error at the end is what the first turn of a thread begins with. It comes from the mass that is \
                 believed wrongly, grows with the square of the speed, and dies away with the integral of the velocity \
                 loop; pitchlock tune finds the mass."
                    .into(),
                "All of this is at the encoder of the motor. The slide behind it differs by the force over the stiffness: \
                 see the slide error in the report of a run."
                    .into(),
            ],
        ),
    ]
}

pub(super) fn condensed() -> String {
    "At one seed. Tuned: as pitchlock tune sets the machine up, from measurements of test moves alone.".into()
}

pub(super) fn chance() -> String {
    "Each interval holds the results of ten seeds, which put encoders and spindle elsewhere at the start. At depth: from \
     the end of the approach on; thread: from one turn later."
        .into()
}

pub(super) fn beside_the_paper() -> String {
    "The paper shows servo errors within ±8 µm in the approach and 0 … −1 µm at its end at these three overrides. Here \
     loops and encoder are those of the machine file; experiment reference has those of the reference simulation."
        .into()
}

pub(super) fn full() -> String {
    "Every row of the JSON document. At depth: from the end of the approach on; thread: from one turn later."
        .into()
}
