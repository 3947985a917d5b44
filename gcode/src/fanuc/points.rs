//! Coordinates without a decimal point: `X40` is 0.04 mm to most controls and 40 mm to others.
//!
//! In: the blocks of a program, and what the machine says of it ([`DecimalPoint`]). Out: a warning where the
//! first such coordinate stands; an error where a program has them with and without a point, because then one
//! of the two is a slip.

use super::codes::DRILLING;
use super::line::Line;
use super::mill;
use crate::block::{letter_bits, letters_of};
use crate::canon::{Place, Units};
use crate::codes::{G, group};
use crate::execute::{Done, Output, thin};
use crate::options::DecimalPoint;
use crate::problem::{Blame, Problem, Span, short};

/// Words of axes.
const AXES: u32 = letter_bits("XZUWC");
/// The same on a mill.
const AXES_OF_MILL: u32 = letter_bits("XYZ");
/// Words of arcs and corners. In a cycle they are depths and allowances, which many write in increments.
const BESIDE: u32 = letter_bits("IKR") | letter_bits("cr");

/// What a program was seen to do.
#[derive(Debug, Default)]
pub(super) struct Points {
    /// A coordinate had a point.
    pointed: bool,
    /// The first that had none and is not 0.
    bare: Option<(Place, Span, char, f64)>,
}

impl Points {
    /// Another text: what none was blamed for in the one before is done.
    pub(super) fn goes_on(&mut self) {
        self.bare = None;
    }

    /// Takes a block. Behind a refusal lengths without a point are taken as mm or inch, as who mixes them
    /// mostly means them: what would follow from 0.04 mm is not found wrong as well.
    ///
    /// # Errors
    /// A coordinate has no point, and the machine, or others of the program, say that it should.
    pub(super) fn see(&mut self, rule: Option<DecimalPoint>, line: &mut Line, out: &mut Output) -> Done {
        let seen = self.judge(rule, line, out);
        if seen.is_err() {
            line.decimal_point = Some(DecimalPoint::PocketCalculator);
        }
        seen
    }

    fn judge(&mut self, rule: Option<DecimalPoint>, line: &Line, out: &mut Output) -> Done {
        if matches!(rule, Some(DecimalPoint::Conventional | DecimalPoint::PocketCalculator)) {
            return Ok(());
        }
        if self.pointed && line.bare() == 0 {
            return Ok(());
        }
        let coordinates = match line.block.g(group::ONCE) {
            Some(G(40)) if line.mill => 0,
            Some(G(100)) if line.mill => AXES_OF_MILL | letter_bits("R"),
            _ if line.mill => AXES_OF_MILL | letter_bits("IJKR") & !of_no_length(line),
            Some(G(40)) => 0,
            Some(G(700..=760)) => AXES,
            // How often a hole is made is no length.
            _ if line.block.g(DRILLING).is_some() => AXES | BESIDE & !letter_bits("K"),
            _ => AXES | BESIDE,
        };
        self.pointed |= line.pointed() & coordinates != 0;
        if let Some((place, span, letter, value)) = self.bare.take_if(|_| self.pointed) {
            return Err(mixed(Blame::Part(place, span), letter, value, line));
        }
        let said = |letter: &char| line.plain(*letter).is_some_and(|value| value != 0.0);
        let Some(letter) = letters_of(line.bare() & coordinates).find(said) else { return Ok(()) };
        let value = line.plain(letter).unwrap_or_default();
        let blame = Blame::Word(letter);
        if self.pointed {
            return Err(mixed(blame, letter, value, line));
        }
        if rule == Some(DecimalPoint::Refuse) {
            let help = format!("write {}{}.", written(letter), short(value));
            return Err(Problem::error("no-decimal-point", blame, readings(letter, value, line), help));
        }
        if self.bare.is_none() {
            let span = line.block.span(blame).unwrap_or_default();
            self.bare = Some((line.block.place(), span, letter, value));
            let message = readings(letter, value, line);
            out.warn(Problem::warning("no-decimal-point", blame, message, SETTLED));
        }
        Ok(())
    }
}

/// K is a number of holes, and R of G68 an angle.
fn of_no_length(line: &Line) -> u32 {
    let holes = if matches!(line.block.g(group::MOTION), Some(G(20 | 30))) { 0 } else { letter_bits("K") };
    if mill::codes::turns(line) { holes | letter_bits("R") } else { holes }
}

/// Warns of a depth of cut that is thinner than any chip, with the other reading of its word. `counts`: it
/// takes no decimal point.
pub(super) fn doubt_cut(
    (what, letter, counts): (&str, char, bool),
    depth: f64,
    cuts: f64,
    line: &Line,
    out: &mut Output,
) {
    let other = line.plain(letter).filter(|_| line.is_bare(letter)).map(|value| {
        let per_unit = line.increments_per_unit();
        let meant = |written: String| format!("write {letter}{written} for {} {}", short(value), line.unit());
        match counts {
            true => (
                format!("{letter} counts steps of {}", short(1.0 / per_unit)),
                meant(short(value * per_unit)),
            ),
            false => (readings(letter, value, line), meant(short(value) + ".")),
        }
    });
    let units = line.units.unwrap_or(Units::Millimetre);
    thin::doubt((what, Blame::Word(letter)), depth, cuts, units, other, out);
}

const SETTLED: &str = "machine.decimal_point of the machine file settles it: \"conventional\" counts increments, \
                       \"pocket-calculator\" mm or inch";

/// The letter as it is written: `c` and `r` are `,C` and `,R`.
fn written(letter: char) -> String {
    if letter.is_ascii_lowercase() { format!(",{}", letter.to_ascii_uppercase()) } else { letter.into() }
}

fn readings(letter: char, value: f64, line: &Line) -> String {
    let (unit, small) = (line.unit(), value / line.increments_per_unit());
    let (letter, value, small) = (written(letter), short(value), short(small));
    format!(
        "{letter}{value} has no decimal point: {small} {unit} is what most controls take it for, {value} {unit} others"
    )
}

fn mixed(blame: Blame, letter: char, value: f64, line: &Line) -> Box<Problem> {
    let told = readings(letter, value, line);
    let (small, letter) = (short(value / line.increments_per_unit()), written(letter));
    let help = format!("write {letter}{}. or {letter}{small}; {SETTLED}", short(value));
    let message = format!("{told}; others of the program have one");
    Problem::error("no-decimal-point", blame, message, help)
}
