//! What was asked for. In: arguments. Out: limits and tolerances, or what is wrong with them and what would
//! be right.

use std::path::PathBuf;

use adviser::{
    resolution::{Demand, Steps},
    tolerance::{Grade, ToleranceError},
};
use machine::{Kinematics, Machine};
use protocol::Axis;

use super::{Asked, Parts, ResolutionArgs, Source, needs::AxisNeeds, needs::turned};
use crate::error::CliError;

const GRADE: &str = "IT7";
const SIZE_MM: f64 = 50.0;
const LEAD_MM: f64 = 5.0;
/// Counts of the published control.
const PER_MM: f64 = 1000.0;

/// What the arguments mean.
pub(super) fn asked(args: &ResolutionArgs) -> Result<Asked, CliError> {
    ranges(args)?;
    let mut parts = parts(args)?;
    let steps = Steps { tolerance: args.k_m, feed: args.k_f, acceleration: args.k_a, jerk: args.k_j };
    let (source, axes) = match given(args, parts.um)? {
        Some(demand) => {
            let per_mm = args.counts.unwrap_or(PER_MM);
            (Source::Given, vec![AxisNeeds::given(demand, per_mm, &steps)])
        }
        None => {
            let (machine, _) = args.machine.read()?;
            parts.radius_mm = radius(args, &machine, &parts)?;
            let axes = axes(&machine, &parts, &steps);
            let lead_mm = lead(args, &machine)?;
            (Source::Machine { machine: Box::new(machine), lead_mm }, axes)
        }
    };
    Ok(Asked { source, parts, steps, axes })
}

fn wrong(text: impl Into<String>) -> CliError {
    CliError::Input(text.into())
}

/// Every number lies where it can be computed with.
fn ranges(args: &ResolutionArgs) -> Result<(), CliError> {
    for (name, value, low, high) in [
        ("--tolerance", args.tolerance, 1e-3, 1e5),
        ("--radius", args.radius, 1e-3, 1e5),
        ("--lead", args.lead, 1e-3, 1e3),
        ("--feed", args.feed, 1e-3, 1e7),
        ("--acceleration", args.acceleration, 1e-6, 1e5),
        ("--jerk", args.jerk, 1e-6, 1e9),
        ("--cycle", args.cycle, 1.0, 1e6),
        ("--counts", args.counts, 1e-3, 1e15),
        ("--k-m", Some(args.k_m), 1.0, 1e9),
        ("--k-f", Some(args.k_f), 1.0, 1e9),
        ("--k-a", Some(args.k_a), 1.0, 1e9),
        ("--k-j", Some(args.k_j), 1.0, 1e9),
    ] {
        if let Some(value) = value.filter(|value| !(low..=high).contains(value)) {
            // A very long number is as well read with its power of ten.
            let plain = (1e-6..1e15).contains(&value.abs()) || value == 0.0 || !value.is_finite();
            let value = if plain { value.to_string() } else { format!("{value:e}") };
            return Err(wrong(format!("{name} {value}: must lie between {low} and {high}")));
        }
    }
    Ok(())
}

/// The tolerance: as it is, or of a grade and size.
fn parts(args: &ResolutionArgs) -> Result<Parts, CliError> {
    if let Some(um) = args.tolerance {
        let taken = [("--grade", args.grade.is_some()), ("--size", args.size.is_some())];
        if let Some((name, _)) = taken.iter().find(|(_, is_given)| *is_given) {
            let text = format!("--tolerance {um} says it already: leave out {name}, or --tolerance");
            return Err(wrong(text));
        }
        return Ok(Parts { um, grade: None, radius_mm: None });
    }
    let (name, size) = (args.grade.as_deref().unwrap_or(GRADE), args.size.unwrap_or(SIZE_MM));
    let refused = |error: ToleranceError| {
        let flag = if matches!(error, ToleranceError::Size(_)) {
            format!("--size {size}")
        } else {
            format!("--grade {name}")
        };
        wrong(format!("{flag}: {error}, or give the tolerance in µm with --tolerance"))
    };
    let grade: Grade = name.parse().map_err(refused)?;
    let um = grade.tolerance_um(size).map_err(refused)?;
    Ok(Parts { um, grade: Some((grade, size)), radius_mm: None })
}

