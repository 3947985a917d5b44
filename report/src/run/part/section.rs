//! The picture of the section of a thread, with what a gauge allows. In: a thread, mm. Out: a [`Figure`].

use rig::observe::{GaugeLimits, Summary};
use serde_json::{Value, json};

use super::limits::{Limit, both, corners};
use super::outline::thinned;
use super::thread::Thread;
use crate::colours::BAND;
use crate::paint::{BLUE, Figure, GREEN, ORANGE, axis, line};

/// Points of a groove before they are thinned, and of the whole section at most.
const IN_A_GROOVE: f64 = 2000.0;
const MOST_POINTS: f64 = 400_000.0;
/// The surface is thinned to this, mm, and beyond that until so many points are left.
const TOLERANCE_MM: f64 = 1e-4;
const MOST_DRAWN: usize = 2000;
/// Turns on which the picture opens.
const TURNS: f64 = 3.0;

/// The surface over Z, y.
pub(super) fn surface(thread: &Thread) -> Vec<(f64, f64)> {
    let outline = thread.outline(&thread.passes);
    let [low, high] = thread.ends_mm;
    let n = (IN_A_GROOVE * (high - low) / thread.pitch_mm).clamp(2.0, MOST_POINTS) as usize;
    let z = |i: usize| low + (high - low) * i as f64 / n as f64;
    let points: Vec<_> = (0..=n).map(z).map(|z| (z, outline.at(z, thread.crest_at(z)))).collect();
    let mut tolerance = TOLERANCE_MM;
    loop {
        let kept = thinned(&points, tolerance);
        if kept.len() <= MOST_DRAWN {
            return kept;
        }
        tolerance *= 4.0;
    }
}

/// Middles of grooves where a line crosses the surface, of those that are nearly as wide as they should be.
pub(super) fn middles(surface: &[(f64, f64)], line: impl Fn(f64) -> f64, width_mm: f64) -> Vec<f64> {
    let mut into = None;
    let mut found = Vec::new();
    for two in surface.windows(2) {
        let [a, b] = [0, 1].map(|i| two[i].1 - line(two[i].0));
        let z = two[0].0 + (two[1].0 - two[0].0) * a / (a - b);
        if a > 0.0 && b <= 0.0 {
            into = Some(z);
        } else if a <= 0.0
            && b > 0.0
            && let Some(from) = into.take()
            && (0.5..1.5).contains(&((z - from) / width_mm))
        {
            found.push(0.5 * (from + z));
        }
    }
    found
}

/// Where the grooves of a thread without errors lie: spread evenly, where they fit best.
fn even(middles: &[f64], pitch_mm: f64) -> Vec<f64> {
    let Some(first) = middles.first() else { return Vec::new() };
    let number = |z: &f64| ((z - first) / pitch_mm).round();
    let off = middles.iter().map(|z| z - number(z) * pitch_mm).sum::<f64>() / middles.len() as f64;
    middles.iter().map(|z| off + number(z) * pitch_mm).collect()
}

/// The traces of a gauge: the smallest thread, the largest one, and what is shaded between them.
fn zone(limits: &GaugeLimits, thread: &Thread, surface: &[(f64, f64)]) -> Vec<Value> {
    let allowed = both(limits, thread.sign, thread.crest_at(limits.plane_mm));
    let slope = 0.5 * thread.sign * limits.taper;
    let pitch = 0.5 * (allowed[0].pitch + allowed[1].pitch);
    let line_at = |z: f64| pitch + slope * (z - limits.plane_mm);
    let grooves = even(&middles(surface, line_at, 0.5 * limits.pitch_mm), limits.pitch_mm);
    let radius = |(z, y): (f64, f64)| (z, thread.sign * y);
    let points = |limit: Limit| {
        let corners = grooves.iter().flat_map(|middle| corners(limits, limit, thread.sign, *middle));
        corners.map(radius).collect::<Vec<_>>()
    };
    let [go, no_go] = allowed.map(points);
    let named = |points: &[(f64, f64)], name: &str, color: &str| {
        let mut drawn = line(points, name, color, ("x", "y"));
        drawn["line"]["width"] = json!(1.0);
        drawn["line"]["simplify"] = json!(false);
        drawn
    };
    let around: Vec<_> = go.iter().chain(no_go.iter().rev()).copied().collect();
    let mut shaded = named(&around, "allowed", GREEN);
    (shaded["fill"], shaded["fillcolor"], shaded["opacity"]) = (json!("toself"), json!(GREEN), json!(0.35));
    (shaded["line"]["width"], shaded["hoverinfo"]) = (json!(0), json!("skip"));
    vec![shaded, named(&go, "GO", GREEN), named(&no_go, "NO-GO", ORANGE)]
}

