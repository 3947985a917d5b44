//! docs/at-the-machine.md: the tasks of a machinist, by the requests that stand on the page, in their order.

use std::fs;

use rig::observe::{Outcome, Summary};
use serde_json::{Value, json};

use super::{client::Panel, watched::is_repeated};
use crate::shop::{Place, project, signal, until};

/// A block of code of some kind in a text.
fn block<'a>(text: &'a str, kind: &str) -> Option<&'a str> {
    text.split(&format!("```{kind}\n")).nth(1)?.split("```").next()
}

/// The files of the page.
fn shop(page: &str) -> Place {
    let place = Place::new();
    place.write("bolt.ngc", block(page, "ngc").expect("a program"));
    let lathe = place.ask(&["machine"]).stdout;
    let commands = block(page, "sh").expect("commands");
    assert!(commands.contains("tool_change = \"by-hand\""), "{commands}");
    place.write("lathe.toml", lathe.replacen("[machine]", "[machine]\ntool_change = \"by-hand\"", 1));
    for name in ["tools.tbl", "lathe.var"] {
        let line = commands.lines().find(|line| line.ends_with(&format!("> {name}"))).expect("a file");
        let text = line.split('\'').nth(1).expect("its text").replace("\\n", "\n");
        place.write(name, text);
    }
    place
}

/// Whether a state has these fields; of a list those at its beginning.
fn has(state: &Value, wanted: &Value) -> bool {
    match wanted {
        Value::Object(fields) => fields.iter().all(|(name, value)| has(&state[name], value)),
        Value::Array(all) => all.iter().enumerate().all(|(at, value)| has(&state[at], value)),
        Value::Number(number) => {
            // A corner is rounded within a hundredth.
            state.as_f64().zip(number.as_f64()).is_some_and(|(one, other)| (one - other).abs() < 0.0101)
        }
        other => state == other,
    }
}

/// Does what a line of the page says; `behind` is the cycle of the last answer.
fn does(panel: &Panel, line: &str, behind: &mut u64) {
    let mut line: Value = serde_json::from_str(line).unwrap_or_else(|error| panic!("{line}: {error}"));
    if let Some(wanted) = line.get("until") {
        return until(&format!("{wanted}"), || {
            let state = panel.state();
            let is_later = state["cycle"].as_u64().is_some_and(|cycle| cycle > *behind);
            (is_later || state["mode"] == "off") && has(&state, wanted)
        });
    }
    (line["id"], line["as"]) = (json!(1), json!("machinist"));
    let answer = panel.ask(&line);
    // With nothing running there is no cycle, and that of the next run begins at 0.
    *behind = answer["cycle"].as_u64().unwrap_or_else(|| panic!("{line}: {answer}"));
}

/// Commanded X and Z where those of the program are, X as a diameter.
fn of_program(state: &Value) -> [f64; 2] {
    let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"));
    let at = |axis: usize| number(&state["axes"][axis]["commanded_mm"]) - number(&state["origin_mm"][axis]);
    [2.0 * at(0), at(1)]
}

/// What is looked at behind a task, besides what its lines wait for.
fn is_done(task: usize, place: &Place, state: &Value, before: &Value) {
    let near = |[x, z]: [f64; 2], wanted: [f64; 2]| {
        assert!((x - wanted[0]).abs() < 1e-6 && (z - wanted[1]).abs() < 1e-6, "task {task}: X {x} Z {z}");
    };
    let tool = |number: u64, letter: &str| {
        let all = state["offsets"]["tool_offsets"].as_array().expect("tools");
        let tool = all.iter().find(|tool| tool["number"] == number).expect("the tool");
        tool[letter].as_f64().unwrap_or_default()
    };
    match task {
        3 => {
            let [x, z] = of_program(state);
            assert!((x - 30.0).abs() < 1e-6 && (3.0..5.0).contains(&z), "X {x} Z {z}");
        }
        4 => near(of_program(state), [30.0, of_program(before)[1] - 0.01]),
        6 => near(of_program(state), [21.4, 3.0]),
        7 => near(of_program(state), [21.36, 3.0]),
        8 => near(of_program(state), [21.36, 0.0]),
        9 => near(of_program(state), [21.36, 0.0]),
        10 => assert_eq!(state["offsets"]["systems"][0]["Z"], 0.2),
        11 => {
            let tools = fs::read_to_string(place.at("tools.tbl")).expect("a table");
            let wanted = "T1 P1 X0.02 Z0 D0.8 Q2 ; turning tool\nT3 P3 X-1.23 Z3.9 Q8 ; threading tool\n";
            assert_eq!(tools, wanted);
            let variables = fs::read_to_string(place.at("lathe.var")).expect("a file");
            assert!(variables.contains("5223\t0.2"), "{variables}");
        }
        17 => {
            let passes = state["passes"].as_array().expect("passes");
            let good = |pass: &Value| pass["end"] == "complete" && pass["helix_um"].as_f64() < Some(5.0);
            assert!(passes.len() == 5 && passes.iter().all(good), "{passes:?}");
            let slowest = passes.iter().filter_map(|pass| pass["rpm"][0].as_f64()).fold(800.0, f64::min);
            assert!((slowest - 640.0).abs() < 20.0, "{slowest}");
        }
        18 => assert!((tool(3, "X") + 1.255).abs() < 1e-9),
        20 => {
            let passes = state["passes"].as_array().expect("passes");
            assert!(passes.last().is_some_and(|pass| pass["end"] == "left"), "{passes:?}");
        }
        _ => {}
    }
}

#[test]
fn twenty_tasks_are_done_with_the_panel_alone() {
    let page = fs::read_to_string(project().join("docs/at-the-machine.md")).expect("the page");
    let place = shop(&page);
    let files = ["--machine", "lathe.toml", "--tools", "tools.tbl", "--parameters", "lathe.var"];
    let more = ["--pace", "10", "--trace", "none"];
    let panel = Panel::start(&place, &[&["panel", "bolt.ngc"], &files[..], &more].concat());
    let (mut behind, mut before) = (0, panel.state());
    let (tasks, _) = page.split_once("## What cannot be done").expect("a heading");
    let tasks: Vec<_> = tasks.split("\n### ").skip(1).collect();
    assert_eq!(tasks.len(), 20);
    for (number, task) in (1..).zip(tasks) {
        assert!(task.starts_with(&format!("{number}. ")), "{task}");
        let lines = block(task, "json").unwrap_or_else(|| panic!("task {number} has no requests"));
        lines.lines().for_each(|line| does(&panel, line, &mut behind));
        let state = panel.state();
        is_done(number, &place, &state, &before);
        before = state;
    }
    signal(panel.launcher.id(), "INT");
    assert_eq!(panel.ends().status, Some(0));
    let summary = |number: u32| {
        Summary::read(&place.at(&format!("runs/bolt-{number}/summary.json"))).expect("a summary")
    };
    assert_eq!(
        [1, 2, 3].map(|run| summary(run).outcome),
        [Outcome::Completed, Outcome::Completed, Outcome::Stopped]
    );
    is_repeated(&place, "runs/bolt-1", &summary(1));
}
