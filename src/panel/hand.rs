//! Work by hand: blocks and jogs become machine code. In: what somebody asks for, and where the axes rest.
//! Out: machine code for the interpreter's place in the chain; or why there is none. Positions in mm of the
//! machine, X of a lathe as a radius, feeds in mm/min; degrees of rotary axes.
//!
//! All that is given goes through one chain: a block, a step, a jog is machine code between where it begins
//! and where the next one is waited for ([`protocol::ByHand`]). A jog is a move to the end of travel that
//! goes on while its key is pressed. So limits, laws and overrides are those of every move, and a session is
//! a machine-code file that can be run again.

use std::path::PathBuf;

use ::panel::HandAsked;
use gcode::canon::Units;
use interpreter::{ByHand as Reader, Language};
use machine::{AxisConfig, Machine};
use protocol::{Axis, ByHand, Code, CodePacket, Feed, Item, MachineState, PerAxis, Position};
use rig::observe::{Message, Record};

use super::{
    homing::InHand,
    jog::{fastest_jog, feed},
    lost::Lost,
    mode::Doing,
    origins::FirstCut,
    tables::typed,
};
use crate::offsets::{Set, Table, Target};

/// Most bytes of a block on its way: what the pipe to the interpreter holds at once.
const MOST_BYTES: usize = 48 << 10;

/// Work by hand at a machine that is on.
pub(crate) struct Hand {
    machine: Machine,
    reader: Reader,
    /// All that was given.
    items: Vec<Item>,
    /// Steps of that, which are done when the machine waits again.
    steps: u64,
    doing: Doing,
    /// Where the axes rest, while the machine waits for a block.
    rests: Option<PerAxis<Position>>,
    lost: Lost,
    first: FirstCut,
    /// What was given last.
    pub(super) in_hand: InHand,
}

/// Why something is not given.
pub(crate) enum NotGiven {
    /// It is wrong.
    Bad(String),
    /// It asks where axes are whose reference run is still to be made.
    NotReferenced(String),
}

impl<T: Into<String>> From<T> for NotGiven {
    fn from(why: T) -> NotGiven {
        NotGiven::Bad(why.into())
    }
}

/// What goes to the machine.
pub(crate) struct Given {
    /// For the interpreter's place.
    pub(crate) items: Vec<Item>,
    /// What it tells its operator.
    pub(crate) messages: Vec<Message>,
    /// It goes on while its key is pressed.
    pub(crate) jogs: bool,
    /// As it stands in the record.
    pub(crate) text: String,
}

/// The first item of a session: it waits.
pub(crate) const BEGINS: Item = Item { line: 0, code: Code::ByHand(ByHand::Waits) };

impl Hand {
    /// At a machine that is switched on.
    pub(crate) fn new(language: &Language, machine: &Machine) -> Result<Hand, String> {
        let reader = Reader::new(language, machine).map_err(|error| error.to_string())?;
        let items = vec![BEGINS];
        let steps = 1;
        Ok(Hand {
            machine: machine.clone(),
            reader,
            items,
            steps,
            doing: Doing::Block,
            rests: None,
            lost: Lost::default(),
            first: FirstCut::default(),
            in_hand: InHand::default(),
        })
    }

    /// One control cycle.
    pub(crate) fn cycle(&mut self, record: &Record) {
        let Record { axes, machine, .. } = record;
        self.lost.look(record);
        let waits = machine.state() == MachineState::ByHand && machine.taken >= self.steps;
        let rest = |(_, status): &(Axis, protocol::AxisStatus)| {
            status.velocity_mm_s == 0.0 && status.acceleration_mm_s2 == 0.0 && status.in_position != 0
        };
        self.rests = (waits && axes.iter().all(rest)).then(|| {
            let mut at = PerAxis::default();
            axes.iter().for_each(|(axis, status)| at[axis.index()] = Position::from_mm(status.commanded_mm));
            at
        });
        if self.rests.is_some() {
            (self.doing, self.in_hand) = (Doing::Nothing, InHand::default());
        }
    }

    /// What it does.
    pub(crate) fn doing(&self) -> Doing {
        self.doing
    }

