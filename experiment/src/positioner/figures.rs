//! Pictures of the positioner. In: what was computed. Out: bounds over the size of the part, what was drawn
//! against them, what linearising leaves out, drives for an accuracy, errors along the seam.

use serde_json::{Value, json};
use shape::DriveErrors;

use super::{
    ACCURACIES_UM, Computed, ERRORS, EXAMPLE, Required, Row, SIZES_MM,
    sample::{Case, Spread},
};
use report::paint::{BLUE, Figure, GREEN, GREY, ORANGE, axis, line};

/// Points that are shown of each way to draw.
const SHOWN: usize = 1200;

pub(super) fn all(computed: &Computed) -> Vec<Figure> {
    vec![over_size(computed), scatter(computed), linearised(computed), drives(), seam(computed)]
}

fn dots(points: &[(f64, f64)], name: &str, color: &str, size: u32, axes: (&str, &str)) -> Value {
    let mut trace = line(points, name, color, axes);
    trace["mode"] = json!("markers");
    trace["marker"] = json!({ "color": color, "size": size });
    trace
}

fn dashed(points: &[(f64, f64)], name: &str, color: &str, axes: (&str, &str)) -> Value {
    let mut trace = line(points, name, color, axes);
    trace["line"]["dash"] = json!("dash");
    trace
}

fn over_size(computed: &Computed) -> Figure {
    let errors = EXAMPLE.errors;
    let bound = |of: fn(&Case) -> [f64; 3], axis: usize| {
        let at = |n: u32| 10.0 * f64::from(n);
        (0..=40).map(|n| (at(n), 1e3 * of(&Case { size_mm: at(n), errors })[axis])).collect::<Vec<_>>()
    };
    let rows = |of: fn(&Row) -> &[f64; 3], axis: usize| {
        let shown = computed.rows.iter().filter(|row| row.is_published());
        shown.map(|row| (row.part_mm, of(row)[axis])).collect::<Vec<_>>()
    };
    let both = ("x", "y");
    Figure {
        title: "Bounds over the size of the part".into(),
        caption: "Slides within 30 µm, angles within 0.0014°. Lines: the tight bound (M51). Dashed: the published one (9), \
                  along y and z. Large dots: attained, exactly. Small dots: the largest of evenly drawn displacements."
            .into(),
        alt: "Largest displacement along x, y and z over the size of the part: tight and published bounds, attained and \
              drawn."
            .into(),
        plot: json!({
            "data": [
                line(&bound(Case::tight, 1), "y, tight", BLUE, both),
                dashed(&bound(Case::published, 1), "y, published", BLUE, both),
                line(&bound(Case::tight, 2), "z, tight", ORANGE, both),
                dashed(&bound(Case::published, 2), "z, published", ORANGE, both),
                line(&bound(Case::tight, 0), "x, both", GREEN, both),
                dots(&rows(|row| &row.attained_um, 1), "y, attained", BLUE, 9, both),
                dots(&rows(|row| &row.attained_um, 2), "z, attained", ORANGE, 9, both),
                dots(&rows(|row| &row.attained_um, 0), "x, attained", GREEN, 9, both),
                dots(&rows(|row| &row.sampled_max_um, 1), "y, drawn", BLUE, 4, both),
                dots(&rows(|row| &row.sampled_max_um, 2), "z, drawn", ORANGE, 4, both),
            ],
            "layout": { "xaxis": axis("part (mm)"), "yaxis": axis("displacement (µm)") },
        }),
        aspect: 0.55,
    }
}

/// A rectangle about the middle.
fn around([y, z]: [f64; 2], color: &str, dash: &str) -> Value {
    json!({ "type": "rect", "x0": -y, "x1": y, "y0": -z, "y1": z, "line": { "color": color, "width": 1.5, "dash": dash } })
}

fn scatter(computed: &Computed) -> Figure {
    let of = |spread| {
        let draws = EXAMPLE.draws(computed.seed, spread).take(SHOWN);
        draws.map(|drawn| (1e3 * drawn.exact[1], 1e3 * drawn.exact[2])).collect::<Vec<_>>()
    };
    let corners: Vec<_> =
        EXAMPLE.corners()[1..].iter().map(|corner| (1e3 * corner.exact[1], 1e3 * corner.exact[2])).collect();
    let bound = |bound: [f64; 3]| [1e3 * bound[1], 1e3 * bound[2]];
    let both = ("x", "y");
    let mut plot = json!({
        "data": [
            dots(&of(Spread::Ends), "sizes and errors at their ends", GREY, 4, both),
            dots(&of(Spread::Even), "evenly drawn", BLUE, 4, both),
            dots(&corners, "attained", ORANGE, 10, both),
        ],
        "layout": { "xaxis": axis("displacement along y (µm)"), "yaxis": axis("along z (µm)") },
    });
    plot["layout"]["shapes"] = json!([
        around(bound(EXAMPLE.tight()), ORANGE, "solid"),
        around(bound(EXAMPLE.published()), GREY, "dash")
    ]);
    Figure {
        title: "What was drawn, and both bounds".into(),
        caption: format!(
            "The published example, {SHOWN} points of each kind: exact displacements along y and z. Solid: the tight bound \
             (M51); dashed: the published one. The large dots are the poses at which M51 is attained along y and along z."
        ),
        alt: "Displacements along y and z, drawn at random, within the rectangles of both bounds.".into(),
        plot,
        aspect: 0.6,
    }
}

