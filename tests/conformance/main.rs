//! The conformance programs of this folder, run by `pitchlock canon --format linuxcnc`: each means what the
//! reference says, each faulty one is refused at its line. `README.md` says where they come from and how two
//! outputs are compared.
#![allow(clippy::unwrap_used)]

mod calls;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use calls::{Call, first_difference, normalised};
use serde::Deserialize;

/// Programs whose output in the reference is a slip of it; `docs/conformance.md` gives the reasons. The other
/// programs marked so are harmless and print the same here.
const NOT_COPIED: [&str; 10] = [
    "quirk_break_then_do",
    "quirk_end_override",
    "quirk_g76_degression_below_one",
    "quirk_g76_plane",
    "quirk_g84_yz_plane",
    "quirk_msg_blank",
    "quirk_named_same_line",
    "quirk_peck_clearance_inch",
    "quirk_repeat_fraction",
    "quirk_tool_unload",
];

/// Moves, dwells and messages: all that is compared of M70 to M73.
const EFFECTS: [&str; 6] =
    ["STRAIGHT_TRAVERSE", "STRAIGHT_FEED", "ARC_FEED", "RIGID_TAP", "DWELL", "MESSAGE"];

/// What `args.json` says about a program.
#[derive(Default, Deserialize)]
struct About {
    #[serde(default)]
    block_delete: bool,
    compare: Option<String>,
    quirk: Option<String>,
}

#[derive(Deserialize)]
struct Arguments {
    programs: BTreeMap<String, About>,
}

/// What `errors.json` says about a faulty program.
#[derive(Deserialize)]
struct Fault {
    line: u32,
    error: String,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/conformance")
}

fn read(name: &str) -> String {
    fs::read_to_string(folder().join(name)).unwrap()
}

fn faults() -> BTreeMap<String, Fault> {
    serde_json::from_str(&read("errors.json")).unwrap()
}

/// The programs that are good, with what is known about them.
fn good() -> Vec<(String, About)> {
    let mut about = serde_json::from_str::<Arguments>(&read("args.json")).unwrap().programs;
    let faults = faults();
    let names = fs::read_dir(folder().join("programs")).unwrap().map(|entry| entry.unwrap().path());
    let names = names.filter(|path| path.extension().is_some_and(|ending| ending == "ngc"));
    let names = names.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned());
    let mut good: Vec<_> = names.filter(|name| !faults.contains_key(name)).collect();
    good.sort();
    assert!(good.len() > 90, "only {} programs were found", good.len());
    good.into_iter().map(|name| (name.clone(), about.remove(&name).unwrap_or_default())).collect()
}

fn run(name: &str, about: &About) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pitchlock"));
    command.args(["canon", "--format", "linuxcnc", "-t"]).arg(folder().join("tool.tbl"));
    command.arg("-i").arg(folder().join("machine.ini"));
    command.args(about.block_delete.then_some("-b"));
    command.arg(folder().join("programs").join(name).with_extension("ngc")).output().unwrap()
}

/// Why a good program does not mean what it should.
fn difference(name: &str, about: &About) -> Option<String> {
    let Output { status, stdout, stderr } = run(name, about);
    if !status.success() {
        return Some(format!("{status}: {}", String::from_utf8_lossy(&stderr)));
    }
    let only = about.compare.as_ref().map(|_| &EFFECTS[..]);
    let counts = |call: &Call| only.is_none_or(|only| only.contains(&call.name.as_str()));
    let calls = |text: &str| normalised(text).into_iter().filter(counts).collect::<Vec<_>>();
    let expected = calls(&read(&format!("programs/{name}.canon")));
    first_difference(&expected, &calls(&String::from_utf8_lossy(&stdout)))
}

#[test]
fn every_program_means_what_the_reference_says() {
    let programs = good().into_iter().filter(|(_, about)| about.quirk.is_none());
    let differences =
        programs.filter_map(|(name, about)| Some(format!("{name}: {}", difference(&name, &about)?)));
    let differences: Vec<_> = differences.collect();
    assert!(differences.is_empty(), "{} differ:\n{}", differences.len(), differences.join("\n"));
}

#[test]
fn every_faulty_program_is_refused_at_its_line() {
    let mut findings = Vec::new();
    for (name, Fault { line, error }) in faults() {
        let Output { status, stdout: _, stderr } = run(&name, &About::default());
        let stderr = String::from_utf8_lossy(&stderr);
        if status.code() != Some(2) || !stderr.contains(&format!("{name}.ngc:{line}:")) {
            findings.push(format!("{name}: line {line} ({error}), not {status}: {stderr}"));
        }
    }
    assert!(findings.is_empty(), "{} are wrong:\n{}", findings.len(), findings.join("\n"));
}

#[test]
fn slips_of_the_reference_are_not_copied() {
    let quirks = good().into_iter().filter(|(_, about)| about.quirk.is_some());
    let differing: Vec<_> =
        quirks.filter(|(name, about)| difference(name, about).is_some()).map(|(name, _)| name).collect();
    assert_eq!(differing, NOT_COPIED);
    let document = fs::read_to_string(folder().join("../../docs/conformance.md")).unwrap();
    for name in NOT_COPIED {
        assert!(
            document.contains(&format!("`{name}`")),
            "docs/conformance.md does not give the reason for {name}"
        );
    }
}

/// Line by line, so that the format itself is also held. The sign of a zero is that of a rounding error.
#[test]
fn the_output_is_that_of_the_reference_to_the_letter() {
    let mut findings = Vec::new();
    let programs = good().into_iter().filter(|(_, about)| about.quirk.is_none() && about.compare.is_none());
    for (name, about) in programs {
        let output = run(&name, &about).stdout;
        let (expected, output) = (read(&format!("programs/{name}.canon")), String::from_utf8_lossy(&output));
        let lines =
            |text: &str| text.lines().map(|line| line.replace("-0.0000", "0.0000")).collect::<Vec<_>>();
        let (expected, output) = (lines(&expected), lines(&output));
        if let Some(n) = (0..expected.len().max(output.len())).find(|n| expected.get(*n) != output.get(*n)) {
            findings.push(format!("{name}: {:?} is not {:?}", output.get(n), expected.get(n)));
        }
    }
    assert!(findings.is_empty(), "{} differ:\n{}", findings.len(), findings.join("\n"));
}
