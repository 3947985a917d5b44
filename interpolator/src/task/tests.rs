//! Every state and every event: what follows is written down here once more, by name, as a table. What the
//! table does not name must change nothing.

use protocol::{Axis, AxisCommand, ThreadPass, Until};

use super::*;

fn arm() -> InHand {
    InHand { pass: ThreadPass { pass: 7, s_rpm: 600.0, ..ThreadPass::default() }, not_before: Cycle(40) }
}

fn leaving(why: Why, way: Way) -> Task {
    Task::Leaving { pass: arm(), why, way }
}

fn awaited(left: u64) -> Await {
    Await { input: 2, until: Until::Rise, before: false, left }
}

const LEAVE: Way = Way::Leave(Cycle(60));

/// A state of each kind, by name.
fn states() -> Vec<(&'static str, Task)> {
    let waits = Wait::CycleStart(3);
    let moving = |wait, fault, back| Task::Moving { wait, fault, back };
    vec![
        ("enabling", Task::Enabling),
        ("starting", Task::Starting),
        ("ready", Task::Ready { wait: Wait::No }),
        ("ready waiting", Task::Ready { wait: waits }),
        ("moving", moving(Wait::No, None, None)),
        ("moving waiting", moving(waits, None, None)),
        ("moving back", moving(Wait::No, None, Some(Back::Held))),
        ("braking", moving(Wait::No, Some(Fault::TravelLimit), None)),
        ("dwelling", Task::Dwelling { left: 5 }),
        ("awaiting", Task::Awaiting(awaited(5))),
        ("paused", Task::Paused { cycle_starts: 3 }),
        ("changing tool", Task::ChangingTool { cycle_starts: 3 }),
        ("by hand", Task::ByHand),
        ("referencing", Task::Referencing { axis: Axis::Z, home_offset: Position(7) }),
        ("arming", Task::Arming { pass: arm(), sent: Cycle(20) }),
        ("armed", Task::Armed(arm())),
        ("calling off", Task::CallingOff { pass: arm(), sent: Cycle(48) }),
        ("cutting", Task::Cutting(arm())),
        ("leaving held", leaving(Why::Held(Back::Held), LEAVE)),
        ("leaving stopped", leaving(Why::Stopped, LEAVE)),
        ("leaving, fault", leaving(Why::Fault(Fault::BadMachineCode), LEAVE)),
        ("leaving, derived", leaving(Why::Fault(Fault::AxisFault), LEAVE)),
        ("leaving, call off", leaving(Why::Fault(Fault::BadMachineCode), Way::CallOff)),
        ("returning", Task::Returning { back: Back::Held, waits: true }),
        ("ending", Task::Ending { stopped: false }),
        ("ending stopped", Task::Ending { stopped: true }),
        ("ended", Task::Ended { stopped: false }),
        ("ended stopped", Task::Ended { stopped: true }),
        ("fault, hold", Task::Fault { fault: Fault::BadMachineCode, order: Order::Hold }),
        ("fault, stop", Task::Fault { fault: Fault::AxisFault, order: Order::Stop }),
    ]
}

