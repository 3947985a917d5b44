//! The part on the page: a canvas that turns, and what it draws. In: heights, mm. Out: HTML with the numbers
//! packed as `u16` between the floor and the top, and its script.

use base64::prelude::{BASE64_STANDARD, Engine as _};
use maud::{Markup, PreEscaped, html};
use serde_json::json;

use super::heights::{Cutter, Heights};

const SCRIPT: &str = include_str!("../../../assets/solid.js");

/// The middle of the numbers that stand for a deviation; 0 where there is none.
const NOTHING: f64 = 32_768.0;

fn packed(numbers: impl Iterator<Item = u16>) -> String {
    BASE64_STANDARD.encode(numbers.flat_map(u16::to_le_bytes).collect::<Vec<u8>>())
}

/// What a tool is called.
fn told(cutter: &Cutter) -> String {
    let kind = match cutter.corner_mm {
        0.0 => "flat".into(),
        corner if corner < cutter.radius_mm => format!("corners of {corner} mm"),
        _ => "ball".to_owned(),
    };
    let name = if cutter.name.is_empty() { String::new() } else { format!(" ({})", cutter.name) };
    let assumed = if cutter.known { "" } else { " is taken, the record does not say" };
    format!("tool {}{name}: {kind}, {} mm{assumed}", cutter.number, 2.0 * cutter.radius_mm)
}

/// What the part is cut from.
fn stock(heights: &Heights) -> String {
    match heights.beside {
        Some(beside) => format!(
            "Nobody said what the stock is: taken are X and Y of {beside}, and as its top the highest feed sideways."
        ),
        None => "The stock is the block that the program describes; where its bottom is seen, the tools went through.".into(),
    }
}

/// The section of the page.
pub(super) fn markup(heights: &Heights) -> Markup {
    let span = heights.top_mm - heights.floor_mm;
    let z = heights
        .z_mm
        .iter()
        .map(|z| ((z - heights.floor_mm) / span * 65_535.0).round().clamp(0.0, 65_535.0) as u16);
    let reach = heights.deviation_um.iter().flatten().map(|um| um.abs()).fold(0.0, f64::max);
    let deviation = heights.deviation_um.iter().map(|um| {
        um.map_or(0, |um| (NOTHING + 32_767.0 * um / reach.max(1e-9)).round().clamp(1.0, 65_535.0) as u16)
    });
    let tools: Vec<String> = heights.cutters.iter().map(told).collect();
    let mut drawn = json!({
        "size": heights.size, "cell": heights.cell_mm, "span": span, "z": packed(z),
        "tool": BASE64_STANDARD.encode(&heights.cut_by),
        "tools": heights.cutters.iter().map(|cutter| cutter.number).collect::<Vec<_>>(),
    });
    if reach > 0.0 {
        drawn["reach"] = json!(reach);
        drawn["deviation"] = json!(packed(deviation));
    }
    let [length, width] = heights.size.map(|cells| (cells - 1) as f64 * heights.cell_mm);
    html! {
        section.solid {
            h2 { "The part" }
            div.views {}
            canvas tabindex="0" role="img"
                aria-label=(format!("The part that is left, {length:.1} by {width:.1} mm. Arrow keys turn it.")) {}
            div.scale {}
            script type="application/json" { (PreEscaped(drawn.to_string().replace('<', "\\u003c"))) }
            p.caption {
                "What the true way of the tools leaves, in cells of " (format!("{:.2} mm", heights.cell_mm))
                "; rapid motion takes off what it goes through, too. " (stock(heights)) " Tools: "
                (tools.join("; ")) ". Drag it or use the arrow keys to turn it."
            }
            script { (PreEscaped(SCRIPT)) }
        }
    }
}
