//! What is shown of a control cycle. In: a [`Record`] and what the observer knows. Out: fields of the panel.

use std::path::Path;

use ::panel::{AxisSeen, Fault, Knobs, Message, PassSeen, Seen, SpindleSeen};
use machine::{AxisConfig, Machine};
use protocol::{Axis, MachineState, MachineStatus, Motion, Panel};
use rig::observe::{FaultReport, MessageReport, Observer, PassEnd, PassReport, Record, Summary};

use serde_json::{Map, Value, json};

use super::{
    known::Known,
    live::fields,
    mode::Mode,
    said::{is_in_pass, words},
};

/// Passes that are shown: the newest.
const MOST_PASSES: usize = 200;
/// Messages and faults that are shown: the newest.
const MOST_TOLD: usize = 50;
/// Kinds of places: in a pass, and in a pass when the index went by.
pub(super) const IN_PASS: u8 = 2;
pub(super) const AT_THE_INDEX: u8 = 3;
/// A message so many lines before a pause belongs to it.
const PROMPT_LINES: u32 = 4;

/// What stands behind a run, whatever of it was shown: `last` is what was. Of an axis with a reference run
/// nobody knows where it stands as soon as the machine is off.
pub(super) fn ended(
    last: Map<String, Value>,
    summary: &Summary,
    machine: &Machine,
    folder: &Path,
) -> Map<String, Value> {
    let mut shown = last;
    for axis in shown.get_mut("axes").and_then(Value::as_array_mut).into_iter().flatten() {
        let of = |(own, config): (Axis, &AxisConfig)| {
            config.reference.is_some()
                && axis["name"].as_str().is_some_and(|name| own.name().eq_ignore_ascii_case(name))
        };
        if machine.axes().any(of) {
            axis["referenced"] = json!(false);
        }
    }
    shown.extend(fields(&json!({
        "passes": passes(&summary.passes),
        "messages": messages(&summary.messages),
        "faults": faults(&summary.faults),
        "outcome": summary.outcome, "part": part(summary, folder),
        "mode": Mode::Off.name(), "by_hand": null, "from": null,
        // Each run begins with these.
        "knobs": Knobs {
            spindle_pct: 100.0,
            spindle_in_force_pct: 100.0,
            feed_pct: 100.0,
            feed_in_force_pct: 100.0,
            rapid_pct: 100.0,
        },
        "held": false, "single_block": false, "optional_stop": true,
        "state": "ended", "words": "the run is over",
    })));
    shown
}

/// Whether the part is good, in the last words of the run, and where its report will be.
pub(super) fn part(summary: &Summary, folder: &Path) -> Value {
    let groove = summary.groove.iter().map(|groove| groove.sentence());
    let gauges = summary.gauged().iter().map(|gauge| gauge.sentence());
    // What a gauge says against it is said once.
    let by_gauge = |told: &str| {
        let reason = told.trim_start_matches("not good: ");
        let of = |name: &str| reason.strip_prefix(name).is_some_and(|rest| rest.starts_with(": "));
        summary.gauged().iter().any(|gauge| of(&gauge.name))
    };
    let reasons = summary.part.told().filter(|told| !by_gauge(told));
    let report = folder.join("report.html").display().to_string();
    let words: Vec<_> = groove.chain(gauges).chain(reasons).collect();
    json!({ "verdict": summary.part.verdict, "words": words, "report": report })
}

/// What is seen in this cycle; lists only if there is something in them that `shown` has not.
pub(super) fn seen(record: &Record, observer: &Observer, shown: Option<Counts>, known: &mut Known) -> Seen {
    let Record { truth, axes, machine } = record;
    let (done, time_s) = (machine.taken.min(known.steps), truth.cycle.0 as f64 * known.cycle_s);
    let target = known.plan.target_mm(done, machine.line).filter(|_| goes(machine));
    let panel = &truth.measurement.panel;
    let tool_name = known.tool_names.get(&machine.tool).cloned().unwrap_or_default();
    let (state, words) = words(record, &tool_name, &known.homing);
    let left_s = match known.homing.goes() {
        true => {
            known.plan.waits(done, time_s);
            None
        }
        false => known.plan.left_s(done, time_s).filter(|_| !known.homing.is_by_hand()),
    };
    let lists = shown != Some(Counts::of(observer));
    let axis = |(axis, status): &(Axis, protocol::AxisStatus)| AxisSeen {
        name: axis.name().to_ascii_uppercase(),
        referenced: !machine.is_unreferenced(*axis),
        commanded_mm: status.commanded_mm,
        measured_mm: status.commanded_mm - status.servo_error_mm,
        to_go_mm: known.homing.to_go_mm(*axis, status.commanded_mm, target.as_ref()),
        error_um: 1e3 * status.servo_error_mm,
        speed_mm_s: status.velocity_mm_s,
        torque_nm: truth.measurement.axes[axis.index()].torque_nm,
        load_pct: load_pct(
            truth.measurement.axes[axis.index()].torque_nm,
            known.torque_limit_nm[axis.index()],
        ),
        state: status.state().name().into(),
    };
    Seen {
        cycle: truth.cycle.0,
        time_s,
        state: state.into(),
        words,
        line: machine.line,
        pass: machine.pass,
        depth_mm: known.depth_mm(machine),
        done: (!known.homing.is_by_hand()).then_some([done, known.steps]),
        left_s,
        axes: axes.iter().map(axis).collect(),
        spindle: SpindleSeen {
            rpm: truth.spindle_rpm,
            commanded_rpm: machine.spindle_rpm,
            angle_deg: truth.spindle_deg.rem_euclid(360.0),
            torque_nm: truth.spindle_torque_nm,
            load_pct: load_pct(truth.spindle_torque_nm, known.spindle_limit_nm(truth.spindle_rpm)),
        },
        knobs: Knobs {
            spindle_pct: panel.spindle_override_pct,
            spindle_in_force_pct: machine.spindle_override_pct,
            feed_pct: panel.feed_override_pct,
            feed_in_force_pct: machine.feed_override_pct,
            rapid_pct: panel.rapid_override_pct,
        },
        held: panel.pressed(Panel::FEED_HOLD),
        single_block: panel.pressed(Panel::SINGLE_BLOCK),
        optional_stop: !panel.pressed(Panel::PASSES_M1),
        tool: machine.tool,
        tool_name,
        origin_mm: known.origin_mm(machine),
        moved_mm: known.moved_mm(machine),
        prompt: prompt(machine, observer, known),
        cutting: observer.pass_so_far().map(|pass| PassSeen { end: "now".into(), ..pass_seen(&pass) }),
        coolant: coolant(machine).into(),
        passes: lists.then(|| passes(observer.passes())),
        messages: lists.then(|| messages(observer.told())),
        faults: lists.then(|| faults(observer.faults())),
    }
}

