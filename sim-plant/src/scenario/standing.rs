//! Scenarios that would never end: a hold that nobody releases, an override that stays at 0.
//! In: checked events. Out: the first event behind which the machine would stand for ever, and what to add.
//!
//! `stop`, `abort`, `emergency_stop` and `power_lost` end a program that stands; a hold is released by
//! `cycle_start` too, an override by one that is above 0 and does not come before it. Which of two events
//! comes first is known of two times, of two cycles and of two passes; of others it is taken to be the one
//! that helps.

use protocol::operator::Request;

use super::{Action, Event, Knob, Trigger};

/// The event, counted from 0, behind which the machine would stand for ever, and what to do about it.
pub(crate) fn forever(events: &[Event]) -> Option<(usize, String)> {
    let pressed = |request: Request| events.iter().any(|event| event.action == Action::Press(request));
    if events.iter().any(|event| event.action.ends()) {
        return None;
    }
    let held = |event: &Event| event.action == Action::Press(Request::FeedHold);
    events.iter().enumerate().find_map(|(index, event)| match event.action {
        _ if held(event) && !pressed(Request::CycleStart) => Some((
            index,
            "feed_hold: the machine would stand for ever; add an event with cycle_start = true, stop = true or \
             abort = true"
                .to_owned(),
        )),
        Action::Turn { knob, pct: 0.0, .. } if !raised(knob, index, events) => {
            let key = key(knob);
            let reason = format!(
                "{key} = 0: the machine would stand for ever; add a later event with {key} = 100, stop = true or \
                 abort = true"
            );
            Some((index, reason))
        }
        _ => None,
    })
}

/// Whether a knob is turned above 0 again behind event `zero`, as far as that is known.
fn raised(knob: Knob, zero: usize, events: &[Event]) -> bool {
    let Some(turned) = events.get(zero) else { return false };
    events.iter().enumerate().any(|(index, event)| {
        let raises =
            matches!(event.action, Action::Turn { knob: other, pct, .. } if other == knob && pct > 0.0);
        // Of events that are due at once, the later one in the file happens last.
        raises
            && !(precedes(event.trigger, turned.trigger) || index < zero && event.trigger == turned.trigger)
    })
}

/// Whether one event certainly happens before another.
fn precedes(one: Trigger, other: Trigger) -> bool {
    match (one, other) {
        (Trigger::Time { time_s: one }, Trigger::Time { time_s: other }) => one < other,
        (Trigger::Cycle { cycle: one }, Trigger::Cycle { cycle: other }) => one < other,
        (Trigger::AfterPass { pass: one }, Trigger::AfterPass { pass: other }) => one < other,
        (
            Trigger::PassAngle { pass: one, angle_deg: from },
            Trigger::PassAngle { pass: other, angle_deg: to },
        ) => (one, from) < (other, to),
        _ => false,
    }
}

/// How scenarios name a knob.
fn key(knob: Knob) -> &'static str {
    match knob {
        Knob::Spindle => "spindle_override_pct",
        Knob::Feed => "feed_override_pct",
        Knob::Rapid => "rapid_override_pct",
    }
}
