//! `pitchlock diff`: two runs are made again side by side, and the first message in which they differ is
//! named and drawn.

use std::{fmt::Debug, mem::offset_of, path::PathBuf, process::ExitCode};

use clap::Args;
use protocol::{Axis, Module, Truth};
use rig::{
    Exchange,
    replay::{fields, first_difference},
};
use serde_json::json;
use zerocopy::IntoBytes;

use super::{
    folder::{Again, Recorded},
    picture,
};
use crate::{
    error::CliError,
    screen,
    words::Phase,
    written::{self, Made},
};

pub(crate) const HELP_DIFF: &str = "Examples:
  pitchlock diff runs/m20x2-1 runs/m20x2-2
  pitchlock diff before after -o difference.html

Both runs are made again (`pitchlock replay`), and everything that goes between their modules is compared in every
control cycle: the truth of the plant first, then what the interpolator says, then the regulators. The page draws what
differs around its place.

Exit status: 0 nothing differs; 1 something does; 2 one of the runs cannot be made again.";

#[derive(Clone, Debug, Args)]
pub(crate) struct DiffArgs {
    /// A run folder.
    pub(crate) one: PathBuf,
    /// Another one.
    pub(crate) other: PathBuf,
    /// The page that shows the place.
    #[arg(short, long, value_name = "FILE", default_value = "diff.html")]
    pub(crate) output: PathBuf,
    /// Print one JSON document, and nothing else; no page is written then.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Where two runs differ.
pub(super) struct Place {
    pub(super) cycle: u64,
    pub(super) module: Option<Module>,
    pub(super) message: &'static str,
    pub(super) path: String,
    pub(super) values: [String; 2],
}

impl Place {
    /// The field with its module.
    pub(super) fn field(&self) -> String {
        format!("{}, {}: {}", self.module_name(), self.message, named(&self.path))
    }

    /// The unit of the field, as its name or its type says it; nothing for a number that has none.
    pub(super) fn unit(&self) -> &'static str {
        let is_field = |word: &&str| word.parse::<usize>().is_err();
        let name = self.path.split('.').rfind(is_field).unwrap_or_default();
        let units = UNITS.iter().filter(|(ending, _)| name.ends_with(ending));
        units.max_by_key(|(ending, _)| ending.len()).map_or("", |(_, unit)| unit)
    }

    /// The value of a run with its unit.
    pub(super) fn told(&self, run: usize) -> String {
        format!("{} {}", self.values[run], self.unit()).trim_end().to_owned()
    }

    fn module_name(&self) -> String {
        self.module.map_or_else(|| "sim-plant".into(), Module::name)
    }

    /// What stands in this field, if it is a number.
    pub(super) fn number(&self, exchange: &Exchange) -> Option<f64> {
        let parts = parts(exchange);
        let part = parts.iter().find(|part| part.module == self.module && part.message == self.message)?;
        let (_, value) = fields(part.told).into_iter().find(|(path, _)| *path == self.path)?;
        value.parse().ok()
    }
}

/// How names of fields end, and the units that they mean.
const UNITS: [(&str, &str); 18] = [
    ("_mm", "mm"),
    ("_mm2", "mm²"),
    ("_mm_s", "mm/s"),
    ("_mm_s2", "mm/s²"),
    ("_mm_s3", "mm/s³"),
    ("_mm_min", "mm/min"),
    ("_deg", "degrees"),
    ("_rpm", "1/min"),
    ("_pct", "%"),
    ("_s", "s"),
    ("_n", "N"),
    ("_nm", "N m"),
    ("_count", "counts"),
    ("_counts", "counts"),
    ("cycle", "control cycles"),
    ("not_before", "control cycles"),
    ("position", "nm (1e-9 degrees of a rotary axis)"),
    ("target", "nm (1e-9 degrees of a rotary axis)"),
];

/// A path with the letters of axes for their numbers.
fn named(path: &str) -> String {
    let mut words: Vec<&str> = path.split('.').collect();
    for at in 1..words.len() {
        if words[at - 1] == "axes"
            && let Some(axis) = words[at].parse().ok().and_then(|index: usize| Axis::ALL.get(index))
        {
            words[at] = axis.name();
        }
    }
    words.join(".")
}

