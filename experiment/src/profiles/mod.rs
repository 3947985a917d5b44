//! Experiment `profiles`: what an approach of 5 mm leaves in a lightly damped mode, for six laws of motion.
//! In: nothing but the constants below. Out: a row for each law, approach time and mode. µm, s, Hz.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | T | s | approach time |
//! | f, ζ | Hz, – | frequency and damping of the mode |
//! | N = f T/2 | – | periods of the mode in half the approach; the bound of M8a is ΔX/(π² N² (N² − 1)) |
//!
//! The drive is ideal: the motor is where the law says, and the mass swings behind it. The residual is the
//! largest deflection of the mass from the end of the approach on.

mod compared;
mod figures;
mod laws;
mod mode;
#[cfg(test)]
mod tests;

use motion::Stroke;
use serde::Serialize;

use report::table::{Place, Table};

use super::Findings;
use laws::Profile;
use mode::{DAMPING, Mode};

/// Length of the approach, mm.
const STROKE_MM: f64 = 5.0;

/// Approach times, s.
const APPROACHES_S: [f64; 4] = [0.1, 0.15, 0.2, 0.3];

/// Lowest and highest mode, Hz.
const MODES_HZ: [u32; 2] = [60, 120];

/// The mode that is shown for itself, Hz.
const SHOWN_HZ: f64 = 80.0;

/// What may be left for a thread, µm: the goal for X.
const QUIET_UM: f64 = 0.2;

/// Approach times that are searched for a quiet one, hundredths of a second.
const SEARCHED: std::ops::RangeInclusive<u32> = 5..=110;

/// Inputs and figures of one case.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    profile: Profile,
    approach_s: f64,
    mode_hz: f64,
    stroke_mm: f64,
    damping: f64,
    /// Largest deflection from the end of the approach on.
    residual_um: f64,
    /// Amplitude of the decaying swing at the end of the approach.
    amplitude_um: f64,
    /// M8a, for the law that it is of.
    bound_um: Option<f64>,
}

impl Row {
    fn of(profile: Profile, approach_s: f64, mode_hz: f64) -> Row {
        let left = Mode::at(mode_hz).residual(&profile.law(STROKE_MM, approach_s));
        let bound = || 1e3 * Stroke::new(STROKE_MM, approach_s).residual_bound(mode_hz);
        Row {
            profile,
            approach_s,
            mode_hz,
            stroke_mm: STROKE_MM,
            damping: DAMPING,
            residual_um: 1e3 * left.largest,
            amplitude_um: 1e3 * left.amplitude,
            bound_um: (profile == Profile::Sin2Acceleration).then(bound),
        }
    }
}

/// Modes from the lowest to the highest, `parts` to the Hz.
fn modes(parts: u32) -> impl Iterator<Item = f64> {
    let [low, high] = MODES_HZ;
    (low * parts..=high * parts).map(move |n| f64::from(n) / f64::from(parts))
}

fn rows() -> Vec<Row> {
    let cases = Profile::ALL.into_iter().flat_map(|profile| APPROACHES_S.map(|t| (profile, t)));
    cases.flat_map(|(profile, t)| modes(1).map(move |hz| Row::of(profile, t, hz))).collect()
}

/// Largest residual of a law among modes in µm, each `step_hz` apart.
fn largest(profile: Profile, approach_s: f64, step_hz: usize) -> f64 {
    let law = profile.law(STROKE_MM, approach_s);
    let left = modes(1).step_by(step_hz).map(|hz| 1e3 * Mode::at(hz).residual(&law).largest);
    left.fold(0.0, f64::max)
}

/// A law over many approach times.
struct Choice {
    profile: Profile,
    /// Approach time in s, and the largest residual of any mode in µm.
    largest: Vec<(f64, f64)>,
}

impl Choice {
    fn of(profile: Profile) -> Choice {
        let times = SEARCHED.map(|hundredths| 0.01 * f64::from(hundredths));
        Choice { profile, largest: times.map(|t| (t, largest(profile, t, 2))).collect() }
    }

    /// The approach time from which on no mode keeps more than `QUIET_UM`, s; to a hundredth.
    fn quiet_s(&self) -> Option<f64> {
        let quiet = self.largest.iter().rev().take_while(|(_, um)| *um <= QUIET_UM);
        quiet.last().map(|(t, _)| *t)
    }
}

