//! The frame of every page: style, pictures, and the script that draws them, all in one file. In: what the
//! page holds. Out: HTML that opens without a network.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::paint::Figure;

/// plotly.js, the bundle of cartesian traces: scatter, heatmap, contour and a few that are not used here.
pub const PLOTTING_SCRIPT: &str = include_str!("../assets/plotly-cartesian.min.js");

const STYLE: &str = include_str!("../assets/report.css");
/// The colours of a dark ground: for a screen whose reader likes it dark. Paper is light.
const DARK: &str = include_str!("../assets/dark.css");
const DARK_SCREEN: &str = "screen and (prefers-color-scheme: dark)";
const THEME: &str = include_str!("../assets/theme.js");
/// Leads from a line of the program to its curves and back.
const LINK: &str = include_str!("../assets/link.js");
const SCRIPT: &str = include_str!("../assets/report.js");

/// A page with its style, and with the script that draws if there is something to draw.
pub fn document(title: &str, content: &Markup, draws: bool) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "pitchlock: " (title) }
                style { (PreEscaped(STYLE)) }
                style #dark media=(DARK_SCREEN) { (PreEscaped(DARK)) }
                script { (PreEscaped(THEME)) }
            }
            body {
                main { (content) }
                @if draws {
                    script { (PreEscaped(PLOTTING_SCRIPT)) }
                    script { (PreEscaped(LINK)) }
                    script { (PreEscaped(SCRIPT)) }
                }
            }
        }
    };
    page.into_string()
}

/// Every figure with its number, from the first one on, and its words.
pub fn pictures(figures: &[Figure], first: usize) -> Markup {
    html! {
        @if first == 1 && !figures.is_empty() { noscript { p.note { "The pictures need JavaScript." } } }
        @for (number, figure) in (first..).zip(figures) { (picture(number, figure)) }
    }
}

fn picture(number: usize, figure: &Figure) -> Markup {
    html! {
        figure {
            h2 { (format!("{number}. {}", figure.title)) }
            div.plot role="img" aria-label=(figure.alt) data-aspect=(figure.aspect) {}
            script type="application/json" { (PreEscaped(embedded(&figure.plot))) }
            figcaption.caption { (figure.caption) }
        }
    }
}

/// JSON that cannot end the script element it stands in.
fn embedded(plot: &serde_json::Value) -> String {
    plot.to_string().replace('<', "\\u003c")
}