/// The motion that was given, if one was: whole, and not beside a machine file.
fn given(args: &ResolutionArgs, tolerance_um: f64) -> Result<Option<Demand>, CliError> {
    let needed = [
        ("--feed", args.feed),
        ("--acceleration", args.acceleration),
        ("--jerk", args.jerk),
        ("--cycle", args.cycle),
    ];
    let mut all = needed.into_iter().chain([("--counts", args.counts)]);
    let Some((first, _)) = all.find(|(_, value)| value.is_some()) else { return Ok(None) };
    if let Some(path) = &args.machine.machine {
        let path = path.display();
        return Err(wrong(format!(
            "--machine {path} has limits, cycle and encoders of its own: leave out {first}, or --machine"
        )));
    }
    let [Some(feed_mm_min), Some(acceleration_m_s2), Some(jerk_m_s3), Some(cycle_hz)] =
        needed.map(|(_, value)| value)
    else {
        let missing: Vec<_> =
            needed.iter().filter(|(_, value)| value.is_none()).map(|(name, _)| *name).collect();
        return Err(wrong(format!(
            "{first} is given without {}: give --feed, --acceleration, --jerk and --cycle, or none of them and a \
             machine file",
            missing.join(", ")
        )));
    };
    for (name, value) in [("--radius", args.radius), ("--lead", args.lead)] {
        if value.is_some() {
            let text = format!("{name} is for the axes and threads of a machine file: leave it out");
            return Err(wrong(text));
        }
    }
    Ok(Some(Demand { tolerance_um, feed_mm_min, acceleration_m_s2, jerk_m_s3, cycle_hz }))
}

/// Where rotary axes hold the tolerance.
fn radius(args: &ResolutionArgs, machine: &Machine, parts: &Parts) -> Result<Option<f64>, CliError> {
    let turns: Vec<_> = machine.axes().map(|(axis, _)| axis).filter(|axis| axis.is_rotary()).collect();
    let half = parts.grade.map(|(_, size_mm)| size_mm / 2.0);
    match (turns.first(), args.radius.or(half)) {
        (None, _) if args.radius.is_some() => {
            Err(wrong(format!("{} has no rotary axis: leave out --radius", args.machine.name())))
        }
        (None, _) => Ok(None),
        (Some(axis), None) => Err(wrong(format!(
            "{axis} turns: --radius says at how many mm from its centre the tolerance holds"
        ))),
        (Some(_), radius_mm) => Ok(radius_mm),
    }
}

fn lead(args: &ResolutionArgs, machine: &Machine) -> Result<f64, CliError> {
    if args.lead.is_some() && machine.general.kinematics != Kinematics::Lathe {
        return Err(wrong(format!("{} cuts no threads: leave out --lead", args.machine.name())));
    }
    Ok(args.lead.unwrap_or(LEAD_MM))
}

/// Whether what an axis makes is measured as a diameter: X of a lathe, which moves by half of it.
pub(super) fn is_diameter(machine: &Machine, axis: Axis) -> bool {
    machine.general.kinematics == Kinematics::Lathe && axis == Axis::X
}

/// Every axis of a machine.
fn axes(machine: &Machine, parts: &Parts, steps: &Steps) -> Vec<AxisNeeds> {
    let tolerance = |axis: Axis| match parts.radius_mm.filter(|_| axis.is_rotary()) {
        Some(radius_mm) => turned(parts.um, radius_mm),
        None if is_diameter(machine, axis) => parts.um / 2.0,
        None => parts.um,
    };
    let needs = |(axis, config)| AxisNeeds::of(axis, config, tolerance(axis), machine.general.cycle_s, steps);
    machine.axes().map(needs).collect()
}

/// The command that says the same again.
pub(super) fn again(args: &ResolutionArgs) -> String {
    let machine =
        args.machine.machine.as_ref().map(|path: &PathBuf| format!(" --machine {}", path.display()));
    let grade = args.grade.as_ref().map(|name| format!(" --grade {name}"));
    let numbers = [
        ("--size", args.size),
        ("--tolerance", args.tolerance),
        ("--radius", args.radius),
        ("--lead", args.lead),
        ("--feed", args.feed),
        ("--acceleration", args.acceleration),
        ("--jerk", args.jerk),
        ("--cycle", args.cycle),
        ("--counts", args.counts),
        ("--k-m", Some(args.k_m)),
        ("--k-f", Some(args.k_f)),
        ("--k-a", Some(args.k_a)),
        ("--k-j", Some(args.k_j)),
    ];
    let numbers = numbers.into_iter().filter_map(|(name, value)| Some(format!(" {name} {}", value?)));
    let words: String = machine.into_iter().chain(grade).chain(numbers).collect();
    format!("pitchlock resolution{words}")
}
