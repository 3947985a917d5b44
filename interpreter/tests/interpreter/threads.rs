//! The law of a pass, for a wide random set of threads: phase, windows, limits, flank, ends.

use interpreter::thread::{Along, Chain, Cut, Plan, Point, plan};
use machine::Machine;
use motion::Limits;
use proptest::prelude::*;
use protocol::{Axis, AxisLaw, Code, CodePacket, Item, Position, ThreadPass};

fn machine() -> Machine {
    Machine::plain()
}

fn limits(machine: &Machine, axis: Axis) -> Limits {
    let config = &machine.axis[&axis];
    Limits {
        v: config.velocity_mm_s,
        a: config.acceleration_mm_s2,
        j: config.jerk_mm_s3,
        dj: config.jerk_rate_mm_s4,
    }
}

prop_compose! {
    /// A cut as G76 makes it: lead, speed, depth, crest, length, direction.
    fn cycle_cut()(
        lead in 0.2..12.0f64, log_s in 1.0..8.0f64, depth in 0.02..4.0f64, crest in 0.1..10.0f64,
        length in 3.0..150.0f64, towards in prop::bool::ANY, inwards in prop::bool::ANY,
    ) -> Cut {
        let (z, x) = (if towards { -1.0 } else { 1.0 }, if inwards { -1.0 } else { 1.0 });
        let approach_mm = x * (crest + depth);
        Cut {
            s_rpm: libm::exp(log_s),
            top_share: 1.0,
            direction: 1.0,
            along: Along::Z,
            lead: Point { x: 0.0, z: z * lead },
            chain: Chain::default(),
            from: Point { x: 30.0, z: -10.0 },
            to_mm: -10.0 + z * length,
            approach_mm,
            retract_mm: -approach_mm,
            lift_mm: 0.0,
            outwards: 1.0,
            clear_mm: depth,
            start_deg: 0.0,
            depth_mm: depth,
            depth_is_told: true,
            entry: None,
            exit: None,
        }
    }
}

prop_compose! {
    /// A cut as G33 makes it on a cone, with a retract.
    fn taper_cut()(
        lead_z in 0.2..12.0f64, slope in -1.5..1.5f64, log_s in 1.0..8.0f64, retract in 1.0..10.0f64,
        length in 3.0..20.0f64,
    ) -> Cut {
        Cut {
            s_rpm: libm::exp(log_s),
            top_share: 1.0,
            direction: -1.0,
            along: Along::Z,
            lead: Point { x: slope * lead_z, z: -lead_z },
            chain: Chain::default(),
            from: Point { x: 40.0, z: 5.0 },
            to_mm: 5.0 - length,
            approach_mm: 0.0,
            retract_mm: retract,
            lift_mm: 0.0,
            outwards: 1.0,
            clear_mm: retract.min(1.3 * lead_z),
            start_deg: 0.0,
            depth_mm: 0.0,
            depth_is_told: true,
            entry: None,
            exit: None,
        }
    }
}

/// Largest share of a limit that a law uses at a ratio, sampled over the whole pass.
fn greatest_share(law: &AxisLaw, s_rpm: f64, ratio: f64, limits: Limits) -> f64 {
    let moves = law.law(s_rpm);
    let mut share = 0.0f64;
    let mut window = |from: f64, to: f64| {
        for step in 0..=4000 {
            let at = moves.at(from + (to - from) * f64::from(step) / 4000.0).driven([ratio, 0.0, 0.0, 0.0]);
            share = share
                .max(at.v.abs() / limits.v)
                .max(at.a.abs() / limits.a)
                .max(at.j.abs() / limits.j)
                .max(at.dj.abs() / limits.dj);
        }
    };
    window(law.begins_deg(), law.locked_deg());
    window(law.leaves_deg(), law.done_deg());
    share
}

fn assert_limits(plan: &Plan, machine: &Machine) -> Result<(), TestCaseError> {
    let pass = &plan.pass;
    let shares = [Axis::X, Axis::Z]
        .map(|axis| greatest_share(pass.axis(axis), pass.s_rpm, pass.max_ratio, limits(machine, axis)));
    prop_assert!(shares[0].max(shares[1]) <= 1.0 + 1e-9, "{shares:?}");
    Ok(())
}

