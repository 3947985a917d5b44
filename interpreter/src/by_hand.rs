//! Blocks that somebody gives by hand, one by one. In: the text of a block, and where the axes rest: whoever
//! jogs moves them without a block. Out: its machine code, behind where it begins and up to where the next
//! one is waited for; or what is wrong with it, and then nothing has changed.
//!
//! ```
//! use interpreter::{ByHand, Language};
//! use machine::Machine;
//!
//! let machine = Machine::default();
//! let mut hand = ByHand::new(&Language::default(), &machine).expect("nothing is beside it");
//! let home = machine.home();
//! assert!(hand.block("G1 Z-1", &home).is_err(), "without a feed");
//! let items = hand.block("G91 G1 Z-1 F100", &home).expect("it is right");
//! assert_eq!(items.len(), 3, "it begins, goes 1 mm, and the next one is waited for");
//! assert!(hand.in_force().contains("G91"));
//! ```

use gcode::canon::Units;
use gcode::files::ToolTable;
use gcode::{Diagnostic, Dialect, Options, Outlasting, Program};
use machine::{Machine, ProgramDialect};
use protocol::{Code, Item, PerAxis, Position, SpindleMode, SpindleSpeed};

use crate::options::{OpenError, asked, named};
use crate::{Interpreter, Language, MessageNote};

/// Most items of machine code that a block may be: those of a cycle, not those of a program.
const MOST_ITEMS: usize = 4096;

/// What a text is blamed for that does not end a program: none of these does.
const NO_END: &str = "no-program-end";

/// Why what a block does depends on where the axes are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// It moves, or sets something to where they stand.
    Places,
    /// It reads where they stand.
    Reads,
    /// The spindle turns by where X is (G96), from now on.
    Surface,
}

/// Who reads them.
pub struct ByHand {
    machine: Machine,
    options: Options,
    interpreter: Interpreter,
    /// What has been given so far, with where the axes rested: what is in force comes from it.
    given: Vec<(String, PerAxis<Position>)>,
    /// What the last of them tells its operator.
    told: Vec<MessageNote>,
}

impl ByHand {
    /// At a machine that has just been switched on, in the dialect of its file.
    ///
    /// # Errors
    /// What is beside the machine (tools, parameters) cannot be read.
    pub fn new(language: &Language, machine: &Machine) -> Result<ByHand, OpenError> {
        let dialect = language.dialect.unwrap_or(machine.general.dialect);
        let dialect = if dialect == ProgramDialect::Auto { None } else { named(dialect, machine) };
        let options = asked(dialect.unwrap_or(Dialect::Linuxcnc), language, machine)?;
        let interpreter = begun(&options, machine);
        Ok(ByHand { machine: machine.clone(), options, interpreter, given: Vec::new(), told: Vec::new() })
    }

    /// Reads a block, with the axes of the machine at rest here. `line` of its items is its number, from 1.
    ///
    /// # Errors
    /// What is wrong with it; nothing has changed.
    pub fn block(&mut self, text: &str, at: &PerAxis<Position>) -> Result<Vec<Item>, Vec<Diagnostic>> {
        let before = (self.interpreter.messages().len(), self.interpreter.translator.steps());
        let items = self.interpreter.given(text, at, &self.options).map(|items| {
            let begins = Code::ByHand(protocol::ByHand::Begins { at: *at, jogs: false });
            std::iter::once(Item { line: 0, code: begins }).chain(items).collect::<Vec<_>>()
        });
        if items.is_ok() {
            self.given.push((text.to_owned(), *at));
            self.told = self.tells(before);
        } else {
            // What was read of it is in force already.
            self.read_again();
        }
        let line = self.given.len() as u32;
        items.map(|items| items.into_iter().map(|item| Item { line, ..item }).collect())
    }

    /// What the last block tells its operator; `line` is the number of the block, and `after` counts from its
    /// first item.
    pub fn messages(&self) -> &[MessageNote] {
        &self.told
    }

    /// Messages of the last block, behind so many messages and steps.
    fn tells(&self, (messages, steps): (usize, u64)) -> Vec<MessageNote> {
        let line = self.given.len() as u32;
        // One more: where it begins was not the interpreter's.
        let of_block =
            |note: &MessageNote| MessageNote { line, after: note.after - steps + 1, text: note.text.clone() };
        self.interpreter.messages()[messages..].iter().map(of_block).collect()
    }

