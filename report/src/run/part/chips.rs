//! What each pass takes out of one groove. In: a thread, mm. Out: chips in mm and mm², their picture and
//! table.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | y_k(z) | mm | the surface after the k-th pass of the run (M161); y_0 is the crest |
//! | A_k | mm² | area of the chip of that pass in the section |
//!
//! ```text
//! (M162) A_k = ∫ (y_{k−1}(z) − y_k(z)) dz   over one pitch about the middle of the groove
//! ```

use serde_json::json;

use super::outline::thinned;
use super::thread::Thread;
use crate::paint::{Figure, axis, strokes};
use crate::run::by_pass::PassScale;
use crate::run::curves::Curves;
use crate::table::{Column, Place, Table};

/// Places along Z at which the groove is looked at.
const PLACES: usize = 4000;
/// Chips thinner than this are not drawn, and shapes are thinned to it, mm.
const TOLERANCE_MM: f64 = 2e-4;
/// A pass that takes less than this share of the groove is a spring pass to the eye: a line.
const SPRING: f64 = 0.01;

/// What one pass takes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chip {
    /// Where the pass stands in the run.
    pub(super) index: usize,
    /// A_k (M162).
    pub(super) area_mm2: f64,
    /// How much it takes at most along X.
    pub(super) thick_mm: f64,
    /// The surface before and after it: z, y, y.
    surface: Vec<[f64; 3]>,
    /// The edge of the pass as far as it reaches into the groove.
    edge: Vec<(f64, f64)>,
}

/// The chips of all passes that reach into the groove in the middle of the thread, as they were cut.
pub(super) fn chips(thread: &Thread) -> Vec<Chip> {
    let from = thread.middle_mm - 0.5 * thread.pitch_mm;
    let step = thread.pitch_mm / PLACES as f64;
    let z: Vec<f64> = (0..=PLACES).map(|i| from + step * i as f64).collect();
    let crest: Vec<f64> = z.iter().map(|z| thread.crest_at(*z)).collect();
    let mut left = crest.clone();
    let mut found = Vec::new();
    for (index, tips) in thread.passes.iter().enumerate() {
        let deep = |tip: &&super::outline::Tip| (tip.at[0] - thread.middle_mm).abs() < 0.5 * thread.pitch_mm;
        if !tips.iter().filter(deep).any(|tip| tip.at[1] < thread.crest_at(tip.at[0])) {
            continue;
        }
        let outline = thread.outline(std::slice::from_ref(tips));
        let edge: Vec<f64> = z.iter().zip(&crest).map(|(z, crest)| outline.at(*z, *crest)).collect();
        let surface: Vec<[f64; 3]> = (0..z.len()).map(|i| [z[i], left[i], left[i].min(edge[i])]).collect();
        let thickness = surface.iter().map(|[_, before, after]| before - after);
        let ends =
            0.5 * (thickness.clone().next().unwrap_or(0.0) + thickness.clone().next_back().unwrap_or(0.0));
        found.push(Chip {
            index,
            area_mm2: step * (thickness.clone().sum::<f64>() - ends),
            thick_mm: thickness.fold(0.0, f64::max),
            edge: (0..z.len()).filter(|i| edge[*i] < crest[*i]).map(|i| (z[i], edge[i])).collect(),
            surface,
        });
        left = found.last().map_or(left, |chip| chip.surface.iter().map(|at| at[2]).collect());
    }
    found
}

/// The outlines of a chip, one after the other.
fn shape(chip: &Chip, sign: f64) -> Vec<Option<(f64, f64)>> {
    let is_cut = |at: &[f64; 3]| at[1] - at[2] > TOLERANCE_MM;
    let mut points = Vec::new();
    for piece in chip.surface.chunk_by(|a, b| is_cut(a) == is_cut(b)).filter(|piece| is_cut(&piece[0])) {
        let side = |which: usize| {
            let side: Vec<_> = piece.iter().map(|at| (at[0], sign * at[which])).collect();
            thinned(&side, TOLERANCE_MM)
        };
        let (before, after) = (side(1), side(2));
        points.extend(after.iter().chain(before.iter().rev()).chain(after.first()).copied().map(Some));
        points.push(None);
    }
    points.pop();
    points
}

