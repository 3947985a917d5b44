//! The sources as a house: no circle of many files, no type whose `impl` is spread over several rooms, one
//! convention for module files.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

use super::{files, modules::Sources, none, read};

/// The most files that may need each other in a circle.
const CIRCLE: usize = 12;

/// Files that need each other, directly or through others, as groups of at least two.
fn circles(sources: &Sources) -> Vec<Vec<PathBuf>> {
    let needs: Vec<BTreeSet<usize>> = (0..sources.files.len()).map(|from| sources.needs(from)).collect();
    let reach = |from: usize| {
        let (mut reached, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(at) = open.pop() {
            open.extend(needs[at].iter().copied().filter(|to| reached.insert(*to)));
        }
        reached
    };
    let reached: Vec<BTreeSet<usize>> = (0..needs.len()).map(reach).collect();
    let circle = |from: usize| {
        let back = reached[from].iter().copied().filter(|to| reached[*to].contains(&from));
        back.collect::<BTreeSet<usize>>()
    };
    let all: BTreeSet<BTreeSet<usize>> = (0..needs.len()).map(circle).collect();
    let paths = |circle: BTreeSet<usize>| circle.iter().map(|at| sources.files[*at].path.clone()).collect();
    all.into_iter().filter(|circle| circle.len() > 1).map(paths).collect()
}

/// Circles that ARCHITECTURE.md names with a reason: one of the files, and how many they are. Rows of the
/// table under the heading `Circles of files`: file, number, reason.
fn named_circles() -> BTreeMap<PathBuf, usize> {
    let page = read("ARCHITECTURE.md");
    let part = page.split("\n### ").find_map(|part| part.strip_prefix("Circles of files\n"));
    let rows = part.unwrap_or_default().lines().filter_map(|line| line.strip_prefix("| `"));
    rows.map(|row| {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        assert!(cells.len() > 3 && !cells[2].is_empty(), "a circle has a file, a number and a reason: {row}");
        let number = cells[1].parse().unwrap_or_else(|_| panic!("the number of files in {row}"));
        (PathBuf::from(cells[0].trim_end_matches('`')), number)
    })
    .collect()
}

#[test]
fn no_circle_of_files_is_large_unless_it_has_its_reason() {
    let mut named = named_circles();
    let mut findings = Vec::new();
    let mut seen = 0;
    for sources in Sources::all().values() {
        seen += sources.files.len();
        for circle in circles(sources).into_iter().filter(|circle| circle.len() > CIRCLE) {
            let reason = circle.iter().find_map(|path| named.remove(path));
            if reason != Some(circle.len()) {
                let told = reason.map_or("it has no reason".into(), |told| format!("the page says {told}"));
                findings.push(format!("a circle of {} files, {told}: {circle:?}", circle.len()));
            }
        }
    }
    findings.extend(named.keys().map(|path| format!("{} is in no large circle any more", path.display())));
    assert!(seen > 150, "only {seen} files were read");
    none(&findings);
}

#[test]
fn a_circle_is_found_through_what_passes_names_on() {
    let sources = Sources::of_texts(&[
        ("lib.rs", "mod a;\nmod b;\nmod c;\npub use a::A;\npub use b::B;\npub use c::C;"),
        ("a.rs", "use crate::B;\npub struct A(B);"),
        ("b.rs", "pub struct B;\nimpl B { fn c(&self) -> super::C { todo() } }"),
        ("c.rs", "use super::a;\npub struct C;\nfn a() -> a::A {}"),
    ]);
    assert_eq!(circles(&sources), [["a.rs", "b.rs", "c.rs"].map(PathBuf::from)]);
}

/// The names of types that have an `impl` of their own here: not one of a trait.
fn implemented(tokens: &[String]) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    for at in (0..tokens.len()).filter(|at| tokens[*at] == "impl") {
        let item = at == 0 || ["}", ";", "{", "]", "unsafe"].contains(&tokens[at - 1].as_str());
        let head = tokens[at + 1..].iter().take_while(|token| *token != "{").map(String::as_str);
        let head: Vec<&str> = head.collect();
        // `for<'a>` of a bound is not the `for` of a trait.
        let of_trait = head.windows(2).any(|pair| pair[0] == "for" && pair[1] != "<");
        if item && !of_trait {
            found.push(name(&head));
        }
    }
    found
}

