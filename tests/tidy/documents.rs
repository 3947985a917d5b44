//! The documents: what they link to and name exists, and what is shipped as an example can be read.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use machine::{Kinematics, Machine};
use sim_plant::Scenario;

use super::{files, none, project, read};

/// Folders with which a path of this project begins: those of its top level that hold something of it.
fn roots() -> BTreeSet<String> {
    let below = files(&[".rs", ".toml", ".md"]).into_iter().filter(|path| path.iter().count() > 1);
    let first = below.filter_map(|path| Some(format!("{}/", path.iter().next()?.to_str()?)));
    let roots: BTreeSet<String> = first.collect();
    for known in ["src/", "gcode/", "fuzz/", "docs/", "testing/"] {
        assert!(roots.contains(known), "{known} is missing in {roots:?}");
    }
    roots
}

fn documents() -> Vec<PathBuf> {
    let documents = files(&[".md"]);
    assert!(documents.iter().any(|path| path == Path::new("README.md")), "{documents:?}");
    documents
}

/// What stands between `open` and `close`, wherever they occur in this order on one line.
fn between<'a>(text: &'a str, open: &str, close: &str) -> Vec<&'a str> {
    let parts = text.lines().flat_map(|line| line.split(open).skip(1));
    parts.filter_map(|part| part.split_once(close).map(|(inside, _)| inside)).collect()
}

/// A document without its blocks of code.
fn prose(text: &str) -> String {
    text.split("\n```").step_by(2).collect::<Vec<_>>().join("\n")
}

#[test]
fn every_link_leads_somewhere() {
    let mut count = 0;
    let mut findings = Vec::new();
    for path in documents() {
        let text = read(&path);
        for link in between(&prose(&text), "](", ")") {
            let (target, anchor) = link.split_once('#').unwrap_or((link, ""));
            if target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            count += 1;
            let folder = path.parent().unwrap_or(Path::new(""));
            let there = if target.is_empty() { path.clone() } else { folder.join(target) };
            if !project().join(&there).exists() {
                findings.push(format!("{}: {link} does not exist", path.display()));
            } else if !anchor.is_empty() && !anchors(&read(&there)).contains(&anchor.to_owned()) {
                findings.push(format!("{}: {link} has no such heading", path.display()));
            }
        }
    }
    assert!(count > 5, "only {count} links were recognised");
    none(&findings);
}

/// A row that has come from another table has other cells than the heading of its own.
#[test]
fn rows_of_tables_have_the_cells_of_their_heading() {
    let mut count = 0;
    let mut findings = Vec::new();
    for path in documents() {
        let mut heading = None;
        for row in prose(&read(&path)).lines() {
            let cells = row.replace("\\|", "").matches('|').count();
            let width = *heading.get_or_insert(cells);
            if !row.starts_with('|') {
                heading = None;
            } else if cells == width {
                count += 1;
            } else {
                findings.push(format!("{}: {cells} cells, not {width}: {row}", path.display()));
            }
        }
    }
    assert!(count > 500, "only {count} rows were recognised");
    none(&findings);
}

/// Headings as anchors: lower case, hyphens for spaces, nothing else but letters and digits.
fn anchors(text: &str) -> Vec<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let anchor = |heading: &str| {
        let kept = heading.trim_start_matches('#').trim().to_lowercase().replace(' ', "-");
        kept.chars().filter(|letter| letter.is_alphanumeric() || "-_".contains(*letter)).collect()
    };
    headings.map(anchor).collect()
}

#[test]
fn every_path_that_is_named_exists() {
    let roots = roots();
    let mut count = 0;
    let mut findings = Vec::new();
    for path in documents() {
        for named in between_backticks(&prose(&read(&path))) {
            let is_path = roots.iter().any(|root| named.starts_with(root));
            if !is_path || named.contains([' ', '*', '<', '{', '…']) {
                continue;
            }
            count += 1;
            let file = named.split([':', '#']).next().unwrap_or(&named);
            if !project().join(file).exists() {
                findings.push(format!("{}: `{named}` does not exist", path.display()));
            }
        }
    }
    assert!(count > 10, "only {count} paths were recognised");
    none(&findings);
}

