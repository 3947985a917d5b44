//! Pictures: error of the helix over time while the spindle changes its speed, and over the bandwidth of the
//! observer.

use serde_json::{Value, json};

use super::{
    BANDWIDTHS_HZ, Case,
    alone::{self, Kind},
};
use report::{
    paint::{BLUE, Figure, GREEN, GREY, ORANGE, axis, line},
    table::six,
};

/// Encoder of the pictures.
const LINES: u32 = 2500;
const COLORS: [&str; 4] = [GREY, BLUE, ORANGE, GREEN];

pub(super) fn all() -> Vec<Figure> {
    vec![
        over_time(
            Case::OverrideRamp,
            "The override is turned from 100 to 60 %",
            "The spindle goes from 500 to 300 1/min between 0 and 0.3 s. The observer needs some 30 ms to learn that the speed \
             changes, and again that it changes no longer: one error at each end of the ramp, of opposite signs, and none \
             between. The faster the observer, the smaller. What stays in between is the rounding of the encoder.",
            [-0.1, 0.5],
        ),
        over_time(
            Case::Dip,
            "The spindle loses 3 % of its speed within 15 ms",
            "15 1/min less between 0 and 0.015 s, which is short for the observer: both errors of a ramp fall into one, and it \
             swings back once. A slow observer sees a step.",
            [-0.05, 0.25],
        ),
        over_bandwidth(),
    ]
}

fn over_time(case: Case, title: &str, caption: &str, [from, to]: [f64; 2]) -> Figure {
    let curve = |(bandwidth_hz, color): (f64, &str)| -> Value {
        let points: Vec<_> = alone::course(Kind::Used, LINES, bandwidth_hz, case, 0.37)
            .into_iter()
            .filter(|(t, _)| (from..=to).contains(t))
            .collect();
        let mut curve = line(&points, &format!("{} Hz", six(bandwidth_hz)), color, ("x", "y"));
        curve["line"]["simplify"] = json!(false);
        curve
    };
    let colors = COLORS.into_iter().skip(1);
    Figure {
        title: title.into(),
        caption: format!(
            "Error of the helix at a lead of 5 mm, {LINES} lines, the observer alone. {caption}"
        ),
        alt: format!("{title}: error of the helix over time, for three bandwidths of the observer."),
        plot: json!({
            "data": BANDWIDTHS_HZ.into_iter().zip(colors).map(curve).collect::<Vec<_>>(),
            "layout": { "xaxis": axis("time since the speed began to change (s)"), "yaxis": axis("error of the helix (µm)") },
        }),
        aspect: 0.45,
    }
}

fn over_bandwidth() -> Figure {
    let bandwidths: Vec<f64> = (0..=24).map(|n| 5.0 * libm::exp10(f64::from(n) / 18.0)).collect();
    let curve = |(case, color): (Case, &str)| -> Value {
        let points: Vec<_> = bandwidths
            .iter()
            .map(|&bandwidth_hz| {
                (bandwidth_hz, alone::errors(Kind::Used, LINES, bandwidth_hz, case).typical_um)
            })
            .collect();
        line(&points, case.name(), color, ("x", "y"))
    };
    let logarithmic =
        |title: &str| json!({ "title": { "text": title }, "type": "log", "dtick": "D2", "tickformat": "~g" });
    Figure {
        title: "Which bandwidth".into(),
        caption: format!(
            "Largest error of the helix over the bandwidth of the observer, {LINES} lines, both axes logarithmic. A change of \
             speed is seen better the faster the observer is; rounding is averaged better the slower it is. At 0.2 \
             1/min counts come one by one: a slow observer averages over them, a fast one sees each for itself and errs by \
             half a count."
        ),
        alt: "Four curves over the bandwidth from 5 to 108 Hz: override ramp and dip fall steeply, constant speed and 0.2 \
              1/min rise."
            .into(),
        plot: json!({
            "data": Case::ALONE.into_iter().zip(COLORS).map(curve).collect::<Vec<_>>(),
            "layout": {
                "xaxis": logarithmic("bandwidth of the observer (Hz)"),
                "yaxis": logarithmic("largest error of the helix (µm)"),
            },
        }),
        aspect: 0.5,
    }
}
