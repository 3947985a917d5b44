//! What the link is built of, and under which licences: those of `deny.toml`, which cargo-deny reads as well.

use std::{collections::BTreeSet, fs, path::Path, process::Command};

use serde_json::Value;

/// Licences that the file allows.
fn allowed() -> BTreeSet<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("deny.toml");
    let text = fs::read_to_string(path).expect("a file");
    let list = text.split("\nallow = [").nth(1).and_then(|rest| rest.split("\n]").next()).expect("a list");
    let name = |line: &str| line.trim().strip_prefix('"')?.split('"').next().map(str::to_owned);
    list.lines().filter_map(name).collect()
}

/// Whether one may choose: any of those between which is `OR` or `/`, all of those between which is `AND`.
fn may(licence: &str, allowed: &BTreeSet<String>) -> bool {
    let one = |name: &str| allowed.contains(name.trim().trim_matches(['(', ')']));
    licence.split(" AND ").all(|part| part.split(" OR ").flat_map(|part| part.split('/')).any(one))
}

#[test]
fn every_licence_is_one_that_is_allowed() {
    let allowed = allowed();
    assert!(
        may("GPL-3.0 OR MIT", &allowed) && !may("GPL-3.0", &allowed) && !may("MIT AND GPL-3.0", &allowed)
    );
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["metadata", "--format-version", "1", "--locked", "--offline", "--manifest-path"]);
    cargo.arg(manifest).args(["--filter-platform", "x86_64-unknown-linux-gnu"]);
    let output = cargo.output().expect("cargo");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let all: Value = serde_json::from_slice(&output.stdout).expect("a document");
    let built: BTreeSet<_> = all["resolve"]["nodes"]
        .as_array()
        .expect("nodes")
        .iter()
        .map(|node| node["id"].to_string())
        .collect();
    let (mut count, mut findings) = (0, Vec::new());
    for package in all["packages"].as_array().expect("packages") {
        if built.contains(&package["id"].to_string()) {
            count += 1;
            let licence = package["license"].as_str().unwrap_or("none");
            findings.extend((!may(licence, &allowed)).then(|| format!("{}: {licence}", package["name"])));
        }
    }
    assert!(count > 100 && findings.is_empty(), "of {count}: {findings:?}");
}