/// Torque as a share of what there is, per cent; 0 where nobody says what there is.
fn load_pct(torque_nm: f64, limit_nm: f64) -> f64 {
    if limit_nm > 0.0 { 100.0 * torque_nm.abs() / limit_nm } else { 0.0 }
}

/// Whether a block of motion may be in hand.
fn goes(machine: &MachineStatus) -> bool {
    !matches!(machine.state(), MachineState::Starting | MachineState::Ended | MachineState::Fault)
}

/// What the program said right before the pause that it waits at.
fn prompt(machine: &MachineStatus, observer: &Observer, known: &Known) -> Option<String> {
    let told = observer.told().last().filter(|_| machine.state().waits_for_start())?;
    if told.cycle < known.went_on {
        return None;
    }
    (told.line..=told.line.saturating_add(PROMPT_LINES)).contains(&machine.line).then(|| told.text.clone())
}

/// How long the lists are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Counts([usize; 3]);

impl Counts {
    pub(super) fn of(observer: &Observer) -> Counts {
        Counts([observer.passes().len(), observer.told().len(), observer.faults().len()])
    }
}

fn coolant(machine: &MachineStatus) -> &'static str {
    match (machine.coolant & MachineStatus::MIST != 0, machine.coolant & MachineStatus::FLOOD != 0) {
        (false, false) => "",
        (true, false) => "mist",
        (false, true) => "flood",
        (true, true) => "mist and flood",
    }
}

/// The last `most` of something.
fn newest<T>(all: &[T], most: usize) -> &[T] {
    &all[all.len().saturating_sub(most)..]
}

fn passes(passes: &[PassReport]) -> Vec<PassSeen> {
    newest(passes, MOST_PASSES).iter().map(pass_seen).collect()
}

fn pass_seen(pass: &PassReport) -> PassSeen {
    PassSeen {
        pass: pass.pass,
        line: pass.line,
        depth_mm: pass.depth_mm,
        end: match pass.end {
            PassEnd::Complete => "complete",
            PassEnd::Left => "left",
            PassEnd::CutOff => "cut-off",
        }
        .into(),
        rpm: [pass.rpm_min, pass.rpm_max],
        helix_um: pass.tool.helix_max_abs_um,
        phase_um: pass.tool.phase_um,
        cut: pass.tool.contact_deg > 0.0,
    }
}

fn messages(told: &[MessageReport]) -> Vec<Message> {
    let told = newest(told, MOST_TOLD).iter();
    told.map(|one| Message { line: one.line, cycle: one.cycle, text: one.text.clone() }).collect()
}

fn faults(faults: &[FaultReport]) -> Vec<Fault> {
    let remedy = |code: &str| {
        let row = protocol::fault::FAULTS.iter().find(|row| row.code == code);
        row.map(|row| row.remedy).unwrap_or_default().to_owned()
    };
    let told = newest(faults, MOST_TOLD).iter();
    told.map(|one| Fault {
        cycle: one.cycle,
        source: one.source.clone(),
        code: one.code.clone(),
        text: one.text.clone(),
        remedy: remedy(&one.code),
    })
    .collect()
}

/// How the tool goes in this cycle, as in a place of its trail.
pub(super) fn kind(record: &Record) -> u8 {
    match (is_in_pass(record), record.machine.motion()) {
        (true, _) => IN_PASS,
        (false, Motion::Feed) => 1,
        (false, _) => 0,
    }
}
