//! `shaping.json`: ratios of plane curves and of paths on surfaces, their errors, feed limits (M36–M45).
//!
//! Errors of the next point are differences of coordinates: their scale is that of the coordinate.

use serde::Deserialize;
use shape::{Correction, Section, Sections, Series, chord_feed, master_feed, radius};
use testing::reference::{close, parameter, read};

#[derive(Deserialize)]
struct File {
    schema: String,
    curves: Vec<Curve>,
    surfaces: Vec<Surface>,
}

#[derive(Deserialize)]
struct FeedLimit {
    x_mm: f64,
    radius_mm: f64,
    delta_mm: f64,
    dt_s: f64,
    s_k_mm_s: f64,
    s_k_exact_mm_s: f64,
    s_x_mm_s: f64,
}

#[derive(Deserialize)]
struct Curve {
    id: String,
    formula: String,
    a: f64,
    k: f64,
    b: f64,
    x0_mm: f64,
    h_mm: f64,
    steps: usize,
    columns: Vec<String>,
    rows: Vec<Vec<f64>>,
    feed_limit: FeedLimit,
}

impl Curve {
    /// Y and its derivatives.
    fn at(&self, x: f64) -> (f64, Section) {
        let Curve { a, k, b, .. } = self;
        let (sin, cos) = libm::sincos(k * x);
        let section = Section {
            slope: a * k * cos + 2.0 * b * x,
            second: -a * k * k * sin + 2.0 * b,
            third: -a * k * k * k * cos,
        };
        (a * sin + b * x * x, section)
    }

    /// A row of the file by our formulas; the sums of errors are those of all steps before and of this one.
    fn row(&self, index: usize, sums: &mut [f64; 2]) -> [f64; 13] {
        let x = self.x0_mm + self.h_mm * index as f64;
        let h = self.h_mm;
        let ((y, section), (next, _)) = (self.at(x), self.at(x + h));
        let corrected = section.corrected(h);
        let exact = (next - y) / h;
        let errors = [section.slope, corrected].map(|ratio| y + ratio * h - next);
        for (sum, error) in sums.iter_mut().zip(errors) {
            *sum += error;
        }
        let m = section.exact_m(h, exact);
        let [rho, tau] = [section.curvature(), section.turn(h)];
        let ratios = [section.slope, rho, tau, corrected, exact, m];
        let [r1, r2, r3, r4, r5, r6] = ratios;
        [index as f64, x, y, r1, r2, r3, r4, r5, r6, errors[0], errors[1], sums[0], sums[1]]
    }
}

const CURVE: [&str; 13] = [
    "i",
    "x_mm",
    "y_mm",
    "k_uncorrected",
    "rho_1_mm",
    "tau_rad",
    "k1_corrected",
    "k_exact",
    "m_exact",
    "dev_uncorrected_mm",
    "dev_corrected_mm",
    "cum_dev_uncorrected_mm",
    "cum_dev_corrected_mm",
];

/// Largest magnitude of each column; columns of errors have the scale of the coordinate that they are of.
fn scales<const N: usize>(columns: [&str; N], rows: &[Vec<f64>], coordinate: &str) -> [f64; N] {
    let largest = |column: usize| rows.iter().map(|row| row[column].abs()).fold(0.0, f64::max);
    let place = |name: &str| columns.iter().position(|column| *column == name).expect("the column is there");
    let scale = |column: usize| match columns[column] {
        "path_dev_y_mm" => largest(place("y_mm")),
        name if name.contains("dev_") => largest(place(coordinate)),
        _ => largest(column),
    };
    std::array::from_fn(scale)
}

fn check_limit(id: &str, limit: &FeedLimit, radius: f64, ratios: [f64; 2]) {
    let &FeedLimit { delta_mm, dt_s, .. } = limit;
    parameter(&format!("{id}: radius"), radius, limit.radius_mm);
    let s_k = chord_feed(radius, delta_mm, dt_s);
    parameter(&format!("{id}: S_k"), s_k, limit.s_k_mm_s);
    parameter(
        &format!("{id}: S_k exact"),
        chord_feed(radius - 0.5 * delta_mm, delta_mm, dt_s),
        limit.s_k_exact_mm_s,
    );
    parameter(&format!("{id}: S_X"), master_feed(s_k, ratios), limit.s_x_mm_s);
}