/// Computes the rows with what is to be said and drawn of them.
pub(super) fn findings() -> Findings<Row> {
    let rows = rows();
    let choices = Profile::ALL.map(Choice::of);
    Findings {
        title: "What an approach leaves in a mode of the machine",
        short: short(&choices),
        done: done(),
        tables: vec![
            summary(&rows),
            laws(&choices),
            compared::table().at(Place::Page),
            every(&rows).at(Place::Details),
        ],
        notes: Vec::new(),
        figures: figures::all(&rows, &choices),
        text: meaning(&choices),
        rows,
    }
}

/// Three significant digits.
fn three(value: f64) -> String {
    if value.is_infinite() {
        return "∞".into();
    }
    format!("{value:.2e}").parse::<f64>().unwrap_or(value).to_string()
}

fn head(first: [&str; 2], unit: &str) -> Vec<[String; 2]> {
    let laws = Profile::ALL.map(|profile| [profile.name().into(), unit.to_owned()]);
    [first.map(str::to_owned)].into_iter().chain(laws).collect()
}

/// Largest of the rows of a law and an approach time, and that of the mode shown.
fn extremes(rows: &[Row], profile: Profile, approach_s: f64) -> (f64, f64) {
    let of = rows.iter().filter(|row| row.profile == profile && row.approach_s == approach_s);
    of.fold((0.0, 0.0), |(largest, shown), row| {
        let here = if row.mode_hz == SHOWN_HZ { row.residual_um } else { shown };
        (row.residual_um.max(largest), here)
    })
}

fn summary(rows: &[Row]) -> Table {
    let cell = |profile, t| {
        let (largest, shown) = extremes(rows, profile, t);
        format!("{} / {}", three(largest), three(shown))
    };
    let line = |t: f64| [t.to_string()].into_iter().chain(Profile::ALL.map(|law| cell(law, t))).collect();
    Table {
        title: format!(
            "Residual after {STROKE_MM} mm: largest of modes from {} to {} Hz / at {SHOWN_HZ} Hz",
            MODES_HZ[0], MODES_HZ[1]
        ),
        caption: "Modes in steps of 1 Hz.".into(),
        head: head(["approach_s", "s"], "µm"),
        rows: APPROACHES_S.into_iter().map(line).collect(),
        place: Place::Everywhere,
    }
}

fn laws(choices: &[Choice]) -> Table {
    let line = |choice: &Choice| {
        let peaks = choice.profile.peaks();
        let quiet = choice.quiet_s();
        let acceleration = quiet.map(|t| 1e-3 * peaks[1] * STROKE_MM / (t * t));
        let shown = |value: Option<f64>| value.map_or("–".into(), three);
        let name = [choice.profile.name().to_owned()].into_iter();
        name.chain(peaks.map(three)).chain([shown(quiet), shown(acceleration)]).collect()
    };
    let head = [
        ["law", ""],
        ["peak v", "ΔX/T"],
        ["peak a", "ΔX/T²"],
        ["peak j", "ΔX/T³"],
        ["quiet from T", "s"],
        ["peak a then", "m/s²"],
    ];
    Table {
        title: "The laws".into(),
        caption: format!(
            "Quiet: no mode from {} to {} Hz keeps more than {QUIET_UM} µm after {STROKE_MM} mm, at this approach time \
             and at every longer one; to a hundredth of a second.",
            MODES_HZ[0], MODES_HZ[1]
        ),
        head: head.map(|column| column.map(str::to_owned)).to_vec(),
        rows: choices.iter().map(line).collect(),
        place: Place::Everywhere,
    }
}

