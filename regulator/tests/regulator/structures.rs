//! What each structure of feedforward sends to the drive, against its formulas.
#![allow(clippy::unwrap_used)]

use crate::stand::{ARMED, ENABLED, HOME_MM, OVER, T, arm, follows, frame, law, machine, run};
use machine::{AxisConfig, Difference, Feedforward};
use motion::Sample;
use protocol::{AxisCommand, Cycle, Measurement};
use regulator::{Out, spindle::Spindle, state::Pass, stream::Stream};

const TORQUE_PER_N: f64 = 5e-3 / core::f64::consts::TAU;

/// The commanded motion, put together once more from its parts.
struct Course {
    stream: Stream,
    spindle: Spindle,
    index: Option<i64>,
    cycle: u64,
}

impl Course {
    fn new() -> Course {
        let (stream, spindle) = (Stream::new(T), Spindle::new(&machine(|_| {}), 100.0));
        Course { stream, spindle, index: None, cycle: 0 }
    }

    fn see(&mut self, cycle: u64, measurement: &Measurement, out: &Out) {
        self.cycle = cycle;
        self.spindle.update(measurement, 0, None);
        if cycle.is_multiple_of(4) && frame(cycle).unpack().unwrap() == AxisCommand::Stream {
            self.stream.push(frame(cycle).setpoint, 0.0);
        }
        self.index =
            (3..=6).contains(&out.status.state).then_some(self.index.unwrap_or(measurement.index_count));
        if self.index.is_none() && cycle > ARMED + 1000 && cycle < OVER {
            self.stream.rest_at(law().end, Cycle(cycle));
        }
    }

    fn at(&self, lead_s: f64) -> Sample {
        let Some(index) = self.index else { return self.stream.at(Cycle(self.cycle), lead_s / T) };
        let pass = Pass {
            out: protocol::WayOut::default(),
            number: 1,
            programmed_deg_s: 1800.0,
            direction: 1.0,
            not_before: Cycle(0),
            index_count: index,
            turned: false,
            law: law(),
            motion: law().law(300.0),
        };
        let c = self.spindle.followed_since(&pass, lead_s);
        let mut sample =
            pass.motion.at(c.angle).driven([c.speed / 1800.0, c.acceleration / 1800.0, 0.0, 0.0]);
        sample.s += law().start.mm();
        sample
    }
}

/// Friction as believed, from its differential equation.
#[derive(Default)]
struct Friction(f64);

impl Friction {
    fn force(&mut self, config: &AxisConfig, v: f64, step_s: f64) -> f64 {
        let (stiffness, coulomb) = (config.presliding_n_mm, config.coulomb_n);
        let relax = stiffness * v.abs() / coulomb * step_s;
        self.0 = (self.0 + v * step_s) / (1.0 + relax);
        stiffness * self.0 + config.viscous_n_s_mm * v
    }
}

/// Runs a structure; `check` gets the course, the axis, measured position and answer of every cycle with a
/// command.
fn walk(change: impl FnOnce(&mut AxisConfig), mut check: impl FnMut(&Course, &AxisConfig, f64, &Out)) {
    let machine = machine(change);
    let config = &machine.axis[&protocol::Axis::X];
    let (mut course, mut states) = (Course::new(), [0; 8]);
    run(&machine, follows, |cycle, measurement, out| {
        course.see(cycle, measurement, out);
        states[out.status.state as usize] += 1;
        if out.status.state != 0 {
            check(&course, config, measurement.axes[0].position.mm(), out);
        }
    });
    assert!(states[..7].iter().all(|cycles| *cycles > 20) && states[7] == 0, "{states:?}");
}

fn sent(out: &Out) -> [u64; 3] {
    [out.drive.target_velocity_mm_s, out.drive.velocity_offset_mm_s, out.drive.torque_offset_nm]
        .map(f64::to_bits)
}

