//! Seams whose direction passes that of the turn axis closely, and may be off by as much.
#![allow(clippy::unwrap_used)]

use interpreter::{Check, check_job};
use machine::{Machine, POSITIONER};
use protocol::{Code, Item, Shape};

fn said(check: &Check) -> String {
    check.diagnostics.iter().map(|diagnostic| diagnostic.render(false)).collect()
}

/// By what the direction of a seam is moved (M239).
fn moved_by(item: &Item) -> Option<[f64; 2]> {
    let Code::Work(work) = &item.code else { return None };
    let Shape::Seam(seam) = &work.shape else { return None };
    seam.moved
}

/// Within its tolerance a direction that passes that of the turn axis goes through it, and C stands;
/// beyond it nothing is changed, nor where the feed is kept.
#[test]
fn a_direction_may_be_off_where_that_lets_c_stand() {
    let passing = |beside: f64, tolerance: &str| {
        let keys = "kind = \"seam\"\nfeed_mm_min = 600\nt = [-1, 1]\nx = \"20*t\"\ny = \"0\"\nz = \"9\"\n";
        let text = format!("{keys}direction = [\"t\", \"{beside:e}\", \"1\"]\n{tolerance}");
        check_job("seam.toml", &text, &Machine::from_toml(POSITIONER).unwrap())
    };
    let moved = |check: &Check| check.items.iter().filter_map(moved_by).collect::<Vec<_>>();
    let fact = |check: &Check, name: &str| {
        check.jobs[0].facts.iter().find(|(key, _)| *key == name).map(|(_, value)| value.clone())
    };
    for beside in [0.01_f64, 0.00005, -0.002] {
        let lean = (2.0 * f64::atan(beside.abs() / 2.0)).to_degrees();
        let good = passing(beside, &format!("direction_tolerance_deg = {}", lean * 1.01));
        assert!(good.diagnostics.is_empty(), "{beside}: {}", said(&good));
        let [[x, y]] = moved(&good)[..] else { panic!("{beside}: one seam") };
        assert!(x.abs() < 1e-6 && (y - beside).abs() < 1e-12, "{beside}: {x} {y}");
        let told = fact(&good, "direction").unwrap();
        assert!(
            told.starts_with(&format!("up to {lean:.4} deg off")) && told.ends_with("t = 0.0000"),
            "{told}"
        );
        let turned = fact(&good, "C").unwrap();
        let (from, to) = turned.trim_end_matches(" deg").split_once(" to ").unwrap();
        assert_eq!(from, to, "{beside}");
        let less = passing(beside, &format!("direction_tolerance_deg = {}", lean * 0.99));
        let none = passing(beside, "");
        assert_eq!((said(&less), &less.items), (said(&none), &none.items), "{beside}");
        assert!(said(&none).contains("direction_tolerance_deg"), "{}", said(&none));
    }
    // Where C keeps the feed the direction stays what it is.
    let kept = passing(0.5, "direction_tolerance_deg = 5");
    assert!(kept.diagnostics.is_empty() && moved(&kept).is_empty(), "{}", said(&kept));
    let wide = passing(0.01, "direction_tolerance_deg = 6");
    assert!(
        said(&wide).contains("direction_tolerance_deg = 6 is not between 0 and 5 deg"),
        "{}",
        said(&wide)
    );
}
