//! The modules of every crate, and what each file needs of the others. In: the text of the sources. Out: for
//! each crate its files, and the file in which the item stands that a path names, through whatever passes it
//! on with `use`.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

use super::{
    files, read,
    tokens::{Import, imports, paths, tokens},
};

/// Imports of imports of imports: further than anything leads.
const FAR: usize = 8;

/// One source file of a crate, without what is compiled for tests alone.
pub(crate) struct Source {
    pub(crate) path: PathBuf,
    /// Names from the root of the crate to this module; none for the root.
    module: Vec<String>,
    pub(crate) tokens: Vec<String>,
    imports: Vec<Import>,
    /// Names of the items that stand in this file.
    defined: BTreeSet<String>,
}

impl Source {
    fn new(path: PathBuf, module: Vec<String>, text: &str) -> Source {
        let tokens = tokens(text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default());
        let begins = ["fn", "struct", "enum", "trait", "const", "static", "type", "union"];
        let named = tokens.windows(2).filter(|pair| begins.contains(&pair[0].as_str()));
        let defined = named.map(|pair| pair[1].clone()).collect();
        Source { path, module, imports: imports(&tokens), tokens, defined }
    }
}

/// The files of `src/` of one crate.
pub(crate) struct Sources {
    pub(crate) files: Vec<Source>,
    of_module: BTreeMap<Vec<String>, usize>,
}

/// Names from the root of the crate to the module in a file, whose path is relative to `src/`.
fn module(path: &Path) -> Vec<String> {
    let name = |part: &std::ffi::OsStr| part.to_string_lossy().into_owned();
    let mut names: Vec<String> = path.with_extension("").iter().map(name).collect();
    names.pop_if(|last| ["mod", "lib", "main"].contains(&last.as_str()));
    names
}

impl Sources {
    /// Every crate of the project that has a folder `src/`: its folder and its sources.
    pub(crate) fn all() -> BTreeMap<PathBuf, Sources> {
        let mut of_crate = BTreeMap::<PathBuf, Vec<Source>>::new();
        for path in files(&[".rs"]) {
            let parts: Vec<_> = path.iter().collect();
            let Some(src) = parts.iter().take(2).position(|part| *part == "src") else { continue };
            let module = module(&parts[src + 1..].iter().collect::<PathBuf>());
            if !module.iter().any(|name| name == "tests") {
                let text = read(&path);
                let folder = parts[..src].iter().collect();
                of_crate.entry(folder).or_default().push(Source::new(path, module, &text));
            }
        }
        of_crate.into_iter().map(|(folder, files)| (folder, Sources::new(files))).collect()
    }

    fn new(files: Vec<Source>) -> Sources {
        let of_module = files.iter().enumerate().map(|(index, file)| (file.module.clone(), index)).collect();
        Sources { files, of_module }
    }

    /// The sources of a crate that only a test has: paths relative to `src/`, and texts.
    pub(crate) fn of_texts(texts: &[(&str, &str)]) -> Sources {
        let source = |(path, text): &(&str, &str)| Source::new(path.into(), module(Path::new(path)), text);
        Sources::new(texts.iter().map(source).collect())
    }

    /// The file with the item that a path names when it stands in the file `from`; `None` if it names a
    /// module, or nothing of this crate.
    pub(crate) fn item(&self, from: usize, path: &[String]) -> Option<usize> {
        self.item_within(from, path, FAR)
    }

    fn item_within(&self, from: usize, path: &[String], steps: usize) -> Option<usize> {
        let mut at = from;
        for (index, name) in path.iter().enumerate() {
            let here = &self.files[at].module;
            let next = match name.as_str() {
                "crate" => Vec::new(),
                "self" => here.clone(),
                "super" => here[..here.len().checked_sub(1)?].to_vec(),
                _ => [here.as_slice(), std::slice::from_ref(name)].concat(),
            };
            match self.of_module.get(&next) {
                Some(next) => at = *next,
                None => return self.named(at, &path[index..], steps.checked_sub(1)?),
            }
        }
        None
    }

    /// A path that begins with no module: with an item of the file, or with something that the file imports.
    fn named(&self, at: usize, path: &[String], steps: usize) -> Option<usize> {
        let file = &self.files[at];
        let (name, rest) = path.split_first()?;
        if let Some(import) = file.imports.iter().find(|import| import.name == *name) {
            // A name that a `use` takes from outside under itself leads nowhere, not round and round.
            let outside = import.path.first() == Some(name) && import.path.len() == 1;
            let whole = [import.path.as_slice(), rest].concat();
            return if outside { None } else { self.item_within(at, &whole, steps) };
        }
        if file.defined.contains(name) {
            return Some(at);
        }
        let globs = file.imports.iter().filter(|import| import.name == "*");
        globs.filter_map(|glob| self.item_within(at, &[&glob.path, path].concat(), steps)).next()
    }

    /// The files that a file needs: those with the items which it names. What it only passes on with
    /// `pub use` is not among them.
    pub(crate) fn needs(&self, from: usize) -> BTreeSet<usize> {
        let file = &self.files[from];
        let imported = file.imports.iter().filter(|import| !import.public).map(|import| import.path.clone());
        let found = imported.chain(paths(&file.tokens)).filter_map(|path| self.item(from, &path));
        found.filter(|to| *to != from).collect()
    }
}

#[test]
fn items_are_found_through_what_passes_them_on() {
    let sources = Sources::of_texts(&[
        ("lib.rs", "mod a;\nmod b;\npub use a::Deep;\npub use b::*;"),
        ("a/mod.rs", "mod deep;\npub use deep::Deep;\npub const HERE: u32 = 1;"),
        ("a/deep.rs", "use super::HERE;\npub struct Deep;\nfn f() { crate::g() }"),
        ("b.rs", "use std::fmt;\nuse crate::{Deep, a};\npub fn g() -> fmt::Error { a::HERE; Deep::new() }"),
    ]);
    let names = |from: usize| {
        let needs = sources.needs(from).into_iter();
        needs.map(|to| sources.files[to].path.display().to_string()).collect::<Vec<_>>()
    };
    assert_eq!(names(0), Vec::<String>::new(), "what is passed on is not needed");
    assert_eq!(names(1), Vec::<String>::new());
    assert_eq!(names(2), ["a/mod.rs", "b.rs"]);
    assert_eq!(names(3), ["a/mod.rs", "a/deep.rs"]);
}