/// The path of a type behind `impl`: after the parameters, up to the arguments.
fn name(head: &[&str]) -> Vec<String> {
    let mut depth = 0_i32;
    let mut path = Vec::new();
    for (at, token) in head.iter().enumerate() {
        match *token {
            "<" => depth += 1,
            // The `>` of `->` closes nothing.
            ">" if at > 0 && head[at - 1] != "-" => depth -= 1,
            "::" => {}
            "where" => break,
            word if depth == 0 && word.starts_with(|letter: char| letter.is_alphabetic()) => {
                path.push(word.to_owned());
            }
            _ => {}
        }
    }
    path
}

/// Types whose `impl` lies neither in one file nor within the folder in which they are defined.
fn spread(sources: &Sources, root: &Path) -> Vec<String> {
    let mut of_type = BTreeMap::<(usize, String), BTreeSet<usize>>::new();
    for (at, file) in sources.files.iter().enumerate() {
        for path in implemented(&file.tokens) {
            if let (Some(home), Some(name)) = (sources.item(at, &path), path.last()) {
                of_type.entry((home, name.clone())).or_default().insert(at);
            }
        }
    }
    let told = of_type.into_iter().filter_map(|((home, name), impls)| {
        let path = |at: &usize| sources.files[*at].path.as_path();
        let folder = path(&home).parent().unwrap_or(Path::new(""));
        // The folder of a type in `lib.rs` is that of the crate, which is then all about it.
        let own = folder != root || path(&home).ends_with("lib.rs");
        let at_home = own && impls.iter().all(|at| path(at).starts_with(folder));
        let places: Vec<String> = impls.iter().map(|at| path(at).display().to_string()).collect();
        (impls.len() > 1 && !at_home).then(|| format!("impl {name} lies in {}", places.join(", ")))
    });
    told.collect()
}

#[test]
fn a_type_has_its_impl_in_one_file_or_in_its_own_folder() {
    let all = Sources::all();
    none(&all.iter().flat_map(|(folder, sources)| spread(sources, &folder.join("src"))).collect::<Vec<_>>());
}

#[test]
fn an_impl_that_is_spread_is_found() {
    let sources = Sources::of_texts(&[
        ("lib.rs", "mod a;\nmod b;\nmod own;\npub struct Whole;\nimpl Whole {}"),
        ("a.rs", "pub struct T<X>(X);\nimpl<X: Fn() -> u8> T<X> {}\nimpl Copy for T<u8> {}"),
        (
            "b.rs",
            "use crate::a::T;\nimpl<X> T<X> where X: Copy {}\nimpl super::Whole {}\nfn f() -> impl Fn() {}",
        ),
        ("own/mod.rs", "mod part;\npub struct U;\nimpl U {}"),
        ("own/part.rs", "use super::U;\nimpl U {}"),
    ]);
    assert_eq!(spread(&sources, Path::new("")), ["impl T lies in a.rs, b.rs"]);
}

/// A module with modules of its own is `x/mod.rs`, never `x.rs` beside `x/`.
#[test]
fn a_folder_has_its_module_inside() {
    let beside = files(&[".rs"]).into_iter().filter(|path| {
        let folder = path.with_extension("");
        let root = ["lib", "main"].iter().any(|root| folder.file_name().is_some_and(|name| name == *root));
        !root && super::project().join(folder).is_dir()
    });
    none(&beside.map(|path| format!("{} stands beside its folder", path.display())).collect::<Vec<_>>());
}
