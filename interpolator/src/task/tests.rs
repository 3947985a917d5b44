//! Every state and every event: what follows is written down here once more, by name, as a table. What the
//! table does not name must change nothing.

use protocol::{Axis, AxisCommand};

use super::*;

fn arm() -> InHand {
    InHand { pass: ThreadPass { pass: 7, s_rpm: 600.0, ..ThreadPass::default() }, not_before: Cycle(40) }
}

/// A state of each kind, by name.
fn states() -> Vec<(&'static str, Task)> {
    let waits = Wait::CycleStart(3);
    vec![
        ("enabling", Task::Enabling),
        ("starting", Task::Starting),
        ("ready", Task::Ready { wait: Wait::No }),
        ("ready waiting", Task::Ready { wait: waits }),
        ("moving", Task::Moving { wait: Wait::No, fault: None }),
        ("moving waiting", Task::Moving { wait: waits, fault: None }),
        ("braking", Task::Moving { wait: Wait::No, fault: Some(Fault::TravelLimit) }),
        ("dwelling", Task::Dwelling { left: 5 }),
        ("paused", Task::Paused { cycle_starts: 3 }),
        ("arming", Task::Arming { pass: arm(), sent: Cycle(20) }),
        ("armed", Task::Armed(arm())),
        ("calling off", Task::CallingOff { pass: arm(), sent: Cycle(48) }),
        ("cutting", Task::Cutting(arm())),
        ("ending", Task::Ending { stopped: false }),
        ("ending stopped", Task::Ending { stopped: true }),
        ("ended", Task::Ended { stopped: false }),
        ("ended stopped", Task::Ended { stopped: true }),
        ("fault, hold", Task::Fault { fault: Fault::BadMachineCode, order: Order::Hold }),
        ("fault, call off", Task::Fault { fault: Fault::IndexNotSeen, order: Order::CallOff }),
        ("fault, stop", Task::Fault { fault: Fault::AxisFault, order: Order::Stop }),
    ]
}

fn events() -> Vec<(&'static str, Event)> {
    let moved = Moved::default();
    let stands = Moved { stands: true, ..moved };
    vec![
        ("nothing", Event::Nothing),
        ("axis fault", Event::Fault(Fault::AxisFault)),
        ("other fault", Event::Fault(Fault::BadMachineCode)),
        ("enabled", Event::Enabled),
        ("streaming", Event::Streaming),
        ("waits", Event::Waits(Wait::No)),
        ("waits for cycle start", Event::Waits(Wait::CycleStart(3))),
        ("dwells", Event::Dwells(5)),
        ("pauses", Event::Pauses(3)),
        ("over", Event::Over),
        ("moved", Event::Moved(moved)),
        ("moved, block done", Event::Moved(Moved { wait: Wait::CycleStart(3), ..moved })),
        ("moved, no further", Event::Moved(Moved { fault: Some(Fault::TravelLimit), ..moved })),
        ("moved, operator ends", Event::Moved(Moved { ends: true, ..moved })),
        ("stands", Event::Moved(stands)),
        ("stands, block done", Event::Moved(Moved { wait: Wait::CycleStart(3), ..stands })),
        ("stands, no further", Event::Moved(Moved { fault: Some(Fault::TravelLimit), ..stands })),
        ("stands, operator ends", Event::Moved(Moved { ends: true, ..stands })),
        ("pass", Event::Pass(arm(), Cycle(20))),
        ("armed", Event::Armed),
        ("taken back", Event::TakenBack(Cycle(48))),
        ("begun", Event::Begun),
        ("called off", Event::CalledOff),
        ("cut", Event::Cut),
        ("ends", Event::Ends(false)),
        ("operator ends", Event::Ends(true)),
        ("spindle stands", Event::Stands),
    ]
}

/// From, event, to. "ready" and "moving" stand for each of their kinds.
const TABLE: &[(&str, &str, &str)] = &[
    ("enabling", "enabled", "starting"),
    ("starting", "streaming", "ready"),
    ("ready", "waits", "ready"),
    ("ready", "waits for cycle start", "ready waiting"),
    ("ready", "dwells", "dwelling"),
    ("ready", "pauses", "paused"),
    ("ready", "pass", "arming"),
    ("ready", "ends", "ending"),
    ("ready", "operator ends", "ending stopped"),
    ("ready", "moved", "moving"),
    ("ready", "moved, block done", "moving waiting"),
    ("ready", "moved, no further", "braking"),
    ("ready", "moved, operator ends", "moving"),
    ("ready", "stands", "ready"),
    ("ready", "stands, block done", "ready waiting"),
    ("ready", "stands, no further", "fault, hold"),
    ("ready", "stands, operator ends", "ending stopped"),
    ("moving", "moved", "moving"),
    ("moving", "moved, block done", "moving waiting"),
    ("moving", "moved, no further", "braking"),
    ("moving", "moved, operator ends", "moving"),
    ("moving", "stands", "ready"),
    ("moving", "stands, block done", "ready waiting"),
    ("moving", "stands, no further", "fault, hold"),
    ("moving", "stands, operator ends", "ending stopped"),
    ("moving", "other fault", "braking"),
    ("braking", "stands", "fault, hold"),
    ("braking", "stands, block done", "fault, hold"),
    ("braking", "stands, no further", "fault, hold"),
    ("braking", "stands, operator ends", "fault, hold"),
    ("braking", "moved, block done", "braking"),
    ("braking", "other fault", "braking"),
    ("dwelling", "nothing", "dwelling"),
    ("dwelling", "over", "ready"),
    ("paused", "over", "ready"),
    ("arming", "armed", "armed"),
    ("armed", "taken back", "calling off"),
    ("armed", "begun", "cutting"),
    ("armed", "cut", "ready"),
    ("calling off", "begun", "cutting"),
    ("calling off", "called off", "ready"),
    ("calling off", "cut", "ready"),
    ("cutting", "cut", "ready"),
    ("ending", "spindle stands", "ended"),
    ("ending stopped", "spindle stands", "ended stopped"),
];

