//! The built-in lathe, which is as hard as one in a shop: the worst of ten seeds, at the tool. What
//! docs/machine-file.md shows of it is what runs give.

use rig::observe::Summary;

use crate::shop::{EXAMPLES, Place, SCENARIOS, example, project, scenario};

const SEEDS: u32 = 10;

/// Swing of the helix about its mean, pass to pass, depth from end to end, µm, and the highest jerk of Z, per
/// cent of its limit.
fn figures(summary: &Summary) -> [f64; 4] {
    let passes = summary.passes.iter();
    let swing = passes.clone().map(|pass| pass.tool.helix_max_abs_um).fold(0.0, f64::max);
    let jerk = passes.map(|pass| pass.limits_used_pct.z_j).fold(0.0, f64::max);
    [swing, summary.thread.tool_phase_spread_um, summary.thread.tool_depth_um, jerk]
}

fn worst(place: &Place, program: &str, events: Option<&str>) -> [f64; 4] {
    let events = events.map(|name| scenario(name).display().to_string());
    (1..=SEEDS).fold([0.0; 4], |worst, seed| {
        let seed = seed.to_string();
        let mut arguments = vec!["--in-process", "--trace", "none", "--seed", &seed];
        arguments.extend(events.iter().flat_map(|path| ["--scenario", path.as_str()]));
        let found = figures(&place.run(&example(program), "run", &arguments));
        std::fs::remove_dir_all(place.at("run")).expect("the run left its folder");
        std::array::from_fn(|i| worst[i].max(found[i]))
    })
}

#[test]
fn the_worst_of_ten_seeds_is_what_the_page_shows_and_every_part_is_good() {
    let page = std::fs::read_to_string(project().join("docs/machine-file.md")).expect("the page is there");
    let place = Place::new();
    for program in EXAMPLES {
        for events in [None].into_iter().chain(SCENARIOS.map(Some)) {
            let [swing, passes, depth, jerk] = worst(&place, program, events);
            let row = format!(
                "| {program} | {} | {swing:.2} | {passes:.2} | {depth:.2} | {jerk:.0} |",
                events.unwrap_or("–")
            );
            assert!(page.contains(&row), "docs/machine-file.md lacks this:\n{row}");
            assert!(swing < 4.0 && passes < 1.0 && depth < 1.5, "{row}");
        }
    }
}