#[test]
fn m54_full_bit_for_bit() {
    let mut friction = Friction::default();
    walk(
        |_| {},
        |course, config, measured_mm, out| {
            let [now, early, late] =
                [0.0, config.velocity_lead_s, config.acceleration_lead_s].map(|lead| course.at(lead));
            let metres_per_radian = config.screw_lead_mm / 1000.0 / core::f64::consts::TAU;
            let force = config.mass_kg * late.a / 1000.0 + friction.force(config, late.v, T);
            let expected =
                [config.position_gain_1_s * (now.s - measured_mm), early.v, force * metres_per_radian];
            assert_eq!(sent(out), expected.map(f64::to_bits), "in cycle {}", course.cycle);
            assert_eq!(out.status.servo_error_mm.to_bits(), (now.s - measured_mm).to_bits());
        },
    );
}

#[test]
fn none_is_the_position_loop_alone() {
    walk(
        |x| x.feedforward = Feedforward::None,
        |course, config, measured_mm, out| {
            let target = config.position_gain_1_s * (course.at(0.0).s - measured_mm);
            assert_eq!(sent(out), [target, 0.0, 0.0].map(f64::to_bits));
        },
    );
}

#[test]
fn analytic_structures_feed_the_law() {
    walk(
        |x| x.feedforward = Feedforward::AnalyticV,
        |course, config, measured_mm, out| {
            let target = config.position_gain_1_s * (course.at(0.0).s - measured_mm);
            assert_eq!(sent(out), [target, course.at(config.velocity_lead_s).v, 0.0].map(f64::to_bits));
        },
    );
    walk(
        |x| x.feedforward = Feedforward::AnalyticVaNoLead,
        |course, config, measured_mm, out| {
            let now = course.at(0.0);
            let target = config.position_gain_1_s * (now.s - measured_mm);
            let torque = config.mass_kg * 1e-3 * now.a * TORQUE_PER_N;
            assert_eq!(sent(out)[..2], [target, now.v].map(f64::to_bits));
            assert!(
                (out.drive.torque_offset_nm - torque).abs() < 1e-12,
                "{} {torque}",
                out.drive.torque_offset_nm
            );
        },
    );
}

/// What the structures with differences send, checked where it is new, and where it is held.
fn differences(
    feedforward: Feedforward,
    difference: Difference,
    mut fed: impl FnMut(&Course, &AxisConfig) -> [f64; 2],
) {
    let change = |x: &mut AxisConfig| (x.feedforward, x.difference) = (feedforward, difference);
    let mut held = None;
    walk(change, |course, config, measured_mm, out| {
        if let Some(held) = held
            && !course.cycle.is_multiple_of(u64::from(difference.cycles))
        {
            assert_eq!(sent(out), held, "in cycle {}", course.cycle);
            return;
        }
        held = Some(sent(out));
        let rounded = rounded(course.at(0.0).s, difference.quantum_mm);
        let target = config.position_gain_1_s * (rounded - measured_mm);
        let [v, force] = fed(course, config);
        let expected = [target, v, force * TORQUE_PER_N];
        let sent = sent(out).map(f64::from_bits);
        for (sent, expected) in sent.iter().zip(expected) {
            assert!((sent - expected).abs() < 1e-7, "{sent} {expected} in cycle {}", course.cycle);
        }
        assert_eq!(
            out.status.servo_error_mm,
            course.at(0.0).s - measured_mm,
            "against the law, at this instant"
        );
    });
}

fn rounded(mm: f64, quantum_mm: f64) -> f64 {
    (mm / quantum_mm).round() * quantum_mm
}

#[test]
fn m67_backward_differences() {
    for (quantum_mm, cycles) in [(1e-3, 2), (1e-4, 1), (1e-2, 5)] {
        let difference = Difference { quantum_mm, cycles, centred: false };
        for (feedforward, mass) in [(Feedforward::DifferenceV, 0.0), (Feedforward::DifferenceVa, 1905e-3)] {
            let (mut sent, h) = ([HOME_MM; 2], f64::from(cycles) * T);
            differences(feedforward, difference, |course, _| {
                let now = rounded(course.at(0.0).s, quantum_mm);
                let [last, before] = sent;
                sent = [now, last];
                [(now - last) / h, mass * (now - 2.0 * last + before) / (h * h)]
            });
        }
    }
}

