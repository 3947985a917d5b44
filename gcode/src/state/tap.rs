//! How a tap is made in step with the spindle. In: R and bottom of a hole, the depth of a peck. Out: depths,
//! in program units.

/// How a tap is made, program units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rigid {
    /// Advance in a turn.
    pub(crate) lead: f64,
    /// How much deeper each time; 0: in one go.
    pub(crate) peck: f64,
}

/// The depths of a tap from R to its bottom.
pub(crate) fn depths(r: f64, bottom: f64, peck: f64) -> impl Iterator<Item = f64> {
    let way = bottom - r;
    let count = if peck > 0.0 { (way.abs() / peck - 1e-9).ceil().max(1.0) } else { 1.0 };
    (1..=count as u64).map(move |n| match n as f64 >= count {
        true => bottom,
        false => r + way.signum() * peck * n as f64,
    })
}
