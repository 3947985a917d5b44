//! A recipe as a part program. In: a [`Recipe`], a dialect, a unit. Out: text, which says in comments what
//! its numbers come from.
//!
//! Lengths are rounded to what the unit can say, in both dialects alike; so both make the same passes. Where
//! a threading cycle says the same the passes are a cycle, else each of them is a block of G33 or G32.

use std::fmt::Write as _;

use gauge::Side;

use crate::words::Words;
use crate::{Dialect, Law, Pass, Recipe, Sequence, Units};

/// Angles of tools that the G76 of FANUC knows, degrees.
const FANUC_ANGLES: [f64; 6] = [80.0, 60.0, 55.0, 30.0, 29.0, 0.0];
/// Feed at which the crest is turned, mm per revolution.
const TURN_FEED_MM: f64 = 0.1;
/// How far before the face that feed begins, and how far behind the thread the tool ends, mm.
const BEFORE_MM: f64 = 2.0;
const AWAY_MM: f64 = 30.0;

/// The lengths of a program, in steps of its unit; diameters but for the depths.
struct Steps {
    crest: i64,
    clear: i64,
    depth: i64,
    start: i64,
    end: i64,
    pitch: f64,
}

/// Writes a program.
struct Writer<'a> {
    recipe: &'a Recipe,
    words: Words,
    at: Steps,
    text: String,
}

/// A recipe as a part program.
#[must_use]
pub fn program(recipe: &Recipe, dialect: Dialect, units: Units) -> String {
    let words = Words { dialect, units };
    let at = Steps {
        crest: 2 * units.of(0.5 * recipe.crest_mm),
        clear: units.of(recipe.clear_mm),
        depth: units.of(recipe.depth_mm),
        start: units.of(recipe.start_mm),
        end: units.of(recipe.end_mm),
        pitch: recipe.nominal.pitch_mm / units.mm() * units.steps(),
    };
    let mut writer = Writer { recipe, words, at, text: String::new() };
    writer.head();
    if recipe.turn {
        writer.crest();
    }
    writer.thread();
    writer.text
}

/// Whether a threading cycle of a dialect says the same.
fn is_cycle(recipe: &Recipe, dialect: Dialect) -> bool {
    let by_root = |(n, pass): (usize, &Pass)| {
        let last = n + 1 == recipe.passes.len();
        let depth = recipe.passes[0].depth_mm * libm::pow(n as f64 + 1.0, 0.5);
        if last {
            depth >= pass.depth_mm - 1e-9
        } else {
            (depth - pass.depth_mm).abs() < 0.01 * recipe.depth_mm
        }
    };
    let angle = recipe.infeed.cycle_deg(recipe.edge.flank_deg, -1.0);
    let has_angle = |deg: f64| dialect == Dialect::Linuxcnc || FANUC_ANGLES.contains(&(2.0 * deg));
    !recipe.written_out
        && recipe.slope == 0.0
        && recipe.law == Law::Root
        && recipe.passes.len() > 1
        && angle.is_some_and(has_angle)
        // FANUC has one at least.
        && (dialect == Dialect::Linuxcnc || recipe.springs > 0)
        && (recipe.starts() == 1 || recipe.sequence == Sequence::ByStart)
        && recipe.passes.iter().enumerate().all(by_root)
}

