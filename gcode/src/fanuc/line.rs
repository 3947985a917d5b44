//! What a line asks for, and the words of a block. Lengths know whether they were written with a decimal
//! point.

use super::simulator::SimulatorLine;
use super::system::System;
use super::variables::Locals;
use crate::block::{Block, letter_bit};
use crate::canon::Units;
use crate::codes::G;
use crate::execute::Done;
use crate::options::DecimalPoint;
use crate::problem::{Blame, Problem, Span, short};

/// What a line asks for.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Statement {
    /// Nothing: it is blank, all comment, an assignment, or its condition does not hold.
    Nothing,
    /// The words of [`Line`].
    Block,
    /// Going on at the line with this N.
    Goto(u32),
    /// Whether the loop of this number is run (again).
    While(u8, bool),
    /// The end of the loop.
    End(u8),
    /// O: a program begins.
    Program(u32),
    /// #3000: an alarm of this number.
    Alarm(f64),
    /// `[`: what the simulator is told that the program was written with.
    Simulator(SimulatorLine),
    /// #3006: the message in the comment is shown and the program waits.
    Message,
}

/// A code that this machine has no use for.
#[derive(Clone, Debug)]
pub(super) struct Idle {
    pub(super) span: Span,
    pub(super) message: String,
    /// Letters that it takes with it, as bits.
    pub(super) words: u32,
}

/// The words of a line.
#[derive(Clone, Debug, Default)]
pub(super) struct Line {
    /// Letters as they are written (increments for those of `bare`), codes in the groups of [`codes`].
    pub(super) block: Block,
    /// Letters written as a whole number without a decimal point, as bits.
    bare: u32,
    /// Letters whose value was computed.
    computed: u32,
    /// The line is of a mill.
    pub(super) mill: bool,
    /// G-code system of a lathe program, as far as it is known.
    system: System,
    /// What lengths without a decimal point are.
    pub(super) decimal_point: Option<DecimalPoint>,
    /// Arguments of G65.
    pub(super) arguments: Option<Box<Locals>>,
    /// Units of the block: those in force, or those of its own G20 or G21.
    pub(super) units: Option<Units>,
    /// The last code without effect.
    pub(super) idle: Option<Idle>,
    /// M29.
    pub(super) rigid: bool,
}

impl Line {
    /// An empty line of a program in which coordinates without a decimal point are read so.
    pub(super) fn new(decimal_point: Option<DecimalPoint>, mill: bool) -> Line {
        Line { decimal_point, mill, ..Line::default() }
    }

    /// Lengths without a decimal point are mm or inch, not increments.
    fn pocket_calculator(&self) -> bool {
        self.decimal_point == Some(DecimalPoint::PocketCalculator)
    }

    /// Least input increment (IS-B), program units.
    fn increment(&self) -> f64 {
        1.0 / self.increments_per_unit()
    }

    /// How many of them a mm or an inch has.
    pub(super) fn increments_per_unit(&self) -> f64 {
        if self.units == Some(Units::Inch) { 1e4 } else { 1e3 }
    }

