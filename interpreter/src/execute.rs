//! Blocks become items, in the order of RS274/NGC: feed mode, F, S, T, spindle, dwell, units, distance modes, motion,
//! end. In: the program and the machine. Out: items and diagnostics, pulled one at a time.

use std::collections::VecDeque;

use protocol::{Code, Item, Machine, SpindleMode};

use crate::block::{Block, Motion, Task};
use crate::codes::{G, M, whole};
use crate::diagnostic::{Diagnostic, Spot, short};
use crate::source::Source;
use crate::state::{FeedMode, State};
use crate::threading::PassNote;
use crate::words::{Line, Word, read_line};

/// Slowest spindle speed, 1/min.
const SLOWEST_RPM: f64 = 0.01;
/// Longest dwell, s.
const LONGEST_DWELL: f64 = 86_400.0;
/// Highest feed, mm/min or mm/rev.
const HIGHEST_FEED: f64 = 1e6;

/// Reads a part program and yields machine code, one item at a time.
///
/// After an error it goes on with the next line, so that a reader can collect several; from the first error on the
/// items only serve to find more of them, and must not be run. The last item is [`Code::End`].
#[derive(Debug)]
pub struct Interpreter {
    name: String,
    source: Source,
    pub(crate) machine: Machine,
    pub(crate) state: State,
    queue: VecDeque<Result<Item, Diagnostic>>,
    pub(crate) warnings: Vec<Diagnostic>,
    pub(crate) notes: Vec<PassNote>,
    ended: bool,
}

/// What a block adds to the machine code.
pub(crate) struct Output {
    line: u32,
    items: Vec<Item>,
}

impl Output {
    pub(crate) fn push(&mut self, code: Code) {
        self.items.push(Item { line: self.line, code });
    }
}

impl Interpreter {
    /// An interpreter at the first line of `source`. `machine` has been checked; `name` is that of the program.
    pub fn new(name: impl Into<String>, source: impl Into<String>, machine: &Machine) -> Interpreter {
        Interpreter {
            name: name.into(),
            source: Source::new(source.into()),
            machine: machine.clone(),
            state: State::new(machine),
            queue: VecDeque::new(),
            warnings: Vec::new(),
            notes: Vec::new(),
            ended: false,
        }
    }

    /// Name of the program.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Warnings so far, in the order of the program.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// The passes of threads so far.
    pub fn passes(&self) -> &[PassNote] {
        &self.notes
    }

    /// The lines that come next, for looking ahead.
    pub(crate) fn lines_ahead(&self) -> impl Iterator<Item = (u32, &str)> {
        self.source.rest()
    }

    fn read_next(&mut self) {
        let Some((number, text)) = self.source.take() else { return self.end_of_text() };
        match read_line(number, text, &self.state.parameters) {
            Ok(line) => self.execute_line(number, &line),
            Err(error) => self.queue.push_back(Err(error)),
        }
    }

    fn execute_line(&mut self, number: u32, line: &Line) {
        for spot in &line.messages {
            let message = "messages are not shown to the operator yet";
            let help = "the program runs without it; leave it out to silence this warning";
            self.warnings.push(Diagnostic::warning("message-not-shown", *spot, message, help));
        }
        for (index, value) in &line.assignments {
            self.state.parameters.set(*index, *value);
        }
        if line.words.is_empty() {
            return;
        }
        let block = match Block::new(line, self.state.motion) {
            Ok(block) => block,
            Err(errors) => return self.queue.extend(errors.into_iter().map(Err)),
        };
        let mut output = Output { line: number, items: Vec::new() };
        match self.execute(&block, &mut output) {
            Ok(()) => self.queue.extend(output.items.into_iter().map(Ok)),
            Err(error) => self.queue.push_back(Err(error)),
        }
        if block.has_m(M::End) {
            self.end(number);
        }
    }

    fn execute(&mut self, block: &Block, output: &mut Output) -> Result<(), Diagnostic> {
        if block.task == Task::ThreadMove
            && let Some(word) = block.word('F')
        {
            let help = "the lead is K, in mm per revolution: leave F out";
            return Err(Diagnostic::error("feed-in-thread", word.spot, "G33 takes no F", help));
        }
        self.set_feed(block)?;
        self.set_spindle(block, output)?;
        self.dwell(block, output)?;
        self.state.set_modes(block);
        match block.task {
            Task::Nothing => Ok(()),
            Task::Line(motion) => self.line(block, motion, output),
            Task::ThreadMove => self.thread_move(block, output),
            Task::ThreadCycle => self.thread_cycle(block, output),
        }
    }

    fn set_feed(&mut self, block: &Block) -> Result<(), Diagnostic> {
        for (code, mode) in
            [(G::FeedPerMinute, FeedMode::PerMinute), (G::FeedPerRevolution, FeedMode::PerRevolution)]
        {
            if block.has(code) && self.state.feed_mode != mode {
                (self.state.feed_mode, self.state.feed) = (mode, None);
            }
        }
        let Some(word) = block.word('F') else { return Ok(()) };
        let feed = word.value * self.state.unit_mm;
        if !(feed > 0.0 && feed <= HIGHEST_FEED) {
            let help = format!("give a feed above 0 and up to {} mm", short(HIGHEST_FEED));
            let message = format!("F{} is no feed", short(word.value));
            return Err(Diagnostic::error("bad-value", word.spot, message, help));
        }
        self.state.feed = Some(feed);
        Ok(())
    }

