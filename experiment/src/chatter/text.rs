//! The words of the page. In: rows and threads, where a sentence says a figure. Out: paragraphs.

use super::{ASKED, MODE, NAMED_RPM, Period, Row, SLOW_RPM, STIFFNESS_N_MM2, lathe::Thread};

fn named(rows: &[Row]) -> Option<&Row> {
    rows.iter().find(|row| row.rpm == NAMED_RPM)
}

/// Largest swing of a thread, µm.
fn swing_um(threads: &[Thread], varied: bool) -> f64 {
    let of = threads.iter().filter(|thread| thread.varied == varied).flat_map(|thread| &thread.passes);
    of.map(|pass| pass[2]).fold(0.0, f64::max)
}

/// The result in a few sentences.
pub(super) fn short(rows: &[Row], threads: &[Thread]) -> Vec<String> {
    let mut sentences = Vec::new();
    sentences.extend(named(rows).map(|row| {
        let held = if row.gain >= ASKED { "held" } else { "not held" };
        format!(
            "At S{NAMED_RPM} a sine of ±{:.0} % over {:.1} revolutions raises the stable width of the chip from {:.2} to \
             {:.2} mm, {:.2} times; asked for is {ASKED}: {held}.",
            row.percent, row.revolutions, row.even_mm, row.sine_mm, row.gain
        )
    }));
    let [even, varied] = [false, true].map(|varied| swing_um(threads, varied));
    sentences.push(format!(
        "The same thread cut on the whole lathe at S{NAMED_RPM}: the depth at the tool swings by up to {even:.0} µm at the \
         even speed and {varied:.0} µm at the varied one."
    ));
    sentences.extend(useless(rows));
    sentences
}

/// Where it does not help.
fn useless(rows: &[Row]) -> Option<String> {
    let useless = rows.iter().filter(|row| row.gain < 1.05).count();
    let last = rows.iter().rfind(|row| row.gain >= ASKED)?;
    let fastest = rows.last()?;
    Some(format!(
        "It does not help everywhere: at {useless} of {} speeds it gains less than 5 %. Above S{:.0} it gains {ASKED} times \
         nowhere, and at S{:.0} it gains {:.2} times: the drive cannot vary so fast a spindle within the turns of a thread. \
         Nor does a period of one turn help: see the table of periods.",
        rows.len(),
        last.rpm,
        fastest.rpm,
        fastest.gain
    ))
}

/// What was done.
pub(super) fn done(speeds: usize) -> Vec<String> {
    vec![
        format!(
            "A tool that gives way across the groove in one mode (stiffness {:.0} N/µm, {:.0} Hz, damping {}) cuts steel, \
             {STIFFNESS_N_MM2:.0} N across the groove for each mm of the chip's thickness and of its width. It meets what \
             the turn before left. At {speeds} speeds from {:.0} to {:.0} 1/min the widest chip was searched at which a \
             swing dies away: at an even speed, and at one that is varied by sine, triangle and random levels.",
            1e-3 * MODE.stiffness_n_mm,
            MODE.hz,
            MODE.damping,
            super::SPEEDS.0,
            super::SPEEDS.1
        ),
        "The variation at each speed is the strongest that the machine proves it can do in a thread of lead 2: ±30 % over \
         the shortest period from 1.5 revolutions on that the ramp of its drive allows; where even ten revolutions are \
         too short for that, the largest per cent over ten. The model is the one that [plant.chatter] of the machine file \
         switches on."
            .into(),
        format!(
            "Then a thread of 2 mm lead was cut twice on the whole lathe with that tool, at S{NAMED_RPM}: passes to 1.9 mm over 110 mm, \
             once at an even and once at the varied speed."
        ),
    ]
}

/// What a period of whole fractions of a turn does.
fn synchronous(periods: &[Period]) -> String {
    let gain = |revolutions| {
        periods.iter().find(|period| period.revolutions == revolutions).map_or(0.0, |one| one.gain)
    };
    format!(
        "A period of one turn, or of a whole part of it, does not help either: each turn is like the one before, and what the \
         tool meets is always as late as before. At S{SLOW_RPM} ±30 % over half a turn gain {:.2} times, over one turn {:.2}, over \
         1.25 turns {:.2}. Two turns ({:.2}) gain less than 1.5 ({:.2}): every other turn is like the one before the last.",
        gain(0.5),
        gain(1.0),
        gain(1.25),
        gain(2.0),
        gain(1.5)
    )
}

/// What it means.
pub(super) fn meaning(rows: &[Row], periods: &[Period]) -> Vec<(&'static str, Vec<String>)> {
    let strongest = rows.iter().max_by(|a, b| a.gain.total_cmp(&b.gain));
    let best = strongest.map_or_else(String::new, |row| {
        format!(" The most here is {:.2} times, at S{:.0}.", row.gain, row.rpm)
    });
    vec![
        (
            "What it means",
            vec![
                format!(
                    "Chatter lives on the wave that the turn before left: it grows where each turn meets the last one out of step. \
                     At a varied speed the number of waves in a turn changes from turn to turn, so that no turn meets the \
                     last one like that for long.{best}"
                ),
                "A fast spindle can hardly be varied within the turns that a thread has: the same change of speed takes the \
                 square of it in acceleration, and the drive has what it has. What is left there are the lobes themselves: a \
                 speed in a pocket between two of them."
                    .into(),
                synchronous(periods),
            ],
        ),
        (
            "What the model is not",
            vec![
                "One mode, a force proportional to the chip, no damping of the flank in the work (which helps slow spindles). A \
                 single point in a thread meets what the pass before left, not the turn before: this is the tool of several \
                 teeth. Figures say what is to be expected of the method, not of a lathe that nobody measured."
                    .into(),
            ],
        ),
    ]
}