#[test]
fn reference_shaping_curves() {
    let file: File = read("shaping.json");
    assert_eq!(file.schema, "shaping/1");
    assert!(!file.curves.is_empty(), "no curves");
    for case in &file.curves {
        let id = &case.id;
        assert_eq!(
            (case.formula.as_str(), &case.columns[..]),
            ("y = a*sin(k*x) + b*x^2", &CURVE.map(str::to_owned)[..])
        );
        let scales = scales(CURVE, &case.rows, "y_mm");
        let mut sums = [0.0; 2];
        let rows: Vec<_> = (0..case.steps).map(|index| case.row(index, &mut sums)).collect();
        assert!(!case.rows.is_empty(), "{id}: no rows");
        for wanted in &case.rows {
            let got = rows[wanted[0] as usize];
            for (column, name) in CURVE.iter().enumerate() {
                close(
                    &format!("{id}: {name} of row {}", wanted[0]),
                    got[column],
                    wanted[column],
                    scales[column],
                    1e-9,
                );
            }
        }
        let limit = &case.feed_limit;
        let (y, section) = case.at(limit.x_mm);
        let path = [[limit.x_mm, 1.0, 0.0, 0.0], [y, section.slope, section.second / 2.0, 0.0], [0.0; 4]];
        check_limit(id, limit, radius(&path.map(Series)), [section.slope, 0.0]);
    }
}

#[derive(Deserialize)]
struct Surface {
    id: String,
    formula: String,
    path: String,
    params: std::collections::BTreeMap<String, f64>,
    steps: usize,
    columns: Vec<String>,
    rows: Vec<Vec<f64>>,
    feed_limit: FeedLimit,
}

impl Surface {
    fn param(&self, name: &str) -> f64 {
        *self.params.get(name).unwrap_or_else(|| panic!("{}: no {name}", self.id))
    }

    /// Y of the path and its derivatives.
    fn path(&self, x: f64) -> (f64, Section) {
        let [y0, p, q] = ["y0", "p", "q"].map(|name| self.param(name));
        (y0 + p * x + q * x * x, Section { slope: p + 2.0 * q * x, second: 2.0 * q, third: 0.0 })
    }

    /// Z, its gradient, and Z_XX, Z_XY, Z_YY.
    fn surface(&self, x: f64, y: f64) -> (f64, [f64; 2], [f64; 3]) {
        let a = self.param("a");
        match self.formula.as_str() {
            "z = a*x^2 + b*y^2 + c*x*y" => {
                let [b, c] = ["b", "c"].map(|name| self.param(name));
                let z = a * x * x + b * y * y + c * x * y;
                (z, [2.0 * a * x + c * y, 2.0 * b * y + c * x], [2.0 * a, c, 2.0 * b])
            }
            "z = a*sin(k*x)*cos(m*y)" => {
                let [k, m] = ["k", "m"].map(|name| self.param(name));
                let ((sx, cx), (sy, cy)) = (libm::sincos(k * x), libm::sincos(m * y));
                let gradient = [a * k * cx * cy, -a * m * sx * sy];
                (a * sx * cy, gradient, [-a * k * k * sx * cy, -a * k * m * cx * sy, -a * m * m * sx * cy])
            }
            other => panic!("{}: a surface that this test does not know: {other}", self.id),
        }
    }

    fn sections(&self, x: f64) -> Sections {
        let (y, xoy) = self.path(x);
        let (_, [zx, zy], [zxx, mixed, zyy]) = self.surface(x, y);
        let section = |slope, second| Section { slope, second, third: 0.0 };
        Sections { xoz: section(zx, zxx), yoz: section(zy, zyy), xoy, mixed }
    }

