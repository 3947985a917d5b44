//! The words of the page. In: what was computed, where a sentence says a figure. Out: paragraphs and
//! captions.

use shape::{Correction, chord_feed, radius, tangent_feed};

use super::{Computed, MISPRINTED, Row, machine::Run, misprints::Misprint, three, um};

/// A figure of a row with the step that is shown first, times a factor.
fn figure(
    computed: &Computed,
    work: &str,
    correction: Correction,
    scale: f64,
    of: fn(&Row) -> f64,
) -> String {
    computed.row(work, correction, scale).map_or("–".into(), |row| um(of(row)))
}

/// The result in a few sentences.
pub(super) fn short(computed: &Computed, runs: &[Run]) -> Vec<String> {
    let next = |work, correction| figure(computed, work, correction, 1.0, |row| row.max_next_point_um);
    let worst_exact = computed.rows.iter().filter(|row| row.correction == Correction::Exact);
    let worst = worst_exact.map(|row| row.max_next_point_um).fold(0.0, f64::max);
    let twist = |correction| next(MISPRINTED, correction);
    vec![
        format!(
            "Exact ratios meet every reference point: the largest error of the next point over all works and steps is \
             {worst:.0e} µm, which is the rounding of positions."
        ),
        format!(
            "On a surface the published correction makes it worse as it is printed: on quad_twist {} µm without a \
             correction, {} µm as printed, {} µm with the signs put right, {} µm with the mixed term that (17) leaves out.",
            twist(Correction::None),
            twist(Correction::Published),
            twist(Correction::PublishedSigns),
            twist(Correction::Mixed)
        ),
        format!(
            "For a plane curve (13) is printed right: on c1 {} µm become {} µm. On a surface as well, the error \
             is of one order higher than without a correction only with the right signs and the mixed term.",
            next("c1", Correction::None),
            next("c1", Correction::PublishedSigns)
        ),
        on_the_machine(runs),
    ]
}

/// What the whole machine made of the wave with exact ratios.
fn on_the_machine(runs: &[Run]) -> String {
    let exact = runs.iter().find(|run| run.correction == Correction::Exact);
    exact.map_or_else(String::new, |run| {
        let report = &run.report;
        format!(
            "On the small mill the tip of a ball of 6 mm is commanded within {} µm of the surface on which it has to move \
             (asked for: 2 µm), and is truly within {:.2} µm of it (6 µm); where the feed of {:.0} mm/min is held, the true \
             feed is within {:+.2} … {:+.2} % of it (1 %).",
            three(report.commanded.max_abs_um()),
            report.slide.max_abs_um(),
            report.feed.programmed_mm_min,
            report.feed.true_low_pct,
            report.feed.true_high_pct
        )
    })
}

/// What was done.
pub(super) fn done() -> Vec<String> {
    let paragraphs = [
        "One axis leads, the others follow in a ratio to it: S_Y = K1 S_X, S_Z = K2 S_X. In a step h of the leader, \
         one cycle of the control, a ratio stays as it is. Without a correction it is the slope where the step begins \
         (M36, M37). The published method turns the slope by half the angle by which the path turns in the step (M38, \
         M39; on a surface in three sections, M41). Exact ratios are divided differences (M40): the way of the follower \
         over the step, by the way of the leader.",
        "Three plane curves, three paths on surfaces and one path of a ball on a surface are walked in steps that are \
         equal in the parameter of the path. Next point: a step starts on the work, and the error is how high it ends over \
         the curve or surface, along Z (Y of a plane curve). Accumulated: the steps are added up from the first, each with the \
         ratio of its reference point. Over the step: the largest distance from the surface, along its normal, on \
         the straight way of the step. Plan: how far the step ends aside of the path, seen from above.",
        "The ball moves on another surface than the one that it touches. Its gradient is that of the part at the point of \
         contact, its second derivatives are those of M93; the source leaves the tool out.",
        "Feed: the leader steps by S_X = S_k/(1 + K1² + K2²)^½ (M45), and the way on the work in each cycle is compared with \
         the one that is asked for.",
        "On the whole machine a few lines of the wave are cut, the job examples/shape/wave.toml with lines 10 mm apart, \
         once with each correction. The interpolator takes the ratios in every cycle of 2 ms, from the exact reference \
         point of the one before; regulators and plant are those of the small mill. The observer knows the true position of \
         the slides and measures how far the ball is from touching the surface.",
    ];
    paragraphs.into_iter().map(str::to_owned).collect()
}

