//! Same machine, program, scenario and seed: the same numbers, over processes and in one process, every time.

use crate::replay::is_the_same_again;
use crate::shop::{Place, SCENARIOS, example, project, scenario};

/// Runs an example over processes and in one process, quietly and with each of these scenarios.
fn both_agree(name: &str, scenarios: &[&'static str]) {
    let place = Place::new();
    let program = example(name);
    let mut hashes = Vec::new();
    for scenario_name in std::iter::once(None).chain(scenarios.iter().map(|name| Some(*name))) {
        let inside = place.run_inside(&program, scenario_name);
        let path = scenario_name.map(|name| scenario(name).display().to_string());
        let mut arguments = vec!["--trace", "none"];
        arguments.extend(path.iter().flat_map(|path| ["--scenario", path.as_str()]));
        let over_processes = place.run(&program, "processes", &arguments);
        let what = format!("{name} {scenario_name:?}");
        is_the_same_again(&place, "processes");
        assert_eq!(over_processes.trace_hash, inside.trace_hash, "{what}");
        assert_eq!(over_processes.cycles, inside.cycles, "{what}");
        assert_eq!(over_processes.passes, inside.passes, "{what}");
        for channel in &over_processes.channels {
            assert_eq!(channel.lost, 0, "{what}: {channel:?}");
        }
        hashes.push(inside.trace_hash);
    }
    hashes.sort();
    hashes.dedup();
    assert_eq!(hashes.len(), 1 + scenarios.len(), "every scenario leaves its own trace");
}

#[test]
fn m20x2_is_the_same_over_processes_and_in_one() {
    both_agree("m20x2", &SCENARIOS);
}

#[test]
fn worm_left_is_the_same_over_processes_and_in_one() {
    both_agree("worm-left", &["bogged-spindle"]);
}

#[test]
fn internal_m30_is_the_same_over_processes_and_in_one() {
    both_agree("internal-m30", &["override-in-pass"]);
}

#[test]
fn a_mill_is_the_same_over_processes_and_in_one() {
    let place = Place::new();
    let machine = project().join("examples/machines/small-mill.toml").display().to_string();
    let program = example("mill/circle");
    let common = ["--machine", &machine, "--trace", "none"];
    let run = |out: &str, more: &[&str]| place.run(&program, out, &[&common[..], more].concat());
    let (over_processes, inside) = (run("processes", &[]), run("inside", &["--in-process"]));
    assert_eq!(over_processes.trace_hash, inside.trace_hash);
    assert_eq!(over_processes.moves, inside.moves);
    assert_eq!((inside.moves.circles.len(), inside.moves.limit_violations), (1, 0));
    assert!(inside.moves.contour_max_um < 3.0, "{} µm", inside.moves.contour_max_um);

    let blocks = run("blocks", &["--single-block"]);
    assert!(blocks.pauses.len() > 5 && blocks.moves.count == inside.moves.count, "{:?}", blocks.pauses);
    let again = place.run(&place.at("blocks"), "again", &["--in-process", "--trace", "none"]);
    assert_eq!(again.trace_hash, blocks.trace_hash, "the switch is part of the run folder");
}

/// A job of one item, whose pieces are made in the interpolator: from the job, and from its machine code.
#[test]
fn a_surface_is_the_same_over_processes_and_in_one() {
    let place = Place::new();
    let machine = project().join("examples/machines/small-mill.toml").display().to_string();
    let job = place.write(
        "wave.toml",
        "[job]\nkind = \"surface\"\norigin_mm = [0, 0, -100]\nspindle_rpm = 8000\nfeed_mm_min = 3000\n\
         z = \"0.02*x^2 + 8*sin(x/15)*cos(y/20)\"\nx = [0, 30]\ny = [0, 4]\ntool = { kind = \"ball\", diameter_mm = 6 }\n\
         path = { pattern = \"lines\", along = \"x\", step_mm = 1 }\n",
    );
    let common = ["--machine", &machine, "--trace", "none"];
    let run = |program: &std::path::Path, out: &str, more: &[&str]| {
        place.run(program, out, &[&common[..], more].concat())
    };
    let (over_processes, inside) = (run(&job, "processes", &[]), run(&job, "inside", &["--in-process"]));
    assert_eq!(over_processes.trace_hash, inside.trace_hash);
    assert_eq!(over_processes.moves, inside.moves);
    assert_eq!((inside.moves.limit_violations, inside.moves.starved), (0, 0));

    let code = place.at("wave.mc");
    let compiled = place.ask(&[
        "compile",
        &job.display().to_string(),
        "--machine",
        &machine,
        "-o",
        &code.display().to_string(),
    ]);
    assert_eq!(compiled.status, Some(0), "{}", compiled.stdout);
    assert_eq!(run(&code, "compiled", &["--in-process"]).trace_hash, inside.trace_hash);
}

#[test]
fn the_seed_is_part_of_the_numbers() {
    let place = Place::new();
    let run = |out: &str, seed: &str| {
        place.run(&example("m20x2"), out, &["--in-process", "--trace", "none", "--seed", seed]).trace_hash
    };
    let (first, again, other) = (run("a", "1"), run("b", "1"), run("c", "2"));
    assert_eq!(first, again);
    assert_ne!(first, other);
}