fn every(rows: &[Row]) -> Table {
    let of = |profile, t, hz| {
        let found = rows.iter().find(|r| r.profile == profile && r.approach_s == t && r.mode_hz == hz);
        found.map_or("–".into(), |row| three(row.residual_um))
    };
    let bound = |t, hz| three(1e3 * Stroke::new(STROKE_MM, t).residual_bound(hz));
    let cases = APPROACHES_S.into_iter().flat_map(|t| modes(1).map(move |hz| (t, hz)));
    let lines = cases.map(|(t, hz)| {
        let inputs = [t.to_string(), hz.to_string()].into_iter();
        inputs.chain(Profile::ALL.map(|law| of(law, t, hz))).chain([bound(t, hz)]).collect()
    });
    let mut head = head(["approach_s", "s"], "µm");
    head.insert(1, ["mode_hz".into(), "Hz".into()]);
    head.push(["bound of sin² acceleration".into(), "µm".into()]);
    Table {
        title: "Residual of every law at every mode".into(),
        caption: "The bound is that of M8a: without damping and at the worst phase.".into(),
        head,
        rows: lines.collect(),
        place: Place::Details,
    }
}

fn seconds(choices: &[Choice], profile: Profile) -> String {
    let quiet = choices.iter().find(|choice| choice.profile == profile).and_then(Choice::quiet_s);
    quiet.map_or("more than 1.1 s".into(), |t| format!("{t:.2} s"))
}

fn short(choices: &[Choice]) -> Vec<String> {
    let [quintic, sin2, trapezoid, cubic] =
        [Profile::Quintic, Profile::Sin2Acceleration, Profile::TrapezoidalSpeed, Profile::Cubic]
            .map(|profile| seconds(choices, profile));
    vec![format!(
        "With sin² acceleration an approach of {STROKE_MM} mm leaves less than {QUIET_UM} µm in any mode from {} to {} \
         Hz if it takes {sin2} or longer. A quintic needs {quintic}, trapezoidal speed {trapezoid}, a cubic {cubic}.",
        MODES_HZ[0], MODES_HZ[1]
    )]
}

fn done() -> Vec<String> {
    vec![
        format!(
            "A mass hangs behind an ideal drive on a spring with a damping of {DAMPING}. The drive goes {STROKE_MM} mm \
             by one of six laws, in 0.1, 0.15, 0.2 or 0.3 s. The residual is the farthest that the mass is from its \
             place from the end of the approach on. sin² acceleration and sin² jerk are evaluated by the code that \
             moves the machine; the other four are there to compare with."
        ),
        "The mass obeys u″ + 2ζw u′ + w² u = −a(t), u being its distance from the law. What is left is the integral of \
         a(t) exp(λ(T − t)) with the pole λ of the mode; it is computed by Gauss's quadrature with at least sixteen \
         points in a period, and agrees with the closed forms, where there are any, to 1e-9 of itself."
            .into(),
    ]
}

fn meaning(choices: &[Choice]) -> Vec<(&'static str, Vec<String>)> {
    vec![
        (
            "What it means for choosing the approach time",
            vec![
                format!(
                    "What is left falls with the approach time T by the number of derivatives that are continuous: \
                     with T² where the acceleration steps (trapezoidal speed, cubic), with T³ where the jerk does \
                     (trapezoidal acceleration, quintic), with T⁴ for sin² acceleration, with T⁵ for sin² jerk. So a \
                     smoother law needs more acceleration for the same time, and less time for the same quiet: sin² \
                     acceleration is quiet from {}, the quintic from {}.",
                    seconds(choices, Profile::Sin2Acceleration),
                    seconds(choices, Profile::Quintic)
                ),
                "The rule: with N = f T/2 an approach by sin² acceleration leaves at most ΔX/(π² N² (N² − \
                 1)) (M8a), whatever the phase and without any damping. For 5 mm and 0.2 µm that is N ≥ \
                 7.15, or T ≥ 14.3/f: 0.24 s for a mode of 60 Hz, 0.18 s for one of 80 Hz; the damping here \
                 makes the first 0.19 s. Where the mode is known well, whole N leave next to nothing, and a \
                 shorter time does. Take the lowest mode of the axis and the longest stroke of a pass."
                    .into(),
                "An override of r makes the approach last T/r: 120 % is the case to choose for, and every lower one is \
                 quieter. sin² jerk is quieter still where N is above 4.5 or so, with the same peaks of speed and \
                 acceleration and 27 % more jerk, and louder below."
                    .into(),
                "The drive of a real axis is not ideal. Its loops see only the motor, whose error is about the same \
                 for all laws; the difference is at the slide, where no encoder of the motor shows it."
                    .into(),
            ],
        ),
        ("Beside the reference simulation", compared::text()),
    ]
}
