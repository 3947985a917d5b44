//! The picture of the whole part: above its axis as seen from outside, below it in section. In: radii over Z
//! at spindle angles 0 and 180°, mm. Out: a [`Figure`] with diameters across.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | z_e, r_e | mm | where a flank ends at the crest, at spindle angle 0 |
//! | F, h | mm, – | lead of the thread; 1 if it is right-handed, −1 if not |
//! | φ | deg | angle around the part, from the edge of the picture towards the reader |
//!
//! ```text
//! (M171) a flank as it is seen from outside:   z = z_e + h F φ/360,   r = r_e cos φ,   φ = 0 … 90
//! ```

use rig::observe::{StockReport, Summary};
use serde_json::{Value, json};

use super::Part;
use super::outline::thinned;
use super::plain::{self, Plain};
use super::profile::{Front, Profile, Slice};
use super::thread::Thread;
use crate::colours::{BAND, GREY, INK};
use crate::paint::{BLUE, Figure, axis, strokes};

/// Outlines are thinned to this, mm.
const TOLERANCE_MM: f64 = 0.004;
/// A corner of the outline turns by more than this, degrees; it is an edge all around the part.
const CORNER_DEG: f64 = 20.0;
/// Threads of more flanks than this are shown by the line of their root alone.
const MOST_FLANKS: usize = 160;
/// How far below the crest a flank is looked for, mm.
const BELOW_CREST_MM: f64 = 0.02;
/// What is not known is drawn beyond a bore by this share of its radius.
const BEYOND: f64 = 1.2;

type Point = Option<(f64, f64)>;

/// The picture, of a part of which anything is known.
pub(super) fn figure(summary: &Summary, part: &Part, shown: usize) -> Option<Figure> {
    let swept = part.swept.finished();
    let stock = summary.stock.as_ref();
    let threads = [0, 1].map(|half| Thread::of(summary, part, shown, half));
    let plain = plain::threads(summary, &part.passes, threads[0].as_ref().map(|thread| thread.ends_mm));
    let [above, below] = threads.each_ref().map(|thread| Profile::of(stock, &swept, thread.as_ref(), &plain));
    let (above, below) = (above?, below?);
    let thread = threads[0].as_ref();
    let along = thread.map(|thread| thread.ends_mm);
    let mut data = vec![seen(&above), section(&below)];
    data.push(drawn(&edges(&above, &below), "outline", INK, 1.6, "solid"));
    let corners = corners(&above, along);
    let mut thin: Vec<Point> = corners;
    let hand = hand(summary, shown);
    if let Some(thread) = thread.filter(|thread| thread.sign > 0.0) {
        let flanks = flanks(&above, thread.ends_mm, |z| thread.crest_at(z));
        if flanks.len() <= MOST_FLANKS {
            flanks.iter().for_each(|flank| thin.extend(around(*flank, hand * thread.lead_mm)));
        }
    }
    thin.extend(roots(&plain, &above));
    data.push(drawn(&thin, "edges and flanks", BLUE, 1.0, "solid"));
    let hidden: Vec<Point> =
        bores(&above).into_iter().flat_map(|bore| bore.into_iter().map(Some).chain([None])).collect();
    if !hidden.is_empty() {
        data.push(drawn(&hidden, "hidden", BLUE, 1.0, "3px,3px"));
    }
    if let Some(stock) = stock {
        data.push(drawn(&around_stock(stock), "stock", GREY, 1.4, "6px,4px"));
    }
    let (low, high) = (above.slices.first()?.z, above.slices.last()?.z);
    let most = most_mm(&above, &below, stock);
    let beyond = 0.04 * (high - low) + 1.0;
    let center = [Some((low - beyond, 0.0)), Some((high + beyond, 0.0))];
    data.push(drawn(&center, "axis", INK, 1.0, "14px,4px,3px,4px"));
    let mut up = axis("X, diameter (mm)");
    (up["scaleanchor"], up["scaleratio"], up["zeroline"]) = (json!("x"), json!(0.5), json!(false));
    Some(Figure {
        title: "The part".into(),
        caption: caption(summary, &above, thread.is_some()),
        alt: format!(
            "The part from Z {low:.2} to {high:.2} mm, {:.2} mm across at most, above its axis from outside, below it \
             in section.",
            2.0 * most
        ),
        plot: json!({ "data": data, "layout": { "xaxis": axis("Z (mm)"), "yaxis": up } }),
        aspect: (2.3 * most / (high - low + 2.0 * beyond)).clamp(0.3, 0.7),
    })
}

