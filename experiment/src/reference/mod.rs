//! Experiment `reference`: the reference simulation of the servo axis, made again with the code that moves
//! the machine. In: a stand, of which only the seed counts. Out: for each structure of feedforward at three
//! overrides the printed figures, those measured here, and whether they agree.
//!
//! | word | means |
//! |---|---|
//! | here | the median of eight seeds |
//! | agrees | it is off the printed figure by at most 5 % of it, one of its last digit, or what the seeds spread over, whichever is most |
//!
//! The reference is another program with another plant, written before this one. Its figures come out here
//! only if this plant does to a servo axis what that one did.

mod figures;
mod measure;
mod plant;
mod published;
#[cfg(test)]
mod tests;
mod text;

use serde::Serialize;

use report::table::{Column, Place, Table};

use super::{Findings, stand::Stand};
use crate::ExperimentError;
use measure::{Measured, measure};
use plant::{AS_PRINTED, Switches};
use published::{CREEP_UM, OVERRIDES, STRUCTURES, Structure};

/// Seeds of which the median is taken.
const SEEDS: u64 = 8;
/// What a figure may be off, a share of it.
const SHARE: f64 = 0.05;

/// A printed figure, and what eight seeds give, µm.
#[derive(Clone, Copy, Debug)]
struct Compared {
    printed: &'static str,
    median: f64,
    least: f64,
    most: f64,
}

impl Compared {
    /// A printed figure and those of the seeds.
    fn of(printed: &'static str, mut seeds: Vec<f64>) -> Compared {
        seeds.sort_by(f64::total_cmp);
        let middle = seeds.len() / 2;
        let at = |index: usize| seeds.get(index).copied().unwrap_or(f64::NAN);
        Compared {
            printed,
            median: 0.5 * (at(middle.saturating_sub(1)) + at(middle)),
            least: at(0),
            most: at(seeds.len().saturating_sub(1)),
        }
    }

    fn reference(&self) -> f64 {
        self.printed.parse().unwrap_or(f64::NAN)
    }

    /// One of the last digit that was printed.
    fn digit(&self) -> f64 {
        let behind = self.printed.split_once('.').map_or(0, |(_, behind)| behind.len());
        libm::pow(10.0, -(behind as f64))
    }

    fn agrees(&self) -> bool {
        let tolerance = (SHARE * self.reference().abs()).max(self.digit()).max(self.most - self.least);
        (self.median - self.reference()).abs() <= tolerance
    }
}

/// Inputs and figures of one structure at one override, µm.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    structure: &'static str,
    override_pct: f64,
    approach_min_um: f64,
    approach_max_um: f64,
    end_um: f64,
    thread_max_abs_um: f64,
    reference_approach_min_um: f64,
    reference_approach_max_um: f64,
    reference_end_um: f64,
    reference_thread_max_abs_um: f64,
    agrees: bool,
    #[serde(skip)]
    figures: [Compared; 4],
}

impl Row {
    fn of(structure: &Structure, at: usize, seeds: &[Measured]) -> Row {
        let figures = core::array::from_fn(|figure| {
            let printed = structure.printed[at][figure];
            Compared::of(printed, seeds.iter().map(|seed| seed.errors_um[figure]).collect())
        });
        let [least, most, end, thread] = figures.map(|figure: Compared| figure.median);
        let [least_there, most_there, end_there, thread_there] =
            figures.map(|figure: Compared| figure.reference());
        Row {
            structure: structure.name,
            override_pct: OVERRIDES[at],
            approach_min_um: least,
            approach_max_um: most,
            end_um: end,
            thread_max_abs_um: thread,
            reference_approach_min_um: least_there,
            reference_approach_max_um: most_there,
            reference_end_um: end_there,
            reference_thread_max_abs_um: thread_there,
            agrees: figures.iter().all(Compared::agrees),
            figures,
        }
    }

    /// What does not agree, in words.
    fn apart(&self) -> String {
        let names = ["least", "largest", "end", "thread"];
        let apart = names.iter().zip(&self.figures).filter(|(_, figure)| !figure.agrees());
        apart
            .map(|(name, figure)| format!("{name} {:+.2}", figure.median - figure.reference()))
            .collect::<Vec<_>>()
            .join(", ")
    }
}

/// One pass to be run.
struct Case {
    structure: &'static Structure,
    switches: Switches,
    override_pct: f64,
    seed: u64,
}

impl Case {
    fn run(&self) -> Result<Measured, ExperimentError> {
        let machine = plant::machine(self.structure, self.switches)?;
        let cycles = if self.structure.held { 2 } else { 1 };
        measure(&machine, self.override_pct, cycles, self.seed)
    }
}

/// The structure that is used, with more and more of the reference.
struct Step {
    name: &'static str,
    switches: Switches,
    /// How far the slide is off in the reference 1.35 s into the thread, µm.
    printed_um: Option<f64>,
}

const STEPS: [Step; 4] = [
    Step {
        name: "observer at 2 kHz, no breakaway, no damping",
        switches: Switches { breakaway: false, damping: 0.0, observer_cycles: 1 },
        printed_um: None,
    },
    Step {
        name: "observer at 1 kHz",
        switches: Switches { breakaway: false, damping: 0.0, observer_cycles: 2 },
        printed_um: Some(CREEP_UM[2]),
    },
    Step {
        name: "and a screw that breaks away",
        switches: Switches { damping: 0.0, ..AS_PRINTED },
        printed_um: Some(CREEP_UM[1]),
    },
    Step { name: "and damping of the bristles", switches: AS_PRINTED, printed_um: Some(CREEP_UM[0]) },
];

/// A step and what eight seeds give.
struct Stepped {
    name: &'static str,
    printed_um: Option<f64>,
    errors: [Compared; 4],
    slide: Compared,
}

