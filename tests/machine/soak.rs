//! Two thousand seeds of the soak: random machines, programs and faults without a broken invariant. More:
//! `pitchlock soak --seeds 0..100000`.

use soak::driver;

/// Seeds that are known to break an invariant, and why they still may. The test fails when one of them no
/// longer does: it has to leave the list then.
///
/// * 1697: measurements to the interpolator come late for good; the run ends, but names no cause.
/// * 1425: a spindle runs away during the stroke to depth; the tool is 0.2 µm deeper than the judge allows.
const OPEN: [u64; 2] = [1425, 1697];

#[test]
fn no_seed_breaks_an_invariant() {
    let seeds = testing::count("PITCHLOCK_SOAK", 2000);
    let jobs = std::thread::available_parallelism().map_or(1, usize::from);
    let report = driver::soak(0..seeds, jobs, &|_, _| {});
    let known: Vec<u64> = OPEN.into_iter().filter(|seed| *seed < seeds).collect();
    let still: Vec<u64> =
        report.failed.iter().map(|failed| failed.seed).filter(|seed| known.contains(seed)).collect();
    assert_eq!(still, known, "they are sound now: strike them off the list");
    let failed = report.failed.iter().filter(|failed| !known.contains(&failed.seed)).map(|failed| {
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
    ] {
        assert!(report.drawn.contains_key(kind), "no {kind} among {seeds} seeds");
    }
}
