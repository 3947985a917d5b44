//! Numbered parameters #1 … #5000. In: index and value, dimensionless. Out: the value, 0 for one never set.

use std::collections::BTreeMap;

/// Last parameter free for programs.
pub(crate) const LAST_FREE: u32 = 5000;
/// Last parameter of the language; those above [`LAST_FREE`] belong to the control.
pub(crate) const LAST: u32 = 5602;

/// Values of the parameters of one program.
#[derive(Clone, Debug, Default)]
pub(crate) struct Parameters(BTreeMap<u32, f64>);

impl Parameters {
    pub(crate) fn get(&self, index: u32) -> f64 {
        self.0.get(&index).copied().unwrap_or(0.0)
    }

    pub(crate) fn set(&mut self, index: u32, value: f64) {
        self.0.insert(index, value);
    }
}