/// The tool never touches the trailing flank while it is in the thread.
fn assert_flank(cut: &Cut, plan: &Plan, machine: &Machine) -> Result<(), TestCaseError> {
    let pass = &plan.pass;
    let (x, z) = (pass.axis(Axis::X), pass.axis(Axis::Z));
    let retract = motion::Stroke::new(x.retract_mm, x.retract_dc_deg / (6.0 * cut.s_rpm));
    let moves = z.law(cut.s_rpm);
    let tan = libm::tan(machine.threading.flank_half_angle_deg.to_radians());
    let from = pass.thread_end_deg;
    let at_end = moves.at(from).s;
    let mut least = f64::INFINITY;
    for step in 0..=5000 {
        let c = from + x.retract_dc_deg * f64::from(step) / 5000.0;
        let retracted = retract.at((c - from) / (6.0 * cut.s_rpm)).s.abs();
        if retracted > cut.clear_mm {
            break;
        }
        let lag = (cut.lead.z * (c - from) / 360.0 - (moves.at(c).s - at_end)).abs();
        prop_assert!(lag <= retracted * tan + 1e-9, "at {c}: lag {lag}, retracted {retracted}");
        least = least.min(retracted * tan - lag);
    }
    Ok(())
}

/// Bytes of a pass on its way to the interpolator, far down in a long program.
fn bytes_on_the_wire(pass: ThreadPass) -> usize {
    let item = Item { line: 99_999, code: Code::Pass(ThreadPass { pass: 250, start: 3, ..pass }) };
    CodePacket::pack(1_000_000, &item).as_bytes().len()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, max_global_rejects: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_pass_is_what_it_must_be(cut in cycle_cut()) {
        let machine = machine();
        let planned = plan(&cut, &machine);
        prop_assume!(planned.is_ok(), "most cuts of the set can be made");
        let plan = planned.expect("assumed");
        let pass = &plan.pass;
        prop_assert!(pass.check().is_ok());
        let (x, z) = (pass.axis(Axis::X), pass.axis(Axis::Z));
        // Both windows end together.
        prop_assert!((x.locked_deg() - z.locked_deg()).abs() < 1e-9 * z.locked_deg());
        // Phase: the helix goes through the start point at a whole number of turns, whatever S is.
        let centre = z.run_in_c0_deg + 0.5 * z.run_in_dc_deg;
        prop_assert!((centre / 360.0 - (centre / 360.0).round()).abs() < 1e-12);
        let moves = z.law(cut.s_rpm);
        for part in [0.0, 0.3, 1.0] {
            let c = z.locked_deg() + part * (pass.thread_end_deg - z.locked_deg());
            let helix = cut.lead.z * (c - centre) / 360.0;
            prop_assert!((moves.at(c).s - helix).abs() < 1e-9, "{} against {helix}", moves.at(c).s);
        }
        // Where they rest.
        let within = |a: f64, b: f64| (a - b).abs() < 2.1e-9;
        prop_assert!(x.start == x.end && within(z.end.mm(), cut.to_mm));
        prop_assert_eq!(z.start, Position::from_mm(cut.from.z));
        // At depth exactly, from the end of the windows to the end of the thread.
        let depth = x.law(cut.s_rpm);
        prop_assert_eq!(depth.at(x.locked_deg()).s, cut.approach_mm);
        prop_assert_eq!(depth.at(pass.thread_end_deg).s, cut.approach_mm);
        // After the index, but not by a turn more than needed.
        let first = x.begins_deg().min(z.begins_deg());
        let margin = 6.0 * cut.s_rpm * 10.0 * machine.general.cycle_s;
        prop_assert!(first >= margin * (1.0 - 1e-12) && first < 1.2 * margin + 360.0 + 1e-6);
        assert_limits(&plan, &machine)?;
        assert_flank(&cut, &plan, &machine)?;
    }

    #[test]
    fn a_tapered_pass_keeps_the_limits_of_both_axes(cut in taper_cut()) {
        let machine = machine();
        let Ok(plan) = plan(&cut, &machine) else { return Ok(()) };
        assert_limits(&plan, &machine)?;
        assert_flank(&cut, &plan, &machine)?;
        let x = plan.pass.axis(Axis::X);
        let end = cut.from.x + cut.lead.x * (cut.to_mm - cut.from.z) / cut.lead.z + cut.retract_mm;
        prop_assert!((x.end.mm() - end).abs() < 3e-9);
    }

    #[test]
    fn a_pass_takes_about_two_hundred_bytes(cut in cycle_cut(), tapered in taper_cut(), start in 0..8u32) {
        for cut in [cut, tapered] {
            // Speeds and starts are round numbers; nothing else is.
            let cut = Cut { s_rpm: cut.s_rpm.ceil(), start_deg: 45.0 * f64::from(start), ..cut };
            if let Ok(plan) = plan(&cut, &machine()) {
                let bytes = bytes_on_the_wire(plan.pass);
                prop_assert!(bytes <= 200, "{bytes} bytes for {cut:?}");
            }
        }
    }

    #[test]
    fn the_groove_does_not_depend_on_the_speed(cut in cycle_cut(), slower in 0.2..0.9f64) {
        let machine = machine();
        let slow = Cut { s_rpm: slower * cut.s_rpm, ..cut };
        let (Ok(fast), Ok(slow)) = (plan(&cut, &machine), plan(&slow, &machine)) else { return Ok(()) };
        // The helix at a whole number of turns, from each law: the same point modulo the lead.
        let phase = |plan: &Plan| {
            let z = plan.pass.axis(Axis::Z);
            let c = z.locked_deg();
            let at = z.start.mm() + z.law(plan.pass.s_rpm).at(c).s;
            at / cut.lead.z - c / 360.0
        };
        let apart = phase(&fast) - phase(&slow);
        prop_assert!((apart - apart.round()).abs() * cut.lead.z.abs() < 1e-9, "{apart}");
    }
}