    /// The unit of its lengths.
    pub(super) fn unit(&self) -> &'static str {
        self.units.unwrap_or(Units::Millimetre).name()
    }

    /// Whether the block has the word of a letter.
    pub(super) fn has(&self, letter: char) -> bool {
        self.block.has(letter)
    }

    /// A length (or a time): without a decimal point it counts least increments, a computed one is rounded to
    /// them.
    pub(super) fn length(&self, letter: char) -> Option<f64> {
        let value = self.block.get(letter)?;
        let per_unit = self.increments_per_unit();
        Some(match () {
            // D of G76 takes no decimal point on any control.
            () if self.is_bare(letter) && self.pocket_calculator() && letter != 'D' => value,
            () if self.is_bare(letter) => value / per_unit,
            () if self.computed & letter_bit(letter) != 0 => (value * per_unit).round() / per_unit,
            () => value,
        })
    }

    /// An angle of a rotary axis: without a decimal point it counts thousandths.
    pub(super) fn degrees(&self, letter: char) -> Option<f64> {
        let value = self.block.get(letter)?;
        Some(if self.is_bare(letter) && !self.pocket_calculator() { value / 1000.0 } else { value })
    }

    /// A length that is written in least increments, without a decimal point: P and Q of the cycles.
    ///
    /// # Errors
    /// It has a decimal point.
    pub(super) fn increments(&self, letter: char) -> Result<Option<f64>, Box<Problem>> {
        let whole = self.whole(letter)?;
        Ok(whole.map(|whole| whole as f64 / self.increments_per_unit()))
    }

    /// A whole number.
    ///
    /// # Errors
    /// It has a decimal point, or is too large.
    pub(super) fn whole(&self, letter: char) -> Result<Option<i64>, Box<Problem>> {
        let Some(value) = self.block.get(letter) else { return Ok(None) };
        let pointed = (self.bare | self.computed) & letter_bit(letter) == 0;
        if pointed || value.abs() >= 1e9 {
            let message = format!("{letter}{} is not a whole number", short(value));
            let micro = format!("; a length counts steps of {} here", short(self.increment()));
            let help = format!("write {letter} without a decimal point{micro}");
            return Err(Problem::error("bad-value", Blame::Word(letter), message, help));
        }
        Ok(Some(value.round() as i64))
    }

    /// Any other number, as it is written.
    pub(super) fn plain(&self, letter: char) -> Option<f64> {
        self.block.get(letter)
    }

    /// Whether a number was written without a decimal point.
    pub(super) fn is_bare(&self, letter: char) -> bool {
        self.bare & letter_bit(letter) != 0
    }

    /// Letters whose numbers were written without a decimal point, as bits.
    pub(super) fn bare(&self) -> u32 {
        self.bare
    }

    /// Letters whose numbers were written with one, as bits.
    pub(super) fn pointed(&self) -> u32 {
        self.block.present() & !self.bare & !self.computed
    }

    /// What a number of an argument of G65 without a decimal point is divided by.
    pub(super) fn argument_steps(&self) -> f64 {
        if self.pocket_calculator() { 1.0 } else { self.increments_per_unit() }
    }

    /// Whether it has any of these letters.
    pub(super) fn has_any(&self, letters: &str) -> bool {
        letters.chars().any(|letter| self.has(letter))
    }

    pub(super) fn clear(&mut self, file: u16, line: u32, units: Units) {
        self.block.clear(file, line);
        (self.bare, self.computed, self.arguments, self.units) = (0, 0, None, Some(units));
        self.idle = None;
        self.rigid = false;
    }

    /// The code of system A for a code of the line `text`; `None` if it says what is so without it.
    ///
    /// # Errors
    /// Codes of both systems are mixed, or it is not available.
    pub(super) fn of_system_a(
        &mut self,
        code: G,
        text: &[u8],
        span: Span,
    ) -> Result<Option<G>, Box<Problem>> {
        if self.mill { Ok(Some(code)) } else { self.system.read(code, text, span) }
    }

    /// Whether the program is known to be one of G-code system B.
    pub(super) fn is_system_b(&self) -> bool {
        self.system == System::B
    }

    /// Adds the word of a letter.
    ///
    /// # Errors
    /// The letter stands in the block already.
    pub(super) fn add(&mut self, letter: char, (value, kind): (f64, Kind), span: Span) -> Done {
        self.block.add(letter, value, span)?;
        match kind {
            Kind::Bare => self.bare |= letter_bit(letter),
            Kind::Computed => self.computed |= letter_bit(letter),
            Kind::Pointed => {}
        }
        Ok(())
    }
}

/// How a number is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// A whole number without a decimal point.
    Bare,
    /// With a decimal point.
    Pointed,
    /// A variable or an expression.
    Computed,
}
