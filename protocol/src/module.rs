//! The modules of a machine that can die or hang, each by the name its process has, and what the plant's
//! scenario wants done to one of them.

use crate::units::Axis;

/// A module that runs beside the plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Module {
    /// G-code to machine code.
    Interpreter,
    /// Machine code to axis commands.
    Interpolator,
    /// One axis.
    Regulator(Axis),
}

impl Module {
    /// The name of its process: `interpreter`, `interpolator`, `regulator-x` …
    pub fn name(self) -> String {
        match self {
            Module::Interpreter => "interpreter".into(),
            Module::Interpolator => "interpolator".into(),
            Module::Regulator(axis) => format!("regulator-{}", axis.name()),
        }
    }

    /// The module of a name.
    ///
    /// ```
    /// use protocol::{Axis, Module};
    /// assert_eq!(Module::from_name("regulator-z"), Some(Module::Regulator(Axis::Z)));
    /// assert_eq!(Module::from_name("launcher"), None);
    /// ```
    pub fn from_name(name: &str) -> Option<Module> {
        match name {
            "interpreter" => Some(Module::Interpreter),
            "interpolator" => Some(Module::Interpolator),
            _ => Axis::from_name(name.strip_prefix("regulator-")?).map(Module::Regulator),
        }
    }

    /// Its number on the wire, from 1.
    pub fn code(self) -> u32 {
        match self {
            Module::Interpreter => 1,
            Module::Interpolator => 2,
            Module::Regulator(axis) => 3 + axis.index() as u32,
        }
    }

    /// The module of a number.
    pub fn from_code(code: u32) -> Option<Module> {
        match code {
            1 => Some(Module::Interpreter),
            2 => Some(Module::Interpolator),
            _ => Axis::ALL.get((code as usize).checked_sub(3)?).map(|axis| Module::Regulator(*axis)),
        }
    }
}

/// What happens to a module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doom {
    /// It ends at once.
    Kill = 1,
    /// It stands still from now on, and lets its messages wait.
    Freeze = 2,
    /// It goes on where it stood.
    Thaw = 3,
}

impl Doom {
    /// What a number on the wire means.
    pub fn from_code(code: u32) -> Option<Doom> {
        [Doom::Kill, Doom::Freeze, Doom::Thaw].into_iter().find(|doom| *doom as u32 == code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_codes_lead_back() {
        let all = [Module::Interpreter, Module::Interpolator];
        for module in all.into_iter().chain(Axis::ALL.map(Module::Regulator)) {
            assert_eq!(Module::from_name(&module.name()), Some(module));
            assert_eq!(Module::from_code(module.code()), Some(module));
        }
        assert_eq!([0, 11, u32::MAX].map(Module::from_code), [None; 3]);
        assert_eq!(
            [0, 1, 2, 3, 4].map(Doom::from_code).map(|doom| doom.is_some()),
            [false, true, true, true, false]
        );
    }
}
