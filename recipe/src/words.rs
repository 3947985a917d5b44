//! Words of a part program: numbers, units and comments as a dialect has them.

/// The dialect of a program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dialect {
    /// LinuxCNC: X words are diameters by G7.
    #[default]
    Linuxcnc,
    /// FANUC, lathe, G-code system A.
    Fanuc,
}

/// The unit of its lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Units {
    /// G21, three places.
    #[default]
    Mm,
    /// G20, four places.
    Inch,
}

impl Units {
    /// Of one unit, mm.
    pub(crate) fn mm(self) -> f64 {
        match self {
            Units::Mm => 1.0,
            Units::Inch => 25.4,
        }
    }

    /// How many steps, the least that a word can say, a unit has.
    pub(crate) fn steps(self) -> f64 {
        match self {
            Units::Mm => 1e3,
            Units::Inch => 1e4,
        }
    }

    fn places(self) -> usize {
        match self {
            Units::Mm => 3,
            Units::Inch => 4,
        }
    }

    /// A length in steps.
    pub(crate) fn of(self, mm: f64) -> i64 {
        (mm / self.mm() * self.steps()).round() as i64
    }
}

/// Writes words.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Words {
    pub(crate) dialect: Dialect,
    pub(crate) units: Units,
}

impl Words {
    /// A length of whole steps.
    pub(crate) fn steps(self, steps: i64) -> String {
        self.number(steps as f64 / self.units.steps(), self.units.places())
    }

    /// A length in a comment, without and with its unit.
    pub(crate) fn told(self, mm: f64) -> String {
        format!("{:.*}", self.units.places(), mm / self.units.mm())
    }

    pub(crate) fn told_with_unit(self, mm: f64) -> String {
        format!("{} {}", self.told(mm), if self.units == Units::Mm { "mm" } else { "inch" })
    }

    /// A lead, given in mm: with as many places as it needs.
    pub(crate) fn lead(self, mm: f64) -> String {
        self.number(mm / self.units.mm(), 8)
    }

    /// A number. FANUC takes one without a point for steps.
    pub(crate) fn number(self, value: f64, places: usize) -> String {
        let text = format!("{value:.places$}");
        let text = if text.contains('.') { text.trim_end_matches('0') } else { &text };
        let text = match self.dialect {
            Dialect::Linuxcnc => text.trim_end_matches('.').to_owned(),
            Dialect::Fanuc if text.contains('.') => text.to_owned(),
            Dialect::Fanuc => format!("{text}."),
        };
        // Less than half a step below zero.
        if text == "-0" || text == "-0." { text[1..].to_owned() } else { text }
    }

    /// A comment in a line of its own.
    pub(crate) fn comment(self, text: &str) -> String {
        let text = text.replace(['(', '['], "<").replace([')', ']'], ">");
        match self.dialect {
            Dialect::Linuxcnc => format!("({text})\n"),
            Dialect::Fanuc => format!("({})\n", text.to_ascii_uppercase()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_short_as_they_can_be() {
        let linuxcnc = Words { dialect: Dialect::Linuxcnc, units: Units::Mm };
        let fanuc = Words { dialect: Dialect::Fanuc, units: Units::Inch };
        assert_eq!([20_000, -500, 0, 12].map(|steps| linuxcnc.steps(steps)), ["20", "-0.5", "0", "0.012"]);
        assert_eq!([20_000, -500, 0, 12].map(|steps| fanuc.steps(steps)), ["2.", "-0.05", "0.", "0.0012"]);
        assert_eq!(linuxcnc.number(-1e-9, 3), "0");
        assert_eq!(fanuc.lead(25.4 / 20.0), "0.05");
        assert_eq!(fanuc.comment("T3 (a)"), "(T3 <A>)\n");
    }
}