/// One message of a control cycle.
struct Part<'a> {
    module: Option<Module>,
    message: &'static str,
    bytes: &'a [u8],
    told: &'a dyn Debug,
}

/// Everything of a control cycle, in the order of cause and effect.
fn parts<'a>(exchange: &'a Exchange) -> Vec<Part<'a>> {
    let Exchange { record, frames, drives, spindle } = exchange;
    // What a scenario has in mind shows in what follows.
    let truth = &record.truth.as_bytes()[..offset_of!(Truth, doomed)];
    let interpolator = Some(Module::Interpolator);
    let mut parts = vec![
        Part { module: None, message: "truth", bytes: truth, told: record.truth },
        Part {
            module: interpolator,
            message: "machine-status",
            bytes: record.machine.as_bytes(),
            told: record.machine,
        },
        Part { module: interpolator, message: "spindle-command", bytes: spindle.as_bytes(), told: spindle },
    ];
    for (axis, status) in record.axes {
        let module = Some(Module::Regulator(*axis));
        let (frame, drive) = (&frames[axis.index()], &drives[axis.index()]);
        let bytes = frame.as_ref().map_or(&[][..], |frame| frame.as_bytes());
        parts.push(Part { module, message: "axis-command", bytes, told: frame });
        parts.push(Part { module, message: "axis-status", bytes: status.as_bytes(), told: status });
        parts.push(Part { module, message: "drive-command", bytes: drive.as_bytes(), told: drive });
    }
    parts
}

/// The first difference of a control cycle.
fn in_cycle(one: &Exchange, other: &Exchange) -> Option<Place> {
    let (ones, others) = (parts(one), parts(other));
    let (one_part, other_part) = ones.iter().zip(&others).find(|(one, other)| one.bytes != other.bytes)?;
    let (path, values) = first_difference(one_part.told, other_part.told)
        .unwrap_or_else(|| ("bits of what is not a number".into(), Default::default()));
    let cycle = one.record.truth.cycle.0;
    Some(Place { cycle, module: one_part.module, message: one_part.message, path, values })
}

/// What a comparison came to.
enum Found {
    Nothing { cycles: u64 },
    Ends { cycle: u64, first: usize },
    Differs(Place),
}

/// Two machines side by side, until they differ.
fn compare(mut one: Again, mut other: Again) -> Result<Found, CliError> {
    let mut cycles = 0;
    loop {
        let (mut place, mut goes_on) = (None, Ok(false));
        let went_on = one.step(|one, _| {
            goes_on = other.step(|other, _| place = in_cycle(one, other));
        })?;
        match (place, went_on, went_on && goes_on?) {
            (Some(place), ..) => return Ok(Found::Differs(place)),
            (None, true, true) => cycles += 1,
            (None, true, false) => return Ok(Found::Ends { cycle: cycles, first: 1 }),
            (None, false, _) => {
                let more = other.step(|_, _| ())?;
                return Ok(if more {
                    Found::Ends { cycle: cycles, first: 0 }
                } else {
                    Found::Nothing { cycles }
                });
            }
        }
    }
}