    /// What is in force for the next block.
    pub(crate) fn in_force(&self) -> String {
        self.reader.in_force()
    }

    /// X and Z of the machine where those of the program are 0 now, mm.
    pub(crate) fn origin_mm(&self) -> [f64; 2] {
        [Axis::X, Axis::Z].map(|axis| self.reader.origin()[axis.index()].mm())
    }

    /// How far the tool is drawn beside where it is, X and Z, mm.
    pub(crate) fn moved_mm(&self) -> [f64; 2] {
        self.first.moved_mm(&self.reader.tool_offset())
    }

    /// Whether X of the program is a diameter.
    pub(crate) fn x_is_diameter(&self) -> bool {
        self.reader.x_is_diameter()
    }

    /// What outlives the session.
    pub(crate) fn outlasting(&self) -> interpreter::Outlasting {
        self.reader.outlasting()
    }

    /// All that was given, as a program that ends.
    pub(crate) fn whole(&self) -> Vec<Item> {
        let end = Item { line: self.reader.blocks() as u32, code: Code::End };
        self.items.iter().copied().chain([end]).collect()
    }

    /// Why this is not asked of axes of which nobody knows where they are, if there are such.
    fn not_referenced(&self, asked: &HandAsked) -> Option<String> {
        let moves = match asked {
            HandAsked::Step { .. } | HandAsked::TouchOff { .. } => true,
            // Home of an axis that is lost is its reference run; of another one it is a move.
            HandAsked::Home(name) => self.axis(name).is_ok_and(|(axis, _)| !self.lost.has(axis)),
            _ => false,
        };
        self.lost.why().filter(|_| moves)
    }

    /// What somebody asks for, as machine code.
    ///
    /// # Errors
    /// Why it is not done; nothing has changed.
    pub(crate) fn give(&mut self, asked: &HandAsked) -> Result<Given, NotGiven> {
        if let Some(why) = self.not_referenced(asked) {
            return Err(NotGiven::NotReferenced(why));
        }
        let at = self.rests.ok_or("the axes have not come to rest yet: press again")?;
        let given = match asked {
            HandAsked::Block(text) => self.block(text, &at)?,
            HandAsked::Spindle(rpm) => self.block(&self.spindle(*rpm)?, &at)?,
            HandAsked::TouchOff { axis, value, tool } => {
                self.block(&self.touch_off(axis, *value, *tool)?, &at)?
            }
            HandAsked::Offset { of, words, add } => self.block(&self.offset(of, words, *add)?, &at)?,
            HandAsked::Step { axis, mm, mm_min } => {
                let (axis, config) = self.axis(axis)?;
                let target = at[axis.index()].moved(*mm);
                let [low, high] = config.travel_mm;
                if !(low..=high).contains(&target.mm()) {
                    let name = axis.name().to_ascii_uppercase();
                    let (to, travel) = (target.mm(), format!("its travel is {low} to {high}"));
                    return Err(format!("{name} would go to {to:.3} of the machine, and {travel}").into());
                }
                let most = 60.0 * config.velocity_mm_s;
                self.jog(&at, (axis, target), feed(*mm_min, most)?, false)
            }
            HandAsked::Home(axis) => {
                let (axis, config) = self.axis(axis)?;
                if self.lost.has(axis) {
                    return Ok(self.taken(self.reference(&at, axis)));
                }
                let target = Position::from_mm(config.home_mm);
                if at[axis.index()] == target {
                    return Err(format!("{} stands at its home", axis.name().to_ascii_uppercase()).into());
                }
                self.jog(&at, (axis, target), Feed::Rapid, false)
            }
            HandAsked::Jog { axis, positive, mm_min } => {
                let (axis, config) = self.axis(axis)?;
                let here = at[axis.index()];
                let lost = self.lost.jogs((axis, config), &self.machine.general, here, *positive);
                if let Some((target, most)) = lost.transpose()? {
                    feed(*mm_min, fastest_jog(config))?;
                    let given = self.jog(&at, (axis, target), feed(mm_min.min(most), most)?, true);
                    return Ok(self.taken(given));
                }
                let target = Position::from_mm(config.travel_mm[usize::from(*positive)]);
                if here == target {
                    let name = axis.name().to_ascii_uppercase();
                    return Err(format!("{name} is at the end of its travel").into());
                }
                self.jog(&at, (axis, target), feed(*mm_min, fastest_jog(config))?, true)
            }
            HandAsked::On
            | HandAsked::JogOn
            | HandAsked::Play(_)
            | HandAsked::ToolIn(_)
            | HandAsked::From(_) => {
                return Err("this is no block".into());
            }
        };
        Ok(self.taken(given))
    }

