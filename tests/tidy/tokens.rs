//! Rust as far as tidy needs it. In: the text of a source. Out: its words and signs without comments and
//! literals, its `use` declarations one name at a time, the paths in the rest.

use std::iter::Peekable;

/// One name that a `use` declaration brings into a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Import {
    /// The name in the file; `*` for all that is there.
    pub(crate) name: String,
    /// The path as it is written, from the first name to the last; without the `*`.
    pub(crate) path: Vec<String>,
    /// Whether the file passes it on.
    pub(crate) public: bool,
}

/// Words and signs, one by one; `::` is one sign.
pub(crate) fn tokens(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = skipped(rest);
        if length > 0 {
            rest = &rest[length..];
        } else if is_word(first) {
            let end = rest.find(|letter| !is_word(letter)).unwrap_or(rest.len());
            found.push(rest[..end].to_owned());
            rest = &rest[end..];
        } else {
            let end = if rest.starts_with("::") { 2 } else { first.len_utf8() };
            found.extend((!first.is_whitespace()).then(|| rest[..end].to_owned()));
            rest = &rest[end..];
        }
    }
    found
}

fn is_word(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

/// Bytes of the comment or literal with which a text begins; 0 if there is none.
fn skipped(text: &str) -> usize {
    let through =
        |end: &str, from: usize| text[from..].find(end).map_or(text.len(), |at| from + at + end.len());
    if text.starts_with("//") {
        return through("\n", 2);
    }
    if text.starts_with("/*") {
        return through("*/", 2);
    }
    let raw = text.trim_start_matches('b').strip_prefix('r').map(|rest| rest.trim_start_matches('#'));
    if let Some(inside) = raw.filter(|inside| inside.starts_with('"')) {
        let head = text.len() - inside.len();
        let hashes = text[..head].matches('#').count();
        return through(&format!("\"{}", "#".repeat(hashes)), head + 1);
    }
    if text.starts_with('"') || text.starts_with("b\"") {
        return string(text);
    }
    character(text)
}

/// Bytes of a string with its quotes.
fn string(text: &str) -> usize {
    let begins = text.find('"').map_or(0, |at| at + 1);
    let mut escaped = false;
    for (at, letter) in text[begins..].char_indices() {
        match letter {
            '"' if !escaped => return begins + at + 1,
            '\\' => escaped = !escaped,
            _ => escaped = false,
        }
    }
    text.len()
}

/// Bytes of a character between its quotes; 0 if the quote begins a lifetime.
fn character(text: &str) -> usize {
    let Some(inside) = text.strip_prefix('\'') else { return 0 };
    let mut letters = inside.char_indices();
    match letters.next() {
        Some((_, '\\')) => inside[2..].find('\'').map_or(0, |at| 2 + at + 2),
        Some(_) => letters.next().filter(|(_, letter)| *letter == '\'').map_or(0, |(at, _)| at + 2),
        None => 0,
    }
}

/// Where each `use` declaration begins and ends, semicolon included.
fn declarations(tokens: &[String]) -> Vec<(usize, usize)> {
    let begins = |at: &usize| {
        // Not the bound `use<'a>` of an opaque type.
        tokens[*at] == "use" && tokens.get(at + 1).is_some_and(|next| next != "<")
    };
    let end = |from: usize| tokens[from..].iter().position(|token| token == ";").map(|at| from + at + 1);
    (0..tokens.len()).filter(begins).filter_map(|from| Some((from, end(from)?))).collect()
}

/// The names that `use` declarations bring.
pub(crate) fn imports(tokens: &[String]) -> Vec<Import> {
    let mut found = Vec::new();
    for (from, end) in declarations(tokens) {
        let public = from > 0 && (tokens[from - 1] == "pub" || tokens[from - 1] == ")");
        let mut tree = tokens[from + 1..end - 1].iter().map(String::as_str).peekable();
        branch(&mut tree, &[], public, &mut found);
    }
    found
}

/// One branch of a tree of names, with the comma behind it.
fn branch<'a>(
    tree: &mut Peekable<impl Iterator<Item = &'a str>>,
    stem: &[String],
    public: bool,
    found: &mut Vec<Import>,
) {
    let mut path = stem.to_vec();
    while let Some(token) = tree.next() {
        match token {
            "{" => {
                while tree.peek().is_some_and(|next| *next != "}") {
                    branch(tree, &path, public, found);
                }
                tree.next();
            }
            "*" => found.push(Import { name: "*".into(), path: path.clone(), public }),
            name => {
                path.extend((name != "self" || path.is_empty()).then(|| name.to_owned()));
                if tree.next_if_eq(&"::").is_some() {
                    continue;
                }
                let renamed = tree.next_if_eq(&"as").and_then(|_| tree.next()).map(str::to_owned);
                let name = renamed.or_else(|| path.last().cloned()).unwrap_or_default();
                found.push(Import { name, path: path.clone(), public });
            }
        }
        tree.next_if_eq(&",");
        return;
    }
}

/// The paths of at least two names that stand outside of `use` declarations.
pub(crate) fn paths(tokens: &[String]) -> Vec<Vec<String>> {
    let mut outside = Vec::new();
    let mut from = 0;
    for (begin, end) in declarations(tokens) {
        outside.extend(from..begin);
        from = end;
    }
    outside.extend(from..tokens.len());
    let name = |at: usize| tokens.get(at).is_some_and(|token| token.starts_with(is_word));
    let mut found = Vec::new();
    let mut next = 0;
    for at in outside {
        if at < next || !name(at) || (at > 0 && ["::", "."].contains(&tokens[at - 1].as_str())) {
            continue;
        }
        let mut path = vec![tokens[at].clone()];
        next = at + 1;
        while tokens.get(next).is_some_and(|token| token == "::") && name(next + 1) {
            path.push(tokens[next + 1].clone());
            next += 2;
        }
        found.extend((path.len() > 1).then_some(path));
    }
    found
}

#[test]
fn comments_and_literals_are_no_words() {
    let text = "a // b\n\"c \\\" d\" r#\"e \" f\"# 'g' '\\'' b\"h\" /* i */ &'j k::l";
    assert_eq!(tokens(text), ["a", "&", "'", "j", "k", "::", "l"]);
}

#[test]
fn every_name_of_a_use_declaration_has_its_path() {
    let text =
        "use a::{self, b as c, d::{e, f::*}};\npub(crate) use super::g;\nfn x() -> impl y + use<'z> {}";
    let import = |name: &str, path: &str, public| Import {
        name: name.into(),
        path: path.split("::").map(str::to_owned).collect(),
        public,
    };
    let want = [
        import("a", "a", false),
        import("c", "a::b", false),
        import("e", "a::d::e", false),
        import("*", "a::d::f", false),
        import("g", "super::g", true),
    ];
    assert_eq!(imports(&tokens(text)), want);
}

#[test]
fn paths_are_those_outside_of_use_declarations() {
    let text = "use a::b;\nfn f(x: c::D<e::F>) { g::<H>(x.i); crate::j::k() }";
    let found: Vec<String> = paths(&tokens(text)).iter().map(|path| path.join("::")).collect();
    assert_eq!(found, ["c::D", "e::F", "crate::j::k"]);
}
