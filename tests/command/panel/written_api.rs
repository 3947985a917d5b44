//! docs/panel.md beside the panel: its examples run, its tables are those of the sources.

use std::process::{Command, Stdio};

use super::client::Panel;
use crate::shop::{Answer, Place, example, project};

fn page() -> String {
    std::fs::read_to_string(project().join("docs/panel.md")).expect("the page")
}

/// Whether a program is there; if not, what is left out is said.
fn is_there(program: &str) -> bool {
    let found = Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    let there = found.is_ok_and(|status| status.success());
    if !there {
        eprintln!("left out: the examples of docs/panel.md for {program}, which is not on this computer");
    }
    there
}

#[test]
fn the_examples_of_the_page_do_what_they_say() {
    let page = page();
    for (language, program) in [("sh", "curl"), ("python", "python3")] {
        let fence = format!("```{language}\n");
        let blocks: Vec<_> = page.split(&fence).skip(1).filter_map(|rest| rest.split("```").next()).collect();
        let blocks: Vec<_> =
            blocks.into_iter().filter(|block| block.contains("$URL") || block.contains("\"URL\"")).collect();
        assert!(!blocks.is_empty(), "{language}");
        if !is_there(program) {
            continue;
        }
        for block in blocks {
            let place = Place::new();
            let run =
                ["run", &example("m20x2").display().to_string(), "--panel", "--pace", "1"].map(str::to_owned);
            let panel = Panel::start(&place, &run.each_ref().map(String::as_str));
            let mut command = match language {
                "sh" => Command::new("sh"),
                _ => Command::new("python3"),
            };
            let url = format!("http://{}", panel.address);
            command.args(["-c", block]).env("URL", url).env("TOKEN", &panel.token);
            let answer = Answer::from(command.output().expect("it starts"));
            assert_eq!(answer.status, Some(0), "{block}\n{}\n{}", answer.stdout, answer.stderr);
            assert!(answer.stdout.contains("cycle"), "{block}\n{}", answer.stdout);
            assert_eq!(panel.state()["knobs"]["feed_pct"], 60.0, "{block}\n{}", answer.stdout);
        }
    }
}

#[test]
fn the_page_has_every_word_every_field_and_every_refusal() {
    let page = page();
    for (word, _) in panel::DOES {
        assert!(page.contains(&format!("`{word}`")), "{word}");
    }
    let place = Place::new();
    // Before the first run every field is there, too.
    let before = Panel::start(&place, &["panel", "--trace", "none"]).state();
    let panel = Panel::start(&place, &["run", &example("m20x2").display().to_string(), "--panel"]);
    crate::shop::until("something is seen", || panel.state()["knobs"].is_object());
    let state = panel.state();
    let names = |state: &serde_json::Value| {
        state.as_object().expect("an object").keys().cloned().collect::<std::collections::BTreeSet<_>>()
    };
    assert_eq!(names(&before), names(&state));
    for (field, value) in state.as_object().expect("an object") {
        assert!(page.contains(&format!("`{field}`")), "{field}");
        let of_row = value.as_array().and_then(|rows| rows.first()).unwrap_or(value);
        for part in of_row.as_object().into_iter().flat_map(|fields| fields.keys()) {
            assert!(page.contains(&format!("`{part}`")), "{field}: {part}");
        }
    }
    for code in ["bad-request", "bad-value", "unknown", "no-seat", "not-your-seat", "not-running"] {
        assert!(page.contains(&format!("`{code}`")), "{code}");
    }
    for code in ["too-many", "no-answer"] {
        assert!(page.contains(&format!("`{code}`")), "{code}");
    }
}

/// Every test that holds a row of the table is there, and every test of hostile requests has its row.
#[test]
fn every_hostile_request_has_its_row() {
    let page = page();
    let tests = include_str!("hostile.rs");
    let names: Vec<_> =
        tests.split("#[test]\nfn ").skip(1).filter_map(|rest| rest.split('(').next()).collect();
    assert!(names.len() >= 13, "{}", names.len());
    for name in names {
        assert!(page.contains(&format!("| `{name}` |")), "{name}");
    }
}