fn events() -> Vec<(&'static str, Event)> {
    let moved = Moved::default();
    let stands = Moved { stands: true, ..moved };
    let back = Some(Back::Held);
    let fault =
        |fault, at_once| Event::Fault(Trouble { fault, axis: None, at_once, way: Way::Leave(Cycle(72)) });
    vec![
        ("nothing", Event::Nothing),
        ("axis fault", fault(Fault::AxisJump, true)),
        ("other fault", fault(Fault::BadMachineCode, false)),
        ("enabled", Event::Enabled),
        ("streaming", Event::Streaming),
        ("waits", Event::Waits(Wait::No)),
        ("waits for cycle start", Event::Waits(Wait::CycleStart(3))),
        ("dwells", Event::Dwells(5)),
        ("awaits", Event::Awaits(awaited(4))),
        ("pauses", Event::Pauses(3)),
        ("changes tool", Event::ChangesTool(3)),
        ("by hand", Event::ByHand),
        ("sets", Event::Sets(Axis::Z, Position(7))),
        ("is set", Event::IsSet),
        ("over", Event::Over(Wait::No)),
        ("over, block done", Event::Over(Wait::CycleStart(3))),
        ("moved", Event::Moved(moved)),
        ("moved, block done", Event::Moved(Moved { wait: Wait::CycleStart(3), ..moved })),
        ("moved, no further", Event::Moved(Moved { fault: Some(Fault::TravelLimit), ..moved })),
        ("moved, operator ends", Event::Moved(Moved { ends: true, ..moved })),
        ("moved back", Event::Moved(Moved { back, ..moved })),
        ("stands", Event::Moved(stands)),
        ("stands, block done", Event::Moved(Moved { wait: Wait::CycleStart(3), ..stands })),
        ("stands, no further", Event::Moved(Moved { fault: Some(Fault::TravelLimit), ..stands })),
        ("stands, operator ends", Event::Moved(Moved { ends: true, ..stands })),
        ("stands back", Event::Moved(Moved { back, ..stands })),
        ("pass", Event::Pass(arm(), Cycle(20))),
        ("armed", Event::Armed),
        ("taken back", Event::TakenBack(Cycle(48))),
        ("begun", Event::Begun),
        ("called off", Event::CalledOff),
        ("cut", Event::Cut(Wait::No)),
        ("cut, block done", Event::Cut(Wait::CycleStart(3))),
        ("leaves, held", Event::Leaves(Why::Held(Back::Held), Cycle(60))),
        ("leaves, stopped", Event::Leaves(Why::Stopped, Cycle(60))),
        ("released", Event::Waiting(Back::Goes)),
        ("left", Event::Left),
        ("returned", Event::Returned),
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
    ("ready", "awaits", "awaiting"),
    ("ready", "pauses", "paused"),
    ("ready", "changes tool", "changing tool"),
    ("ready", "by hand", "by hand"),
    ("ready", "sets", "referencing"),
    ("referencing", "is set", "ready"),
    ("ready", "pass", "arming"),
    ("ready", "ends", "ending"),
    ("ready", "operator ends", "ending stopped"),
    ("ready", "moved", "moving"),
    ("ready", "moved, block done", "moving waiting"),
    ("ready", "moved, no further", "braking"),
    ("ready", "moved, operator ends", "moving"),
    ("ready", "moved back", "moving back"),
    ("ready", "stands", "ready"),
    ("ready", "stands, block done", "ready waiting"),
    ("ready", "stands, no further", "fault, hold"),
    ("ready", "stands, operator ends", "ending stopped"),
    ("ready", "stands back", "returning"),
    ("moving", "moved", "moving"),
    ("moving", "moved, block done", "moving waiting"),
    ("moving", "moved, no further", "braking"),
    ("moving", "moved, operator ends", "moving"),
    ("moving", "moved back", "moving back"),
    ("moving", "stands", "ready"),
    ("moving", "stands, block done", "ready waiting"),
    ("moving", "stands, no further", "fault, hold"),
    ("moving", "stands, operator ends", "ending stopped"),
    ("moving", "stands back", "returning"),
    ("moving", "other fault", "braking"),
    ("moving back", "other fault", "braking back"),
    ("moving back", "moved, no further", "braking"),
    ("braking", "stands", "fault, hold"),
    ("braking", "stands, block done", "fault, hold"),
    ("braking", "stands, no further", "fault, hold"),
    ("braking", "stands, operator ends", "fault, hold"),
    ("braking", "stands back", "fault, hold"),
    ("braking", "moved, block done", "braking"),
    ("braking", "moved back", "braking back"),
    ("braking", "other fault", "braking"),
    ("dwelling", "nothing", "dwelling"),
    ("dwelling", "over", "ready"),
    ("dwelling", "over, block done", "ready waiting"),
    ("awaiting", "awaits", "awaiting"),
    ("awaiting", "over", "ready"),
    ("awaiting", "over, block done", "ready waiting"),
    ("paused", "over", "ready"),
    ("changing tool", "over", "ready"),
    ("changing tool", "over, block done", "ready waiting"),
    ("by hand", "over", "ready"),
    ("by hand", "over, block done", "ready waiting"),
    ("paused", "over, block done", "ready waiting"),
    ("arming", "armed", "armed"),
    ("armed", "taken back", "calling off"),
    ("armed", "begun", "cutting"),
    ("armed", "cut", "ready"),
    ("armed", "cut, block done", "ready waiting"),
    ("armed", "leaves, held", "leaving held"),
    ("armed", "leaves, stopped", "leaving stopped"),
    ("calling off", "begun", "cutting"),
    ("calling off", "called off", "ready"),
    ("calling off", "cut", "ready"),
    ("calling off", "cut, block done", "ready waiting"),
    ("calling off", "leaves, held", "leaving held"),
    ("calling off", "leaves, stopped", "leaving stopped"),
    ("cutting", "cut", "ready"),
    ("cutting", "cut, block done", "ready waiting"),
    ("cutting", "leaves, held", "leaving held"),
    ("cutting", "leaves, stopped", "leaving stopped"),
    ("leaving held", "released", "leaving released"),
    ("leaving held", "left", "returning"),
    ("leaving held", "cut", "ready"),
    ("leaving held", "cut, block done", "ready waiting"),
    ("leaving stopped", "left", "ending stopped"),
    ("leaving stopped", "cut", "ending stopped"),
    ("leaving stopped", "cut, block done", "ending stopped"),
    ("leaving, fault", "left", "fault, hold"),
    ("leaving, fault", "cut", "fault, hold"),
    ("leaving, fault", "cut, block done", "fault, hold"),
    ("leaving, derived", "left", "fault, hold"),
    ("leaving, derived", "cut", "fault, hold"),
    ("leaving, derived", "cut, block done", "fault, hold"),
    ("leaving, call off", "leaves, held", "leaving, fault"),
    ("leaving, call off", "leaves, stopped", "leaving, fault"),
    ("leaving, call off", "left", "fault, hold"),
    ("leaving, call off", "cut", "fault, hold"),
    ("leaving, call off", "cut, block done", "fault, hold"),
    ("returning", "moved", "moving"),
    ("returning", "moved, block done", "moving waiting"),
    ("returning", "moved, no further", "braking"),
    ("returning", "moved, operator ends", "moving"),
    ("returning", "moved back", "moving back"),
    ("returning", "stands", "ready"),
    ("returning", "stands, block done", "ready waiting"),
    ("returning", "stands, no further", "fault, hold"),
    ("returning", "stands, operator ends", "ending stopped"),
    ("returning", "stands back", "returning"),
    ("returning", "released", "returning released"),
    ("returning", "returned", "ready"),
    ("returning", "ends", "ending"),
    ("returning", "operator ends", "ending stopped"),
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
        Task::Moving { fault: Some(_), back: Some(_), .. } => "braking back",
        Task::Moving { fault: Some(_), .. } => "braking",
        Task::Moving { back: Some(_), .. } => "moving back",
        Task::Moving { wait: Wait::No, .. } => "moving",
        Task::Moving { .. } => "moving waiting",
        Task::Dwelling { .. } => "dwelling",
        Task::Awaiting(_) => "awaiting",
        Task::Paused { .. } => "paused",
        Task::ChangingTool { .. } => "changing tool",
        Task::ByHand => "by hand",
        Task::Referencing { .. } => "referencing",
        Task::Arming { .. } => "arming",
        Task::Armed(_) => "armed",
        Task::CallingOff { .. } => "calling off",
        Task::Cutting(_) => "cutting",
        Task::Leaving { why: Why::Held(Back::Goes), .. } => "leaving released",
        Task::Leaving { why: Why::Held(_), .. } => "leaving held",
        Task::Leaving { why: Why::Stopped, .. } => "leaving stopped",
        Task::Leaving { way: Way::CallOff, .. } => "leaving, call off",
        Task::Leaving { why: Why::Fault(Fault::AxisFault), .. } => "leaving, derived",
        Task::Leaving { .. } => "leaving, fault",
        Task::Returning { back: Back::Goes, .. } => "returning released",
        Task::Returning { .. } => "returning",
        Task::Ending { stopped: false } => "ending",
        Task::Ending { stopped: true } => "ending stopped",
        Task::Ended { stopped: false } => "ended",
        Task::Ended { stopped: true } => "ended stopped",
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
    let plain = |suffix| state.strip_suffix(suffix);
    plain(" waiting").or_else(|| plain(" back")).unwrap_or(state)
}

/// The state a fault leads to, where no row says otherwise.
fn faulted(state: &'static str, event: &str) -> Option<&'static str> {
    let after = match (state, event) {
        (over, _) if over.starts_with("ended") || over.starts_with("fault") => return None,
        (_, other) if other != "axis fault" && other != "other fault" => return None,
        ("arming" | "armed" | "calling off" | "leaving, call off", _) => "leaving, call off",
        (in_pass, _) if in_pass == "cutting" || in_pass.starts_with("leaving") => "leaving, fault",
        (_, "axis fault") => "fault, stop",
        _ => "fault, hold",
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
        let known = |name: &&str| {
            let released = ["leaving released", "returning released", "braking back"];
            states().iter().any(|(state, _)| state == name) || released.contains(name)
        };
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
            let wanted = match (kind(state), &next) {
                ("ready", Task::Arming { .. }) => Order::Arm(arm()),
                (_, Task::Fault { order: Order::Stop, .. }) => Order::Stop,
                ("ready" | "moving" | "braking" | "returning", _) => Order::Stream,
                (_, Task::Fault { order, .. }) => *order,
                (_, Task::CallingOff { .. } | Task::Leaving { way: Way::CallOff, .. }) => Order::CallOff,
                (_, Task::Leaving { way: Way::Leave(at), .. }) => Order::Leave(*at),
                ("referencing", _) => Order::Reference(Axis::Z, Position(7)),
                ("enabling" | "arming" | "armed" | "calling off" | "cutting", _) => Order::Hold,
                (leaving, _) if leaving.starts_with("leaving") => Order::Hold,
                _ => Order::Stream,
            };
            assert_eq!(order, wanted, "{what}");
        }
    }
}

#[test]
fn a_pass_that_has_begun_is_called_off_by_nothing() {
    for (event, happened) in events() {
        let (next, order) = stepped(Task::Cutting(arm()), happened);
        assert!(matches!(order, Order::Hold | Order::Leave(_)), "{event}: {order:?}");
        let after = name(&next);
        let known = after.starts_with("leaving") || after.starts_with("ready") || after == "cutting";
        assert!(known, "{event}: {after}");
    }
}

/// The first fault stays, but a cause takes the place of its consequence.
#[test]
fn the_first_fault_is_the_one_that_is_told() {
    let fault = |fault, at_once| Event::Fault(Trouble { fault, axis: None, at_once, way: LEAVE });
    let after = |task, event| stepped(task, event).0;
    let first = leaving(Why::Fault(Fault::ThreadError), LEAVE);
    assert_eq!(after(first, fault(Fault::DriveFault, true)), first);
    let derived = leaving(Why::Fault(Fault::AxisFault), LEAVE);
    assert_eq!(after(derived, fault(Fault::DriveFault, true)).fault(), Some(Fault::DriveFault));
    let braking = Task::Moving { wait: Wait::No, fault: Some(Fault::TravelLimit), back: None };
    let stopped = Task::Fault { fault: Fault::TravelLimit, order: Order::Stop };
    assert_eq!(after(braking, fault(Fault::AxisFault, true)), stopped);
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