/// What it means.
pub(super) fn meaning(computed: &Computed, runs: &[Run]) -> Vec<(&'static str, Vec<String>)> {
    vec![
        ("What is misprinted, and how that was established", misprinted(computed)),
        ("What it means", conclusions(computed, runs)),
    ]
}

fn found<'a>(computed: &'a Computed, equation: &str, what: &str) -> Option<&'a Misprint> {
    computed
        .misprints
        .iter()
        .find(|misprint| misprint.equation == equation && misprint.what.starts_with(what))
}

/// Errors of a misprint: without a correction, as printed, put right.
fn three_errors(computed: &Computed, equation: &str, what: &str) -> [String; 3] {
    found(computed, equation, what).map_or(Default::default(), |m| [m.none, m.printed, m.right].map(three))
}

fn misprinted(computed: &Computed) -> Vec<String> {
    let [none_14, printed_14, right_14] = three_errors(computed, "(14)", "−τ");
    let [none_15, printed_15, right_15] = three_errors(computed, "(15)", "−τ");
    let [none_16, printed_16, right_16] = three_errors(computed, "(16)", "−τ");
    let [_, angle_15, _] = three_errors(computed, "(15)", "angle");
    let [_, below_16, _] = three_errors(computed, "(16)", "Z_X");
    let [none_17, printed_17, right_17] = three_errors(computed, "(17)", "no");
    let order = |correction| {
        let row = computed.row(MISPRINTED, correction, 1.0);
        let order = row.and_then(|row| computed.order(row, |row| row.max_next_point_um));
        order.map_or("–".into(), |order| format!("{order:.1}"))
    };
    vec![
        format!(
            "(14) to (16), signs. The ratio of a section is the tangent of the sum of two angles, of the slope and of τ: (12), \
             and (13) for a plane curve, which has +τ above and −τ f′ below. (14) to (16) are the same for the \
             three sections of a surface and have −τ above. In each section alone the minus adds about as much as it should take \
             away: XOZ {none_14} µm without correction, {printed_14} µm as printed, {right_14} µm with plus; YOZ \
             {none_15}, {printed_15}, {right_15} µm; XOY, the path seen from above, {none_16}, {printed_16}, {right_16} µm. \
             (16) and (13) are of one and the same curve and cannot both be right."
        ),
        format!(
            "(15) and (16), names. A section has one derivative and one angle: in (15) Z_Y throughout, and the angle of YOZ, in \
             (16) dY/dX also below. In print another section's stand in places. With the angle of XOZ in (15) the error is \
             {angle_15} µm instead of {right_15} µm, with Z_X below in (16) it is {below_16} µm instead of {right_16} µm."
        ),
        format!(
            "(17), the sum. K_XOZ is taken at Y, K_YOZ at X: the sum misses how the slope along Y changes with X, Z_XY h k. \
             On quad_twist the error falls from {none_17} µm without correction to {printed_17} µm by the sum, and to \
             {right_17} µm with the missing term (M42). Over the step it goes with the power {} of h without correction, {} \
             as printed, {} with right signs, and {} with the mixed term as well: the sum alone is no better in \
             order than no correction. Where Z_XY = 0 nothing is missing.",
            order(Correction::None),
            order(Correction::Published),
            order(Correction::PublishedSigns),
            order(Correction::Mixed)
        ),
        m_of_10(computed),
        chord(computed),
        "Slips that change no figure here. (2) is a derivative by a parameter φ and has to end in φ′: on the path of \
         saddle φ = t/15, and without φ′ = 1/15 its feed would be 15 times too high. Before (7) the feeds of a plane curve \
         are S_Y = f′ S_X, as (3) has it. In the two lines before (12) τ stands where the second angle of the sum belongs."
            .into(),
        "The published formulas are compared as they are, evaluated on works whose errors are known; figures to \
         compare with are the reference values of 50 digits."
            .into(),
    ]
}

/// What (10) leaves open.
fn m_of_10(computed: &Computed) -> String {
    let of = |scale, correction| figure(computed, "circle", correction, scale, |row| row.max_next_point_um);
    format!(
        "(10), the factor m. It is left open; the angle from tangent to chord is the mean of the turning over the step, so m = ½ \
         in the limit of small steps, and exactly so on a circle if the length of the step is that of its arc. (10) has the \
         length of the tangent, which leaves an error of the next order: on circle {} µm with a step of 0.5 mm and {} µm with \
         a quarter of it, where {} and {} µm are left without correction. On c1 the exact m is between 0.3 \
         and 0.7 but for the places near an inflection (last picture but those of the machine).",
        of(1.0, Correction::PublishedSigns),
        of(0.25, Correction::PublishedSigns),
        of(1.0, Correction::None),
        of(0.25, Correction::None)
    )
}

