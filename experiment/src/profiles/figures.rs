//! Pictures: how quiet an approach time is, the residual over the mode, the laws, and the swing itself. In:
//! rows and approach times. Out: figures in µm, s, Hz.

use serde_json::{Value, json};

use super::{APPROACHES_S, Choice, MODES_HZ, Mode, Profile, QUIET_UM, Row, STROKE_MM, modes, three};
use report::{
    paint::{BLUE, Figure, GREEN, GREY, ORANGE, PURPLE, YELLOW, axis, line},
    table::six,
};

/// Points of a curve over time.
const POINTS: u32 = 600;

fn color(profile: Profile) -> &'static str {
    match profile {
        Profile::TrapezoidalSpeed => ORANGE,
        Profile::TrapezoidalAcceleration => YELLOW,
        Profile::Cubic => GREY,
        Profile::Quintic => PURPLE,
        Profile::Sin2Acceleration => BLUE,
        Profile::Sin2Jerk => GREEN,
    }
}

pub(super) fn all(rows: &[Row], choices: &[Choice]) -> Vec<Figure> {
    vec![choice(choices), residuals(), swing(rows), laws()]
}

/// A line in the colour of its law, its values in six digits however small they are.
fn curve(profile: Profile, points: &[(f64, f64)], axes: (&str, &str)) -> Value {
    let mut curve = line(points, profile.name(), color(profile), axes);
    curve["y"] = points.iter().map(|(_, y)| json!(six(*y).parse::<f64>().ok())).collect();
    curve["legendgroup"] = json!(profile.name());
    curve["line"]["simplify"] = json!(false);
    if profile == Profile::Sin2Acceleration {
        curve["line"]["width"] = json!(2.5);
    }
    curve
}

fn logarithmic(title: &str) -> Value {
    json!({ "title": { "text": title }, "type": "log", "exponentformat": "none", "dtick": 1 })
}

fn choice(choices: &[Choice]) -> Figure {
    let shown = |choice: &Choice| {
        let points: Vec<_> = choice.largest.iter().filter(|(t, _)| *t <= 0.505).copied().collect();
        curve(choice.profile, &points, ("x", "y"))
    };
    let mut y = logarithmic("largest residual (µm)");
    y["range"] = json!([-3.5, 3.0]);
    Figure {
        title: "How long an approach has to take".into(),
        caption: format!(
            "Largest residual of modes from {} to {} Hz after {STROKE_MM} mm, over the approach time. Dotted: \
             {QUIET_UM} µm, the goal for X in the thread. The steeper a law falls, the more of its derivatives are \
             continuous.",
            MODES_HZ[0], MODES_HZ[1]
        ),
        alt: format!(
            "Six falling curves. The first below {QUIET_UM} µm for good is that of sin² jerk or sin² acceleration, at \
             about 0.2 s; the last are trapezoidal speed and the cubic, beyond the picture."
        ),
        plot: json!({
            "data": choices.iter().map(shown).collect::<Vec<_>>(),
            "layout": {
                "xaxis": axis("approach time (s)"), "yaxis": y,
                "shapes": [{ "type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": QUIET_UM, "y1": QUIET_UM,
                             "line": { "color": GREY, "width": 1, "dash": "dot" } }],
            },
        }),
        aspect: 0.5,
    }
}

/// Names of the axis number `index` of a stack, for a trace and for the layout.
fn stacked(index: usize) -> (String, String) {
    let number = if index == 0 { String::new() } else { (index + 1).to_string() };
    (format!("y{number}"), format!("yaxis{number}"))
}

fn residuals() -> Figure {
    let mut data = Vec::new();
    let mut layout = json!({ "xaxis": { "anchor": "y4", "title": { "text": "mode (Hz)" } } });
    for (index, t) in APPROACHES_S.into_iter().enumerate() {
        let (y, yaxis) = stacked(index);
        let top = 1.0 - 0.255 * index as f64;
        layout[yaxis] = logarithmic(&format!("{t} s: residual (µm)"));
        layout[&stacked(index).1]["domain"] = json!([top - 0.23, top]);
        for profile in Profile::ALL {
            let law = profile.law(STROKE_MM, t);
            let points: Vec<_> = modes(4).map(|hz| (hz, 1e3 * Mode::at(hz).residual(&law).largest)).collect();
            let mut drawn = curve(profile, &points, ("x", &y));
            drawn["showlegend"] = json!(index == 0);
            data.push(drawn);
        }
        let bound: Vec<_> =
            modes(1).map(|hz| (hz, 1e3 * motion::Stroke::new(STROKE_MM, t).residual_bound(hz))).collect();
        let mut drawn = curve(Profile::Sin2Acceleration, &bound, ("x", &y));
        drawn["name"] = json!("bound of sin² acceleration");
        drawn["line"] = json!({ "color": BLUE, "width": 1.5, "dash": "dash" });
        drawn["showlegend"] = json!(index == 0);
        data.push(drawn);
    }
    Figure {
        title: "Residual over the frequency of the mode".into(),
        caption: "One picture for each approach time, every law in its colour. Dashed: the bound of sin² acceleration \
                  (M8a), which holds at every phase and without damping. Good: the curve of sin² acceleration stays \
                  below its bound, dips at whole N = f T/2, and lies below the quintic at nearly every mode."
            .into(),
        alt: "Residual of six laws over modes from 60 to 120 Hz, for four approach times one above the other, on a \
              logarithmic scale; sin² acceleration stays below its dashed bound everywhere."
            .into(),
        plot: json!({ "data": data, "layout": layout }),
        aspect: 1.45,
    }
}

