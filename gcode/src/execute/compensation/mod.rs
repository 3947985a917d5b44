//! Cutter radius and tool nose compensation.

/// G40, G41, G42 and the moves that wait for the next corner.
#[derive(Clone, Debug, Default)]
pub struct Compensation;
