//! Pictures of a commissioning. In: what was found. Out: for each axis its open loops, its friction; then the
//! servo error of the trial pass.

use machine::AxisConfig;
use protocol::Axis;
use serde_json::{Value, json};
use tune::{Complex, OpenLoops, Tuned};

use super::Found;
use report::paint::{BLUE, Figure, GREY, ORANGE, axis, line};

pub(super) fn all(found: &Found) -> Vec<Figure> {
    let curves = found.trial.as_ref().map_or(&[][..], |compared| &compared.curves);
    let trial = curves.iter().map(servo);
    let axes = found.tuned.iter().flat_map(|tuned| {
        let (before, after) = (&found.machine.axis[&tuned.axis], &found.proposed.axis[&tuned.axis]);
        let velocity = loops(tuned, "velocity", [before, after], |open| open.velocity);
        let position = loops(tuned, "position", [before, after], |open| open.position);
        [velocity, position, friction(tuned, [before, after]), reversals(tuned)]
    });
    trial.chain(axes).collect()
}

/// Servo error over time.
fn servo((moved, [before, after]): &(Axis, [Vec<(f64, f64)>; 2])) -> Figure {
    let axes = ("x", "y");
    Figure {
        title: format!("Servo error of {moved} in the trial pass, 100 %"),
        caption: "Commanded minus measured at the same instant. The approach takes 0.2 s; behind it X rests at depth \
                  and Z goes on along the thread. What is left in the approach comes from the count of the spindle encoder."
            .into(),
        alt: "Servo error over time, before and after.".into(),
        plot: json!({
            "data": [line(before, "before", ORANGE, axes), line(after, "after", BLUE, axes)],
            "layout": { "xaxis": axis("time since the axis began to move (s)"), "yaxis": axis("servo error (µm)") },
        }),
        aspect: 0.42,
    }
}

/// Magnitude and phase of an open loop, before and after.
fn loops(tuned: &Tuned, name: &str, configs: [&AxisConfig; 2], of: fn(&OpenLoops) -> Complex<f64>) -> Figure {
    let mut data = Vec::new();
    for (config, (when, color)) in configs.into_iter().zip([("before", ORANGE), ("after", BLUE)]) {
        let open: Vec<_> = tuned.open_loops(config).iter().map(|open| (open.hz, of(open))).collect();
        let decibels: Vec<_> = open.iter().map(|(hz, l)| (*hz, 20.0 * libm::log10(l.norm()))).collect();
        data.push(line(&decibels, when, color, ("x", "y")));
        let mut phase = line(&phases(&open), when, color, ("x", "y2"));
        phase["showlegend"] = json!(false);
        data.push(phase);
    }
    let level = |axis: &str, at: f64| -> Value {
        json!({ "type": "line", "xref": "paper", "yref": axis, "x0": 0, "x1": 1, "y0": at, "y1": at,
                "line": { "color": GREY, "width": 1, "dash": "dash" } })
    };
    let margins = |margins: &tune::Margins| {
        let margins = if name == "velocity" { margins.velocity } else { margins.position };
        format!("{:.0}° and {:.1}", margins.phase_deg, margins.gain)
    };
    let (before, after) = (margins(&tuned.before), margins(&tuned.after));
    Figure {
        title: format!("{}: the {name} loop, opened", tuned.axis),
        caption: format!(
            "Frequency response as measured, with the gains before and after. Phase margin: what the phase is above \
             −180° where the magnitude is 0 dB; gain margin: what the magnitude is below 0 dB where the phase is −180°. \
             Before {before}, after {after}. The dip and peak is the mode of the slide."
        ),
        alt: format!("Magnitude and phase over frequency. Margins before {before}, after {after}."),
        plot: json!({ "data": data, "layout": {
            "xaxis": { "anchor": "y2", "type": "log", "title": { "text": "frequency (Hz)" } },
            "yaxis": { "domain": [0.52, 1.0], "title": { "text": "magnitude (dB)" } },
            "yaxis2": { "domain": [0.0, 0.47], "title": { "text": "phase (°)" } },
            "shapes": [level("y", 0.0), level("y2", -180.0)],
        } }),
        aspect: 0.62,
    }
}

/// Phases in degrees that do not jump, from −180 … 180 on.
fn phases(open: &[(f64, Complex<f64>)]) -> Vec<(f64, f64)> {
    let mut before: Option<f64> = None;
    let unwrapped = |(hz, l): &(f64, Complex<f64>)| {
        let degrees = libm::atan2(l.im, l.re).to_degrees();
        let last = before.unwrap_or(-90.0);
        let degrees = degrees - 360.0 * ((degrees - last) / 360.0).round();
        before = Some(degrees);
        (*hz, degrees)
    };
    open.iter().map(unwrapped).collect()
}

/// Friction against speed, with what was believed and what is proposed.
fn friction(tuned: &Tuned, configs: [&AxisConfig; 2]) -> Figure {
    let points: Vec<_> = tuned.friction_curve.iter().map(|[v, force]| (*v, *force)).collect();
    let mut measured = line(&points, "measured", GREY, ("x", "y"));
    measured["mode"] = json!("markers");
    let fastest = points.iter().map(|(v, _)| v.abs()).fold(0.0, f64::max);
    let model = |config: &AxisConfig, name: &str, color: &str| {
        let force = |v: f64| config.coulomb_n.copysign(v) + config.viscous_n_s_mm * v;
        let ends = [-fastest, -1e-3, 1e-3, fastest].map(|v| (v, force(v)));
        line(&ends, name, color, ("x", "y"))
    };
    Figure {
        title: format!("{}: friction against speed", tuned.axis),
        caption: "Each point is a run at constant speed. Lines: Coulomb and viscous friction as believed before, and as \
                  proposed."
            .into(),
        alt: format!(
            "Points on two lines: {:.0} N and {:.2} N s/mm.",
            tuned.coulomb_n.value, tuned.viscous_n_s_mm.value
        ),
        plot: json!({
            "data": [model(configs[0], "before", ORANGE), model(configs[1], "after", BLUE), measured],
            "layout": { "xaxis": axis("speed (mm/s)"), "yaxis": axis("friction (N)") },
        }),
        aspect: 0.42,
    }
}

/// Friction against position in small reversals.
fn reversals(tuned: &Tuned) -> Figure {
    let last = tuned.reversals.last().map_or(0.0, |point| point[0]);
    let points: Vec<_> = tuned.reversals.iter().map(|[x, force]| (1e3 * (x - last), *force)).collect();
    Figure {
        title: format!("{}: friction in small reversals", tuned.axis),
        caption: "Before it slides, friction is a spring: its slope at a reversal is twice presliding_n_mm. The longer the \
                  stroke, the nearer it comes to the friction of sliding."
            .into(),
        alt: "Hysteresis loops of friction against position.".into(),
        plot: json!({
            "data": [line(&points, "measured", BLUE, ("x", "y"))],
            "layout": { "xaxis": axis("position (µm)"), "yaxis": axis("friction (N)"), "showlegend": false },
        }),
        aspect: 0.5,
    }
}
