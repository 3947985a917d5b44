//! `docs/surfaces.md`: its jobs are right, its tables of refusals are what is said, its tables of keys are
//! the keys.
//!
//! A fence `toml mill` or `toml lathe` is a job file for the built-in machine of this kind, `ngc mill` a
//! program. Rows of a table behind `<!-- jobs: … -->` change the first job of that kind, line by line; the
//! second cell is part of what is said.

use std::collections::BTreeSet;

use interpreter::{Check, Severity, check, check_job};
use machine::{Kinematics, Machine};

use super::pages::{cells, page, quoted};

const PAGE: &str = "surfaces.md";

fn machine(kind: &str) -> Machine {
    let kinematics = if kind == "mill" { Kinematics::Mill } else { Kinematics::Lathe };
    Machine::from_toml(kinematics.example()).expect("a built-in machine")
}

fn said(check: &Check) -> String {
    check.diagnostics.iter().map(|diagnostic| diagnostic.render(false)).collect()
}

/// The fences of a language, with the machine they are for.
fn fences(language: &str) -> Vec<(String, String)> {
    let text = page(PAGE);
    let mut lines = text.lines();
    let mut found = Vec::new();
    while let Some(line) = lines.next() {
        let Some(words) = line.strip_prefix("```") else { continue };
        let inside: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
        if let Some(kind) = words.strip_prefix(language) {
            found.push((kind.trim().to_owned(), inside.join("\n") + "\n"));
        }
    }
    found
}

#[test]
fn every_job_of_the_page_is_right() {
    let (jobs, programs) = (fences("toml "), fences("ngc "));
    assert!(jobs.len() > 4 && programs.len() == 1);
    for (kind, text) in jobs {
        let check = check_job("job.toml", &text, &machine(&kind));
        assert!(check.diagnostics.is_empty() && check.jobs.len() == 1, "{text}{}", said(&check));
    }
    for (kind, text) in programs {
        let check = check("part.ngc", &text, &machine(&kind));
        assert!(check.diagnostics.is_empty() && check.jobs.len() == 1, "{text}{}", said(&check));
    }
}

/// A job with other lines: each takes the place of that with the same key.
fn changed(job: &str, lines: &str) -> String {
    let key = |line: &str| line.split('=').next().unwrap_or_default().trim().to_owned();
    let mut text: Vec<String> = job.lines().map(str::to_owned).collect();
    for line in lines.split('⏎').map(str::trim) {
        match text.iter_mut().find(|old| key(old) == key(line)) {
            Some(old) => line.clone_into(old),
            None => text.push(line.to_owned()),
        }
    }
    text.join("\n") + "\n"
}

/// The program of the page, with a line before its job, or in it.
fn program_with(line: &str) -> String {
    let (_, program) = fences("ngc ").remove(0);
    let at = program.find(";@").expect("there is a job");
    let (before, job) = program.split_at(at);
    format!("{before}{line}\n{job}")
}

