//! G33.1: what a tap comes to, and why there is none.

use interpreter::{Check, check};
use machine::{Kinematics, Machine};
use protocol::{Axis, Code, ThreadPass, WayOut};

fn lathe(text: &str) -> Check {
    check("test.ngc", &format!("G18 G21 G90 G8 G97\nM3 S400\nG0 X0 Z6\n{text}\nM2\n"), &Machine::default())
}

fn taps(check: &Check) -> Vec<ThreadPass> {
    let pass = |item: &protocol::Item| match item.code {
        Code::Pass(pass) => Some(pass),
        _ => None,
    };
    check.items.iter().filter_map(pass).collect()
}

/// The code, and the text, of the one error.
fn refused(check: &Check) -> (&'static str, String) {
    let errors: Vec<_> =
        check.diagnostics.iter().filter(|one| one.severity == interpreter::Severity::Error).collect();
    assert_eq!(errors.len(), 1, "{:#?}", check.diagnostics);
    (errors[0].code, format!("{}; {}", errors[0].message, errors[0].help))
}

#[test]
fn a_tap_goes_in_along_the_helix_through_its_start_and_comes_back() {
    let check = lathe("G33.1 Z-20 K1.25 I2\nG33.1 Z-20 K1.25");
    assert!(check.is_good(), "{:#?}", check.diagnostics);
    let taps = taps(&check);
    assert_eq!(taps.len(), 2);
    for (tap, out) in taps.iter().zip([2.0, 1.0]) {
        let (x, z) = (tap.axis(Axis::X), tap.axis(Axis::Z));
        assert!(tap.check().is_ok() && Machine::default().can_follow(tap));
        assert_eq!((tap.out.leaves & WayOut::RETURNS, tap.return_ratio), (WayOut::RETURNS, out));
        assert_eq!((z.start.mm(), z.end.mm(), x.start.mm(), x.end.mm()), (6.0, 6.0, 0.0, 0.0));
        // Phase rule: prolonged, the helix goes through the start at the index.
        let middle = z.run_in_c0_deg + 0.5 * z.run_in_dc_deg;
        assert!((middle / 360.0 - (middle / 360.0).round()).abs() < 1e-9, "{middle}");
        let at_depth = z.start.mm() + z.law(tap.s_rpm).at(tap.thread_end_deg).s;
        assert!((at_depth + 20.0).abs() < 1e-9, "{at_depth}");
        // Farther in than it is told to, it is on its helix to the end of the travel.
        let end = z.start.mm() + z.law(tap.s_rpm).at(z.done_deg()).s;
        assert!((end + 400.0).abs() < 1e-4, "{end}");
    }
    let told = check.passes[0].tap.expect("it is a tap");
    assert!(told.top_rpm > 400.0 && told.brakes_mm > 0.0 && told.seconds > 1.0, "{told:?}");
}

#[test]
fn a_tap_that_the_machine_cannot_make_is_refused_with_what_it_can() {
    for (text, code, words) in [
        ("M3 S1500\nG33.1 Z-5 K1", "tap-not-feasible", "turns to stop"),
        ("M3 S3000\nG33.1 Z-200 K4", "tap-not-feasible", "which can do"),
        ("G33.1 Z5.9 K1.25", "tap-not-feasible", "until it is on the helix"),
        ("M3 S1600\nG33.1 Z-200 K1 I2", "tap-not-feasible", "faster than the spindle"),
        ("G33.1 Z-20 K1.25 I20", "bad-value", "20 times"),
        ("G33.1 X4 Z-20 K1.25", "unused-word", "goes in along Z"),
        ("G33.1 Z6 K1.25", "bad-value", "no depth"),
        ("G33.1 Z-900 K1.25", "travel-limit", "travel"),
    ] {
        let (found, said) = refused(&lathe(text));
        assert!(found == code && said.contains(words), "{text}: {found}: {said}");
    }
    // The speed that is named is one that does.
    let (_, said) = refused(&lathe("M3 S1500\nG33.1 Z-5 K1"));
    let rpm: f64 = said
        .split("would do is S")
        .nth(1)
        .and_then(|rest| rest.split([';', ' ']).next())
        .unwrap()
        .parse()
        .unwrap();
    assert!(lathe(&format!("M3 S{rpm}\nG33.1 Z-5 K1")).is_good(), "S{rpm}");
}

#[test]
fn a_mill_taps_too_and_a_positioner_does_not() {
    let mill = Machine::from_toml(Kinematics::Mill.example()).expect("the shipped mill");
    let check_on = |machine: &Machine, text: &str| check("test.ngc", text, machine);
    let check = check_on(&mill, "G17 G21 G90 G97\nM3 S300\nG0 X10 Y10 Z-20\nG33.1 Z-30 K1\nM2\n");
    assert!(check.is_good() && taps(&check).len() == 1, "{:#?}", check.diagnostics);
    assert!(mill.can_follow(&taps(&check)[0]));
}

#[test]
fn what_makes_a_tap_leave_is_said_as_in_a_thread() {
    let tap = taps(&lathe("(on_hold, leave)\n(on_stop, finish)\nG33.1 Z-20 K1.25"))[0];
    assert!(tap.out.on(WayOut::ON_HOLD) && !tap.out.on(WayOut::ON_STOP));
}

/// Beside the axis of a lathe a tap breaks; it makes no screw, and no thread of another lead.
#[test]
fn a_tap_beside_the_axis_and_one_of_another_thread_are_warned_of() {
    let warned = |text: &str| -> Vec<&'static str> {
        let check = check("test.ngc", text, &Machine::default());
        assert!(check.is_good(), "{:#?}", check.diagnostics);
        check.diagnostics.iter().map(|one| one.code).collect()
    };
    let tap = |head: &str, x: f64| {
        warned(&format!("G18 G21 G90 G8 G97\n{head}\nM3 S400\nG0 X{x} Z6\nG33.1 Z-20 K1.25\nM2\n"))
    };
    assert_eq!(tap("", 0.0), [""; 0]);
    assert_eq!(tap("", 10.0), ["tap-off-axis"]);
    assert_eq!(tap("(thread, M8x1.25-6H)", 0.0), [""; 0]);
    // A tap has all of its starts: of that lead it may be one of several.
    assert_eq!(tap("(thread, P0.625 D2 7.6..7.7 internal starts 2)", 0.0), [""; 0]);
    for other in ["M8x1.25-6g", "M8x1-6H", "M8x1.25-6H-LH"] {
        assert_eq!(tap(&format!("(thread, {other})"), 0.0), ["gauge-differs"], "{other}");
    }
}
