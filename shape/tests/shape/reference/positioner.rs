//! `positioner.json` (M46–M52): 18 poses with their errors, bounds as published and tight.

use serde::Deserialize;
use shape::{Branch, DriveErrors, Drives, Positioner};
use std::f64::consts::PI;
use testing::reference::{close, read};

#[derive(Deserialize)]
struct File {
    schema: String,
    cases: Vec<Case>,
    bounds: Vec<Bound>,
    general_bounds: Vec<GeneralBound>,
}

#[derive(Deserialize)]
struct Case {
    id: String,
    offsets_mm: [f64; 6],
    point_mm: [f64; 3],
    drives: Pose,
    fk_mm: [f64; 3],
    ik: Inverse,
    drive_errors: Errors,
    linear_error_mm: [f64; 3],
    exact_error_mm: [f64; 3],
}

#[derive(Deserialize)]
struct Pose {
    x_mm: f64,
    y_mm: f64,
    alpha_rad: f64,
    beta_rad: f64,
    z_a_mm: Option<f64>,
}

#[derive(Deserialize)]
struct Inverse {
    target_xy_mm: [f64; 2],
    direction: [f64; 3],
    singular: bool,
    solutions: Vec<Pose>,
}

#[derive(Deserialize)]
struct Errors {
    dx_mm: f64,
    dy_mm: f64,
    dalpha_rad: f64,
    dbeta_rad: f64,
}

#[derive(Deserialize)]
struct Bound {
    delta_m_mm: f64,
    delta_rad_deg: f64,
    l_max_mm: f64,
    paper: [f64; 3],
    tight: [f64; 3],
}

#[derive(Deserialize)]
struct GeneralBound {
    delta_m_mm: f64,
    delta_rad: f64,
    x_abs_mm: f64,
    y_abs_mm: f64,
    z_abs_mm: f64,
    y2_abs_mm: f64,
    z2_abs_mm: f64,
    tight: [f64; 3],
}

fn file() -> File {
    let file: File = read("positioner.json");
    assert_eq!(file.schema, "positioner/1");
    assert!(!file.cases.is_empty() && !file.bounds.is_empty() && !file.general_bounds.is_empty());
    file
}

fn all_close(at: &str, got: &[f64], want: &[f64], scale: f64) {
    assert_eq!(got.len(), want.len(), "{at}");
    got.iter().zip(want).for_each(|(got, want)| close(at, *got, *want, scale, 1e-9));
}

impl Case {
    fn positioner(&self) -> Positioner {
        let [x1, y1, z1, x2, y2, z2] = self.offsets_mm;
        Positioner { x1, y1, z1, x2, y2, z2 }
    }
}

impl Pose {
    fn drives(&self) -> Drives {
        Drives { x: self.x_mm, y: self.y_mm, alpha: self.alpha_rad, beta: self.beta_rad }
    }
}

#[test]
fn reference_forward_and_errors() {
    for case in file().cases {
        let (positioner, drives) = (case.positioner(), case.drives.drives());
        let errors = &case.drive_errors;
        let error =
            Drives { x: errors.dx_mm, y: errors.dy_mm, alpha: errors.dalpha_rad, beta: errors.dbeta_rad };
        all_close(&case.id, &positioner.forward(case.point_mm, &drives), &case.fk_mm, 1e3);
        let linear = positioner.linear_error(case.point_mm, &drives, &error);
        all_close(&case.id, &linear, &case.linear_error_mm, 1e-3);
        // A difference of positions of some hundred mm: their rounding is the scale.
        all_close(
            &case.id,
            &positioner.exact_error(case.point_mm, &drives, &error),
            &case.exact_error_mm,
            1e3,
        );
    }
}

#[test]
fn reference_inverse() {
    for case in file().cases.iter().filter(|case| !case.ik.singular) {
        let (positioner, point, ik) = (case.positioner(), case.point_mm, &case.ik);
        assert_eq!(ik.solutions.len(), 2, "{}", case.id);
        for (branch, want) in Branch::BOTH.into_iter().zip(&ik.solutions) {
            let got = positioner.inverse(point, ik.direction, ik.target_xy_mm, branch, want.beta_rad);
            all_close(&case.id, &[got.x, got.y], &[want.x_mm, want.y_mm], 1e3);
            all_close(&case.id, &[got.alpha, got.beta], &[want.alpha_rad, want.beta_rad], 4.0);
            all_close(&case.id, &[positioner.forward(point, &got)[2]], &[want.z_a_mm.unwrap()], 1e3);
        }
    }
}

#[test]
fn reference_singular_directions_keep_the_turn() {
    let cases = file().cases;
    let singular: Vec<_> = cases.iter().filter(|case| case.ik.singular).collect();
    assert!(!singular.is_empty());
    for case in singular {
        assert!(case.ik.solutions.is_empty(), "{}", case.id);
        for branch in Branch::BOTH {
            let (point, ik) = (case.point_mm, &case.ik);
            let got = case.positioner().inverse(point, ik.direction, ik.target_xy_mm, branch, 1.25);
            assert_eq!(got.beta, 1.25, "{}", case.id);
            assert_eq!(got.alpha.abs(), if ik.direction[2] > 0.0 { 0.0 } else { PI }, "{}", case.id);
            let at = case.positioner().forward(point, &got);
            all_close(&case.id, &at[..2], &ik.target_xy_mm, 1e3);
        }
    }
}

#[test]
fn reference_bounds_of_a_size() {
    for bound in file().bounds {
        let errors =
            DriveErrors { linear_mm: bound.delta_m_mm, angular_rad: bound.delta_rad_deg.to_radians() };
        let size = bound.l_max_mm;
        all_close("published", &errors.published_bound(size), &bound.paper, 0.0);
        let tight = Positioner::of_size(size).error_bound([size; 3], errors);
        all_close("tight", &tight, &bound.tight, 0.0);
    }
}

#[test]
fn reference_bounds_of_known_values() {
    for bound in file().general_bounds {
        let errors = DriveErrors { linear_mm: bound.delta_m_mm, angular_rad: bound.delta_rad };
        let positioner =
            Positioner { y2: bound.y2_abs_mm, z2: -bound.z2_abs_mm, x1: 77.0, ..Positioner::default() };
        let largest = [bound.x_abs_mm, bound.y_abs_mm, bound.z_abs_mm];
        all_close("tight", &positioner.error_bound(largest, errors), &bound.tight, 0.0);
    }
}