/// Compares two runs.
pub(crate) fn diff(args: &DiffArgs, quiet: bool) -> Result<ExitCode, CliError> {
    if !args.json {
        written::free(&args.output, Made::Page)?;
    }
    let runs = [Recorded::open(&args.one)?, Recorded::open(&args.other)?];
    let axes = runs.each_ref().map(|run| run.machine.axes().map(|(axis, _)| axis).collect::<Vec<_>>());
    if axes[0] != axes[1] {
        return Err(CliError::Input(
            "the machines of the two runs have other axes: nothing to compare".into(),
        ));
    }
    let compared = Phase::begin("making both runs again");
    let [one, other] = [runs[0].machine_again()?, runs[1].machine_again()?];
    let found = compare(one, other)?;
    drop(compared);
    if args.json {
        screen::print(&format!("{:#}\n", document(&runs, &found)));
        return Ok(if matches!(found, Found::Nothing { .. }) {
            ExitCode::SUCCESS
        } else {
            ExitCode::FAILURE
        });
    }
    let place = match found {
        Found::Nothing { cycles } => {
            if !quiet {
                screen::print(&format!("the same: every message of {cycles} cycles\n"));
            }
            return Ok(ExitCode::SUCCESS);
        }
        Found::Ends { cycle, first } => {
            let [ends, goes_on] = [&runs[first].name, &runs[1 - first].name];
            screen::print(&format!("the same until {ends} ends in cycle {cycle}; {goes_on} goes on\n"));
            return Ok(ExitCode::FAILURE);
        }
        Found::Differs(place) => place,
    };
    let mut text = inputs(&runs);
    text += &format!(
        "first in cycle {} ({:.4} s), {}\n  {}: {}\n  {}: {}\n",
        place.cycle,
        place.cycle as f64 * runs[0].machine.general.cycle_s,
        place.field(),
        runs[0].name,
        place.told(0),
        runs[1].name,
        place.told(1),
    );
    let page = picture::page(&runs, &place)?;
    written::put(&args.output, page)?;
    text += &format!("drawn     {}\n", args.output.display());
    screen::print(&text);
    Ok(ExitCode::FAILURE)
}

/// What a comparison came to, for programs. `first` is null where nothing differs; where one run ends before
/// the other, its `module` and `field` are.
fn document(runs: &[Recorded; 2], found: &Found) -> serde_json::Value {
    let first = match found {
        Found::Nothing { .. } => serde_json::Value::Null,
        Found::Ends { cycle, first } => {
            json!({ "cycle": cycle, "module": null, "field": null, "ends": runs[*first].name })
        }
        Found::Differs(place) => json!({
            "cycle": place.cycle,
            "module": place.module_name(),
            "field": format!("{}: {}", place.message, named(&place.path)),
            "values": place.values,
        }),
    };
    json!({
        "version": 1,
        "equal": matches!(found, Found::Nothing { .. }),
        "first": first,
        "inputs_that_differ": changed_inputs(runs),
        "runs": runs.each_ref().map(|run| json!({
            "name": run.name,
            "cycles": run.summary.cycles,
            "trace_hash": run.summary.trace_hash,
            "outputs": run.summary.outputs,
            "analog_outputs": run.summary.analog_outputs,
            "inputs": run.summary.inputs,
        })),
    })
}

/// Names of what the runs were made of, where that differs.
fn changed_inputs(runs: &[Recorded; 2]) -> Vec<&'static str> {
    let [one, other] = runs;
    let differ = [
        ("program", one.program_bytes() != other.program_bytes()),
        ("machine file", one.texts[0] != other.texts[0]),
        ("scenario", one.texts[1] != other.texts[1]),
        ("seed", one.summary.seed != other.summary.seed),
    ];
    differ.iter().filter(|(_, differs)| *differs).map(|(name, _)| *name).collect()
}

/// What the runs were made of, where that differs.
fn inputs(runs: &[Recorded; 2]) -> String {
    match changed_inputs(runs).as_slice() {
        [] => "inputs    the same\n".into(),
        names => format!("inputs    that differ: {}\n", names.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_has_the_unit_that_its_name_says() {
        let unit = |path: &str| {
            let values = ["1".into(), "2".into()];
            let place = Place { cycle: 0, module: None, message: "truth", path: path.into(), values };
            (place.unit(), place.told(1))
        };
        for (path, is, told) in [
            ("axes.2.slide_mm", "mm", "2 mm"),
            ("axes.0.velocity_mm_s", "mm/s", "2 mm/s"),
            ("cut.area_mm2", "mm²", "2 mm²"),
            ("axes.1.torque_nm", "N m", "2 N m"),
            ("setpoint.position", UNITS[16].1, "2 nm (1e-9 degrees of a rotary axis)"),
            ("target.2", UNITS[17].1, "2 nm (1e-9 degrees of a rotary axis)"),
            ("measurement.panel.buttons", "", "2"),
            ("", "", "2"),
        ] {
            assert_eq!(unit(path), (is, told.to_owned()), "{path}");
        }
    }
}
