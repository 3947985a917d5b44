//! Experiment `positioner`: how far errors of four drives move the beam of a positioner on its part, by
//! bounds, by poses and at random; what drives a wanted accuracy needs; and a seam in the whole machine. In:
//! sizes of parts, errors of the drives; a positioner. Out: a row for each case. mm, µm, degrees. Source:
//! "Mathematical model of kinematics and requirements for drives of a precision positioning system",
//! (2)–(10); its equations are M46–M52, in `shape`; M90, M91 are new.

mod figures;
mod misprints;
mod sample;
mod seam;
mod tables;
#[cfg(test)]
mod tests;
mod text;

use serde::Serialize;
use shape::{DriveErrors, Positioner};

use super::{Findings, Stand};
use crate::ExperimentError;
use misprints::Misprint;
use sample::{Case, Drawn, Spread};
use seam::SeamRun;

/// The published example, (10).
const EXAMPLE: Case = Case {
    size_mm: 200.0,
    errors: DriveErrors { linear_mm: 0.03, angular_rad: 0.0014 * std::f64::consts::PI / 180.0 },
};

/// Sizes of part and positioner, mm.
const SIZES_MM: [f64; 6] = [50.0, 100.0, 150.0, 200.0, 300.0, 400.0];

/// Errors of slides in mm and of angles in degrees; the first are the published ones.
const ERRORS: [(f64, f64); 3] = [(0.03, 0.0014), (0.01, 0.005), (0.002, 0.0005)];

/// Accuracies that are asked for, µm.
const ACCURACIES_UM: [f64; 4] = [5.0, 10.0, 20.0, 50.0];

/// The share of an accuracy that slides may use up.
const LINEAR_SHARE: f64 = 0.5;

/// Inputs and figures of one case; displacements along x, y, z of the machine.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    part_mm: f64,
    linear_error_mm: f64,
    angular_error_deg: f64,
    /// (9) of the source.
    published_um: [f64; 3],
    /// M51.
    tight_um: [f64; 3],
    /// At the poses where M51 is largest, exactly.
    attained_um: [f64; 3],
    /// Largest of those drawn evenly within their limits, exactly.
    sampled_max_um: [f64; 3],
    sampled_rms_um: [f64; 3],
    /// Largest of those with sizes and errors at their ends, in any pose.
    sampled_ends_max_um: [f64; 3],
    /// Largest difference between exact and linear (M50) displacement of all that were drawn, and its bound
    /// (M91).
    linearisation_um: f64,
    linearisation_bound_um: f64,
    /// What drives an accuracy needs on this part (M90).
    required: Vec<Required>,
}

/// The largest errors that drives may have for an accuracy.
#[derive(Clone, Copy, Debug, Serialize)]
struct Required {
    accuracy_um: f64,
    linear_um: f64,
    angular_deg: f64,
}

impl Required {
    fn of(accuracy_um: f64, size_mm: f64) -> Required {
        let positioner = Positioner::of_size(size_mm);
        let errors = positioner.required([size_mm; 3], 1e-3 * accuracy_um, LINEAR_SHARE);
        Required {
            accuracy_um,
            linear_um: 1e3 * errors.linear_mm,
            angular_deg: errors.angular_rad.to_degrees(),
        }
    }
}

impl Row {
    fn of(size_mm: f64, (linear_error_mm, angular_error_deg): (f64, f64), seed: u64) -> Row {
        let errors = DriveErrors { linear_mm: linear_error_mm, angular_rad: angular_error_deg.to_radians() };
        let case = Case { size_mm, errors };
        let um = |mm: [f64; 3]| mm.map(|mm| 1e3 * mm);
        let [even, ends]: [Drawn; 2] = [Spread::Even, Spread::Ends].map(|spread| case.drawn(seed, spread));
        Row {
            part_mm: size_mm,
            linear_error_mm,
            angular_error_deg,
            published_um: um(case.published()),
            tight_um: um(case.tight()),
            attained_um: um(case.attained()),
            sampled_max_um: um(even.largest),
            sampled_rms_um: um(even.rms),
            sampled_ends_max_um: um(ends.largest),
            linearisation_um: 1e3 * even.neglected.max(ends.neglected),
            linearisation_bound_um: 1e3 * case.neglected(),
            required: ACCURACIES_UM.map(|um| Required::of(um, size_mm)).to_vec(),
        }
    }

    /// Whether it has the errors of the published example.
    fn is_published(&self) -> bool {
        (self.linear_error_mm, self.angular_error_deg) == ERRORS[0]
    }
}

/// Everything that was computed.
struct Computed {
    rows: Vec<Row>,
    misprints: Vec<Misprint>,
    seam: SeamRun,
    seed: u64,
}

impl Computed {
    /// The published example.
    fn example(&self) -> Option<&Row> {
        self.rows.iter().find(|row| row.is_published() && row.part_mm == EXAMPLE.size_mm)
    }
}

/// What is computed at once with others.
enum Job {
    Seam,
    Row(f64, (f64, f64)),
}

enum Done {
    Seam(Box<SeamRun>),
    Row(Row),
}

/// Computes the rows, runs the seam, with what is to be said and drawn of them.
///
/// # Errors
/// The machine did not make the seam.
pub(super) fn findings(stand: &Stand) -> Result<Findings<Row>, ExperimentError> {
    let cases = ERRORS.iter().flat_map(|errors| SIZES_MM.map(|size| Job::Row(size, *errors)));
    let jobs: Vec<Job> = std::iter::once(Job::Seam).chain(cases).collect();
    let done = stand.each(&jobs, |job| {
        Ok(match job {
            Job::Seam => Done::Seam(Box::new(seam::run(&stand.machine, stand.seed)?)),
            Job::Row(size, errors) => Done::Row(Row::of(*size, *errors, stand.seed)),
        })
    })?;
    let (mut seam, mut rows) = (None, Vec::new());
    for one in done {
        match one {
            Done::Seam(run) => seam = Some(*run),
            Done::Row(row) => rows.push(row),
        }
    }
    let seam = seam.ok_or_else(|| ExperimentError::Machine("the seam was not run".into()))?;
    let computed = Computed { rows, misprints: misprints::all(stand.seed), seam, seed: stand.seed };
    Ok(Findings {
        title: "A positioner with four axes: errors of its drives at the beam",
        short: text::short(&computed),
        done: text::done(),
        tables: tables::all(&computed),
        notes: computed.misprints.iter().map(Misprint::sentence).collect(),
        figures: figures::all(&computed),
        text: text::meaning(&computed),
        rows: computed.rows,
    })
}