    /// It goes to the machine.
    fn taken(&mut self, given: Given) -> Given {
        self.steps += given.items.iter().map(Item::steps).sum::<u64>();
        self.items.extend(&given.items);
        self.in_hand = InHand::of(&given.items);
        self.doing = if given.jogs { Doing::Jog } else { Doing::Block };
        self.rests = None;
        given
    }

    fn axis(&self, name: &str) -> Result<(Axis, &AxisConfig), String> {
        let found = self.machine.axes().find(|(axis, _)| axis.name().eq_ignore_ascii_case(name));
        found.ok_or_else(|| {
            let there: Vec<_> =
                self.machine.axes().map(|(axis, _)| axis.name().to_ascii_uppercase()).collect();
            format!("this machine has no axis {name}: {}", there.join(", "))
        })
    }

    /// A block, read by the interpreter of programs.
    fn block(&mut self, text: &str, at: &PerAxis<Position>) -> Result<Given, NotGiven> {
        if text.lines().any(has_tape_mark) {
            return Err("a % stands before and behind a program, and a block has none: leave it out".into());
        }
        let items = self.reader.block(text, at).map_err(|errors| in_words(&errors))?;
        let job = |item: &Item| matches!(item.code, Code::Work(_) | Code::Formula { .. });
        let bytes: usize = items.iter().map(|item| CodePacket::pack(0, item).as_bytes().len() + 2).sum();
        let refused = match () {
            () if items.iter().any(job) => Some("jobs are cut by programs"),
            () if bytes > MOST_BYTES => Some("this is too long for a block"),
            () => None,
        };
        if let Some(why) = refused {
            self.reader.forget_last();
            return Err(format!("{why}: run it as a program").into());
        }
        if let Some(why) = self.lost.refuses(|| self.reader.needs(text, at, &items)) {
            self.reader.forget_last();
            return Err(NotGiven::NotReferenced(why));
        }
        self.first.gives(&items, &self.reader.tool_offset());
        let told = self.reader.messages().iter();
        let messages = told.map(|note| Message {
            line: note.line,
            after: self.steps + note.after,
            text: note.text.clone(),
        });
        let (messages, text) = (messages.collect(), text.trim().replace(['\n', '\r'], " / "));
        Ok(Given { items, messages, jogs: false, text })
    }

    /// One axis goes to a place.
    fn jog(&self, at: &PerAxis<Position>, (axis, to): (Axis, Position), feed: Feed, jogs: bool) -> Given {
        let line = self.reader.blocks() as u32;
        let mut target = *at;
        target[axis.index()] = to;
        let codes = [
            Code::ByHand(ByHand::Begins { at: *at, jogs }),
            Code::Line { target, feed },
            Code::ByHand(ByHand::Waits),
        ];
        let (name, what) = (axis.name().to_ascii_uppercase(), if jogs { "towards" } else { "to" });
        let fast = match feed {
            Feed::PerMinute(mm_min) => format!("at {mm_min} /min"),
            _ => "in rapid motion".into(),
        };
        let text = format!("jog: {name} {what} {:.6} of the machine {fast}", to.mm());
        let items = codes.map(|code| Item { line, code }).to_vec();
        Given { items, messages: Vec::new(), jogs, text }
    }

    /// The reference run of an axis.
    fn reference(&self, at: &PerAxis<Position>, axis: Axis) -> Given {
        let line = self.reader.blocks() as u32;
        let codes = [ByHand::Begins { at: *at, jogs: false }, ByHand::References(axis), ByHand::Waits];
        let items = codes.map(|code| Item { line, code: Code::ByHand(code) }).to_vec();
        let text = format!("reference run: {}", axis.name().to_ascii_uppercase());
        Given { items, messages: Vec::new(), jogs: false, text }
    }