#[test]
fn what_the_page_says_is_refused_is_refused_with_these_words() {
    let text = page(PAGE);
    let jobs = fences("toml mill");
    let first = |kind: &str| {
        let wanted = format!("kind = \"{kind}\"");
        jobs.iter()
            .find(|(_, job)| job.contains(&wanted))
            .map(|(_, job)| job.clone())
            .expect("a job of this kind")
    };
    let (mut kind, mut rows, mut wrong) = (None, 0, Vec::new());
    for line in text.lines() {
        if let Some(words) = line.strip_prefix("<!-- jobs: ") {
            kind = Some(words.trim_end_matches(" -->"));
        } else if line.starts_with('#') {
            kind = None;
        }
        let (Some(kind), Some(cells)) = (kind, cells(line)) else { continue };
        let [change, message] = cells.as_slice() else { panic!("{line}") };
        let Some(change) = quoted(change) else { continue };
        let check = match kind {
            "program" => check("part.ngc", &program_with(change), &machine("mill")),
            kind => check_job("job.toml", &changed(&first(kind), change), &machine("mill")),
        };
        let said = said(&check);
        // A program goes on behind its job, and may be wrong there, too.
        let alone = check.diagnostics.len() == 1 || kind == "program";
        let is_of_job =
            check.diagnostics.first().is_some_and(|one| one.code == "job" && one.severity == Severity::Error);
        if !(alone && is_of_job && said.contains(message.as_str())) {
            wrong.push(format!("{change}: not {message}, but\n{said}"));
        }
        rows += 1;
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(rows > 40, "{rows}");
}

#[test]
fn what_the_page_says_is_a_warning_is_one() {
    let paths = "path = { pattern = \"lines\", step_mm = 8 }";
    let (_, wave) = fences("toml mill").remove(0);
    let apart = check_job("job.toml", &changed(&wave, paths), &machine("mill"));
    let still = check("part.ngc", &program_with("M5"), &machine("mill"));
    let nearly = check("part.ngc", &program_with("; @ kind = \"surface\""), &machine("mill"));
    let said = [apart, still, nearly].map(|check| {
        assert!(check.diagnostics.iter().all(|one| one.severity == Severity::Warning), "{}", said(&check));
        said(&check)
    });
    let rows = super::pages::rows_below(PAGE, "## What is a warning");
    assert_eq!(rows.len(), 2 + said.len(), "a heading and a rule above them");
    for (row, said) in rows.iter().skip(2).zip(said) {
        let message = row.last().map_or("", |cell| cell.as_str());
        assert!(said.contains(message), "{message}: {said}");
    }
}

/// The keys in the first cells of the tables below a heading.
fn keys_below(heading: &str) -> BTreeSet<String> {
    let rows = super::pages::rows_below(PAGE, heading);
    let names = rows.iter().filter_map(|row| row.first()).flat_map(|cell| cell.split('`').skip(1).step_by(2));
    names.map(str::to_owned).collect()
}

/// The keys that a message names: those that could stand instead of one that is unknown.
fn expected(job: &str) -> BTreeSet<String> {
    let check = check_job("job.toml", job, &machine("mill"));
    let [one] = check.diagnostics.as_slice() else { panic!("{}", said(&check)) };
    let (_, list) = one.message.split_once("expected one of").unwrap_or_else(|| panic!("{}", one.message));
    list.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

#[test]
fn the_tables_of_keys_hold_all_keys() {
    let surface = "kind = \"surface\"\norigin_mm = [0, 0, 0]\nfeed_mm_min = 9\n";
    let tool = "z = \"x\"\nx = [0, 1]\ny = [0, 1]\npath = { pattern = \"rings\", step_mm = 1 }\n";
    let mut all = expected(&format!("{surface}nothing = 1\n"));
    all.extend(expected(&format!("{surface}{tool}tool = {{ nothing = 1 }}\n")));
    all.extend(["pattern", "along", "step_mm", "scallop_mm", "one_way", "t"].map(str::to_owned));
    assert_eq!(keys_below("## Surface"), all);

    let contour = expected("kind = \"contour\"\norigin_mm = [0, 0, 0]\nfeed_mm_min = 9\nnothing = 1\n");
    assert!(contour.is_subset(&keys_below("## Contour")), "{contour:?}");

    let check = check_job(
        "job.toml",
        "kind = \"surface\"\nfeed_mm_min = 9\nnothing = 1\norigin_mm = [0, 0, 0]\n",
        &machine("mill"),
    );
    let help = &check.diagnostics[0].help;
    let list = help.strip_prefix("every job has ").and_then(|help| help.split(';').next()).expect("the keys");
    let common: BTreeSet<String> = list.split(", ").map(str::to_owned).collect();
    assert!(common.is_subset(&keys_below("## Keys of every job")), "{common:?}");
}