    fn set_spindle(&mut self, block: &Block, output: &mut Output) -> Result<(), Diagnostic> {
        let commanded = |state: &State| match state.spindle {
            SpindleMode::Stop => (SpindleMode::Stop, 0.0),
            mode => (mode, state.rpm.unwrap_or(0.0)),
        };
        let before = commanded(&self.state);
        if let Some(word) = block.word('S') {
            self.state.rpm = Some(self.speed(&word)?);
        }
        if let Some(word) = block.word('T') {
            output.push(Code::Tool { number: self.tool(&word)? });
        }
        for (code, mode) in [
            (M::Clockwise, SpindleMode::Clockwise),
            (M::Counterclockwise, SpindleMode::Counterclockwise),
            (M::SpindleStop, SpindleMode::Stop),
        ] {
            if block.has_m(code) {
                self.state.spindle = mode;
            }
        }
        let after = commanded(&self.state);
        if after.0 != SpindleMode::Stop && after.1 == 0.0 && before.0 != after.0 {
            let message = "the spindle is started without a speed: it stands still until S comes";
            let help = "give the speed in this block or before, as in S600 M3";
            self.warnings.push(Diagnostic::warning("no-spindle-speed", block.spot, message, help));
        }
        if before != after {
            output.push(Code::Spindle { mode: after.0, rpm: after.1 });
        }
        Ok(())
    }

    fn speed(&self, word: &Word) -> Result<f64, Diagnostic> {
        let highest = self.machine.spindle.max_rpm;
        if (SLOWEST_RPM..=highest).contains(&word.value) {
            return Ok(word.value);
        }
        let message = format!(
            "S{} is outside what the spindle can do: {SLOWEST_RPM} to {} 1/min (spindle.max_rpm)",
            short(word.value),
            short(highest)
        );
        let help = if word.value > highest {
            format!("give at most S{}", short(highest))
        } else {
            "stop it with M5".to_owned()
        };
        Err(Diagnostic::error("speed-limit", word.spot, message, help))
    }

    fn tool(&self, word: &Word) -> Result<u32, Diagnostic> {
        let number = whole(word.value).and_then(|n| u32::try_from(n).ok());
        let Some(number) = number else {
            let message = format!("T{} is no tool number", short(word.value));
            return Err(Diagnostic::error(
                "bad-value",
                word.spot,
                message,
                "a tool number is whole, 0 or above",
            ));
        };
        let tools = &self.machine.tools;
        if tools.is_empty() || tools.keys().any(|name| name.parse() == Ok(number)) {
            return Ok(number);
        }
        let known: Vec<&str> = tools.keys().map(String::as_str).collect();
        let message = format!("tool {number} is not in the machine file");
        let help = format!("tools there: {}; add [tools.{number}] for this one", known.join(", "));
        Err(Diagnostic::error("unknown-tool", word.spot, message, help))
    }

    fn dwell(&mut self, block: &Block, output: &mut Output) -> Result<(), Diagnostic> {
        if !block.has(G::Dwell) {
            return Ok(());
        }
        let word = block.needed('P', "G4", "seconds to wait")?;
        if !(0.0..=LONGEST_DWELL).contains(&word.value) {
            let message = format!("G4 cannot wait {} s", short(word.value));
            let help = format!("give 0 to {LONGEST_DWELL} seconds");
            return Err(Diagnostic::error("bad-value", word.spot, message, help));
        }
        output.push(Code::Dwell { seconds: word.value });
        Ok(())
    }

    /// M2 and M30: the spindle stops, the program is over.
    fn end(&mut self, line: u32) {
        if self.state.spindle != SpindleMode::Stop {
            self.state.spindle = SpindleMode::Stop;
            let code = Code::Spindle { mode: SpindleMode::Stop, rpm: 0.0 };
            self.queue.push_back(Ok(Item { line, code }));
        }
        self.queue.push_back(Ok(Item { line, code: Code::End }));
        self.ended = true;
    }

    fn end_of_text(&mut self) {
        let line = self.source.last_line();
        if !self.source.at_end_mark() {
            let spot = Spot { line, column: 1, start: 0, end: 0 };
            let message = "the program has no end";
            let help = "end it with M2 or M30, or put % alone on its first and its last line";
            self.queue.push_back(Err(Diagnostic::error("no-program-end", spot, message, help)));
        }
        self.end(line);
    }
}

impl Iterator for Interpreter {
    type Item = Result<Item, Diagnostic>;

    fn next(&mut self) -> Option<Result<Item, Diagnostic>> {
        while self.queue.is_empty() && !self.ended {
            self.read_next();
        }
        self.queue.pop_front()
    }
}

impl State {
    /// Units, diameter or radius, absolute or incremental: whatever of it the block says.
    pub(crate) fn set_modes(&mut self, block: &Block) {
        let choose = |on: G, off: G, now: bool| block.has(on) || now && !block.has(off);
        if block.has(G::Inches) {
            self.unit_mm = 25.4;
        } else if block.has(G::Millimetres) {
            self.unit_mm = 1.0;
        }
        self.diameter = choose(G::Diameter, G::Radius, self.diameter);
        self.incremental = choose(G::Incremental, G::Absolute, self.incremental);
        match block.task {
            Task::Line(motion) => self.motion = motion,
            Task::ThreadMove => self.motion = Motion::Thread,
            Task::ThreadCycle => self.motion = Motion::None,
            Task::Nothing => {}
        }
    }
}