#[test]
fn m67_centred_differences() {
    for (quantum_mm, cycles) in [(1e-3, 2), (1e-6, 1)] {
        let difference = Difference { quantum_mm, cycles, centred: true };
        for (feedforward, mass) in [(Feedforward::DifferenceV, 0.0), (Feedforward::DifferenceVa, 1905e-3)] {
            let (mut friction, h) = (Friction::default(), f64::from(cycles) * T);
            differences(feedforward, difference, |course, config| {
                let x = |lead_s: f64| rounded(course.at(lead_s).s, quantum_mm);
                let (t_v, t_a) = (config.velocity_lead_s, config.acceleration_lead_s);
                let speed = |l: f64| (x(l + h / 2.0) - x(l - h / 2.0)) / h;
                let a = (x(t_a + h) - 2.0 * x(t_a) + x(t_a - h)) / (h * h);
                [speed(t_v), mass * a + friction.force(config, speed(t_a), h)]
            });
        }
    }
}

/// Fine centred differences are the analytic structure within what a held command loses.
#[test]
fn fine_centred_differences_come_close_to_the_law() {
    let difference = Difference { quantum_mm: 1e-9, cycles: 1, centred: true };
    let change = |x: &mut AxisConfig| (x.feedforward, x.difference) = (Feedforward::DifferenceVa, difference);
    let (mut worst_v, mut worst_a) = (0.0_f64, 0.0_f64);
    let mut friction = Friction::default();
    walk(change, |course, config, _, out| {
        let (v, late) = (course.at(config.velocity_lead_s).v, course.at(config.acceleration_lead_s));
        let force = out.drive.torque_offset_nm / TORQUE_PER_N - friction.force(config, late.v, T);
        worst_v = worst_v.max((out.drive.velocity_offset_mm_s - v).abs());
        worst_a = worst_a.max((1e3 * force / config.mass_kg - late.a).abs());
    });
    assert!(worst_v < 0.01 && worst_a < 20.0, "{worst_v} mm/s, {worst_a} mm/s²");
}

/// An axis that stands between two counts of its positions does not jump when it gets its first command.
#[test]
fn motion_begins_without_a_jump() {
    for (feedforward, centred) in [
        (Feedforward::DifferenceV, false),
        (Feedforward::DifferenceVa, false),
        (Feedforward::DifferenceV, true),
        (Feedforward::DifferenceVa, true),
    ] {
        let difference = Difference { quantum_mm: 0.007, cycles: 2, centred };
        let change = |x: &mut AxisConfig| (x.feedforward, x.difference) = (feedforward, difference);
        walk(change, |course, _, _, out| {
            if (ENABLED..ENABLED + 200).contains(&course.cycle) {
                assert_eq!((out.drive.velocity_offset_mm_s, out.drive.torque_offset_nm), (0.0, 0.0));
                assert!(out.drive.target_velocity_mm_s.abs() < 0.5, "{}", out.drive.target_velocity_mm_s);
            }
        });
    }
}

/// Whatever feeds a speed feeds the whole way.
#[test]
fn the_speeds_add_up_to_the_way() {
    for feedforward in [
        Feedforward::DifferenceV,
        Feedforward::DifferenceVa,
        Feedforward::AnalyticV,
        Feedforward::AnalyticVaNoLead,
        Feedforward::Full,
    ] {
        let (mut up, mut down) = (0.0, 0.0);
        walk(
            |x| x.feedforward = feedforward,
            |_, _, _, out| {
                let way = out.drive.velocity_offset_mm_s * T;
                *if way > 0.0 { &mut up } else { &mut down } += way;
            },
        );
        assert!((up - 17.0).abs() < 0.01 && (down + 5.0).abs() < 0.01, "{feedforward:?}: {up} {down}");
    }
}

#[test]
fn the_pass_is_the_one_that_was_armed() {
    assert_eq!(frame(ARMED).unpack(), Ok(arm()));
}