/// The picture.
pub(super) fn figure(curves: &Curves, thread: &Thread, chips: &[Chip]) -> Figure {
    let scale = PassScale::new(curves);
    let whole: f64 = chips.iter().map(|chip| chip.area_mm2).sum();
    let draw = |chip: &Chip| {
        let is_line = chip.area_mm2 < SPRING * whole;
        let points = if is_line {
            let edge: Vec<_> = chip.edge.iter().map(|(z, y)| (*z, thread.sign * y)).collect();
            thinned(&edge, TOLERANCE_MM).into_iter().map(Some).collect()
        } else {
            shape(chip, thread.sign)
        };
        let mut drawn = strokes(&points, "", "", ("x", "y"));
        scale.dress(&mut drawn, chip.index, true);
        if is_line {
            (drawn["line"]["width"], drawn["line"]["dash"]) = (json!(2), json!("4px,3px"));
        } else {
            drawn["fill"] = json!("toself");
            drawn["fillcolor"] = drawn["line"]["color"].clone();
            drawn["line"]["width"] = json!(0.5);
        }
        drawn["line"]["simplify"] = json!(false);
        drawn["connectgaps"] = json!(false);
        let name = drawn["name"].as_str().unwrap_or_default();
        let text = format!("{name}: {:.4} mm², {:.1} µm deep at most", chip.area_mm2, 1e3 * chip.thick_mm);
        (drawn["text"], drawn["hoverinfo"], drawn["hoveron"]) =
            (json!(text), json!("text"), json!("points+fills"));
        drawn
    };
    let mut data: Vec<_> = chips.iter().map(draw).collect();
    data.extend(scale.key());
    let mut up = axis("X, radius (mm)");
    up["scaleanchor"] = json!("x");
    Figure {
        title: "Chips of one groove, pass by pass".into(),
        caption: "What every pass takes out of a groove in the middle of the thread, in the section at spindle angle 0 \
                  and at true places, both axes at the same scale; a pass that takes less than a hundredth of the \
                  groove, as a spring pass should, is a dashed line where its edge went. Good: areas as the infeed \
                  means them (alike where equal chip area is asked for), chips that are nowhere thinner than the edge \
                  can cut, and spring passes on the line of the pass before."
            .into(),
        alt: format!(
            "Chips of one groove of {whole:.4} mm², pass by pass: {} mm².",
            chips.iter().map(|chip| format!("{:.4}", chip.area_mm2)).collect::<Vec<_>>().join(", ")
        ),
        plot: json!({ "data": data, "layout": { "xaxis": axis("Z (mm)"), "yaxis": up } }),
        aspect: 0.55,
    }
}

/// The table of chips.
pub(super) fn table(curves: &Curves, chips: &[Chip]) -> Table {
    struct Row {
        pass: u32,
        line: u32,
        area_mm2: f64,
        share: f64,
        thick_mm: f64,
    }
    let whole: f64 = chips.iter().map(|chip| chip.area_mm2).sum();
    let row = |chip: &Chip| Row {
        pass: curves.passes[chip.index].pass,
        line: curves.passes[chip.index].line,
        area_mm2: chip.area_mm2,
        share: chip.area_mm2 / whole.max(f64::MIN_POSITIVE),
        thick_mm: chip.thick_mm,
    };
    let columns = [
        Column { name: "Pass", unit: "(line)", cell: |row: &Row| format!("{} ({})", row.pass, row.line) },
        Column { name: "Chip area", unit: "mm²", cell: |row| format!("{:.4}", row.area_mm2) },
        Column { name: "Share", unit: "of the groove, %", cell: |row| format!("{:.1}", 100.0 * row.share) },
        Column {
            name: "Deep",
            unit: "at most along X, µm",
            cell: |row| format!("{:.1}", 1e3 * row.thick_mm),
        },
    ];
    let rows: Vec<Row> = chips.iter().map(row).collect();
    Table::of("Chips of one groove", &columns, &rows).at(Place::Page).with_caption(
        "What every pass takes out of the groove in the middle of the thread, at spindle angle 0 and at true places: \
         the areas that its picture shows.",
    )
}
