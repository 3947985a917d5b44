//! What keys have asked for and the machine does not show yet: a key that comes before the picture of the
//! one before it counts from there. In: requests with their values, answers, cycles that are shown. Out: the
//! value to count from.

use std::collections::BTreeMap;

use serde_json::Value;

/// The newest request of each word that may not be seen yet.
#[derive(Debug, Default)]
pub(crate) struct Wanted(BTreeMap<String, One>);

#[derive(Debug)]
struct One {
    id: u64,
    value: Value,
    /// Seen by the next picture behind this cycle, in which the machine took it.
    taken: Option<u64>,
}

impl Wanted {
    /// A value that is asked for by the request of this number.
    pub(crate) fn asked(&mut self, word: &str, id: u64, value: Value) {
        self.0.insert(word.into(), One { id, value, taken: None });
    }

    /// The value that a word was asked for last.
    pub(crate) fn value(&self, word: &str) -> Option<&Value> {
        self.0.get(word).map(|one| &one.value)
    }

    /// A request was answered: taken in a cycle, or refused.
    pub(crate) fn answered(&mut self, id: u64, cycle: Option<u64>) {
        match cycle {
            None => self.0.retain(|_, one| one.id != id),
            Some(_) => self.0.values_mut().filter(|one| one.id == id).for_each(|one| one.taken = cycle),
        }
    }

    /// A cycle is shown; of a machine that is off, or a recording, every picture is the newest.
    pub(crate) fn shown(&mut self, cycle: u64, is_off: bool) {
        self.0.retain(|_, one| one.taken.is_none_or(|taken| !is_off && cycle <= taken));
    }

    /// Nothing of it will be answered.
    pub(crate) fn forget(&mut self) {
        self.0.clear();
    }
}