#[test]
fn the_highest_ratio_is_tight() {
    let machine = machine();
    for (s_rpm, lead, depth) in [(300.0, 2.0, 0.3), (1500.0, 1.0, 0.1), (60.0, 10.0, 3.0), (850.0, 10.0, 1.0)]
    {
        let cut = Cut {
            s_rpm,
            top_share: 1.0,
            direction: 1.0,
            along: Along::Z,
            lead: Point { x: 0.0, z: -lead },
            chain: Chain::default(),
            from: Point { x: 20.0, z: 10.0 },
            to_mm: -80.0,
            approach_mm: -2.0 - depth,
            retract_mm: 2.0 + depth,
            lift_mm: 0.0,
            outwards: 1.0,
            clear_mm: depth,
            start_deg: 0.0,
            depth_mm: depth,
            depth_is_told: true,
            entry: None,
            exit: None,
        };
        let plan = plan(&cut, &machine).expect("feasible");
        let pass = plan.pass;
        let share = |ratio: f64| {
            let of = |axis| greatest_share(pass.axis(axis), s_rpm, ratio, limits(&machine, axis));
            of(Axis::X).max(of(Axis::Z))
        };
        // Up to the share that leaves a margin for changes of the spindle's speed (M8), and no further.
        let allowed = (machine.threading.limit_share_pct / 100.0).max(share(1.0));
        let used = share(pass.max_ratio);
        assert!((0.999 * allowed..=1.000_001 * allowed).contains(&used), "S{s_rpm}: {used}");
        assert!(pass.max_ratio >= 1.0);
    }
}

#[test]
fn the_run_out_is_delayed_no_more_than_needed() {
    let machine = machine();
    let cut = Cut {
        s_rpm: 600.0,
        top_share: 1.0,
        direction: 1.0,
        along: Along::Z,
        lead: Point { x: 0.0, z: -3.0 },
        chain: Chain::default(),
        from: Point { x: 20.0, z: 10.0 },
        to_mm: -40.0,
        approach_mm: -3.0,
        retract_mm: 3.0,
        lift_mm: 0.0,
        outwards: 1.0,
        clear_mm: 1.8,
        start_deg: 0.0,
        depth_mm: 1.8,
        depth_is_told: true,
        entry: None,
        exit: None,
    };
    let plan = plan(&cut, &machine).expect("feasible");
    let (x, z) = (plan.pass.axis(Axis::X), plan.pass.axis(Axis::Z));
    assert!(z.brake_c_deg > plan.pass.thread_end_deg, "this lead needs a delay");
    // One degree earlier, and the flank is touched.
    let earlier = AxisLaw { brake_c_deg: z.brake_c_deg - 1.0, ..*z }.law(600.0);
    let retract = x.law(600.0);
    let tan = libm::tan(machine.threading.flank_half_angle_deg.to_radians());
    let from = plan.pass.thread_end_deg;
    let touched = (0..3000).any(|step| {
        let c = from + x.retract_dc_deg * f64::from(step) / 3000.0;
        let out = retract.at(c).s + 3.0;
        let lag = (earlier.at(c).s - earlier.at(from - 5.0).s - cut.lead.z * (c - from + 5.0) / 360.0).abs();
        out < 1.8 && lag > out * tan
    });
    assert!(touched);
}
