//! `pitchlock journal`: what the control knew last of a run, whatever became of it.

use std::{fmt::Write as _, path::PathBuf, process::ExitCode};

use clap::Args;
use protocol::{Axis, AxisState, Fault, Panel};
use rig::journal::{Act, MOST, State, has_other_version, latest};
use serde_json::{Map, Value, json};

use crate::{
    error::CliError,
    run::{JOURNAL, claim::is_held, folder::without_journal},
    screen,
};

pub(crate) const HELP: &str = "Examples:
  pitchlock journal runs/m20x2-1
  pitchlock journal runs/m20x2-1 --json

Reads journal.bin of a run folder, also of a run that lost its power, was killed or still goes on. What is damaged in it
is passed over.";

#[derive(Clone, Debug, Args)]
pub(crate) struct JournalArgs {
    /// A run folder.
    pub(crate) run_dir: PathBuf,
    /// Print one JSON document, and nothing else.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Prints what is known of a run.
pub(crate) fn journal(args: &JournalArgs) -> Result<ExitCode, CliError> {
    let path = args.run_dir.join(JOURNAL);
    let bytes = intake::bytes(&path, MOST).map_err(|error| without_journal(&args.run_dir, &error))?;
    let Some((record, state)) = latest::<State>(&bytes) else {
        if has_other_version::<State>(&bytes) {
            return Err(CliError::file(
                &path,
                "was written by another version of pitchlock: read it by that one",
            ));
        }
        let goes_on = match is_held(&args.run_dir) {
            true => "this run is about to begin, and nothing is known of it yet".into(),
            false => format!(
                "holds no whole record: nothing is known of this run\nhelp: `pitchlock run {} --resume` goes by where the axes stand",
                args.run_dir.display()
            ),
        };
        return Err(CliError::file(&path, goes_on));
    };
    if args.json {
        screen::print(&format!("{:#}\n", as_json(record, &state)));
    } else {
        screen::print(&told(record, &state, is_held(&args.run_dir)));
    }
    Ok(ExitCode::SUCCESS)
}

/// How the run ended, as far as the control knew.
fn end(state: &State) -> &'static str {
    match Fault::from_code(state.fault) {
        _ if state.is_complete() => "completed",
        Some(fault) => fault.code(),
        None if state.stopped != 0 => "stopped",
        None => "open",
    }
}

/// The axes that have said something, with their states.
fn axes(state: &State) -> impl Iterator<Item = (Axis, f64, AxisState)> {
    let of = |axis: Axis| {
        let code = AxisState::from_code(state.axes[axis.index()].into()).unwrap_or_default();
        (axis, state.measured[axis.index()].mm(), code)
    };
    Axis::ALL.into_iter().map(of).filter(|(_, mm, code)| *mm != 0.0 || *code != AxisState::Idle)
}

/// The axes of which nobody knew where they were.
fn unreferenced(state: &State) -> impl Iterator<Item = Axis> {
    Axis::ALL.into_iter().filter(|axis| state.unreferenced >> axis.index() & 1 == 1)
}

/// An action in words.
fn did(act: u32, value: f64) -> String {
    let turned = |knob: &str| format!("turned the {knob} override to {value} %");
    match act {
        act if act == Act::SpindleOverride as u32 => turned("spindle"),
        act if act == Act::FeedOverride as u32 => turned("feed"),
        act if act == Act::RapidOverride as u32 => turned("rapid"),
        act if act == Act::Buttons as u32 => format!("buttons: {}", buttons(value as u32)),
        _ => format!("pressed cycle start, {value} times so far"),
    }
}

/// Which buttons are pressed.
fn buttons(bits: u32) -> String {
    const NAMES: [(u32, &str); 6] = [
        (Panel::FEED_HOLD, "feed hold"),
        (Panel::STOP, "stop"),
        (Panel::SINGLE_BLOCK, "single block"),
        (Panel::ABORT, "abort"),
        (Panel::EMERGENCY_STOP, "emergency stop"),
        (Panel::POWER_LOST, "power lost"),
    ];
    let pressed: Vec<_> = NAMES.iter().filter(|(bit, _)| bits & bit != 0).map(|(_, name)| *name).collect();
    if pressed.is_empty() { "all released".into() } else { pressed.join(", ") }
}

/// The numbers of the bits that are set.
fn on(bits: u64) -> Vec<u32> {
    (0..u64::BITS).filter(|number| bits >> number & 1 == 1).collect()
}