fn caption(summary: &Summary, profile: &Profile, has_thread: bool) -> String {
    let mut words = String::from(
        "What the true ways of the tools leave, both axes at the same scale, diameters across: above the axis as seen \
         from outside, below it in section.",
    );
    if has_thread {
        words += " The thread is what its edge leaves at spindle angle 0, above, and at 180°, below.";
    } else if !summary.passes.is_empty() {
        words += " Of a thread whose tool has no angle in the machine file, crest and root are drawn, as far as they are known.";
    }
    if summary.stock.is_none() {
        words += " Nobody said what the stock is, so the outline is drawn only where a tool has cut";
        words += match profile.front {
            Front::Zero => ", and it is taken to begin at Z 0.",
            Front::Known | Front::Cut => ".",
        };
        if profile.slices.iter().all(|slice| slice.outer.is_none()) {
            words += " Where nothing outside is known, the section ends anywhere.";
        }
    }
    words
        + " A feed counts by the tip of its tool, as wide as the tool table has it. Good: the outline is that of the \
             drawing, without steps that nobody meant."
}

/// A line with a name in the legend.
fn drawn(points: &[Point], name: &str, color: &str, width: f64, dash: &str) -> Value {
    let points: Vec<Point> = points.iter().map(|point| point.map(|(z, r)| (z, 2.0 * r))).collect();
    let mut drawn = strokes(&points, name, color, ("x", "y"));
    drawn["line"] = json!({ "color": color, "width": width, "dash": dash, "simplify": false });
    (drawn["connectgaps"], drawn["hoverinfo"]) = (json!(false), json!("x+y+name"));
    drawn
}

/// A shape that is filled.
fn filled(points: &[Point], name: &str) -> Value {
    let mut filled = drawn(points, name, BLUE, 0.0, "solid");
    (filled["fill"], filled["fillcolor"], filled["hoverinfo"]) =
        (json!("toself"), json!(BAND), json!("skip"));
    filled
}

/// Pieces over which the outside is known, thinned; each with the inside.
fn pieces(profile: &Profile) -> Vec<[Vec<(f64, f64)>; 2]> {
    let known = |slice: &Slice| slice.outer.is_some_and(|outer| outer > slice.inner);
    let pieces = profile.slices.chunk_by(|a, b| known(a) == known(b)).filter(|piece| known(&piece[0]));
    let side = |piece: &[Slice], of: fn(&Slice) -> f64| {
        thinned(&piece.iter().map(|slice| (slice.z, of(slice))).collect::<Vec<_>>(), TOLERANCE_MM)
    };
    pieces.map(|piece| [side(piece, |at| at.outer.unwrap_or(0.0)), side(piece, |at| at.inner)]).collect()
}

/// The outside, seen.
fn seen(profile: &Profile) -> Value {
    let mut points = Vec::new();
    for [outer, _] in pieces(profile) {
        let (Some(first), Some(last)) = (outer.first(), outer.last()) else { continue };
        points.extend(outer.iter().copied().chain([(last.0, 0.0), (first.0, 0.0), *first]).map(Some));
        points.push(None);
    }
    filled(&points, "from outside")
}

/// The section, hatched; where the outside is not known, as thick as anything.
fn section(profile: &Profile) -> Value {
    let anything = BEYOND * profile.slices.iter().map(|slice| slice.inner).fold(0.0, f64::max);
    let slices = profile.slices.iter().filter(|slice| slice.outer.is_some() || slice.inner > 0.0);
    let slices = slices.map(|slice| Slice { outer: Some(slice.outer.unwrap_or(anything)), ..*slice });
    let whole = Profile { slices: slices.collect(), ..profile.clone() };
    let mut points = Vec::new();
    for [outer, inner] in pieces(&whole) {
        let shape = outer.iter().chain(inner.iter().rev()).chain(outer.first());
        points.extend(shape.map(|(z, r)| Some((*z, -r))));
        points.push(None);
    }
    let mut hatched = filled(&points, "in section");
    hatched["fillpattern"] = json!({ "shape": "/", "size": 9, "solidity": 0.12, "fgcolor": BLUE, "bgcolor": BAND, "fillmode": "replace" });
    hatched
}

/// The lines of the outside above and below, of the inside below, and of the faces.
fn edges(above: &Profile, below: &Profile) -> Vec<Point> {
    let mut points: Vec<Point> = Vec::new();
    let mut line = |line: Vec<(f64, f64)>, sign: f64| {
        points.extend(line.into_iter().map(|(z, r)| Some((z, sign * r))));
        points.push(None);
    };
    for (profile, sign) in [(above, 1.0), (below, -1.0)] {
        let first = profile.slices[0].z;
        for [outer, inner] in pieces(profile) {
            let ends = [outer.first().zip(inner.first()), outer.last().zip(inner.last())];
            let is_face = |at: &(f64, f64)| at.0 > first || profile.ends_at_back;
            for (at, from) in ends.into_iter().flatten().filter(|(at, _)| is_face(at)) {
                line(vec![*at, (at.0, if sign > 0.0 { 0.0 } else { from.1 })], sign);
            }
            line(outer, sign);
        }
    }
    for bore in bores(below) {
        line(bore, -1.0);
    }
    points
}

