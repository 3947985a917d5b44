//! The built-in lathe, which is as hard as one in a shop, and the plain one: the worst of ten seeds, at the
//! tool. What docs/figures.md and the README show is what runs give.

use std::path::Path;

use rig::observe::{PassReport, Summary};

use crate::shop::{EXAMPLES, Place, SCENARIOS, example, project, scenario};

const SEEDS: u32 = 10;

/// Swing of the helix about its mean, pass to pass, depth from end to end, µm; the highest jerk of Z, per
/// cent of its limit; the nut beside the helix, µm.
fn figures(summary: &Summary) -> [f64; 5] {
    let worst = |of: fn(&PassReport) -> f64| summary.passes.iter().map(of).fold(0.0, f64::max);
    [
        worst(|pass| pass.tool.helix_max_abs_um),
        summary.thread.tool_phase_spread_um,
        summary.thread.tool_depth_um,
        worst(|pass| pass.limits_used_pct.z_j),
        worst(|pass| pass.helix_max_abs_um),
    ]
}

fn worst_of(one: [f64; 5], other: [f64; 5]) -> [f64; 5] {
    std::array::from_fn(|i| one[i].max(other[i]))
}

fn worst(place: &Place, lathe: &str, program: &Path, events: Option<&str>) -> [f64; 5] {
    let lathe = project().join("examples/machines").join(lathe).display().to_string();
    let events = events.map(|name| scenario(name).display().to_string());
    (1..=SEEDS).fold([0.0; 5], |worst, seed| {
        let seed = seed.to_string();
        let mut arguments = vec!["--in-process", "--trace", "none", "--machine", &lathe, "--seed", &seed];
        arguments.extend(events.iter().flat_map(|path| ["--scenario", path.as_str()]));
        let found = figures(&place.run(program, "run", &arguments));
        std::fs::remove_dir_all(place.at("run")).expect("the run left its folder");
        worst_of(worst, found)
    })
}

/// What pages lack: told as a whole, so that whoever changes a figure sees all that it moves.
#[derive(Default)]
struct Lacks(String);

impl Lacks {
    fn says(&mut self, page: &str, row: &str) {
        let text = std::fs::read_to_string(project().join(page)).expect("the page is there");
        if !text.contains(row) {
            self.0 += &format!("{page}: {row}\n");
        }
    }

    fn nothing(&self) {
        assert!(self.0.is_empty(), "pages lack this:\n{}", self.0);
    }
}

#[test]
fn the_worst_of_ten_seeds_is_what_the_pages_show_and_every_part_is_good() {
    let (place, mut pages) = (Place::new(), Lacks::default());
    // Without a scenario, with the override turned, bogged down.
    let mut kinds = [[0.0; 5]; 3];
    for program in EXAMPLES {
        for events in [None].into_iter().chain(SCENARIOS.map(Some)) {
            let shop = worst(&place, "small-lathe.toml", &example(program), events);
            let plain = worst(&place, "plain-lathe.toml", &example(program), events);
            let [swing, passes, depth, jerk, nut] = shop;
            let name = events.unwrap_or("–");
            pages.says(
                "docs/figures.md",
                &format!(
                    "| {program} | {name} | {swing:.2} | {passes:.2} | {depth:.2} | {jerk:.0} | {nut:.2} | \
                     {:.2} | {:.2} | {:.2} |",
                    plain[0], plain[2], plain[4]
                ),
            );
            let (kind, allowed) = match events {
                None => (0, 1.5),
                Some("bogged-spindle") => (2, 4.0),
                Some(_) => (1, 2.5),
            };
            assert!(swing <= allowed && passes <= 1.0 && depth <= 1.5, "{program} {name}: {shop:?}");
            kinds[kind] = worst_of(kinds[kind], shop);
        }
    }
    let spindles =
        ["at constant speed", "override turned, while it cuts and in between", "bogged down by a fifth"];
    for (spindle, [swing, passes, depth, ..]) in spindles.into_iter().zip(kinds) {
        pages.says("README.md", &format!("| {spindle} | {swing:.1} | {passes:.1} | {depth:.1} |"));
    }
    pages.nothing();
}

#[test]
fn the_worst_of_ten_seeds_of_chains_is_what_the_page_shows() {
    let (place, mut pages) = (Place::new(), Lacks::default());
    for (name, program) in [("chain", "chain.ngc"), ("variable-lead", "fanuc/variable-lead.nc")] {
        let path = project().join("examples").join(program);
        for events in [None].into_iter().chain(SCENARIOS.map(Some)) {
            let [swing, passes, depth, jerk, nut] = worst(&place, "small-lathe.toml", &path, events);
            let scenario = events.unwrap_or("–");
            pages.says(
                "docs/figures.md",
                &format!(
                    "| {name} | {scenario} | {swing:.2} | {passes:.2} | {depth:.2} | {jerk:.0} | {nut:.2} |"
                ),
            );
            assert!(swing <= 4.0 && passes <= 1.0, "{name} {scenario}: {swing} {passes}");
        }
    }
    pages.nothing();
}