/// What kind of state it is, by name.
fn name(task: &Task) -> &'static str {
    match task {
        Task::Enabling => "enabling",
        Task::Starting => "starting",
        Task::Ready { wait: Wait::No } => "ready",
        Task::Ready { .. } => "ready waiting",
        Task::Moving { fault: Some(_), .. } => "braking",
        Task::Moving { wait: Wait::No, .. } => "moving",
        Task::Moving { .. } => "moving waiting",
        Task::Dwelling { .. } => "dwelling",
        Task::Paused { .. } => "paused",
        Task::Arming { .. } => "arming",
        Task::Armed(_) => "armed",
        Task::CallingOff { .. } => "calling off",
        Task::Cutting(_) => "cutting",
        Task::Ending { stopped: false } => "ending",
        Task::Ending { stopped: true } => "ending stopped",
        Task::Ended { stopped: false } => "ended",
        Task::Ended { stopped: true } => "ended stopped",
        Task::Fault { order: Order::CallOff, .. } => "fault, call off",
        Task::Fault { order: Order::Stop, .. } => "fault, stop",
        Task::Fault { .. } => "fault, hold",
    }
}

/// The state after an event, and what the axes are told.
fn stepped(mut task: Task, event: Event) -> (Task, Order) {
    let order = task.step(&event);
    (task, order)
}

fn kind(state: &'static str) -> &'static str {
    state.strip_suffix(" waiting").unwrap_or(state)
}

/// The state a fault leads to, where no row says otherwise.
fn faulted(state: &'static str, event: &str) -> Option<&'static str> {
    let after = match (state, event) {
        (over, _) if over.starts_with("ended") || over.starts_with("fault") => return None,
        ("arming" | "armed" | "calling off", "axis fault" | "other fault") => "fault, call off",
        ("cutting", "axis fault" | "other fault") => "fault, hold",
        (_, "axis fault") => "fault, stop",
        (_, "other fault") => "fault, hold",
        _ => return None,
    };
    Some(after)
}

#[test]
fn every_state_after_every_event() {
    for (state, task) in states() {
        for (event, happened) in events() {
            let row = |from: &str| TABLE.iter().find(|row| (row.0, row.1) == (from, event)).map(|row| row.2);
            let wanted = row(state).or_else(|| row(kind(state))).or_else(|| faulted(state, event));
            let (next, _) = stepped(task, happened);
            match wanted {
                Some(wanted) => assert_eq!(name(&next), wanted, "{state} × {event}"),
                None => assert_eq!(next, task, "{state} × {event}"),
            }
        }
    }
    for (from, event, to) in TABLE {
        let known = |name: &&str| states().iter().any(|(state, _)| state == name);
        assert!(known(from) && known(to), "{from} → {to}");
        assert!(events().iter().any(|(name, _)| name == event), "{event}");
    }
}

#[test]
fn what_the_axes_are_told() {
    for (state, task) in states() {
        for (event, happened) in events() {
            let (next, order) = stepped(task, happened);
            let what = format!("{state} × {event}: {order:?}");
            match (kind(state), name(&next)) {
                ("ready", "arming") => assert_eq!(order, Order::Arm(arm()), "{what}"),
                ("ready" | "moving" | "braking", _) => assert_eq!(order, Order::Stream, "{what}"),
                (_, "fault, hold") => assert_eq!(order, Order::Hold, "{what}"),
                (_, "fault, call off" | "calling off") => assert_eq!(order, Order::CallOff, "{what}"),
                (_, "fault, stop") => assert_eq!(order, Order::Stop, "{what}"),
                ("enabling" | "arming" | "armed" | "cutting", _) | (_, "cutting") => {
                    assert_eq!(order, Order::Hold, "{what}");
                }
                _ => assert_eq!(order, Order::Stream, "{what}"),
            }
        }
    }
}

#[test]
fn a_pass_that_has_begun_is_taken_back_by_nothing() {
    for (event, happened) in events() {
        let (next, order) = stepped(Task::Cutting(arm()), happened);
        assert!(matches!(order, Order::Hold), "{event}: {order:?}");
        let after = name(&next);
        assert!(["cutting", "ready", "fault, hold"].contains(&after), "{event}: {after}");
    }
}

#[test]
fn every_axis_is_armed_with_its_own_law() {
    let mut pass = arm();
    pass.pass.axes[Axis::Z.index()].lead_mm = 2.0;
    let (_, order) = stepped(Task::Ready { wait: Wait::No }, Event::Pass(pass, Cycle(20)));
    for (axis, lead_mm) in [(Axis::X, 0.0), (Axis::Z, 2.0)] {
        let AxisCommand::Arm { pass, s_rpm, not_before, law, .. } = order.of(axis) else {
            panic!("{axis:?} is not armed");
        };
        assert_eq!((pass, s_rpm, not_before, law.lead_mm), (7, 600.0, Cycle(40), lead_mm));
    }
}
