//! What a picture of the scope begins with. In: rows of the ring. Out: the first of them in which it happens.

use protocol::AxisState;
use serde::Deserialize;

use super::ring::Ring;

/// What happens from one row to the next.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(untagged)]
pub(crate) enum Trigger {
    Event(OfEvent),
    Level(OfLevel),
}

#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub(crate) struct OfEvent {
    event: Event,
}

/// A signal goes through a level, in its unit.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub(crate) struct OfLevel {
    pub(crate) signal: String,
    level: f64,
    edge: Edge,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum Event {
    /// The index of the spindle goes by.
    Index,
    /// An axis is armed for a pass.
    Armed,
    /// An axis is on its helix.
    Locked,
    /// An axis has a fault.
    Fault,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum Edge {
    Rising,
    Falling,
    Either,
}

impl Trigger {
    /// The first of these rows in which it happens; each is compared with the one before it.
    pub(crate) fn first(&self, ring: &Ring, rows: std::ops::Range<usize>) -> Option<usize> {
        let rows = rows.start.max(1)..rows.end;
        let becomes = |rows: std::ops::Range<usize>, state: AxisState| {
            let is = |row| ring.any_state(row, |other| other == state);
            rows.into_iter().find(|row| is(*row) && !is(row - 1))
        };
        match self {
            Trigger::Event(OfEvent { event: Event::Index }) => {
                let turn = |row| (ring.angle_deg(row) / 360.0).floor();
                rows.into_iter().find(|row| turn(*row) != turn(row - 1))
            }
            Trigger::Event(OfEvent { event: Event::Armed }) => becomes(rows, AxisState::Armed),
            Trigger::Event(OfEvent { event: Event::Locked }) => becomes(rows, AxisState::Locked),
            Trigger::Event(OfEvent { event: Event::Fault }) => becomes(rows, AxisState::Fault),
            Trigger::Level(OfLevel { signal, level, edge }) => {
                let column = ring.column(signal)?;
                let value = |row| ring.value(column, row);
                let rises = |row: usize| value(row - 1) < *level && value(row) >= *level;
                let falls = |row: usize| value(row - 1) > *level && value(row) <= *level;
                rows.into_iter().find(|row| match edge {
                    Edge::Rising => rises(*row),
                    Edge::Falling => falls(*row),
                    Edge::Either => rises(*row) || falls(*row),
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::ring::tests::filled, *};

    #[test]
    fn each_trigger_is_the_cycle_in_which_it_happens() {
        let ring = filled(0..3000, 3000);
        for (text, wanted) in [
            (r#"{"event":"index"}"#, Some(1080)),
            (r#"{"event":"armed"}"#, Some(2200)),
            (r#"{"event":"locked"}"#, Some(1180)),
            (r#"{"event":"fault"}"#, None),
            (r#"{"signal":"pass","level":1.5,"edge":"rising"}"#, Some(2200)),
            (r#"{"signal":"pass","level":0.5,"edge":"falling"}"#, Some(1500)),
            (r#"{"signal":"pass","level":0.5,"edge":"either"}"#, Some(1500)),
            (r#"{"signal":"pass","level":9,"edge":"either"}"#, None),
        ] {
            let trigger: Trigger =
                serde_json::from_str(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            assert_eq!(trigger.first(&ring, 1050..3000), wanted, "{text}");
        }
        for wrong in [r#"{"event":"noon"}"#, r#"{"event":"index","level":1}"#, r#"{"signal":"pass"}"#, "{}"] {
            assert!(serde_json::from_str::<Trigger>(wrong).is_err(), "{wrong}");
        }
    }
}