fn between_backticks(text: &str) -> Vec<String> {
    let inside = |line: &str| line.split('`').skip(1).step_by(2).map(str::to_owned).collect::<Vec<_>>();
    text.lines().flat_map(inside).collect()
}

/// Commands in blocks of code that name a file of the project name one that exists.
#[test]
fn every_command_that_is_shown_names_files_that_exist() {
    let mut findings = Vec::new();
    for path in documents() {
        for block in read(&path).split("\n```").skip(1).step_by(2) {
            let commands =
                block.lines().filter(|line| line.contains("pitchlock ") || line.contains("cargo "));
            for word in commands.flat_map(str::split_whitespace) {
                if word.starts_with("examples/") && !project().join(word).exists() {
                    findings.push(format!("{}: {word} does not exist", path.display()));
                }
            }
        }
    }
    none(&findings);
}

#[test]
fn every_example_can_be_read() {
    let of_folder = |folder: &str, ending: &str| {
        let found = files(&[ending]).into_iter().filter(|path| path.parent() == Some(Path::new(folder)));
        let found: Vec<PathBuf> = found.collect();
        assert!(!found.is_empty(), "{folder} holds no {ending}");
        found
    };
    for path in of_folder("examples/machines", ".toml") {
        let machine = Machine::from_toml(&read(&path)).unwrap_or_else(|error| panic!("{path:?}: {error}"));
        let plant = sim_plant::Plant::new(&machine, Scenario::none(), 1);
        assert!(plant.is_ok(), "{path:?}: {:?}", plant.err());
    }
    for path in of_folder("examples/scenarios", ".toml") {
        Scenario::from_toml(&read(&path)).unwrap_or_else(|error| panic!("{path:?}: {error}"));
    }
    let cell = |name: &str| read(Path::new("examples/bar-feeder").join(name));
    let machine = Machine::from_toml(&cell("lathe.toml")).unwrap_or_else(|error| panic!("{error}"));
    let answers = Scenario::from_toml(&cell("answers.toml")).unwrap_or_else(|error| panic!("{error}"));
    assert!(sim_plant::Plant::new(&machine, answers, 1).is_ok());
    let check = interpreter::check("pin.ngc", &cell("pin.ngc"), &machine);
    assert!(check.diagnostics.is_empty(), "{:?}", check.diagnostics);
    for (folder, kinematics) in [("examples", Kinematics::Lathe), ("examples/mill", Kinematics::Mill)] {
        let machine = Machine::from_toml(kinematics.example()).expect("the shipped machines are tested");
        for path in of_folder(folder, ".ngc") {
            let check = interpreter::check(&path.display().to_string(), &read(&path), &machine);
            assert!(check.diagnostics.is_empty(), "{path:?}: {:?}", check.diagnostics);
        }
    }
}

/// Every row of the tables that promise something names tests that there are.
#[test]
fn every_test_that_a_page_names_exists() {
    let unindented = |path| read(path).replace("\n    ", "\n");
    let sources: Vec<String> = files(&[".rs"]).iter().map(unindented).collect();
    let mut findings = Vec::new();
    for page in ["docs/trust.md", "docs/comparison.md"] {
        let text = read(Path::new(page));
        let rows = text.lines().filter(|line| line.starts_with('|') && !line.starts_with("|---"));
        let last = |row: &str| row.trim_end_matches('|').rsplit('|').next().unwrap_or_default().to_owned();
        let mut count = 0;
        for cell in rows.map(last) {
            let names = between_backticks(&cell);
            let is_empty = names.is_empty() && !["test", "–"].contains(&cell.trim());
            findings.extend(is_empty.then(|| format!("{page}: {cell} is not the name of a test")));
            for name in names {
                count += 1;
                let head = format!("#[test]\nfn {name}()");
                if !sources.iter().any(|source| source.contains(&head)) {
                    findings.push(format!("{page}: there is no test {name}"));
                }
            }
        }
        assert!(count > 4, "{page}: only {count} tests are named");
    }
    none(&findings);
}

