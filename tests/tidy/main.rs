//! What a machine can check of how the code reads, how the crates depend on each other, and whether the
//! documents are right.

mod comments;
mod documents;
mod figures;
mod modules;
mod rooms;
#[path = "../shop/mod.rs"]
mod shop;
mod sources;
mod tokens;
mod trees;

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

/// The crates of the workspace but the root package, and what of the others each may name.
const CRATES: [(&str, &[&str]); 26] = [
    ("intake", &[]),
    ("motion", &[]),
    ("adviser", &[]),
    ("metrology", &[]),
    ("gauge", &["metrology"]),
    ("recipe", &["metrology", "gauge"]),
    ("shape", &["motion"]),
    ("gcode", &["intake"]),
    ("protocol", &["intake", "motion", "shape"]),
    ("machine", &["protocol", "motion"]),
    ("route", &["machine", "protocol", "motion", "shape"]),
    ("interpreter", &["intake", "gauge", "gcode", "route", "machine", "protocol", "motion", "shape"]),
    ("interpolator", &["route", "machine", "protocol", "motion", "shape"]),
    ("regulator", &["machine", "protocol", "motion"]),
    ("sim-plant", &["machine", "protocol", "motion"]),
    ("tune", &["machine", "protocol", "motion"]),
    (
        "rig",
        &[
            "intake",
            "route",
            "machine",
            "protocol",
            "motion",
            "shape",
            "interpreter",
            "interpolator",
            "regulator",
            "sim-plant",
            "tune",
            "gauge",
        ],
    ),
    ("soak", &["machine", "protocol", "motion", "interpreter", "sim-plant", "rig", "testing"]),
    ("report", &["intake", "gauge", "gcode", "protocol", "rig"]),
    (
        "experiment",
        &[
            "adviser",
            "interpreter",
            "machine",
            "motion",
            "protocol",
            "regulator",
            "report",
            "rig",
            "shape",
            "sim-plant",
            "tune",
        ],
    ),
    ("campaign", &["intake", "machine"]),
    ("panel", &["protocol"]),
    ("terminal", &[]),
    ("lsp", &["intake", "gcode", "interpreter", "machine"]),
    ("process", &["intake", "machine", "protocol", "interpreter", "interpolator", "regulator", "sim-plant"]),
    ("testing", &[]),
];

/// What only one crate may name: the channels and clocks of the operating system.
const PROCESS_ONLY: [(&str, &str); 2] = [("iceoryx2", "process"), ("rustix", "process")];

/// Pure functions of their input.
const CORES: [&str; 5] = ["interpreter", "interpolator", "regulator", "sim-plant", "tune"];

fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: impl AsRef<Path>) -> String {
    let path = project().join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Files below the project with one of these endings, relative to it; not what was built, run or hidden.
fn files(endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![project().to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("the project can be read").flatten() {
            let (path, name) = (entry.path(), entry.file_name());
            let name = name.to_string_lossy();
            if name.starts_with('.') || ["target", "runs"].contains(&name.as_ref()) {
                continue;
            }
            if path.is_dir() {
                folders.push(path);
            } else if endings.iter().any(|ending| name.ends_with(ending)) {
                found.push(path.strip_prefix(project()).expect("it lies below").to_path_buf());
            }
        }
    }
    found.sort();
    found
}

/// Fails with every finding, one a line.
fn none(findings: &[String]) {
    assert!(findings.is_empty(), "\n{}", findings.join("\n"));
}

fn manifest(folder: &str) -> toml::Table {
    read(Path::new(folder).join("Cargo.toml")).parse().expect("cargo has also read it")
}

/// Names in a section of a manifest.
fn names(manifest: &toml::Table, section: &str) -> BTreeSet<String> {
    let table = manifest.get(section).and_then(toml::Value::as_table);
    table.map(|table| table.keys().cloned().collect()).unwrap_or_default()
}

#[test]
fn crates_depend_in_one_direction() {
    let ours: BTreeSet<String> = CRATES.iter().map(|(name, _)| (*name).to_owned()).collect();
    let mut findings = Vec::new();
    for (name, allowed) in CRATES {
        let manifest = manifest(name);
        for other in names(&manifest, "dependencies").intersection(&ours) {
            if !allowed.contains(&other.as_str()) {
                findings.push(format!("{name} must not depend on {other}"));
            }
        }
        let all = ["dependencies", "dev-dependencies", "build-dependencies"];
        let everything: BTreeSet<String> = all.iter().flat_map(|section| names(&manifest, section)).collect();
        for (outside, inside) in PROCESS_ONLY {
            if everything.contains(outside) && name != inside {
                findings.push(format!("{name}: only {inside} names {outside}"));
            }
        }
        if CORES.contains(&name) && everything.contains("clap") {
            findings.push(format!("{name} is a core: it has no command line"));
        }
        if names(&manifest, "dependencies").contains("testing") && name != "soak" {
            findings.push(format!("{name}: only tests, benches and soak depend on testing"));
        }
        if everything.contains("pitchlock") {
            findings.push(format!("{name} must not depend on the program that starts it"));
        }
    }
    let members = manifest("");
    let members = members["workspace"]["members"].as_array().expect("a list of folders");
    assert_eq!(members.len(), CRATES.len(), "a new crate needs its place in this test");
    for section in ["dependencies", "dev-dependencies"] {
        for (outside, inside) in PROCESS_ONLY {
            if names(&manifest(""), section).contains(outside) {
                findings.push(format!("pitchlock: only {inside} names {outside}"));
            }
        }
    }
    for (outside, inside) in PROCESS_ONLY {
        assert!(
            names(&manifest(inside), "dependencies").contains(outside),
            "{inside} is there for {outside}"
        );
    }
    none(&findings);
}

/// Nothing is named that no crate uses, and every crate from outside is accounted for in CONTRIBUTING.md.
#[test]
fn every_dependency_has_its_reason() {
    let ours: BTreeSet<String> = CRATES.iter().map(|(name, _)| (*name).to_owned()).collect();
    let contributing = read("CONTRIBUTING.md");
    let rows = contributing.lines().filter_map(|line| line.strip_prefix('|')?.split('|').next());
    let table: BTreeSet<&str> = rows.map(|cell| cell.trim().trim_matches('`')).collect();
    let mut used = BTreeSet::new();
    for folder in CRATES.map(|(name, _)| name).iter().chain(&[""]) {
        for section in ["dependencies", "dev-dependencies", "build-dependencies"] {
            used.extend(names(&manifest(folder), section));
        }
    }
    let missing = used.difference(&ours).filter(|name| !table.contains(name.as_str()));
    none(&missing.map(|name| format!("CONTRIBUTING.md has no row for {name}")).collect::<Vec<_>>());
}

#[test]
fn every_file_of_the_workspace_is_seen() {
    let sources = files(&[".rs"]);
    assert!(sources.len() > 150, "{sources:?}");
    for path in ["src/main.rs", "motion/src/lib.rs", "tests/tidy/main.rs", "process/src/ipc/port.rs"] {
        assert!(sources.iter().any(|source| source == Path::new(path)), "{path}");
    }
}

/// A number that overflows ends its process in a release as well: it moves no axis to somewhere else.
#[test]
fn overflow_is_looked_for_in_releases() {
    let manifest: toml::Table = toml::from_str(&read(Path::new("Cargo.toml"))).expect("it is a manifest");
    let checks =
        |path: &[&str]| path.iter().try_fold(&manifest["profile"], |table, key| table.get(key)).cloned();
    assert_eq!(checks(&["release", "overflow-checks"]), Some(true.into()));
    let profiles = manifest["profile"].as_table().expect("profiles");
    for (name, profile) in profiles.iter().filter(|(name, _)| *name != "release") {
        assert_ne!(profile.get("overflow-checks"), Some(&false.into()), "{name}");
    }
}