impl Writer<'_> {
    fn line(&mut self, text: &str) {
        self.text.push_str(text);
        self.text.push('\n');
    }

    fn remark(&mut self, text: &str) {
        self.text += &self.words.comment(text);
    }

    fn is_fanuc(&self) -> bool {
        self.words.dialect == Dialect::Fanuc
    }

    /// What it is, what cuts it, and what stays in force.
    fn head(&mut self) {
        let recipe = self.recipe;
        if self.is_fanuc() {
            self.line("%");
            self.line("O1000");
        }
        self.remark(&format!("{}, written by pitchlock thread", recipe.thread));
        let edge = recipe.edge;
        let angle: f64 = edge.flank_deg.iter().sum();
        let words = self.words;
        let [flat, nose] = [edge.flat_mm, edge.nose_mm].map(|mm| words.told_with_unit(mm));
        let tip = match (edge.flat_mm > 0.0, edge.nose_mm > 0.0) {
            (false, false) => "a sharp point".into(),
            (false, true) => format!("a nose of {nose}"),
            (true, false) => format!("a flat of {flat}"),
            (true, true) => format!("a flat of {flat} between noses of {nose}"),
        };
        self.remark(&format!("T{}: {}, {angle} degrees, {tip}", recipe.tool_number, recipe.tool));
        let [least, most] = recipe.nominal.pitch_diameter_mm;
        let text = format!(
            "pitch diameter {} to {}, so the tip ends at {}, {} below the crest at {}",
            words.told(least),
            words.told_with_unit(most),
            words.told(recipe.root_mm),
            words.told(recipe.depth_mm),
            words.told(recipe.crest_mm)
        );
        self.remark(&text);
        self.remark(&format!("thread, {}", self.name()));
        if self.words.dialect == Dialect::Linuxcnc {
            self.remark("where a tool table holds the offsets, write G43 behind each M6");
        }
        let unit = if self.words.units == Units::Mm { "G21" } else { "G20" };
        self.line(&match self.words.dialect {
            Dialect::Linuxcnc => format!("{unit} G18 G90 G7 G40 G97 G95"),
            Dialect::Fanuc => format!("{unit} G18 G40 G97 G99"),
        });
        // In the unit that is in force now.
        self.remark(&format!("thread_insert, {}", self.insert()));
    }

    /// The words of its tip, by which a check finds that the machine has another one.
    fn insert(&self) -> String {
        let Recipe { edge, width_mm, .. } = self.recipe;
        let mut text = format!("A{}", edge.flank_deg.iter().sum::<f64>());
        for (letter, mm) in [('R', edge.nose_mm), ('W', *width_mm)] {
            if mm > 0.0 {
                text += &format!(" {letter}{}", self.words.told(mm));
            }
        }
        text
    }

    /// The name as the gauge understands it, in capitals too.
    fn name(&self) -> String {
        let name = match self.recipe.nominal.name.starts_with('P') {
            true => self.recipe.nominal.name.clone(),
            false => self.recipe.thread.to_string(),
        };
        let told = name.ends_with("external") || name.ends_with("internal");
        match self.recipe.side() {
            Side::External if self.is_fanuc() && !told && !name.starts_with('P') => name + " external",
            _ => name,
        }
    }

    /// A tool with the spindle at speed.
    fn tool(&mut self, number: u32, is_left: bool, what: &str) {
        let turn = if is_left { 4 } else { 3 };
        let speed = self.recipe.s_rpm;
        let text = match self.words.dialect {
            Dialect::Linuxcnc => format!("\nM5\nT{number} M6 ({what})\nS{speed} M{turn}"),
            Dialect::Fanuc => {
                format!(
                    "\nM05\nT{number:02}{number:02} ({})\nG97 S{speed} M{turn:02}",
                    what.to_ascii_uppercase()
                )
            }
        };
        self.line(&text);
    }

    /// A block of a G code with X and Z, in steps.
    fn go(&mut self, code: &str, x: Option<i64>, z: Option<i64>, more: &str) {
        let mut text = code.to_owned();
        for (letter, steps) in [('X', x), ('Z', z)] {
            if let Some(steps) = steps {
                let _ = write!(text, " {letter}{}", self.words.steps(steps));
            }
        }
        self.line(&(text + more));
    }

    fn rapid(&self) -> &'static str {
        if self.is_fanuc() { "G00" } else { "G0" }
    }

    /// Diameter of a line along the thread that has `steps` at Z 0, at a place along Z in steps.
    fn along(&self, steps: i64, z: i64) -> i64 {
        2 * (0.5 * steps as f64 + self.recipe.slope * z as f64).round() as i64
    }

    /// Turns the crest in one cut.
    fn crest(&mut self) {
        let (number, what) = self.recipe.turning_tool();
        self.tool(number, false, &format!("{what}: the crest in one cut"));
        let near = if self.recipe.side() == Side::External {
            "the bar is a little larger"
        } else {
            "the bore is a little smaller"
        };
        self.remark(&format!("{near}, by no more than this tool takes off in one cut"));
        let before = self.words.units.of(BEFORE_MM);
        let feed = format!(" F{}", self.words.number(TURN_FEED_MM / self.words.units.mm(), 4));
        let (clear, end, rapid) = (self.at.clear, self.at.end, self.rapid());
        let [from, to] = [before, end].map(|z| self.along(self.at.crest, z));
        let line = if self.is_fanuc() { "G01" } else { "G1" };
        self.go(rapid, Some(clear), Some(before), "");
        self.go(rapid, Some(from), None, "");
        self.go(line, Some(to), Some(end), &feed);
        self.go(rapid, Some(clear), None, "");
        self.go(rapid, None, Some(self.words.units.of(AWAY_MM)), "");
    }

    /// Cuts the thread, and ends the program.
    fn thread(&mut self) {
        let recipe = self.recipe;
        self.tool(recipe.tool_number, recipe.thread.profile().left_hand, "threading tool");
        let count = recipe.passes.len();
        let springs = recipe.springs;
        let starts = if recipe.starts() == 1 {
            String::new()
        } else {
            format!(" in each of {} starts", recipe.starts())
        };
        let unit = recipe.speed_m_min();
        let passes = if count == 1 { "pass" } else { "passes" };
        self.remark(&format!("{count} {passes} and {springs} at full depth{starts}, {unit:.0} m/min"));
        if is_cycle(recipe, self.words.dialect) {
            self.cycles();
        } else {
            self.passes();
        }
        let (rapid, clear) = (self.rapid(), self.at.clear);
        self.go(rapid, Some(clear), None, "");
        self.go(rapid, None, Some(self.at.start.max(self.words.units.of(AWAY_MM))), "");
        self.line(match self.words.dialect {
            Dialect::Linuxcnc => "M5\nM2",
            Dialect::Fanuc => "M05\nM30\n%",
        });
    }

    /// Where a start begins, in steps along Z: a pitch before the last one.
    fn start(&self, number: u32) -> i64 {
        self.at.start + (f64::from(number) * self.at.pitch).round() as i64
    }

    /// A cycle for each start.
    fn cycles(&mut self) {
        let recipe = self.recipe;
        let Steps { crest, clear, depth, end, .. } = self.at;
        let inwards = if recipe.side() == Side::External { -1 } else { 1 };
        let first = self.words.units.of(recipe.passes[0].depth_mm);
        let first = if recipe.passes[0].depth_mm
            > first as f64 / self.words.units.steps() * self.words.units.mm() + 1e-9
        {
            first + 1
        } else {
            first
        };
        let angle = recipe.infeed.cycle_deg(recipe.edge.flank_deg, -1.0).unwrap_or_default();
        for number in 0..recipe.starts() {
            let (rapid, start) = (self.rapid(), self.start(number));
            self.go(rapid, Some(clear), Some(start), "");
            let words = self.words;
            match words.dialect {
                Dialect::Linuxcnc => {
                    let [i, j, k] = [crest - clear, 2 * first, 2 * depth].map(|steps| words.steps(steps));
                    let lead = words.lead(recipe.lead_mm);
                    let deg = words.number(angle, 4);
                    let text = format!(
                        "G76 P{lead} Z{} I{i} J{j} K{k} R2 Q{deg} H{}",
                        words.steps(end),
                        recipe.springs
                    );
                    self.line(&text);
                }
                Dialect::Fanuc => {
                    let root = words.steps(crest + 2 * inwards * depth);
                    let text = format!("G76 P{:02}00{:02} Q1 R0.", recipe.springs, 2.0 * angle);
                    self.line(&text);
                    let lead = words.lead(recipe.lead_mm);
                    let text = format!("G76 X{root} Z{} P{depth} Q{first} F{lead}", words.steps(end));
                    self.line(&text);
                }
            }
        }
    }

    /// Every pass of every start.
    fn passes(&mut self) {
        let recipe = self.recipe;
        let last = recipe.passes.last().copied().into_iter();
        let springs = last.cycle().take(recipe.springs as usize);
        let passes: Vec<Pass> = recipe.passes.iter().copied().chain(springs).collect();
        let starts = recipe.starts();
        match recipe.sequence {
            Sequence::ByStart => {
                for start in 0..starts {
                    passes
                        .iter()
                        .enumerate()
                        .for_each(|(n, pass)| self.pass((n, passes.len()), *pass, start));
                }
            }
            Sequence::ByDepth => {
                for (n, pass) in passes.iter().enumerate() {
                    (0..starts).for_each(|start| self.pass((n, passes.len()), *pass, start));
                }
            }
        }
    }

    /// One pass of one start.
    fn pass(&mut self, (n, of): (usize, usize), pass: Pass, start: u32) {
        let recipe = self.recipe;
        let units = self.words.units;
        let inwards = if recipe.side() == Side::External { -1 } else { 1 };
        let beside = units.of(pass.beside_mm);
        let (from, end) = (self.start(start) + beside, self.at.end + beside);
        let tip = self.at.crest + 2 * inwards * units.of(pass.depth_mm);
        let [x_from, x_end] = [from, end].map(|z| self.along(tip, z));
        let number = if recipe.starts() == 1 { String::new() } else { format!(" of start {}", start + 1) };
        self.remark(&format!(
            "pass {}{number} of {of}: {} deep",
            n + 1,
            self.words.told_with_unit(pass.depth_mm)
        ));
        let (rapid, clear) = (self.rapid(), self.at.clear);
        self.go(rapid, Some(clear), Some(from), "");
        self.go(rapid, Some(x_from), None, "");
        let x = (recipe.slope != 0.0).then_some(x_end);
        let (code, lead) = match self.words.dialect {
            // Along the path.
            Dialect::Linuxcnc => (
                "G33",
                format!(" K{}", self.words.lead(recipe.lead_mm * self.stretch(x_from, x_end, from, end))),
            ),
            Dialect::Fanuc => ("G32", format!(" F{}", self.words.lead(recipe.lead_mm))),
        };
        self.go(code, x, Some(end), &lead);
        self.go(rapid, Some(clear), None, "");
    }

    /// Length of the path over its length along Z.
    fn stretch(&self, x_from: i64, x_end: i64, from: i64, end: i64) -> f64 {
        if self.recipe.slope == 0.0 {
            return 1.0;
        }
        let rise = 0.5 * (x_end - x_from) as f64 / (end - from) as f64;
        libm::sqrt(1.0 + rise * rise)
    }
}
