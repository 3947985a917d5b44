//! The spindle observer on quantised counts (M53): helix error in µm at a lead of 5 mm/rev, measured at 1
//! kHz.
//!
//! The true angle is known in closed form, in revolutions; the encoder gives floor(4 N angle), the observer
//! gets the middle of the count. Table of the design: maximum error per encoder, bandwidth and scenario.

use motion::SpindleObserver;

const T: f64 = 1e-3;
const LEAD_UM: f64 = 5000.0;
/// 10/f_o at the slowest bandwidth of the table, and some more.
const SETTLED_S: f64 = 0.8;

/// A spindle that changes from one speed to another, linearly over `ramp` seconds from 1 s on (rev/s).
#[derive(Clone, Copy)]
struct Spindle {
    before: f64,
    after: f64,
    ramp: f64,
}

impl Spindle {
    fn constant(rpm: f64) -> Spindle {
        Spindle { before: rpm / 60.0, after: rpm / 60.0, ramp: 1.0 }
    }

    /// Unwrapped angle in revolutions.
    fn angle(&self, t: f64) -> f64 {
        let x = (t - 1.0).max(0.0);
        let gained = if x < self.ramp { 0.5 * x * x / self.ramp } else { x - 0.5 * self.ramp };
        self.before * t + (self.after - self.before) * gained
    }
}

/// Largest helix error in µm after settling, over `seconds`; several starting phases, so that no lucky beat
/// between counts and cycles hides an error.
fn worst_helix_error(lines: f64, f_o: f64, spindle: Spindle, seconds: f64) -> f64 {
    let quanta = 4.0 * lines;
    let mut worst = 0.0_f64;
    for phase in [0.0, 0.13, 0.37, 0.71] {
        let truth = |cycle: u32| spindle.angle(f64::from(cycle) * T) * quanta + phase;
        let mut observer = SpindleObserver::new(f_o, T);
        observer.start(truth(0), spindle.before * quanta);
        for cycle in 1..=(seconds / T) as u32 {
            let angle = truth(cycle);
            observer.update(angle.floor() + 0.5);
            if f64::from(cycle) * T >= SETTLED_S {
                worst = worst.max((observer.at(0.0).angle - angle).abs());
            }
        }
    }
    worst * LEAD_UM / quanta
}

/// The table is one run of each scenario, rounded to 0.01 µm; here the worst of four phases counts, and
/// override and dip have sharp corners. Both directions give the same error to the phase of the count.
#[test]
fn m53_table_of_helix_errors() {
    let rows = [
        (1024.0, 30.0, [0.42, 0.59, 0.65, 0.70]),
        (2500.0, 20.0, [0.08, 0.84, 0.98, 0.25]),
        (2500.0, 30.0, [0.09, 0.42, 0.50, 0.25]),
        (5000.0, 30.0, [0.04, 0.29, 0.37, 0.12]),
        (5000.0, 40.0, [0.05, 0.18, 0.20, 0.12]),
    ];
    // Not exactly 500: 250/3 counts per cycle would lock the phase of the count for ever, a bias no spindle
    // keeps.
    let rpm500 = Spindle::constant(500.37);
    let scenarios = [
        ("constant", rpm500, 3.0),
        ("override", Spindle { after: 0.6 * rpm500.before, ramp: 0.3, ..rpm500 }, 3.0),
        ("dip", Spindle { after: 0.97 * rpm500.before, ramp: 0.015, ..rpm500 }, 3.0),
        ("0.2 rpm", Spindle::constant(0.2), 20.0),
    ];
    for (lines, f_o, expected) in rows {
        for ((name, spindle, seconds), want) in scenarios.into_iter().zip(expected) {
            let back = Spindle { before: -spindle.before, after: -spindle.after, ..spindle };
            let got = [spindle, back].map(|spindle| worst_helix_error(lines, f_o, spindle, seconds));
            println!("N {lines} f_o {f_o} {name}: {:.3} um, backwards {:.3}, table {want}", got[0], got[1]);
            for error in got {
                let rounded_up = want + 0.005;
                assert!(error <= 1.8 * rounded_up, "N {lines} f_o {f_o} {name}: {error} um, table {want}");
                assert!(
                    error >= want / 1.8,
                    "N {lines} f_o {f_o} {name}: {error} um is too good, table {want}"
                );
            }
        }
    }
}

/// Runs an observer at 30 Hz on the exact angle of a constant acceleration, in rev and s, and returns its
/// errors in angle, speed and acceleration `lead` seconds after the last measurement.
fn steady_errors(speed: f64, acceleration: f64, lead: f64) -> [f64; 3] {
    let angle = |t: f64| (speed + 0.5 * acceleration * t) * t;
    let mut observer = SpindleObserver::new(30.0, T);
    observer.start(angle(0.0), speed);
    for cycle in 1..=2000 {
        observer.update(angle(f64::from(cycle) * T));
    }
    let (now, t) = (observer.at(lead), 2000.0 * T + lead);
    [now.angle - angle(t), now.speed - (speed + acceleration * t), now.acceleration - acceleration]
}

#[test]
fn constant_acceleration_leaves_no_steady_error() {
    for (speed, acceleration) in [(8.0, -1.5), (-8.0, 1.5), (-8.0, -11.0), (8.0, 11.0), (0.0, 0.0)] {
        for lead in [0.0, 0.5e-3, 2e-3, -0.25e-3] {
            let errors = steady_errors(speed, acceleration, lead);
            // Doubles near 40 rev, divided by T and T² in the corrections.
            let allowed = [1e-12, 1e-9, 1e-7];
            for (error, allowed) in errors.into_iter().zip(allowed) {
                assert!(error.abs() < allowed, "{speed} rev/s, {acceleration} rev/s²: {errors:?}");
            }
        }
    }
}

