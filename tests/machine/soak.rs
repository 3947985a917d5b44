//! Two thousand seeds of the soak: random machines, programs and faults without a broken invariant. More:
//! `pitchlock soak --seeds 0..100000`.

use soak::driver;

#[test]
fn no_seed_breaks_an_invariant() {
    let seeds = testing::count("PITCHLOCK_SOAK", 2000);
    let jobs = std::thread::available_parallelism().map_or(1, usize::from);
    let report = driver::soak(0..seeds, jobs, &|_, _, _| true);
    let failed = report.failed.iter().map(|failed| {
        let (seed, broken) = (failed.seed, &failed.broken);
        format!("{} ({}), again: pitchlock soak --seeds {seed}..{}", broken.invariant, broken.text, seed + 1)
    });
    let failed: Vec<String> = failed.collect();
    assert!(failed.is_empty(), "{} of {seeds}:\n{}", failed.len(), failed.join("\n"));
    for kind in [
        "g33-taper",
        "g33-multi-start",
        "g76-internal",
        "roughing",
        "formula",
        "power-lost",
        "kill-regulator",
        "shop-lathe",
    ] {
        assert!(report.drawn.contains_key(kind), "no {kind} among {seeds} seeds");
    }
}