    /// Why what the last block does depends on where the axes are; `None` if it moves nothing and does the
    /// same wherever they are. `items` are those that it is.
    pub fn needs(&mut self, text: &str, at: &PerAxis<Position>, items: &[Item]) -> Option<Needs> {
        let moves = |item: &Item| item.is_move() || matches!(item.code, Code::Pass(_) | Code::Work(_));
        let by_x = |item: &Item| match item.code {
            Code::Spindle { mode, speed: SpindleSpeed::Surface { .. } } => mode != SpindleMode::Stop,
            _ => false,
        };
        if items.iter().any(moves) {
            return Some(Needs::Places);
        }
        if self.interpreter.program.has_read_place() {
            return Some(Needs::Reads);
        }
        let left = |hand: &ByHand| (hand.outlasting(), hand.tools().clone(), hand.origin());
        let here = left(self);
        self.forget_last();
        let elsewhere = at.map(|position| position.moved(1.0));
        let there = self.block(text, &elsewhere).map(|items| (items, left(self)));
        if there.is_ok() {
            self.forget_last();
        }
        let again = self.block(text, at);
        assert!(again.is_ok(), "it was right before");
        // The first item says where it begins.
        let same = there.is_ok_and(|(others, there)| others[1..] == items[1..] && there == here);
        if same { items.iter().any(by_x).then_some(Needs::Surface) } else { Some(Needs::Places) }
    }

    /// The last block is not to be made after all.
    pub fn forget_last(&mut self) {
        self.given.pop();
        self.read_again();
    }

    /// Comes to what is in force by reading again what was given.
    fn read_again(&mut self) {
        self.interpreter = begun(&self.options, &self.machine);
        for (text, at) in &self.given {
            let again = self.interpreter.given(text, at, &self.options);
            assert!(again.is_ok(), "it was right before");
        }
    }

    /// How many blocks have been read.
    pub fn blocks(&self) -> usize {
        self.given.len()
    }

    /// What is in force: the dialect, and words of a block of it.
    pub fn in_force(&self) -> String {
        let dialect = if self.is_fanuc() { "FANUC" } else { "LinuxCNC" };
        format!("{dialect}: {}", self.interpreter.program.in_force())
    }

    /// Where zero of the program lies on the machine now.
    pub fn origin(&self) -> PerAxis<Position> {
        self.interpreter.translator.zero()
    }

    /// The offset of the tool that is in force.
    pub fn tool_offset(&self) -> PerAxis<Position> {
        self.interpreter.translator.tool_offset()
    }

    /// Number of the coordinate system in force, 1 (G54) to 9.
    pub fn system(&self) -> u8 {
        self.interpreter.program.system()
    }

    /// Units of the words of a block, and those of offsets and tools as they are kept.
    pub fn units(&self) -> [Units; 2] {
        [self.interpreter.program.units(), self.options.machine_units]
    }

    /// The tools as they are now, in machine units.
    pub fn tools(&self) -> &ToolTable {
        self.interpreter.program.tools()
    }

    /// Whether X words are diameters.
    pub fn x_is_diameter(&self) -> bool {
        self.interpreter.program.x_is_diameter()
    }

    /// Whether blocks are read as FANUC does.
    pub fn is_fanuc(&self) -> bool {
        self.options.dialect != Dialect::Linuxcnc
    }

    /// What outlives the session.
    pub fn outlasting(&self) -> Outlasting {
        self.interpreter.program.outlasting()
    }
}

/// An interpreter that has begun: what holds at the start has been said.
fn begun(options: &Options, machine: &Machine) -> Interpreter {
    let program = Program::from_text("by hand", "", options);
    let mut interpreter = Interpreter::new(program, machine);
    interpreter.by_hand = true;
    // An empty text has nothing that could be wrong.
    interpreter.by_ref().for_each(drop);
    interpreter
}

