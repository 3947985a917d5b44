//! What is seen, as the server keeps it, and what of it is new to somebody who has seen it before.

use std::{collections::BTreeMap, sync::Arc};

use serde_json::{Map, Value, json};

use crate::wire::Point;

/// Most places of the way of the tool; then every second one is left out.
const MOST_PLACES: usize = 16_384;

/// The kind of a place at which the index went by in a pass.
const AT_THE_INDEX: u8 = 3;

/// What is seen, field by field. A field that did not change is the same one.
#[derive(Clone, Debug, Default)]
pub(crate) struct State {
    pub(crate) fields: BTreeMap<String, Arc<Value>>,
    pub(crate) trail: Trail,
}

/// The way of the tool. `points` only grows while `drawn` stays the same.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trail {
    drawn: u64,
    points: Arc<Vec<Point>>,
}

impl Trail {
    /// The tool has not gone anywhere yet.
    pub(crate) fn begin(&mut self) {
        *self = Trail { drawn: self.drawn + 1, points: Arc::default() };
    }

    /// It went on along these places.
    pub(crate) fn go_on(&mut self, points: Vec<Point>) {
        let all = Arc::make_mut(&mut self.points);
        all.extend(points);
        if all.len() > MOST_PLACES {
            let marks = all.iter().filter(|(_, kind)| *kind == AT_THE_INDEX).count();
            let mut keep = false;
            // Marks of a groove stay as long as others are more.
            let few = 2 * marks <= all.len();
            all.retain(|(_, kind)| {
                let mark = few && *kind == AT_THE_INDEX;
                keep ^= !mark;
                mark || keep
            });
            self.drawn += 1;
        }
    }
}

impl State {
    /// Whether the launcher has told anything of the machine.
    pub(crate) fn is_known(&self) -> bool {
        self.fields.get("state").is_some_and(|state| !state.is_null())
    }

    /// These fields are this now.
    pub(crate) fn set(&mut self, fields: Map<String, Value>) {
        for (name, value) in fields {
            if self.fields.get(&name).is_none_or(|before| **before != value) {
                self.fields.insert(name, Arc::new(value));
            }
        }
    }

    /// All of it.
    pub(crate) fn whole(&self) -> Value {
        let mut fields = self.since(&State::default()).unwrap_or_else(|| json!({}));
        if fields.get("trail").is_none() {
            fields["trail"] = json!({ "from": 0, "points": [] });
        }
        fields
    }

    /// What of it is not in `before`, as one document: fields, and where the trail goes on.
    pub(crate) fn since(&self, before: &State) -> Option<Value> {
        let same = |name: &String, value: &Arc<Value>| {
            before.fields.get(name).is_some_and(|before| Arc::ptr_eq(before, value))
        };
        let changed = self.fields.iter().filter(|(name, value)| !same(name, value));
        let mut document: Map<String, Value> =
            changed.map(|(name, value)| (name.clone(), (**value).clone())).collect();
        let anew = self.trail.drawn != before.trail.drawn;
        let from = if anew { 0 } else { before.trail.points.len() };
        if anew || from < self.trail.points.len() {
            let points = self.trail.points.get(from..).unwrap_or_default();
            document.insert("trail".into(), json!({ "from": from, "points": points }));
        }
        (!document.is_empty()).then_some(Value::Object(document))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fields and places that a document leads to from others.
    fn led(before: &State, document: &Value) -> (BTreeMap<String, Arc<Value>>, Vec<Point>) {
        let mut fields = before.fields.clone();
        let mut points = before.trail.points.to_vec();
        for (name, value) in document.as_object().expect("an object") {
            if name == "trail" {
                points.truncate(value["from"].as_u64().expect("a number") as usize);
                let more: Vec<Point> = serde_json::from_value(value["points"].clone()).expect("points");
                points.extend(more);
            } else {
                fields.insert(name.clone(), Arc::new(value.clone()));
            }
        }
        (fields, points)
    }

    /// From any earlier state the changes lead to the present one; and only what changed is told.
    #[test]
    fn what_changed_leads_from_any_state_to_the_present_one() {
        let mut seed = testing::Seed::new(20);
        let mut state = State::default();
        let mut states = vec![state.clone()];
        for number in 0..150_u16 {
            match seed.below(40) {
                0 => state.trail.begin(),
                1..10 => {
                    let fields = json!({ "line": seed.below(5), "cycle": number, "name": "always" });
                    state.set(fields.as_object().cloned().unwrap_or_default());
                }
                _ => {
                    let point = |step: u16| (vec![f32::from(number), f32::from(step)], 1);
                    state.trail.go_on((0..900).map(point).collect());
                }
            }
            states.push(state.clone());
        }
        assert!(state.trail.drawn > 3 && state.trail.points.len() <= MOST_PLACES);
        for (later, after) in states.iter().enumerate() {
            let before = &states[seed.below(later + 1)];
            let document = after.since(before).unwrap_or_else(|| json!({}));
            let (fields, points) = led(before, &document);
            assert_eq!((&fields, &points), (&after.fields, &*after.trail.points));
            if before.fields.contains_key("name") {
                assert!(document.get("name").is_none(), "what stays is not told again");
            }
        }
    }
}
