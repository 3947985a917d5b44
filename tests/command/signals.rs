//! Outputs and inputs as the user of the command sees them: the bar feeder of the examples.

use rig::observe::{Outcome, Summary};

use crate::shop::{Place, project};

/// Runs the example into the folder `run`; its exit status, and its summary.
fn run(place: &Place, more: &[&str]) -> (Option<i32>, Summary) {
    place.clear("run");
    let folder = project().join("examples/bar-feeder");
    let [program, machine] = ["pin.ngc", "lathe.toml"].map(|name| folder.join(name).display().to_string());
    let answer =
        place.ask(&[&["run", &program, "--machine", &machine, "--json", "--out", "run"], more].concat());
    (answer.status, serde_json::from_str(&answer.stdout).expect("a summary"))
}

/// What changed in its order: an output, an input, an analog output, each with its number.
fn changes(summary: &Summary) -> Vec<String> {
    let on = |on: bool| if on { "on" } else { "off" }.to_owned();
    let outputs = summary.outputs.iter().map(|one| (one.cycle, "output", one.number, on(one.on)));
    let inputs = summary.inputs.iter().map(|one| (one.cycle, "input", one.number, on(one.on)));
    let analog = summary.analog_outputs.iter();
    let analog = analog.map(|one| (one.cycle, "analog", one.number, one.value.to_string()));
    let mut all: Vec<_> = outputs.chain(inputs).chain(analog).collect();
    all.sort_by_key(|(cycle, ..)| *cycle);
    let behind_the_start = all.into_iter().filter(|(cycle, ..)| *cycle > 100);
    behind_the_start.map(|(_, what, number, state)| format!("{what} {number} {state}")).collect()
}

#[test]
fn a_bar_feeder_works_and_everything_tells_of_it() {
    let place = Place::new();
    let answers = project().join("examples/bar-feeder/answers.toml").display().to_string();
    let (status, summary) = run(&place, &["--scenario", &answers]);
    assert_eq!((status, summary.outcome), (Some(0), Outcome::Completed));
    assert_eq!(summary.warnings, [], "every event comes");
    let expected = [
        "output 1 off",
        "input 3 off",
        "analog 0 3",
        "output 2 on",
        "input 2 on",
        "output 1 on",
        "input 3 on",
        "output 2 off",
        "output 3 on",
        "analog 0 1",
        "input 2 off",
        "output 3 off",
        "analog 0 0",
    ];
    assert_eq!(changes(&summary), expected);
    let (_, inside) = run(&place, &["--scenario", &answers, "--in-process"]);
    assert_eq!(inside.trace_hash, summary.trace_hash, "over processes the inputs come in the same cycles");

    let journal: serde_json::Value =
        serde_json::from_str(&place.ask(&["journal", "run", "--json"]).stdout).expect("one document");
    assert_eq!((&journal["outputs"], &journal["inputs"]), (&[1].into(), &[1, 3].into()), "{journal}");
    let told = place.ask(&["journal", "run"]).stdout;
    assert!(told.contains("outputs   on: 1\n") && told.contains("inputs    on: 1, 3\n"), "{told}");
    let page = std::fs::read_to_string(place.at("run/report.html")).expect("a report");
    assert!(page.contains("Outputs and inputs") && page.contains("bar at the stop"));

    // Nobody answers: the chuck never tells that it is open.
    let (status, summary) = run(&place, &["--in-process"]);
    assert_eq!((status, summary.outcome), (Some(1), Outcome::Faulted));
    assert_eq!((summary.faults[0].code.as_str(), summary.faults.len()), ("input-timed-out", 1));
    assert_eq!(changes(&summary), ["output 1 off", "output 1 on", "analog 0 0"], "it closes again");
}

/// An event for an input that the machine does not have is refused before anything moves.
#[test]
fn an_event_for_an_input_that_is_not_there_is_refused() {
    let place = Place::new();
    let program = place.write("part.ngc", "G0 X10\nM2\n");
    let refused = |text: &str| {
        place.write("scenario.toml", format!("[[event]]\nat = {{ cycle = 5 }}\n{text}\n"));
        let answer = place.ask(&["run", program.to_str().expect("a name"), "--scenario", "scenario.toml"]);
        assert_eq!(answer.status, Some(2), "{}", answer.stderr);
        answer.stderr
    };
    let said = refused("input = { number = 2, on = true }");
    assert!(said.contains("event 1") && said.contains("add it, and below it name"), "{said}");
    let said = refused("input = { number = 64, on = true }");
    assert!(said.contains("input.number"), "{said}");
    let said = refused("input = { number = 2 }");
    assert!(said.contains("on"), "{said}");
}