/// The picture.
pub(super) fn figure(summary: &Summary, thread: &Thread) -> Figure {
    let surface = surface(thread);
    let crest = thread.crest_at(thread.middle_mm);
    let depth = crest - thread.root_mm;
    let radius = |y: f64| thread.sign * y;
    let cut: Vec<_> = surface.iter().map(|(z, y)| (*z, radius(*y))).collect();
    let mut material = cut.clone();
    let [low, high] = thread.ends_mm;
    let below = radius(thread.root_mm - depth);
    material.extend([(high, below), (low, below)]);
    let mut part = line(&material, "part", BLUE, ("x", "y"));
    (part["fill"], part["fillcolor"], part["line"]["width"]) = (json!("toself"), json!(BAND), json!(0));
    (part["hoverinfo"], part["showlegend"]) = (json!("skip"), json!(false));
    let mut data = vec![part];
    let gauge = summary.gauge_of(thread.pass).filter(|gauge| gauge.limits.pitch_mm > 0.0);
    data.extend(gauge.iter().flat_map(|gauge| zone(&gauge.limits, thread, &surface)));
    let mut drawn = line(&cut, "cut", BLUE, ("x", "y"));
    drawn["line"]["simplify"] = json!(false);
    data.push(drawn);
    let (mut right, mut up) = (axis("Z (mm)"), axis("X, radius (mm)"));
    let half = 0.5 * TURNS * thread.lead_mm;
    let mut heights = [thread.root_mm - 0.3 * depth, crest + 0.3 * depth].map(radius);
    heights.sort_by(f64::total_cmp);
    right["range"] = json!([thread.middle_mm - half, thread.middle_mm + half]);
    (up["range"], up["scaleanchor"]) = (json!(heights), json!("x"));
    let allowed = gauge.map_or_else(String::new, |gauge| {
        format!(
            " Shaded: what {} allows, between the largest thread that GO lets pass and the smallest one that NO-GO \
             refuses, laid along Z where it fits best. Good: the line of the part runs in the shaded zone on both \
             flanks of every groove.",
            gauge.name
        )
    });
    Figure {
        title: "Section of the thread".into(),
        caption: format!(
            "The part as all passes leave it, cut along its axis at spindle angle 0: what the edge of the tool leaves \
             at its true places each time the spindle goes through that angle, {}.{allowed}{} The picture opens on three turns; double-click it for the whole \
             thread.",
            if thread.crest_is_guessed {
                "below a crest that is taken to lie three eighths of the height of the flanks over the pitch line of GO: \
                 nobody says where it is"
            } else {
                "below the crest that was turned, or else that the depth of the passes is counted from"
            },
            if gauge.is_none() { " Good: all grooves are alike, with straight flanks." } else { "" }
        ),
        alt: format!(
            "Section of the thread: crest at a diameter of {:.3} mm, deepest place at {:.3} mm in the middle of the \
             thread.",
            2.0 * crest.abs(),
            2.0 * thread.root_mm.abs()
        ),
        plot: json!({ "data": data, "layout": { "xaxis": right, "yaxis": up } }),
        aspect: 0.4,
    }
}