/// The structure on which the steps are taken: everything fed forward.
const FULL: &Structure = &STRUCTURES[7];

/// Runs every case.
///
/// # Errors
/// As [`Stand::run`].
pub(super) fn findings(stand: &Stand) -> Result<Findings<Row>, ExperimentError> {
    let rows = rows(stand)?;
    let steps = steps(stand)?;
    let tables = vec![
        Table::of("Servo error of X, printed and here", &COLUMNS, &rows).with_caption(text::rows()),
        Table::of("What makes the difference: all fed forward, 100 %", &STEP_COLUMNS, &steps)
            .with_caption(text::steps()),
        Table::of("What the seeds spread over", &SPREAD, &rows)
            .with_caption(text::spread())
            .at(Place::Details),
    ];
    Ok(Findings {
        title: "The reference simulation of the servo axis",
        short: text::short(&rows),
        done: text::done(),
        tables,
        notes: Vec::new(),
        figures: vec![figures::beside(&rows)],
        text: text::meaning(),
        rows,
    })
}

fn rows(stand: &Stand) -> Result<Vec<Row>, ExperimentError> {
    let places =
        || STRUCTURES.iter().flat_map(|structure| (0..OVERRIDES.len()).map(move |at| (structure, at)));
    let cases: Vec<Case> =
        places().flat_map(|(structure, at)| seeds(stand, structure, AS_PRINTED, OVERRIDES[at])).collect();
    let measured = stand.each(&cases, Case::run)?;
    let each = measured.chunks(SEEDS as usize);
    Ok(places().zip(each).map(|((structure, at), seeds)| Row::of(structure, at, seeds)).collect())
}

fn steps(stand: &Stand) -> Result<Vec<Stepped>, ExperimentError> {
    let cases: Vec<Case> =
        STEPS.iter().flat_map(|step| seeds(stand, FULL, step.switches, OVERRIDES[0])).collect();
    let measured = stand.each(&cases, Case::run)?;
    let stepped = |(step, seeds): (&Step, &[Measured])| Stepped {
        name: step.name,
        printed_um: step.printed_um,
        errors: core::array::from_fn(|figure| {
            Compared::of(FULL.printed[0][figure], seeds.iter().map(|seed| seed.errors_um[figure]).collect())
        }),
        slide: Compared::of("", seeds.iter().map(|seed| seed.slide_um).collect()),
    };
    Ok(STEPS.iter().zip(measured.chunks(SEEDS as usize)).map(stepped).collect())
}

/// A case for each seed.
fn seeds(
    stand: &Stand,
    structure: &'static Structure,
    switches: Switches,
    override_pct: f64,
) -> impl Iterator<Item = Case> {
    let first = stand.seed;
    (0..SEEDS).map(move |more| Case { structure, switches, override_pct, seed: first.wrapping_add(more) })
}

const COLUMNS: [Column<Row>; 9] = [
    Column { name: "structure", unit: "", cell: |row| row.structure.into() },
    Column { name: "override", unit: "%", cell: |row| format!("{:.0}", row.override_pct) },
    Column {
        name: "approach: printed",
        unit: "µm",
        cell: |row| format!("{} … {}", row.figures[0].printed, row.figures[1].printed),
    },
    Column {
        name: "here",
        unit: "µm",
        cell: |row| format!("{} … {}", um(row.approach_min_um), um(row.approach_max_um)),
    },
    Column { name: "end: printed", unit: "µm", cell: |row| row.figures[2].printed.into() },
    Column { name: "here", unit: "µm", cell: |row| um(row.end_um) },
    Column { name: "thread: printed", unit: "± µm", cell: |row| row.figures[3].printed.into() },
    Column { name: "here", unit: "± µm", cell: |row| um(row.thread_max_abs_um) },
    Column { name: "apart", unit: "µm", cell: |row| if row.agrees { "agrees".into() } else { row.apart() } },
];

const STEP_COLUMNS: [Column<Stepped>; 5] = [
    Column { name: "plant and observer", unit: "", cell: |step| step.name.into() },
    Column {
        name: "approach",
        unit: "µm",
        cell: |step| format!("{} … {}", um(step.errors[0].median), um(step.errors[1].median)),
    },
    Column { name: "end", unit: "µm", cell: |step| um(step.errors[2].median) },
    Column {
        name: "slide after 1.35 s: reference",
        unit: "µm",
        cell: |step| step.printed_um.map_or_else(|| "–".into(), um),
    },
    Column { name: "here", unit: "µm", cell: |step| um(step.slide.median) },
];

const SPREAD: [Column<Row>; 6] = [
    Column { name: "structure", unit: "", cell: |row| row.structure.into() },
    Column { name: "override", unit: "%", cell: |row| format!("{:.0}", row.override_pct) },
    Column { name: "least", unit: "µm", cell: |row| row.figures[0].spread() },
    Column { name: "largest", unit: "µm", cell: |row| row.figures[1].spread() },
    Column { name: "end", unit: "µm", cell: |row| row.figures[2].spread() },
    Column { name: "thread", unit: "± µm", cell: |row| row.figures[3].spread() },
];

impl Compared {
    fn spread(&self) -> String {
        format!("{} … {}", um(self.least), um(self.most))
    }
}

/// An error in two digits behind the point below 10 µm, one below 100 µm, else none.
fn um(um: f64) -> String {
    let digits = if um.abs() < 9.995 { 2 } else { usize::from(um.abs() < 99.95) };
    let text = format!("{um:.digits$}");
    // What rounds to nothing has no sign.
    if text.trim_start_matches(['-', '0', '.']).is_empty() { text.replace('-', "") } else { text }
}
