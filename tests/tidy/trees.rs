//! What the crates are built from, as `cargo tree` lists it, without a registry.

use std::{collections::BTreeSet, path::PathBuf, process::Command};

use super::{CORES, files, none, project, read};

/// The most crates that a core is built from, itself included: its normal dependencies and theirs.
const MOST: [(&str, usize); 5] =
    [("regulator", 26), ("interpolator", 27), ("interpreter", 46), ("sim-plant", 26), ("tune", 39)];

/// The crates that a crate is built from, by name and version; those of the workspace by their names alone.
fn built_from(name: &str) -> BTreeSet<String> {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(["tree", "--offline", "--locked", "--edges", "normal", "--prefix", "none", "--format", "{p}"]);
    let out = cargo.args(["--package", name]).current_dir(project()).output().expect("cargo runs");
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "cargo tree of {name}: {said}");
    let text = String::from_utf8(out.stdout).expect("names of crates");
    let words = text.lines().map(|line| line.split(' ').take(2).collect::<Vec<_>>().join(" "));
    words.filter(|crate_name| !crate_name.is_empty()).collect()
}

/// A core is arithmetic over messages: whoever builds or tests one does not wait for a machine.
#[test]
fn a_core_is_built_from_few_crates() {
    assert_eq!(MOST.map(|(name, _)| name).iter().collect::<BTreeSet<_>>(), CORES.iter().collect());
    let mut findings = Vec::new();
    for (name, most) in MOST {
        let crates = built_from(name);
        assert!(crates.iter().any(|one| one.starts_with("protocol ")), "{name}: {crates:?}");
        if crates.len() > most {
            findings.push(format!("{name} is built from {} crates, not {most}: {crates:?}", crates.len()));
        }
        for outside in ["iceoryx2", "rustix", "clap"] {
            if crates.iter().any(|one| one.split(' ').next() == Some(outside)) {
                findings.push(format!("{name} is built from {outside}"));
            }
        }
    }
    none(&findings);
}

/// A core is a library: it is started, and talks to others, elsewhere.
#[test]
fn a_core_has_neither_main_nor_shell() {
    let of_core = |path: &PathBuf| {
        let mut parts = path.iter();
        parts.next().is_some_and(|folder| CORES.iter().any(|core| folder == *core))
            && parts.next().is_some_and(|folder| folder == "src")
            && path.file_name().is_some_and(|name| name == "main.rs" || name == "shell.rs")
    };
    none(
        &files(&[".rs"])
            .iter()
            .filter(|path| of_core(path))
            .map(|path| path.display().to_string())
            .collect::<Vec<_>>(),
    );
}

/// The pages that say who uses bincode name exactly the files which do.
#[test]
fn the_users_of_bincode_are_those_that_the_pages_name() {
    let uses = |path: &PathBuf| {
        let product = path.iter().any(|part| part == "src");
        product
            && read(path)
                .lines()
                .any(|line| !line.trim_start().starts_with("//") && line.contains("bincode::"))
    };
    let users: BTreeSet<String> =
        files(&[".rs"]).iter().filter(|path| uses(path)).map(|path| path.display().to_string()).collect();
    let words = |text: &str| {
        let words = text.split(|letter: char| letter.is_whitespace() || "`,;:()".contains(letter));
        words.filter(|word| word.ends_with(".rs")).map(str::to_owned).collect::<BTreeSet<String>>()
    };
    let contributing = read("CONTRIBUTING.md");
    let chapter = contributing.split("\n### ").find(|part| part.starts_with("bincode"));
    assert_eq!(words(chapter.expect("CONTRIBUTING.md has a chapter on bincode")), users, "CONTRIBUTING.md");
    let deny = read("deny.toml");
    let advisories = deny.split("\n[").find(|part| part.starts_with("advisories"));
    let files = users.iter().filter_map(|user| user.rsplit('/').next().map(str::to_owned)).collect();
    assert_eq!(words(advisories.expect("deny.toml has advisories")), files, "deny.toml");
}
