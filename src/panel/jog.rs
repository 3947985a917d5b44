//! How fast an axis is jogged. In: its limits. Out: feeds, mm/min.

use machine::AxisConfig;
use motion::Exit;
use protocol::Feed;

/// A jog comes to rest in so long, s: with the time for which its key stays pressed with nobody to confirm
/// it, 0.08 s, and the way of a setpoint to the axis, less than 0.15 s.
const JOG_STOPS_S: f64 = 0.05;
/// Slowest jog, mm/min.
const SLOWEST: f64 = 0.1;

/// A feed of a jog.
pub(super) fn feed(mm_min: f64, most: f64) -> Result<Feed, String> {
    if (SLOWEST..=most).contains(&mm_min) {
        return Ok(Feed::PerMinute(mm_min));
    }
    Err(format!("{mm_min} is no feed of this jog: {SLOWEST} to {most:.0} mm/min"))
}

/// The fastest jog of an axis that comes to rest soon enough, mm/min, in whole tens: a hold on its path takes
/// the law of smoothest braking within a, j and the rate of jerk of the axis.
pub(crate) fn fastest_jog(config: &AxisConfig) -> f64 {
    let limits = config.limits();
    let (mut low, mut high) = (0.0, config.velocity_mm_s);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        let soon = Exit::stop_s(middle, 0.0, &limits) <= JOG_STOPS_S;
        (low, high) = if soon { (middle, high) } else { (low, middle) };
    }
    (6.0 * low).floor() * 10.0
}