    fn row(&self, index: usize) -> [f64; 22] {
        let h = self.param("h");
        let x = self.param("x0") + h * index as f64;
        let (y, next_y) = (self.path(x).0, self.path(x + h).0);
        let z = self.surface(x, y).0;
        let sections = self.sections(x);
        // In the file the exact ratio goes to the Y that the corrected one of the plan view reaches.
        let k = sections.xoy.corrected(h) * h;
        let ways = [k, self.surface(x + h, y + k).0 - z];
        let of = |correction| sections.ratios(correction, h, ways);
        let (_, [_, zy], [_, _, zyy]) = self.surface(x + h, y);
        let shifted = Sections { yoz: Section { slope: zy, second: zyy, third: 0.0 }, ..sections };
        let [k1, shifted] = shifted.ratios(Correction::PublishedSigns, h, ways);
        let ([k1_none, none], [_, signs], [_, mixed], [_, exact]) = (
            of(Correction::None),
            of(Correction::PublishedSigns),
            of(Correction::Mixed),
            of(Correction::Exact),
        );
        // The error of Z is taken at the Y that is reached with the same correction.
        let error = |k1: f64, k2: f64| z + k2 * h - self.surface(x + h, y + k1 * h).0;
        let Sections { xoz, yoz, xoy, .. } = sections;
        [
            index as f64,
            x,
            y,
            z,
            xoz.slope,
            yoz.slope,
            xoy.slope,
            none,
            xoz.turn(h),
            yoz.turn(k1 * h),
            xoz.corrected(h),
            yoz.corrected(k1 * h),
            k1,
            signs,
            mixed,
            shifted,
            exact,
            error(k1_none, none),
            error(k1, signs),
            error(k1, mixed),
            error(k1, shifted),
            y + k1 * h - next_y,
        ]
    }
}

const SURFACE: [&str; 22] = [
    "i",
    "x_mm",
    "y_mm",
    "z_mm",
    "dz_dx",
    "dz_dy",
    "dy_dx",
    "k2_uncorrected",
    "tau_xoz",
    "tau_yoz",
    "k_xoz",
    "k_yoz",
    "k_xoy",
    "k2_corrected",
    "k2_corrected_mixed",
    "k2_corrected_shifted",
    "k2_exact",
    "dev_uncorrected_mm",
    "dev_corrected_mm",
    "dev_mixed_mm",
    "dev_shifted_mm",
    "path_dev_y_mm",
];

#[test]
fn reference_shaping_surfaces() {
    let file: File = read("shaping.json");
    assert!(!file.surfaces.is_empty(), "no surfaces");
    for case in &file.surfaces {
        let id = &case.id;
        assert_eq!(
            (case.path.as_str(), &case.columns[..]),
            ("y = y0 + p*x + q*x^2", &SURFACE.map(str::to_owned)[..])
        );
        assert_eq!(case.rows.len(), case.steps, "{id}");
        let scales = scales(SURFACE, &case.rows, "z_mm");
        for wanted in &case.rows {
            let got = case.row(wanted[0] as usize);
            for (column, name) in SURFACE.iter().enumerate() {
                close(
                    &format!("{id}: {name} of row {}", wanted[0]),
                    got[column],
                    wanted[column],
                    scales[column],
                    1e-9,
                );
            }
        }
        let limit = &case.feed_limit;
        let Sections { xoz, yoz, xoy, mixed } = case.sections(limit.x_mm);
        let bend = xoz.second
            + 2.0 * mixed * xoy.slope
            + yoz.second * xoy.slope * xoy.slope
            + yoz.slope * xoy.second;
        let rise = xoz.slope + yoz.slope * xoy.slope;
        let path = [
            [limit.x_mm, 1.0, 0.0, 0.0],
            [0.0, xoy.slope, xoy.second / 2.0, 0.0],
            [0.0, rise, bend / 2.0, 0.0],
        ];
        check_limit(id, limit, radius(&path.map(Series)), [xoy.slope, rise]);
    }
}