/// What `following` gives between two measurements is how the estimate moved from one to the other: half a
/// cycle back, its speed is that of the way from the estimate before.
#[test]
fn an_axis_that_follows_is_told_how_the_estimate_moves() {
    let mut observer = SpindleObserver::new(40.0, T);
    observer.start(0.0, 100.0);
    let mut before = observer.at(0.0);
    for cycle in 1..=200 {
        let t = f64::from(cycle) * T;
        observer.update((100.0 + 5000.0 * t) * t);
        let (now, back) = (observer.at(0.0), observer.following(-0.5 * T));
        let moved = (now.angle - before.angle) / T;
        // The speed itself was also corrected, and counts for only half of the way.
        let bound = T * (back.acceleration - now.acceleration).abs() + 1e-6;
        assert!((back.speed - moved).abs() <= bound, "cycle {cycle}: {} for {moved}", back.speed);
        let gained = (now.speed - before.speed) / T;
        assert!((back.acceleration - gained).abs() <= 1e-6 + 0.2 * gained.abs(), "cycle {cycle}");
        before = now;
    }
}

/// 0.2 rev/min at 2500 lines: 33 counts/s come one by one. The speed observed still swings by about itself
/// (1.2 from top to bottom), with the full bandwidth by six times as much; what changes is seen at once.
#[test]
fn counts_that_come_one_by_one_are_averaged() {
    let unevenness = |mut observer: SpindleObserver| {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        observer.start(0.5, 0.0);
        for cycle in 1..=10_000 {
            let angle = 33.3 * f64::from(cycle) * T;
            observer.update(angle.floor() + 0.5);
            if cycle > 5000 {
                assert!((observer.at(0.0).angle - angle).abs() < 1.0);
                (low, high) = (low.min(observer.at(0.0).speed), high.max(observer.at(0.0).speed));
            }
        }
        (high - low) / 33.3
    };
    let [plain, averaged] =
        [SpindleObserver::new(40.0, T), SpindleObserver::of_counts(40.0, T)].map(unevenness);
    assert!(averaged < 0.25 * plain, "{averaged} for {plain}");
    // Starting up, and beyond that speed, it keeps up with the plain one.
    let [mut plain, mut counts] = [SpindleObserver::new(40.0, T), SpindleObserver::of_counts(40.0, T)];
    for cycle in 0..2000 {
        let t = f64::from(cycle) * T;
        let angle = 60_000.0 * (t - 0.5).max(0.0).powi(2);
        plain.update(angle.floor() + 0.5);
        counts.update(angle.floor() + 0.5);
        let apart = (plain.at(0.0).angle - counts.at(0.0).angle).abs();
        assert!(apart < 3.0, "{apart} counts at {t} s");
    }
    assert!((plain.at(0.0).speed - counts.at(0.0).speed).abs() < 100.0);
}

/// A wrong initial speed is forgotten after 10/f_o, the lead time the design asks for before a thread.
#[test]
fn initial_speed_error_is_gone_after_ten_periods() {
    let mut observer = SpindleObserver::new(30.0, T);
    observer.start(0.0, 0.0);
    let cycles = (10.0 / 30.0 / T) as u32;
    for cycle in 1..=cycles {
        observer.update(8.0 * f64::from(cycle) * T);
    }
    let now = observer.at(0.0);
    assert!((now.angle - 8.0 * f64::from(cycles) * T).abs() < 1e-12);
    assert!((now.speed - 8.0).abs() < 1e-9, "{now:?}");
}

/// A shift of the origin shifts the estimate and nothing else: what the zero mark must look like.
#[test]
fn a_start_elsewhere_changes_only_the_origin() {
    let mut here = SpindleObserver::new(20.0, T);
    let mut there = here;
    here.start(0.0, 5.0);
    there.start(4096.0, 5.0);
    for cycle in 1..=500 {
        let angle = (7.0 * f64::from(cycle) * T).floor() + 0.5;
        here.update(angle);
        there.update(angle + 4096.0);
    }
    let (a, b) = (here.at(1e-3), there.at(1e-3));
    assert!((b.angle - a.angle - 4096.0).abs() < 1e-9 && (b.speed - a.speed).abs() < 1e-7);
}

/// Every second measurement missing while the spindle brakes by 12,000 1/min per s: the observer goes on as
/// it has learned, and is off by what half of the bandwidth makes of it, four times as much.
#[test]
fn missing_measurements_are_bridged_as_expected() {
    const CYCLE: f64 = 5e-4;
    let spindle = Spindle { before: 25.0, after: 5.0, ramp: 0.1 };
    let worst = |every: u32| {
        let mut observer = SpindleObserver::of_counts(60.0, CYCLE);
        let mut worst = 0.0_f64;
        for cycle in 0..2500_u32 {
            let angle = 10_000.0 * spindle.angle(f64::from(cycle) * CYCLE);
            if cycle.is_multiple_of(every) {
                observer.update(angle.floor() + 0.5);
            } else {
                observer.skip();
            }
            if cycle > 1900 {
                worst = worst.max((observer.at(0.0).angle - angle).abs());
            }
        }
        worst
    };
    let (all, half) = (worst(1), worst(2));
    assert!(half <= 4.0 * all, "{half} counts, {all} without");
}
