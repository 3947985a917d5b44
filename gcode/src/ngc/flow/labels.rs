//! The labels of O words. In: a number or a name. Out: a small number that stands for it, so that nothing has
//! to compare texts again; and where the subroutine of that label is defined.

use std::collections::BTreeMap;

use crate::text::Mark;

/// A label that was met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Label(usize);

/// How a subroutine is written, and so how it is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Style {
    /// `o100 sub` to `o100 endsub`, by `o100 call`.
    Sub,
    /// `o100` to M99, by M98 P100.
    Program,
}

/// Where a subroutine is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Definition {
    pub(super) style: Style,
    pub(super) file: usize,
    /// Number of its first line.
    pub(super) line: u32,
    /// The line after that.
    pub(super) body: Mark,
}

#[derive(Debug)]
struct Entry {
    /// As in `o100` or `o<name>`.
    text: Box<str>,
    definition: Option<Definition>,
    /// Its subroutine was looked through after an error.
    looked: bool,
}

/// All labels of a program and its subroutine files.
#[derive(Debug, Default)]
pub(super) struct Labels {
    numbers: BTreeMap<u32, Label>,
    names: BTreeMap<Box<str>, Label>,
    entries: Vec<Entry>,
}

impl Labels {
    /// The label of a number.
    pub(super) fn number(&mut self, number: u32) -> Label {
        match self.numbers.get(&number) {
            Some(label) => *label,
            None => {
                let label = self.add(format!("o{number}"));
                self.numbers.insert(number, label);
                label
            }
        }
    }

    /// The label of a name; `<100>` is the number 100.
    pub(super) fn name(&mut self, name: &str) -> Label {
        if let Some(label) = self.names.get(name) {
            return *label;
        }
        if let Some(number) = name.parse().ok().filter(|number: &u32| number.to_string() == name) {
            return self.number(number);
        }
        let label = self.add(format!("o<{name}>"));
        self.names.insert(name.into(), label);
        label
    }

    fn add(&mut self, text: String) -> Label {
        self.entries.push(Entry { text: text.into(), definition: None, looked: false });
        Label(self.entries.len() - 1)
    }

    /// The label as it is written.
    pub(super) fn text(&self, label: Label) -> &str {
        self.entries.get(label.0).map_or("o", |entry| &entry.text)
    }

    /// The label without `o`, `<` and `>`: the name of its file.
    pub(super) fn file_stem(&self, label: Label) -> &str {
        self.text(label).trim_start_matches('o').trim_start_matches('<').trim_end_matches('>')
    }

    /// Where its subroutine is, if that is known.
    pub(super) fn definition(&self, label: Label) -> Option<Definition> {
        self.entries.get(label.0)?.definition
    }

    /// Whether its subroutine is to be looked through for the first time; not again from then on.
    pub(super) fn look(&mut self, label: Label) -> bool {
        self.entries.get_mut(label.0).is_some_and(|entry| !std::mem::replace(&mut entry.looked, true))
    }

    /// Notes where its subroutine is; the first one met counts, and is returned.
    pub(super) fn define(&mut self, label: Label, definition: Definition) -> Definition {
        match self.entries.get_mut(label.0) {
            Some(entry) => *entry.definition.get_or_insert(definition),
            None => definition,
        }
    }
}
