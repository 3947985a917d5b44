//! The tutorial docs/first-hour.md: its commands are run in their order, and print what the page shows.

use std::{os::unix::fs::symlink, path::Path, process::Command};

use crate::shop::{Answer, Place, project};

/// A block of commands, and what the page shows of their answer.
struct Step {
    commands: String,
    shown: Option<String>,
}

fn page() -> String {
    std::fs::read_to_string(project().join("docs/first-hour.md")).expect("there is a tutorial")
}

/// The steps of the page: every block of `sh`, with the block of `text` behind it if there is one.
fn steps(page: &str) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    for block in page.split("\n```").skip(1).step_by(2) {
        let (kind, text) = block.split_once('\n').expect("a block of code has lines");
        let text = format!("{text}\n");
        match kind {
            "sh" => steps.push(Step { commands: text, shown: None }),
            "text" => {
                let step = steps.last_mut().filter(|step| step.shown.is_none());
                step.expect("an answer follows its commands").shown = Some(text);
            }
            _ => panic!("the tutorial has commands (sh) and their answers (text), not {kind:?}"),
        }
    }
    steps
}

/// What a shell answers in a place where the examples and the program are found: both streams, in their
/// order.
fn answer(place: &Place, commands: &str) -> Answer {
    let program = Path::new(env!("CARGO_BIN_EXE_pitchlock"));
    let folder = program.parent().expect("a program lies in a folder").display();
    let path = format!("{folder}:{}", std::env::var("PATH").expect("there is a PATH"));
    let mut shell = Command::new("sh");
    shell.current_dir(place.path()).env("TMPDIR", place.path()).env("PATH", path);
    shell.args(["-c", &format!("exec 2>&1\n{commands}")]).output().expect("a shell").into()
}

/// An answer without the time that the computer took.
fn lasting(answer: &str) -> String {
    let line = |line: &str| match line.split_once(" on the machine in ") {
        Some((before, _)) if line.starts_with("completed: ") => format!("{before} on the machine\n"),
        _ => format!("{line}\n"),
    };
    answer.lines().map(line).collect()
}

/// Compares an answer with what is shown. A line `…` stands for any number of lines.
fn compare(commands: &str, shown: &str, answer: &str) {
    let (shown, answer) = (lasting(shown), lasting(answer));
    let mut rest = answer.as_str();
    for (number, part) in shown.split("…\n").enumerate() {
        let at = if number == 0 { rest.starts_with(part).then_some(0) } else { rest.find(part) };
        let at = at.unwrap_or_else(|| panic!("{commands}shows\n{part}and prints\n{rest}"));
        rest = &rest[at + part.len()..];
    }
    assert!(rest.is_empty() || shown.ends_with("…\n"), "{commands}also prints\n{rest}");
}

#[test]
fn every_command_of_the_first_hour_prints_what_the_page_shows() {
    let place = Place::new();
    symlink(project().join("examples"), place.at("examples")).expect("a link");
    let steps = steps(&page());
    let (built, run): (Vec<_>, Vec<_>) =
        steps.into_iter().partition(|step| step.commands == "cargo install --locked --path .\n");
    assert_eq!(built.len(), 1, "all but the build is run");
    assert!(run.len() > 8 && run.iter().filter(|step| step.shown.is_some()).count() > 6, "steps are missing");
    let mut entered = "";
    for Step { commands, shown } in &run {
        let answer = answer(&place, &format!("{entered}{commands}"));
        match shown {
            Some(shown) => compare(commands, shown, &answer.stdout),
            None => assert_eq!(answer.status, Some(0), "{commands}{}", answer.stdout),
        }
        if commands.ends_with("cd first-hour\n") {
            entered = "cd first-hour\n";
        }
    }
}
