//! The edge of a tool that the gauge takes: that of the machine file, and what is taken of it that is not
//! there. In: the machine file, the number of a tool, the flanks of the thread, degrees. Out: an [`Edge`];
//! what was taken, in words.

use gauge::{Edge, Nominal};
use machine::Machine;

/// Angles between flanks that are one, degrees.
const SAME_DEG: f64 = 1e-6;

/// The edge of a tool: of an angle that is that of both flanks of the thread it has these, as for a buttress
/// thread, else half of it to either side; a sharp point and the flanks of the thread where the machine file
/// says nothing.
pub(super) fn edge_of(machine: &Machine, number: u32, nominal: &Nominal) -> Edge {
    let tool = machine.tool(number);
    let both_deg: f64 = nominal.flank_deg.iter().sum();
    let other = tool.and_then(|tool| tool.angle_deg).filter(|deg| (deg - both_deg).abs() > SAME_DEG);
    let flank_deg = other.map_or(nominal.flank_deg, |deg| [0.5 * deg; 2]);
    let nose_mm = tool.and_then(|tool| tool.nose_mm).unwrap_or(0.0);
    match tool.and_then(|tool| tool.width_mm) {
        Some(width_mm) => Edge::of_width(flank_deg, width_mm, nose_mm),
        None => Edge { flank_deg, flat_mm: 0.0, nose_mm },
    }
}

/// What was taken for the edge of a tool of which nobody said all of it, and how to say it.
pub(super) fn assumed(machine: &Machine, number: u32, flank_deg: [f64; 2]) -> Option<String> {
    let tool = machine.tool(number);
    let has = |key: fn(&machine::Tool) -> Option<f64>| tool.and_then(key).is_some();
    let angle_deg = {
        let both: f64 = flank_deg.iter().sum();
        format!("{}°", (100.0 * both).round() / 100.0)
    };
    let (angle, tip) = (has(|tool| tool.angle_deg), has(|tool| tool.nose_mm.or(tool.width_mm)));
    let (taken, keys) = match (angle, tip) {
        (true, true) => return None,
        (true, false) => ("a sharp point".to_owned(), "nose_mm (width_mm of a flat)"),
        (false, true) => (format!("{angle_deg} between its flanks"), "angle_deg"),
        (false, false) => {
            (format!("a sharp point of {angle_deg}"), "angle_deg, nose_mm (width_mm of a flat)")
        }
    };
    Some(match number {
        0 => format!(
            "the edge is taken to be {taken}, for the program calls for no tool: T1, and [tools.1] {keys} say otherwise"
        ),
        _ => format!(
            "the edge is taken to be {taken}, for nobody described tool {number}: [tools.{number}] {keys} say otherwise"
        ),
    })
}
