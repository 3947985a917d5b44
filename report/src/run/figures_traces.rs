//! The figures of a trace: deviation, direction and feed over the way, and a map of the deviation over the
//! part.

use rig::observe::{TraceReport, WorkKind};
use serde_json::{Value, json};

use super::traces::{Map, TraceCurves, name};
use super::verdict::um;
use crate::colours::AMOUNT;
use crate::envelope::Envelope;
use crate::paint::{BLUE, Figure, ORANGE, axis, curve, short};

/// Deviation and feed of one trace over its way; of a seam also its direction.
pub(super) fn way(trace: &TraceReport, curves: &TraceCurves) -> Figure {
    let seam = trace.kind == WorkKind::Seam;
    let mut rows: Vec<(&str, &[Envelope; 2])> = vec![("deviation (µm)", &curves.deviation)];
    if seam {
        rows.push(("direction (degrees)", &curves.angle));
    }
    rows.push(("feed (mm/min)", &curves.feed));
    let (mut data, mut layout) = (Vec::new(), json!({}));
    let height = 1.0 / rows.len() as f64;
    for (i, (title, pair)) in rows.iter().enumerate() {
        let number = if i == 0 { String::new() } else { (i + 1).to_string() };
        let key = format!("y{number}");
        for (curve_of, what, color) in [(&pair[1], "true", ORANGE), (&pair[0], "commanded", BLUE)] {
            let mut drawn = curve(curve_of, what, color, ("x", &key));
            drawn["legendgroup"] = json!(what);
            drawn["showlegend"] = json!(i == 0);
            data.push(drawn);
        }
        let top = 1.0 - height * i as f64;
        let bottom = if i + 1 == rows.len() { 0.0 } else { top - height + 0.06 };
        layout[format!("yaxis{number}")] = json!({ "domain": [bottom, top], "title": { "text": title } });
    }
    let last = format!("y{}", rows.len());
    layout["xaxis"] = json!({ "anchor": last, "title": { "text": "way (mm)" } });
    let what = what(trace.kind);
    Figure {
        title: format!("{}: deviation and feed", name(trace)),
        caption: format!(
            "Distance {what}, by commanded and by true positions, and the feed along the path, each interval of the way by \
             its lowest and highest value. Good: the commanded deviation is next to nothing, the true one a few µm with \
             peaks where an axis turns back, the feed level except where a limit makes it slower."
        ),
        alt: format!(
            "Deviation over the way: commanded at most {}, true at most {}; feed held {:.1} % of the time.",
            um(trace.commanded.max_abs_um()),
            um(trace.slide.max_abs_um()),
            trace.feed.held_pct
        ),
        plot: json!({ "data": data, "layout": layout }),
        aspect: if seam { 0.75 } else { 0.55 },
    }
}

/// The true deviation of a surface over the part, seen from above.
pub(super) fn map(trace: &TraceReport, map: &Map) -> Figure {
    let [x, y] = map.middles();
    let cells: Vec<Vec<Value>> = map
        .rows()
        .map(|row| row.iter().map(|cell| cell.map_or(Value::Null, |um| json!(rounded(um)))).collect())
        .collect();
    let reach = trace.slide.max_abs_um().max(0.1);
    let (mut right, mut up) = (axis("X (mm)"), axis("Y (mm)"));
    up["scaleanchor"] = json!("x");
    for side in [&mut right, &mut up] {
        side["constrain"] = json!("domain");
        side["showgrid"] = json!(false);
    }
    let middles = |side: &[f64]| side.iter().map(|at| short(*at)).collect::<Vec<_>>();
    let [width, height] = map.size.map(|cells| cells as f64);
    let worst = trace.slide.worst_mm;
    let mark = json!({ "type": "scatter", "mode": "markers", "name": "largest", "x": [short(worst[0])], "y": [short(worst[1])],
                       "marker": { "symbol": "circle-open", "size": 16, "color": ORANGE, "line": { "width": 3 } },
                       "showlegend": false, "hoverinfo": "skip" });
    Figure {
        title: format!("{}: the deviation over the part", name(trace)),
        caption: format!(
            "How far the true tool was at most from touching the surface, standing off or cutting too deep, in every cell of \
             {:.2} mm seen from above; X and Y of its tip from the zero of the formula. The ring marks the largest, {}. Good: \
             a few µm, more only where an axis turns back: along a line of the map, not anywhere.",
            map.cell_mm,
            um(trace.slide.max_abs_um())
        ),
        alt: format!(
            "Map of the deviation from the surface: between {} and {}.",
            um(trace.slide.low_um),
            um(trace.slide.high_um)
        ),
        plot: json!({
            "data": [{ "type": "heatmap", "x": middles(&x), "y": middles(&y), "z": cells, "zmin": 0,
                       "zmax": rounded(reach), "colorscale": AMOUNT, "hoverongaps": false,
                       "colorbar": { "title": { "text": "µm" }, "thickness": 14 } }, mark],
            "layout": { "xaxis": right, "yaxis": up },
        }),
        aspect: (height / width).clamp(0.3, 1.0) * 0.85,
    }
}

/// µm with two decimals: what a colour can show.
fn rounded(um: f64) -> f64 {
    (um * 100.0).round() / 100.0
}

/// What a deviation is measured from.
fn what(kind: WorkKind) -> &'static str {
    match kind {
        WorkKind::Contour => "of the tool from touching its contour",
        WorkKind::Surface => "of the tool from touching its surface",
        WorkKind::Seam => {
            "of the beam from its seam, angle between the beam and the direction that belongs to it"
        }
    }
}