/// (21) to (23): the limit of the feed by the chord error.
fn chord(computed: &Computed) -> String {
    let Some(work) = computed.work("c1") else { return String::new() };
    let r = radius(&work.path(work.text.t[0]));
    let (delta, dt) = (0.005, 0.001);
    let chord = chord_feed(r, delta, dt);
    let tangent = tangent_feed(r, delta, dt);
    let at_chord_feed = (chord * dt) * (chord * dt) / (2.0 * r);
    format!(
        "(21) to (23), the limit of the feed. δ = l²/8R is the error of a chord, a step that ends on the curve. Steps along the \
         tangent, without correction, end l²/2R beside it. On c1 at X = −20 mm, R = {} mm, 5 µm and 1 ms allow {} mm/s \
         of chords; at that feed a tangent step ends {} µm beside the curve, and {} mm/s is its limit (M44).",
        three(r),
        three(chord),
        three(1e3 * at_chord_feed),
        three(tangent)
    )
}

fn conclusions(computed: &Computed, runs: &[Run]) -> Vec<String> {
    let of = |correction, of: fn(&Row) -> f64| figure(computed, "sin_cos", correction, 1.0, of);
    vec![
        "A control that can evaluate the formula of a curve at the end of a step needs no correction of its slope: the exact \
         ratio costs one evaluation and has no error there. This is what pitchlock does by default. The other corrections can be \
         chosen in a job, to see what they do."
            .into(),
        format!(
            "Ratios that are summed add up their errors, on sin_cos to {} µm without a correction and to {} µm with the \
             mixed term over 8 mm. Every step has to start from the exact reference point, or from the point that was \
             really reached.",
            of(Correction::None, |row| row.max_accumulated_um),
            of(Correction::Mixed, |row| row.max_accumulated_um)
        ),
        "Between two reference points what is left is the error of the chord; it sets the feed (M44), with the radius of \
         curvature of the path in space."
            .into(),
        "Where a slope is large the ratio is, and so is its error; the axis with the largest way has to lead. Then no ratio \
         is above 1, and the leader never stands still while another axis moves."
            .into(),
        what_the_machine_shows(runs),
    ]
}

fn what_the_machine_shows(runs: &[Run]) -> String {
    let commanded = |correction| {
        let run = runs.iter().find(|run| run.correction == correction);
        run.map_or("–".into(), |run| three(run.report.commanded.max_abs_um()))
    };
    format!(
        "On the machine the commanded positions are off by {} µm without a correction, {} µm with the published one, {} µm with its \
         signs put right, {} µm with the mixed term and {} µm with exact ratios. A cycle of 2 ms makes 0.1 mm of way: l²/2R is \
         0.4 µm where the path of the tip has a radius of 12.5 mm, and the minus sign doubles it. The true positions hardly \
         show it. What they are off by comes from friction, which changes its side with the direction of a line, and from the \
         elasticity behind the motors.",
        commanded(Correction::None),
        commanded(Correction::Published),
        commanded(Correction::PublishedSigns),
        commanded(Correction::Mixed),
        commanded(Correction::Exact)
    )
}

pub(super) fn summary() -> String {
    "With the step that is shown first. Order: power of the step with which the error falls, from that step to a quarter of \
     it. Rounding: less than 1e-6 µm. Over the step even exact ratios have the error of the chord, l²/8R."
        .into()
}

pub(super) fn leaders() -> String {
    "On circle the slope goes from 0 to 9.5; steps are 0.5 mm along it. Distance: of the next point from the circle, along its \
     normal. What is left of the corrected ratio grows with the slope where X leads."
        .into()
}

pub(super) fn machine() -> String {
    "Deviation: how far the ball is from touching the surface, positive where it stands off; commanded, and true at the \
     slides. Feed held: share of the time in which the commanded feed is within 1 % of the programmed one; it is \
     lower at the ends of lines. True feed: where it is held. Limits: largest commanded speed, acceleration, jerk or jerk rate \
     of an axis, in per cent of its limit. A cycle makes 0.1 mm of way, so each correction leaves less than in the tables \
     above."
        .into()
}

pub(super) fn works() -> String {
    "The first two curves, quad_twist and sin_cos are the cases of the reference values, with their paths and steps."
        .into()
}

pub(super) fn every() -> String {
    "Every row of the JSON document.".into()
}