/// The mode that a law excites most, among the rows of the shortest approach.
fn worst(rows: &[Row], profile: Profile) -> f64 {
    let of = rows.iter().filter(|row| row.profile == profile && row.approach_s == APPROACHES_S[0]);
    of.max_by(|a, b| a.residual_um.total_cmp(&b.residual_um)).map_or(super::SHOWN_HZ, |row| row.mode_hz)
}

fn swing(rows: &[Row]) -> Figure {
    let (t, hz) = (APPROACHES_S[0], worst(rows, Profile::Sin2Acceleration));
    let mode = Mode::at(hz);
    let laws = [Profile::TrapezoidalSpeed, Profile::Quintic, Profile::Sin2Acceleration];
    let shown = laws.map(|profile| {
        let law = profile.law(STROKE_MM, t);
        let times = (0..=POINTS).map(|n| 3.0 * t * f64::from(n) / f64::from(POINTS));
        let points: Vec<_> = times.map(|at| (at, 1e3 * mode.deflection(&law, at))).collect();
        curve(profile, &points, ("x", "y"))
    });
    let left = laws.map(|profile| three(1e3 * mode.residual(&profile.law(STROKE_MM, t)).largest));
    Figure {
        title: format!("The swing of a mode of {hz} Hz during and after an approach in {t} s"),
        caption: format!(
            "Mass minus law, in the case that is worst for sin² acceleration. In the approach the spring has to carry \
             the acceleration; what swings on after {t} s (dotted) is the residual: {}, {} and {} µm.",
            left[0], left[1], left[2]
        ),
        alt: format!(
            "Deflection of the mass over time for trapezoidal speed, quintic and sin² acceleration. After the approach \
             they swing on with {}, {} and {} µm.",
            left[0], left[1], left[2]
        ),
        plot: json!({
            "data": shown,
            "layout": {
                "xaxis": axis("time (s)"), "yaxis": axis("mass minus law (µm)"),
                "shapes": [{ "type": "line", "yref": "paper", "x0": t, "x1": t, "y0": 0, "y1": 1,
                             "line": { "color": GREY, "width": 1, "dash": "dot" } }],
            },
        }),
        aspect: 0.5,
    }
}

fn laws() -> Figure {
    let mut data = Vec::new();
    for profile in Profile::ALL {
        let law = profile.law(1.0, 1.0);
        // Two points at the end of a piece, so that a step is drawn as one.
        let even = (0..=POINTS).map(|n| f64::from(n) / f64::from(POINTS));
        let sides = law.ends.iter().flat_map(|end| [end - 1e-9, end + 1e-9]).filter(|t| *t < 1.0);
        let mut times: Vec<f64> = even.chain(sides).collect();
        times.sort_by(f64::total_cmp);
        let of = |value: fn(&motion::Sample) -> f64| -> Vec<(f64, f64)> {
            times.iter().map(|t| (*t, value(&(law.at)(*t)))).collect()
        };
        data.push(curve(profile, &of(|at| at.v), ("x", "y")));
        let mut lower = curve(profile, &of(|at| at.a), ("x", "y2"));
        lower["showlegend"] = json!(false);
        data.push(lower);
    }
    Figure {
        title: "The six laws".into(),
        caption: "Speed and acceleration over time, for a way of 1 in a time of 1. Where the acceleration steps, every \
                  mode is struck; where only the jerk steps, it is pushed; sin² acceleration and sin² jerk step in \
                  neither."
            .into(),
        alt: "Speed and acceleration of six laws over time; those of sin² have no step and no kink in the acceleration."
            .into(),
        plot: json!({
            "data": data,
            "layout": {
                "xaxis": { "anchor": "y2", "title": { "text": "t/T" } },
                "yaxis": { "domain": [0.54, 1.0], "title": { "text": "v in ΔX/T" } },
                "yaxis2": { "domain": [0.0, 0.46], "title": { "text": "a in ΔX/T²" } },
            },
        }),
        aspect: 0.75,
    }
}
