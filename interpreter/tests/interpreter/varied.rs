//! Speed variation: what is sent before which pass, what passes are laid out for, what is refused and what is
//! told instead.

use interpreter::{Check, check};
use machine::Machine;
use protocol::{Code, Variation, VariationShape};

fn checked(body: &str) -> Check {
    check("test.ngc", &format!("G18 G21 G90 G8 G94 G97\n{body}\nM2\n"), &Machine::default())
}

/// Variations and passes in their order.
fn told(check: &Check) -> Vec<String> {
    let tell = |code: &Code| match code {
        Code::Variation(None) => Some("even".to_owned()),
        Code::Variation(Some(Variation { shape, share, revolutions })) => {
            Some(format!("{} {share} {revolutions}", shape.name()))
        }
        Code::Pass(pass) => Some(format!("pass {}", pass.pass)),
        _ => None,
    };
    check.items.iter().filter_map(|item| tell(&item.code)).collect()
}

#[test]
fn it_is_sent_before_the_first_pass_that_it_is_about_and_when_it_changes() {
    let cycle = "G0 X12 Z8\nG76 P2 Z-10 I-1 J0.4 K0.5\nG0 X14";
    let check = checked(&format!(
        "M3 S200\n(speed_variation, sine, 30, 4)\n{cycle}\n(speed_variation, sine, 30, 4)\n{cycle}\n\
         (Speed_Variation, off)\n{cycle}\n(speed_variation, random, 12.5, 2)\nG0 X20"
    ));
    assert!(check.is_good(), "{:?}", check.diagnostics);
    let passes = |first: u32| (first..first + 2).map(|pass| format!("pass {pass}"));
    let expected = ["sine 0.3 4".to_owned()].into_iter().chain(passes(1)).chain(passes(3));
    let expected = expected.chain(["even".to_owned()]).chain(passes(5));
    assert_eq!(told(&check), expected.collect::<Vec<_>>());
    assert!(check.passes[..4].iter().all(|note| note.varied.is_some()) && check.passes[4].varied.is_none());
}

#[test]
fn a_g33_has_the_variation_of_its_own_line() {
    let thread = "G0 X12 Z8\nG0 X9.5\nG33 Z-10 K2";
    let check = checked(&format!(
        "M3 S200\n(speed_variation, triangle, 20, 4)\n{thread}\n(speed_variation, off)\nG0 X12\n{thread}\nG0 X12"
    ));
    assert!(check.is_good(), "{:?}", check.diagnostics);
    assert_eq!(told(&check), ["triangle 0.2 4", "pass 1", "even", "pass 2"]);
}

/// The knob keeps its range: passes are laid out for the peaks at the design override.
#[test]
fn passes_are_laid_out_for_the_highest_speed() {
    let thread = "G0 X12 Z8\nG76 P2 Z-20 I-1 J0.4 K0.5\nG0 X14";
    let of = |how: &str| checked(&format!("M3 S200\n({how})\n{thread}"));
    let [even, varied] = [of("nothing"), of("speed_variation, sine, 30, 4")];
    let ratio = |check: &Check| {
        let pass = check
            .items
            .iter()
            .find_map(|item| if let Code::Pass(pass) = item.code { Some(pass) } else { None });
        pass.expect("a pass").max_ratio
    };
    assert!(
        ratio(&even) < 1.3 && ratio(&varied) >= 1.2 * 1.3 * (1.0 - 1e-9),
        "{} {}",
        ratio(&even),
        ratio(&varied)
    );
    let [even, varied] = [even, varied].map(|check| check.passes[0].delta_mm[0].abs());
    assert!(varied > 1.1 * even, "the run-in is longer: {even}, {varied}");
}

#[test]
fn what_the_machine_cannot_do_is_refused_with_what_would_do() {
    let thread = "G0 X12 Z8\nG76 P2 Z-20 I-1 J0.4 K0.5\nG0 X14";
    let refused = |how: &str, s: u32| {
        let check = checked(&format!("M3 S{s}\n(speed_variation, {how})\n{thread}"));
        let found: Vec<_> =
            check.diagnostics.iter().filter(|one| one.code == "variation-not-feasible").collect();
        assert_eq!(found.len(), 1, "{:?}", check.diagnostics);
        assert!(found[0].line == 5, "at the cycle: {:?}", found[0]);
        (found[0].message.clone(), found[0].help.clone())
    };
    let (message, help) = refused("sine, 30, 1", 600);
    assert!(message.contains("spindle.ramp_rpm_s") && message.contains("may use 720"), "{message}");
    // What is told instead can be, one at a time.
    let number = |behind: &str| -> f64 {
        let rest = help.split(behind).nth(1).unwrap_or_else(|| panic!("{behind}: {help}"));
        rest.split(' ').next().and_then(|word| word.parse().ok()).unwrap_or_else(|| panic!("{help}"))
    };
    let (percent, revolutions) = (number("±"), number("cent over "));
    assert!(percent < 30.0 && revolutions > 1.0, "{help}");
    for how in [format!("sine, {percent}, 1"), format!("sine, 30, {revolutions}")] {
        let check = checked(&format!("M3 S600\n(speed_variation, {how})\n{thread}"));
        assert!(check.is_good(), "{how}: {:?}", check.diagnostics);
    }
    let (message, _) = refused("sine, 50, 900", 1800);
    assert!(message.contains("goes up to S2700"), "{message}");
}

#[test]
fn the_time_foretold_is_that_of_the_varied_speed() {
    let thread = "G0 X12 Z8\nG76 P2 Z-60 I-1 J0.4 K0.5\nG0 X14";
    let seconds = |how: &str| checked(&format!("M3 S150\n({how})\n{thread}")).time_s;
    let [even, varied] = [seconds("nothing"), seconds("speed_variation, sine, 50, 4")];
    // A turn takes 1/√(1 − a²) times as long in the mean: 15 % at a half.
    assert!(varied / even > 1.08 && varied / even < 1.2, "{even} s, {varied} s");
}

#[test]
fn shapes_have_the_names_of_the_page() {
    assert_eq!(VariationShape::ALL.map(VariationShape::name), ["sine", "triangle", "random"]);
}