fn linearised(computed: &Computed) -> Figure {
    let case = |n: u32| {
        let angular_rad = libm::pow(10.0, f64::from(n) / 4.0 - 4.0).to_radians();
        Case { errors: DriveErrors { angular_rad, ..EXAMPLE.errors }, ..EXAMPLE }
    };
    let points = |of: &dyn Fn(&Case) -> f64| {
        let all = (0..=16).map(case);
        all.map(|case| (case.errors.angular_rad.to_degrees(), 1e3 * of(&case))).collect::<Vec<_>>()
    };
    let missed = |case: &Case| {
        let draws = case.draws(computed.seed, Spread::Ends).take(SHOWN);
        let off =
            |[a, b]: [[f64; 3]; 2]| a.into_iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        draws.map(|drawn| off([drawn.exact, drawn.linear])).fold(0.0, f64::max)
    };
    let exact = |points: Vec<(f64, f64)>, name: &str, color: &str, mode: &str| {
        let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
        json!({ "type": "scatter", "mode": mode, "name": name, "x": x, "y": y,
                "line": { "color": color, "width": 1.5 }, "marker": { "color": color, "size": 7 } })
    };
    let log = |title: &str| json!({ "title": { "text": title }, "type": "log", "exponentformat": "power" });
    Figure {
        title: "What the linear displacement leaves out".into(),
        caption: "A part of 200 mm. It grows with the square of the error of the angles, and stays below M91; at 0.0014° it is \
                  a thousandth of a micrometre."
            .into(),
        alt: "Difference between exact and linear displacement over the error of the angles, with its bound.".into(),
        plot: json!({
            "data": [
                exact(points(&Case::neglected), "at most (M91)", ORANGE, "lines"),
                exact(points(&missed), "drawn", BLUE, "markers"),
                exact(points(&|case: &Case| case.tight()[2]), "displacement itself, z (M51)", GREY, "lines"),
            ],
            "layout": { "xaxis": log("error of the angles (deg)"), "yaxis": log("µm") },
        }),
        aspect: 0.5,
    }
}

fn drives() -> Figure {
    let colors = [BLUE, ORANGE, GREEN, GREY];
    let trace = |(accuracy_um, color): (f64, &str)| {
        let points: Vec<_> = (2..=40)
            .map(|n| 10.0 * f64::from(n))
            .map(|size_mm| (size_mm, 3600.0 * Required::of(accuracy_um, size_mm).angular_deg))
            .collect();
        line(&points, &format!("within {accuracy_um} µm"), color, ("x", "y"))
    };
    let data: Vec<_> = ACCURACIES_UM.into_iter().zip(colors).map(trace).collect();
    let published = (EXAMPLE.size_mm, 3600.0 * ERRORS[0].1);
    Figure {
        title: "Angles for a wanted accuracy".into(),
        caption: format!(
            "Largest error of the rotary axes over the size of the part, if slides use half of the accuracy (M90), from {} mm \
             on. Dot: the published example.",
            SIZES_MM[0].min(20.0)
        ),
        alt: "Largest error of the angles in seconds of arc over the size of the part, for four accuracies."
            .into(),
        plot: json!({
            "data": data.into_iter().chain([dots(&[published], "published example", ORANGE, 9, ("x", "y"))]).collect::<Vec<_>>(),
            "layout": { "xaxis": axis("part (mm)"), "yaxis": { "title": { "text": "angles (″)" }, "type": "log" } },
        }),
        aspect: 0.5,
    }
}

fn seam(computed: &Computed) -> Figure {
    let curve = &computed.seam.curve;
    let over =
        |of: fn(&rig::observe::Traced) -> f64| curve.iter().map(|(t, at)| (*t, of(at))).collect::<Vec<_>>();
    let axes = |n: u32| ("x".to_owned(), if n == 1 { "y".to_owned() } else { format!("y{n}") });
    let trace = |of, name: &str, color: &str, n: u32| {
        let (x, y) = axes(n);
        line(&over(of), name, color, (&x, &y))
    };
    Figure {
        title: "Along the seam".into(),
        caption: "A branch of 40 mm on a pipe of 60 mm, in the whole machine. Above: how far the beam is beside the seam; middle: \
                  its angle to the bisector; below: feed of the beam on the part."
            .into(),
        alt: "Deviation of the beam, its angle to the bisector, and its feed, over the time of the seam.".into(),
        plot: json!({
            "data": [
                trace(|at| 1e3 * at.slide.deviation_mm, "true", BLUE, 1),
                trace(|at| 1e3 * at.commanded.deviation_mm, "commanded", ORANGE, 1),
                trace(|at| 1e3 * at.slide.angle_deg, "true", BLUE, 2),
                trace(|at| 1e3 * at.commanded.angle_deg, "commanded", ORANGE, 2),
                trace(|at| at.slide.feed_mm_min, "true", BLUE, 3),
                trace(|at| at.commanded.feed_mm_min, "commanded", ORANGE, 3),
            ],
            "layout": {
                "xaxis": { "anchor": "y3", "title": { "text": "time (s)" } },
                "yaxis": { "domain": [0.70, 1.0], "title": { "text": "beside (µm)" } },
                "yaxis2": { "domain": [0.36, 0.64], "title": { "text": "angle (0.001°)" } },
                "yaxis3": { "domain": [0.0, 0.30], "title": { "text": "feed (mm/min)" } },
            },
        }),
        aspect: 0.7,
    }
}
