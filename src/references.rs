//! The reference runs that a program begins with. In: the machine file. Out: each of them, for people and for
//! programs, mm; degrees of a rotary axis.

use machine::{Machine, Method};
use protocol::Axis;
use serde::Serialize;

/// A run that is to be made.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Reference {
    axis: Axis,
    method: Method,
    position_mm: f64,
}

/// Those of a machine, in their order.
pub(crate) fn of(machine: &Machine) -> Vec<Reference> {
    let runs = machine.reference_runs().into_iter();
    runs.map(|(axis, run)| Reference { axis, method: run.method, position_mm: run.position_mm }).collect()
}

/// One line of each; `then` is what else is to be known.
pub(crate) fn told(references: &[Reference], then: &str) -> String {
    let line = |Reference { axis, method, position_mm }: &Reference| {
        let (name, unit) = (axis.name().to_ascii_uppercase(), if axis.is_rotary() { "°" } else { "mm" });
        format!("reference {name} by {} at {position_mm} {unit}: {then}\n", method.in_words())
    };
    references.iter().map(line).collect()
}
