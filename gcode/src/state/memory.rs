//! Parameters: what `#1`, `#<name>` and `#<_name>` hold.
//!
//! In: numbers and names (lower case, without blanks). Out: values, dimensionless. Numbered parameters are 0
//! until they are set. `#1` to `#30` and names belong to the call level they are set in; names that begin
//! with `_` and all other numbers belong to the program.

use std::collections::BTreeMap;

/// Parameters are `#1` to `#5601`.
pub(crate) const LAST: u32 = 5601;
/// `#1` to `#30` are the arguments of a subroutine.
pub(crate) const ARGUMENTS: usize = 30;
/// `(DEBUG,...)` is shown while this is positive.
pub(crate) const DEBUG_SHOWN: u32 = 5599;

/// A name that was met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Name {
    /// How many names were met before it.
    index: usize,
    global: bool,
}

impl Name {
    /// Whether it belongs to the program and not to the call level.
    pub(crate) fn is_global(self) -> bool {
        self.global
    }
}

/// Values of named parameters, by the number of their name.
type Values = Vec<Option<f64>>;

/// What a call hands over.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arguments {
    /// `#1` to `#30`, 0 where nothing was given.
    pub(crate) values: [f64; ARGUMENTS],
    /// How many were given: `#<n_args>`.
    pub(crate) given: usize,
}

impl Arguments {
    /// None.
    pub(crate) const NONE: Arguments = Arguments { values: [0.0; ARGUMENTS], given: 0 };

    /// The next one; `false` if there is no room for it.
    pub(crate) fn push(&mut self, value: f64) -> bool {
        let slot = self.values.get_mut(self.given);
        self.given += usize::from(slot.is_some());
        slot.map(|slot| *slot = value).is_some()
    }
}

/// The parameters of a program.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    /// `#0` is never used.
    numbered: Vec<f64>,
    names: BTreeMap<Box<str>, Name>,
    globals: Values,
    /// One for each call level; those above `level` wait to be used again.
    locals: Vec<Values>,
    level: usize,
    /// `n_args`, which every subroutine has.
    arguments_given: Name,
    /// `#1` to `#30` of the levels below, for those calls that have arguments.
    saved: Vec<[f64; ARGUMENTS]>,
}

impl Memory {
    /// All parameters 0 and no names but those given.
    pub(super) fn new(numbered: &[(u32, f64)], named: &[(String, f64)]) -> Memory {
        let mut memory = Memory {
            numbered: vec![0.0; LAST as usize + 1],
            names: BTreeMap::new(),
            globals: Vec::new(),
            locals: vec![Vec::new()],
            level: 0,
            arguments_given: Name { index: 0, global: false },
            saved: Vec::new(),
        };
        memory.arguments_given = memory.note("n_args");
        memory.set_numbered(DEBUG_SHOWN, 1.0);
        for (index, value) in numbered {
            memory.set_numbered(*index, *value);
        }
        let returned = [("_value", 0.0), ("_value_returned", 0.0)];
        let named = named.iter().map(|(name, value)| (name.as_str(), *value));
        for (name, value) in named.chain(returned) {
            memory.set_named(name, value);
        }
        memory
    }

    /// The value of `#index`; 0 if it was never set or there is none.
    pub(crate) fn numbered(&self, index: u32) -> f64 {
        self.numbered.get(index as usize).copied().unwrap_or(0.0)
    }

    /// So many values from `#first` on, as far as there are parameters.
    pub(crate) fn from(&self, first: u32, many: usize) -> &[f64] {
        let first = first as usize;
        self.numbered.get(first..first + many).unwrap_or_default()
    }

    /// Sets `#index`, 1 to [`LAST`]; nothing happens if there is none.
    pub(crate) fn set_numbered(&mut self, index: u32, value: f64) {
        if let Some(parameter) = self.numbered.get_mut(index as usize) {
            *parameter = value;
        }
    }

    /// The value of `#<name>`, if it is set.
    pub(crate) fn named(&self, name: &str) -> Option<f64> {
        self.at(self.find(name)?)
    }

    /// Sets `#<name>`.
    pub(crate) fn set_named(&mut self, name: &str, value: f64) {
        let name = self.note(name);
        self.set_at(name, value);
    }

    /// A name, if it was met before.
    pub(crate) fn find(&self, name: &str) -> Option<Name> {
        self.names.get(name).copied()
    }

    /// A name that is met.
    pub(crate) fn note(&mut self, name: &str) -> Name {
        if let Some(known) = self.find(name) {
            return known;
        }
        let known = Name { index: self.names.len(), global: name.starts_with('_') };
        self.names.insert(name.into(), known);
        known
    }

    /// The value of a name, if it is set.
    pub(crate) fn at(&self, name: Name) -> Option<f64> {
        let values = if name.global { &self.globals } else { self.locals.get(self.level)? };
        values.get(name.index).copied().flatten()
    }

    /// Sets a name.
    pub(crate) fn set_at(&mut self, name: Name, value: f64) {
        let values = if name.global { Some(&mut self.globals) } else { self.locals.get_mut(self.level) };
        let Some(values) = values else { return };
        if values.len() <= name.index {
            values.resize(name.index + 1, None);
        }
        if let Some(slot) = values.get_mut(name.index) {
            *slot = Some(value);
        }
    }

    /// Names that belong to the program, with their values, but those that every program has.
    pub(crate) fn globals_in_force(&self) -> impl Iterator<Item = (String, f64)> {
        let own = |name: &str| !matches!(name, "_value" | "_value_returned");
        let globals = self.names.iter().filter(move |(text, name)| name.global && own(text));
        globals.filter_map(|(text, name)| Some((format!("#<{text}>"), self.at(*name)?)))
    }

    /// Enters a subroutine: its names are its own, and so are `#1` to `#30` if it takes arguments.
    pub(crate) fn enter(&mut self, arguments: Option<&Arguments>) {
        self.level += 1;
        match self.locals.get_mut(self.level) {
            Some(values) => values.clear(),
            None => self.locals.push(Vec::new()),
        }
        self.set_at(self.arguments_given, arguments.map_or(0.0, |arguments| arguments.given as f64));
        if let (Some(arguments), Some(slots)) = (arguments, self.numbered.get_mut(1..=ARGUMENTS)) {
            let mut saved = arguments.values;
            saved.swap_with_slice(slots);
            self.saved.push(saved);
        }
    }

    /// Leaves a subroutine that was entered with arguments or without.
    pub(crate) fn leave(&mut self, with_arguments: bool) {
        self.level = self.level.saturating_sub(1);
        if !with_arguments {
            return;
        }
        if let (Some(saved), Some(slots)) = (self.saved.pop(), self.numbered.get_mut(1..=ARGUMENTS)) {
            slots.copy_from_slice(&saved);
        }
    }
}