/// The lines of bores, each from its bottom if it has one.
fn bores(profile: &Profile) -> Vec<Vec<(f64, f64)>> {
    let is_bored = |slice: &Slice| slice.inner > 0.0;
    let bores = profile.slices.chunk_by(|a, b| is_bored(a) == is_bored(b)).filter(|bore| is_bored(&bore[0]));
    let line = |bore: &[Slice]| {
        let bored: Vec<_> = bore.iter().map(|slice| (slice.z, slice.inner)).collect();
        let bottom = (bored[0].0, 0.0);
        let bottom = (bottom.0 > profile.slices[0].z).then_some(bottom);
        bottom.into_iter().chain(thinned(&bored, TOLERANCE_MM)).collect()
    };
    bores.map(line).collect()
}

/// Edges all around the part: upright lines at the corners of its outline, but not in a thread.
fn corners(profile: &Profile, thread_mm: Option<[f64; 2]>) -> Vec<Point> {
    let mut points = Vec::new();
    for [outer, _] in pieces(profile) {
        for three in outer.windows(3) {
            let [(z0, r0), (z, r), (z1, r1)] = [three[0], three[1], three[2]];
            let turn = libm::atan2(r1 - r, z1 - z) - libm::atan2(r - r0, z - z0);
            let is_threaded = thread_mm.is_some_and(|[low, high]| (low..=high).contains(&z));
            if turn.abs().to_degrees() > CORNER_DEG && !is_threaded {
                points.extend([Some((z, r)), Some((z, 0.0)), None]);
            }
        }
    }
    points
}

/// Where flanks end at the crest: Z and radius.
fn flanks(profile: &Profile, [low, high]: [f64; 2], crest: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let below = |slice: &Slice| {
        let outer = slice.outer.unwrap_or(0.0);
        outer - crest(slice.z) + BELOW_CREST_MM
    };
    let inside = profile.slices.iter().filter(|slice| (low..=high).contains(&slice.z)).collect::<Vec<_>>();
    let crossings = inside.windows(2).filter(|two| (below(two[0]) > 0.0) != (below(two[1]) > 0.0));
    crossings.filter_map(|two| Some((two[0].z, two[0].outer?))).collect()
}

/// A flank around the part (M171).
fn around((z, r): (f64, f64), advance_mm: f64) -> impl Iterator<Item = Point> {
    let at = move |deg: i32| {
        let turn = f64::from(deg) / 360.0;
        Some((z + advance_mm * turn, r * libm::cos(core::f64::consts::TAU * turn)))
    };
    (0..=6).map(move |step| at(15 * step)).chain([None])
}

/// 1 of a right-handed thread, −1 of a left-handed one.
fn hand(summary: &Summary, shown: usize) -> f64 {
    let pass = summary.passes.get(shown);
    pass.map_or(1.0, |pass| -(pass.lead_mm * pass.direction).signum())
}

/// The lines of the roots of threads above and below the axis, as far as the part goes.
fn roots(plain: &[Plain], profile: &Profile) -> Vec<Point> {
    let (low, high) = (profile.slices[0].z, profile.slices[profile.slices.len() - 1].z);
    let seen = plain.iter().filter(|thread| thread.ends_mm[0] < high && thread.ends_mm[1] > low);
    let both = seen.flat_map(|thread| {
        let ends = thread.ends_mm.map(|z| z.clamp(low, high));
        let inner =
            thread.root_mm.iter().map(|place| place[0]).filter(move |z| (ends[0] < *z) && (*z < ends[1]));
        let places: Vec<f64> = [ends[0]].into_iter().chain(inner).chain([ends[1]]).collect();
        let line = |side: f64| {
            let points: Vec<Point> = places.iter().map(|z| Some((*z, side * thread.root_at(*z)))).collect();
            points.into_iter().chain([None])
        };
        let above = (thread.sign > 0.0).then(|| line(1.0));
        above.into_iter().flatten().chain(line(-1.0)).collect::<Vec<Point>>()
    });
    both.collect()
}

/// Stock above and below, its bore, and a line where the jaws begin.
fn around_stock(stock: &StockReport) -> Vec<Point> {
    let rows = &stock.rows_mm;
    let (Some([low, _]), Some([high, _])) = (rows.first(), rows.last()) else { return Vec::new() };
    let mut points: Vec<Point> = rows.iter().map(|[z, r]| Some((*z, *r))).collect();
    points.extend(rows.iter().rev().map(|[z, r]| Some((*z, -r))));
    points.extend([points[0], None]);
    if stock.inner_mm > 0.0 {
        let bore = |r: f64| [Some((*low, r)), Some((*high, r)), None];
        points.extend([bore(stock.inner_mm), bore(-stock.inner_mm)].concat());
    }
    if let Some(z) = stock.chuck_mm {
        let most = 1.15 * rows.iter().map(|row| row[1]).fold(0.0, f64::max);
        points.extend([Some((z, most)), Some((z, -most)), None]);
    }
    points
}

/// The largest radius that is drawn.
fn most_mm(above: &Profile, below: &Profile, stock: Option<&StockReport>) -> f64 {
    let slices = above.slices.iter().chain(&below.slices);
    let most = slices.map(|slice| slice.outer.unwrap_or(BEYOND * slice.inner)).fold(0.0, f64::max);
    stock.iter().flat_map(|stock| &stock.rows_mm).map(|row| row[1]).fold(most, f64::max)
}
