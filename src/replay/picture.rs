//! The page of `pitchlock diff`: what differs first, around its place, in both runs. In: both runs, the
//! place. Out: HTML.

use maud::html;
use protocol::Axis;
use report::{
    page::{document, pictures},
    paint::{BLUE, Figure, GREEN, ORANGE, PURPLE, axis, line},
};
use serde_json::{Value, json};

use super::{differ::Place, folder::Recorded};
use crate::error::CliError;

/// Control cycles before and behind the place.
const AROUND: u64 = 200;

/// What is drawn of a run: by cycle, the field, and where the slides are, mm or degrees.
#[derive(Default)]
struct Drawn {
    field: Vec<(f64, f64)>,
    slides: Vec<(f64, Vec<f64>)>,
}

fn drawn(run: &Recorded, place: &Place) -> Result<Drawn, CliError> {
    let (mut drawn, mut machine, mut now) = (Drawn::default(), run.machine_again()?, 0);
    let axes: Vec<Axis> = run.machine.axes().map(|(axis, _)| axis).collect();
    while now <= place.cycle + AROUND
        && machine.step(|exchange, _| {
            now = exchange.record.truth.cycle.0;
            if now + AROUND >= place.cycle {
                let number = place.number(exchange);
                drawn.field.extend(number.map(|number| (now as f64, number)));
                let slides = axes.iter().map(|axis| exchange.record.truth.axes[axis.index()].slide_mm);
                drawn.slides.push((now as f64, slides.collect()));
            }
        })?
    {}
    Ok(drawn)
}

/// The page.
pub(super) fn page(runs: &[Recorded; 2], place: &Place) -> Result<String, CliError> {
    let both = [drawn(&runs[0], place)?, drawn(&runs[1], place)?];
    let mut figures = Vec::new();
    if both.iter().all(|drawn| !drawn.field.is_empty()) {
        let data = [
            line(&both[0].field, &runs[0].name, BLUE, ("x", "y")),
            line(&both[1].field, &runs[1].name, ORANGE, ("x", "y")),
        ];
        figures.push(figure(
            &place.field(),
            place,
            &data,
            place.unit(),
            "The field in which the runs differ first.",
        ));
    }
    let colors = [BLUE, GREEN, ORANGE, PURPLE];
    let lines = runs[0].machine.axes().enumerate().map(|(at, (name, _))| {
        let pairs = both[0].slides.iter().zip(&both[1].slides);
        let apart: Vec<_> =
            pairs.map(|((now, one), (_, other))| (*now, 1e3 * (other[at] - one[at]))).collect();
        line(&apart, &name.to_string(), colors[at % colors.len()], ("x", "y"))
    });
    let caption = "True position of each slide in the second run less that in the first.";
    figures.push(figure("How far the slides are apart", place, &lines.collect::<Vec<_>>(), "µm", caption));
    let title = format!("{} and {}", runs[0].name, runs[1].name);
    let content = html! {
        h1 { (title) }
        p { "They differ first in cycle " (place.cycle) ": " (place.field()) "." }
        table {
            tr { th { (runs[0].name) } td { (place.told(0)) } }
            tr { th { (runs[1].name) } td { (place.told(1)) } }
        }
        (pictures(&figures, 1))
    };
    Ok(document(&title, &content, true))
}

/// Curves over cycles, with a line where the place is.
fn figure(title: &str, place: &Place, data: &[Value], y: &str, caption: &str) -> Figure {
    let at = place.cycle as f64;
    let mark = json!({ "type": "line", "xref": "x", "yref": "paper", "x0": at, "x1": at, "y0": 0, "y1": 1,
                       "line": { "width": 1, "dash": "dot" } });
    Figure {
        title: title.into(),
        caption: format!("{caption} The dotted line is the first cycle in which they differ."),
        alt: format!("{title}, over control cycles, of both runs"),
        plot: json!({ "data": data,
                      "layout": { "xaxis": axis("control cycle"), "yaxis": axis(y), "shapes": [mark] } }),
        aspect: 0.5,
    }
}