/// What a record knows, in words, of a run that goes on or does not.
pub(crate) fn told(record: u64, state: &State, goes_on: bool) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "known     up to control cycle {} (record {record})", state.cycle);
    let ended = match end(state) {
        "completed" => "the program came to its end".into(),
        "stopped" => "the operator ended the program".into(),
        "open" if goes_on => "none yet: the run goes on".into(),
        "open" => "not known: the run was broken off".into(),
        fault => format!("fault {fault}"),
    };
    let _ = writeln!(text, "end       {ended}");
    let _ = writeln!(
        text,
        "program   line {}, {} steps of machine code are done, {} moves",
        state.line, state.step, state.moves
    );
    let _ = match state.open {
        0 => writeln!(text, "passes    {} cut to their end, none is open", state.passes),
        open => writeln!(
            text,
            "passes    {} cut to their end; pass {open} was begun and is not, last seen at {:.1}° from its index",
            state.passes, state.angle_deg
        ),
    };
    let [x_mm, z_mm] = state.origin_mm;
    let _ = writeln!(text, "zero      of the program at X {x_mm:.4} Z {z_mm:.4} mm of the machine");
    let _ = writeln!(text, "tool      {}, coolant {}", state.tool, state.coolant);
    let signals = [("outputs", state.outputs), ("inputs", state.inputs)];
    for (what, bits) in signals.into_iter().filter(|(_, bits)| *bits != 0) {
        let numbers: Vec<String> = on(bits).iter().map(u32::to_string).collect();
        let _ = writeln!(text, "{what:<9} on: {}", numbers.join(", "));
    }
    if state.analog.iter().any(|value| *value != 0.0) {
        let values: Vec<String> =
            (0..).zip(state.analog).map(|(number, value)| format!("{number} at {value}")).collect();
        let _ = writeln!(text, "analog    {}", values.join(", "));
    }
    let _ = match state.index_number {
        0 => writeln!(text, "spindle   {:.1} 1/min commanded; no index has been seen", state.spindle_rpm),
        number => writeln!(
            text,
            "spindle   {:.1} 1/min commanded; index {number} at count {}, encoder at {}",
            state.spindle_rpm, state.index_count, state.spindle_count
        ),
    };
    for (axis, mm, code) in axes(state) {
        let _ = writeln!(text, "{:<9} {mm:.4} measured, {}", axis.name(), code.name());
    }
    let lost: Vec<_> = unreferenced(state).map(|axis| axis.name().to_ascii_uppercase()).collect();
    if !lost.is_empty() {
        let _ = writeln!(text, "reference not known of {}: its run has not been made", lost.join(", "));
    }
    let [spindle, feed, rapid] = state.overrides_pct;
    let _ = writeln!(text, "overrides spindle {spindle} %, feed {feed} %, rapid {rapid} %");
    let acted = state.actions.iter().filter(|action| action.act != 0);
    for action in acted {
        let _ = writeln!(text, "operator  cycle {}: {}", action.cycle, did(action.act, action.value));
    }
    text
}

/// The same as a document.
pub(crate) fn as_json(record: u64, state: &State) -> Value {
    let measured: Map<String, Value> = axes(state)
        .map(|(axis, mm, code)| (axis.name().into(), json!({ "measured": mm, "state": code.name() })))
        .collect();
    let actions: Vec<Value> = state
        .actions
        .iter()
        .filter(|action| action.act != 0)
        .map(|action| json!({ "cycle": action.cycle, "what": did(action.act, action.value) }))
        .collect();
    let input: String = state.input.iter().map(|byte| format!("{byte:02x}")).collect();
    json!({
        "version": 1,
        "record": record,
        "cycle": state.cycle,
        "end": end(state),
        "input": input,
        "seed": state.seed,
        "line": state.line,
        "steps": state.step,
        "moves": state.moves,
        "passes": state.passes,
        "pass": state.pass,
        "open_pass": (state.open != 0).then_some(state.open),
        "angle_deg": state.angle_deg,
        "origin_mm": state.origin_mm,
        "tool": state.tool,
        "coolant": state.coolant,
        "outputs": on(state.outputs),
        "analog_outputs": state.analog,
        "inputs": on(state.inputs),
        "spindle": {
            "commanded_rpm": state.spindle_rpm,
            "count": state.spindle_count,
            "index_count": state.index_count,
            "indexes": state.index_number,
        },
        "axes": measured,
        "unreferenced": unreferenced(state).collect::<Vec<_>>(),
        "overrides_pct": state.overrides_pct,
        "buttons": buttons(state.buttons),
        "cycle_starts": state.cycle_starts,
        "acted": state.acted,
        "actions": actions,
    })
}