/// A "no" of another control can be looked up: its column has a document for each of the tables.
#[test]
fn every_control_of_the_comparison_has_its_sources() {
    let text = read(Path::new("docs/comparison.md"));
    let (tables, sources) = text.split_once("## Where it was read").expect("a heading");
    let heads: Vec<&str> = tables.lines().filter(|line| line.starts_with("| | ")).collect();
    assert!(heads.len() == 3 && heads.iter().all(|head| *head == heads[0]), "{heads:?}");
    let controls =
        heads[0].split('|').map(str::trim).filter(|name| !["", "pitchlock", "test"].contains(name));
    let mut findings = Vec::new();
    for control in controls {
        let of =
            sources.split(&format!("* **{control}**")).nth(1).and_then(|rest| rest.split("\n* **").next());
        for kind in ["words", "in the thread", "besides"] {
            let told = of.and_then(|of| of.split(&format!("  * {kind}: ")).nth(1));
            let told = told.and_then(|told| told.split("\n  * ").next()).unwrap_or_default();
            let is_source = told.contains("http")
                || told.chars().any(|c| c.is_ascii_digit())
                || told.contains("contents");
            findings.extend((!is_source).then(|| format!("{control}, {kind}: no source")));
        }
    }
    none(&findings);
}

/// Whoever looks a code up in the page of faults finds it, those of the launcher too.
#[test]
fn the_codes_of_the_launcher_are_on_the_page_of_faults() {
    let text = read(Path::new("docs/ending.md"));
    let table = text.split("## Codes of the launcher").nth(1).expect("a heading");
    let codes: Vec<&str> = between(table, "| `", "` |");
    assert!(codes.contains(&"process-died") && codes.len() >= 6, "{codes:?}");
    let faults = read(Path::new("docs/faults.md"));
    let missing = codes.iter().filter(|code| !faults.contains(&format!("`{code}`")));
    none(&missing.map(|code| format!("docs/faults.md: {code} is missing")).collect::<Vec<_>>());
}

/// Whoever adds a bound in wall time says why it is one.
#[test]
fn every_bound_of_wall_time_is_in_the_table() {
    let table = read(Path::new("docs/ending.md"));
    let table = table.split("## Bounds of time").nth(1).and_then(|rest| rest.split("\n## ").next());
    let told = between_backticks(table.expect("a heading"));
    let (mut count, mut findings) = (0, Vec::new());
    for path in files(&[".rs"]) {
        if !["src", "process/src", "hosts/src"].iter().any(|place| path.starts_with(place)) {
            continue;
        }
        let text = read(&path);
        for line in text.lines() {
            let inline = line.contains("Duration::from_secs(") || line.contains("Duration::from_millis(");
            let constant = line.trim_start().trim_start_matches("pub(crate) ").trim_start_matches("pub ");
            let constant = constant.strip_prefix("const ").and_then(|rest| rest.split_once(": "));
            match constant {
                Some((name, kind)) if kind.starts_with("Duration") || name.ends_with("_S") => {
                    count += 1;
                    let known = told.iter().any(|told| told == name);
                    findings.extend((!known).then(|| format!("{}: {name} is not in it", path.display())));
                }
                _ if inline && !path.ends_with("wait.rs") => {
                    findings.push(format!("{}: a bound without a name: {line}", path.display()));
                }
                _ => {}
            }
        }
    }
    assert!(count > 12, "only {count} bounds were recognised");
    none(&findings);
}

/// ARCHITECTURE.md says of each module of the tests of the whole what it holds.
#[test]
fn every_module_of_tests_has_its_row() {
    let page = read(Path::new("ARCHITECTURE.md"));
    let mut findings = Vec::new();
    let mut count = 0;
    for path in files(&[".rs"]) {
        let of_the_whole = ["tests/command", "tests/machine"].iter().any(|folder| path.starts_with(folder));
        if !of_the_whole || path.ends_with("main.rs") || !read(&path).contains("#[test]") {
            continue;
        }
        count += 1;
        let module = path.file_stem().unwrap_or_default().to_string_lossy();
        let in_a_row = |line: &str| line.starts_with('|') && line.contains(&format!("`{module}`"));
        if !page.lines().any(in_a_row) {
            findings.push(format!("{}: ARCHITECTURE.md has no row for it", path.display()));
        }
    }
    assert!(count > 40, "only {count} modules were found");
    none(&findings);
}
