//! Changes of lead: outside of their windows the axis is where the programmed corners have it, within them it
//! is as smooth as the peaks say.

use motion::{LeadChange, Limits, MOST_CHANGES, PassLaw, Window};

const S: f64 = 600.0;
/// Lead, growth in a turn, angle, window of the changes.
const CHANGES: [(f64, f64, f64, f64); 5] = [
    (0.0, 0.05, 130.0, 60.0),
    (-1.5, -0.05, 700.0, 120.0),
    (0.25, 0.02, 1300.0, 40.0),
    (0.0, -0.02, 1900.0, 30.0),
    (2.0, 0.0, 2100.0, 200.0),
];
const LEAD: f64 = -3.0;

fn law(s_rpm: f64) -> PassLaw {
    let run_in = Window { c: 100.0, dc: 120.0, lambda: 0.5 };
    let brake = Window { c: 3000.0, dc: 300.0, lambda: 0.5 };
    let law = PassLaw::new(s_rpm).with_lead(LEAD, run_in, brake);
    CHANGES.iter().fold(law, |law, (lead, growth, c, dc)| law.with_change(*lead, *growth, *c, *dc))
}

/// The programmed lead integrated corner by corner, from the start of the helix in the middle of the run-in.
fn programmed(c: f64) -> f64 {
    let (mut at, mut s, mut lead, mut growth) = (160.0, 0.0, LEAD, 0.0);
    let corners = CHANGES.iter().map(|(lead, growth, c, dc)| (c + 0.5 * dc, *lead, *growth));
    for (corner, jump, grows) in corners.filter(|(corner, ..)| *corner < c).chain([(c, 0.0, 0.0)]) {
        let turns = (corner - at) / 360.0;
        s += lead * turns + 0.5 * growth * turns * turns;
        lead += growth * turns + jump;
        growth += grows;
        at = corner;
    }
    s
}

#[test]
fn outside_of_its_windows_a_change_leaves_the_programmed_corners() {
    let (slow, fast) = (law(50.0), law(2000.0));
    let inside = |c: f64| CHANGES.iter().any(|(.., begins, dc)| (*begins..begins + dc).contains(&c));
    let mut judged = 0;
    for c in (220..3000).map(f64::from).filter(|c| !inside(*c)) {
        let off = [slow.at(c).s, fast.at(c).s].map(|s| (s - programmed(c)).abs());
        assert!(off[0].max(off[1]) < 1e-11, "{off:?} at {c}");
        judged += 1;
    }
    assert!(judged > 2000);
    assert!((programmed(2000.0) - programmed(700.0)).abs() > 5.0, "the corners matter");
}

#[test]
fn what_changes_is_as_smooth_as_its_peaks_say_and_ends_at_rest() {
    let law = law(S);
    let (mut before, step, peak) = (law.at(0.0), 0.02, law.peak());
    let dt = step / (6.0 * S);
    let mut reached = Limits { v: 0.0, a: 0.0, j: 0.0, dj: 0.0 };
    for i in 1..170_000 {
        let c = f64::from(i) * step;
        let now = law.at(c);
        assert!((now.s - before.s - 0.5 * (now.v + before.v) * dt).abs() < 1e-9, "at {c}");
        assert!((now.v - before.v).abs() <= 1.001 * peak.a * dt, "at {c}");
        assert!((now.a - before.a).abs() <= 1.001 * peak.j * dt, "at {c}");
        assert!((now.j - before.j).abs() <= 1.001 * peak.dj * dt, "at {c} {before:?} {now:?} {peak:?} {dt}");
        assert!(
            now.v.abs() <= peak.v && now.a.abs() <= peak.a && now.j.abs() <= peak.j,
            "at {c}: {now:?} {peak:?}"
        );
        reached = Limits {
            v: reached.v.max(now.v.abs()),
            a: reached.a.max(now.a.abs()),
            j: reached.j.max(now.j.abs()),
            dj: reached.dj.max(now.dj.abs()),
        };
        before = now;
    }
    let over = [peak.v / reached.v, peak.a / reached.a, peak.j / reached.j, peak.dj / reached.dj];
    assert!(over.iter().all(|over| *over < 1.6), "the bounds are not wild: {over:?}");
    let end = law.at(3300.0);
    assert_eq!((end.v, end.a), (0.0, 0.0));
    let brake = PassLaw::new(S);
    assert!(brake.at(1.0).s == 0.0 && end.s == law.at(9e9).s);
}

#[test]
fn the_shortest_change_uses_its_limits_and_no_more() {
    let limits = Limits { v: 100.0, a: 500.0, j: 50_000.0, dj: 1.0e7 };
    for (dv, da) in [(10.0, 0.0), (-0.01, 0.0), (60.0, 0.0), (0.0, 100.0), (0.0, -400.0), (5.0, 100.0)] {
        let duration = LeadChange::shortest(dv, da, &limits);
        let peak = LeadChange::new(dv, da, duration).peak();
        let shares = [peak.a / limits.a, peak.j / limits.j, peak.dj / limits.dj];
        let most = shares.into_iter().fold(0.0, f64::max);
        assert!(
            most <= 1.0 && most > if dv == 0.0 || da == 0.0 { 0.999 } else { 0.5 },
            "{dv} {da}: {shares:?}"
        );
    }
    assert_eq!(LeadChange::shortest(0.0, 450.0, &Limits { a: 450.0, ..limits }), f64::INFINITY);
}

#[test]
fn a_pass_holds_as_many_changes_as_it_says() {
    let (run_in, brake) =
        (Window { c: 0.0, dc: 10.0, lambda: 0.5 }, Window { c: 9e3, dc: 10.0, lambda: 0.5 });
    let law = PassLaw::new(S).with_lead(1.0, run_in, brake);
    let more = |law: PassLaw, n: usize| {
        (0..n).fold(law, |law, i| law.with_change(0.1, 0.0, 100.0 * (i + 1) as f64, 50.0))
    };
    let full = more(law, MOST_CHANGES);
    assert!((full.at(8e3).v - (1.0 + 0.1 * MOST_CHANGES as f64) * S / 60.0).abs() < 1e-9);
    assert!(std::panic::catch_unwind(|| more(law, MOST_CHANGES + 1)).is_err());
}