    /// The block that turns the spindle at a speed, 1/min; negative counterclockwise.
    fn spindle(&self, rpm: f64) -> Result<String, String> {
        match (&self.machine.spindle, rpm) {
            (spindle, _) if spindle.is_none() => Err("this machine has no spindle".into()),
            (_, 0.0) => Ok("M5".into()),
            (_, rpm) => Ok(format!("G97 S{:.3} M{}", rpm.abs(), if rpm > 0.0 { 3 } else { 4 })),
        }
    }

    /// The block that makes a place of an axis this value of the coordinate system in force: its zero, or the
    /// offset of a tool, becomes so.
    fn touch_off(&self, axis: &str, value: f64, tool: Option<u32>) -> Result<String, String> {
        let (axis, _) = self.axis(axis)?;
        if self.reader.is_fanuc() {
            return Err(
                "touching off is G10 L20, which FANUC does not have: set the offset with G10 L2".into()
            );
        }
        let (l, p) = tool.map_or((20, u32::from(self.reader.system())), |tool| (10, tool));
        Ok(format!("G10 L{l} P{p} {}{value:.6}", axis.name().to_ascii_uppercase()))
    }

    /// Offsets and tools as they are now; `files` are those that keep them.
    pub(crate) fn table(&self, files: [Option<PathBuf>; 2]) -> Table {
        let [_, units] = self.reader.units();
        Table::in_force_now(self.reader.outlasting().parameters, self.reader.tools().clone(), files, units)
    }

    /// The block that sets words of a coordinate system or a tool.
    fn offset(&self, of: &str, words: &[(char, f64)], add: bool) -> Result<String, String> {
        let table = self.table([None, None]);
        let sets = typed(of, words, add, &table, &self.machine)?;
        let [program, kept] = self.reader.units();
        let length = match (program, kept) {
            (Units::Inch, Units::Millimetre) => 1.0 / 25.4,
            (Units::Millimetre, Units::Inch) => 25.4,
            _ => 1.0,
        };
        let across = if self.reader.x_is_diameter() { 2.0 } else { 1.0 };
        let target = sets[0].target;
        let head = match target {
            Target::System(system) => format!("G10 L2 P{}", system + 1),
            Target::Tool(_) if self.reader.is_fanuc() => {
                let why = "FANUC has no block that sets a tool here: switch the machine off and set it then";
                return Err(why.into());
            }
            Target::Tool(number) => format!("G10 L1 P{number}"),
        };
        let word = |Set { letter, value, .. }: &Set| match (letter, target) {
            ('U' | 'V' | 'W', _) => {
                Err(format!("{letter} is set while the machine is off: no block sets it"))
            }
            // A tool has its radius in that block.
            ('D', _) => Ok(format!("R{}", decimal(0.5 * value * length))),
            ('X', _) => Ok(format!("X{}", decimal(value * length * across))),
            ('Y' | 'Z', _) => Ok(format!("{letter}{}", decimal(value * length))),
            _ => Ok(format!("{letter}{}", decimal(*value))),
        };
        let words: Vec<_> = sets.iter().map(word).collect::<Result<_, _>>()?;
        Ok(format!("{head} {}", words.join(" ")))
    }
}

/// What is wrong with a block.
fn in_words(errors: &[gcode::Diagnostic]) -> String {
    let told = errors.iter().map(|error| match error.help.as_str() {
        "" => error.message.clone(),
        help => format!("{}: {help}", error.message),
    });
    told.collect::<Vec<_>>().join("; ")
}

/// Whether a line has a % outside of comments.
fn has_tape_mark(line: &str) -> bool {
    let mut in_comment = false;
    let words = line.split(';').next().unwrap_or_default();
    words.chars().any(|letter| {
        in_comment = letter == '(' || in_comment && letter != ')';
        letter == '%' && !in_comment
    })
}

/// A number of a block, to a millionth of a micrometre.
fn decimal(value: f64) -> String {
    let text = format!("{value:.9}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