impl Interpreter {
    /// Reads a text that was given by hand, to its end.
    fn given(
        &mut self,
        text: &str,
        at: &PerAxis<Position>,
        options: &Options,
    ) -> Result<Vec<Item>, Vec<Diagnostic>> {
        let point = self.translator.rests_at(at);
        // A tape: it ends without M2, and what waits for a next move is made.
        self.program.goes_on("MDI", format!("%\n{text}\n%\n"), options, point);
        self.reported.clear();
        self.ended = false;
        let (mut items, mut errors) = (Vec::new(), Vec::new());
        for item in self.by_ref().take(MOST_ITEMS) {
            match item {
                Ok(item) => items.push(item),
                Err(error) => errors.push(error),
            }
        }
        self.translator.ends_by_hand();
        self.find(false);
        errors.extend(self.errors.drain(..));
        errors.retain(|error| error.code != NO_END);
        while let Some(item) = self.translator.next_item() {
            items.push(item);
        }
        let whole = self.ended && matches!(items.last(), Some(Item { code: Code::ByHand(_), .. }));
        if !whole {
            let (place, help) = (self.translator.place(), "run it as a program");
            let message = format!("a block by hand is at most {MOST_ITEMS} items of machine code");
            let problem = gcode::Problem::error("too-long", gcode::problem::Blame::Block, message, help);
            errors.push(self.program.diagnose(place, *problem));
        }
        if errors.is_empty() { Ok(items) } else { Err(errors) }
    }
}

#[cfg(test)]
mod tests {
    use super::{ByHand, Language, Machine, Needs, ProgramDialect};

    /// What a block needs behind another one.
    fn needs(dialect: ProgramDialect, before: &str, text: &str) -> Option<Needs> {
        let machine = Machine::default();
        let language = Language { dialect: Some(dialect), ..Language::default() };
        let mut hand = ByHand::new(&language, &machine).expect("nothing is beside it");
        let at = machine.home();
        hand.block(before, &at).expect("it is right");
        let items = hand.block(text, &at).unwrap_or_else(|errors| panic!("{text}: {errors:?}"));
        let needs = hand.needs(text, &at, &items);
        assert_eq!(hand.blocks(), 2, "{text} stays given");
        needs
    }

    #[test]
    fn what_a_block_tells_is_told_where_it_stands_in_it_and_once() {
        let machine = Machine::default();
        let mut hand = ByHand::new(&Language::default(), &machine).expect("nothing is beside it");
        let at = machine.home();
        let block = "(MSG, first)\nG91 G0 Z-1\n(MSG, second)\nG0 Z1";
        for number in 1..=2 {
            let items = hand.block(block, &at).expect("it is right");
            assert_eq!(items.len(), 4, "it begins, goes there and back, and the next one is waited for");
            let told: Vec<_> =
                hand.messages().iter().map(|note| (note.line, note.after, note.text.as_str())).collect();
            assert_eq!(told, [(number, 1, "first"), (number, 2, "second")]);
        }
        hand.block("G0 X", &at).expect_err("a value is missing");
        hand.block("M8", &at).expect("it is right");
        assert!(hand.messages().is_empty());
    }

    #[test]
    fn what_a_block_does_depends_on_where_the_axes_are_if_it_moves_reads_or_turns_by_them() {
        use ProgramDialect::{Fanuc, Linuxcnc};
        for (dialect, before, text, expected) in [
            (Linuxcnc, "G97 S300 M3", "M8", None),
            (Linuxcnc, "G97 S300 M3", "#1=[#5401+2]", None),
            (Linuxcnc, "#1=20", "#2=#1", None),
            (Linuxcnc, "M5", "G96 S150", None),
            (Linuxcnc, "G96 S150", "M5", None),
            (Linuxcnc, "M5", "G0 X20", Some(Needs::Places)),
            (Linuxcnc, "M5", "G92 X20", Some(Needs::Places)),
            (Linuxcnc, "G97 S300 M3", "G96 S150 G92 X20", Some(Needs::Places)),
            (Linuxcnc, "M5", "#1=[2*#5422]", Some(Needs::Reads)),
            (Linuxcnc, "M5", "#<a>=#<_abs_z>", Some(Needs::Reads)),
            (Linuxcnc, "M5", "#1=#<_x>", Some(Needs::Reads)),
            (Linuxcnc, "M5", "(debug, X is at #5021)", Some(Needs::Reads)),
            (Linuxcnc, "#1=#5420", "#2=#1", None),
            (Linuxcnc, "G97 S300 M3", "G96 S150", Some(Needs::Surface)),
            (Linuxcnc, "G96 S150", "M3", Some(Needs::Surface)),
            (Fanuc, "M5", "#100=#5041", Some(Needs::Reads)),
            (Fanuc, "M5", "#100=#5081", None),
            (Fanuc, "G50 S2000", "G96 S150 M3", Some(Needs::Surface)),
        ] {
            assert_eq!(needs(dialect, before, text), expected, "{before:?}, then {text:?}");
        }
    }
}
