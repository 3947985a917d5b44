//! Threading blocks: G33 and G76. In: a block and the modal state. Out: passes, and the timed moves to their starts.

use protocol::{Axis, Code, Feed, ThreadPass};

use crate::block::{Block, Motion, Task};
use crate::codes::whole;
use crate::diagnostic::{Diagnostic, short};
use crate::execute::{Interpreter, Output};
use crate::moves::{positions, within_travel};
use crate::state::State;
use crate::thread::{Cut, Cycle, MOST_PASSES, Plan, Point, Single, plan};
use crate::words::{Line, Word, read_line};

/// Leads a thread may have, mm.
const LEADS: [f64; 2] = [0.001, 1000.0];
/// Angles of infeed, degrees.
const INFEED_DEG: f64 = 80.0;
/// Highest degression.
const DEGRESSION: f64 = 100.0;
/// Lines read ahead in search of the retract that follows a G33.
const LINES_AHEAD: usize = 100;
/// Positions closer than this are one, mm: the quantum of the wire.
const SAME: f64 = 1e-9;
/// The end of a law may miss the programmed one by this much, mm.
const ROUNDING: f64 = 1e-8;

/// What a user wants to know about a pass before it is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassNote {
    /// Running number, from 1.
    pub pass: u32,
    /// Line of the program.
    pub line: u32,
    /// Depth below the crest, mm; 0 for G33, which does not know it.
    pub depth_mm: f64,
    /// Z at which the pass starts, mm.
    pub start_z_mm: f64,
    /// Z at which full depth begins and ends, mm.
    pub full_depth_z_mm: [f64; 2],
    /// ΔZ of the run-in and of the run-out, mm.
    pub delta_z_mm: [f64; 2],
    /// Highest spindle speed that every axis can follow, per cent of the programmed one.
    pub max_override_pct: f64,
    /// Size of the pass on the wire, bytes.
    pub packet_bytes: usize,
}

impl Interpreter {
    /// G33: one pass along the path to the target.
    pub(crate) fn thread_move(&mut self, block: &Block, output: &mut Output) -> Result<(), Diagnostic> {
        let k = block.needed('K', "G33", "the advance per revolution along the path")?;
        let (s_rpm, direction) = self.spindle_of_thread(block)?;
        let k_mm = lead(&k, k.value * self.state.unit_mm)?;
        let target = self.programmed_target(block)?;
        let (from, spot) = (self.state.point, block.spot_of_task());
        if (target.z - from.z).abs() < SAME {
            let message = "G33 without a move along Z";
            let help = "threads along X alone (scrolls) are not available yet: add a Z word";
            return Err(Diagnostic::error("not-available", spot, message, help));
        }
        if self.state.after_thread {
            let message = "threads that follow each other without a pause are not available yet";
            return Err(Diagnostic::error("not-available", spot, message, "put a G0 between the G33 blocks"));
        }
        let retract_to = self.retract_ahead(target);
        let single = Single { s_rpm, direction, from, to: target, k_mm, retract_to };
        let cut = single.cut();
        self.state.point = target;
        let planned = plan(&cut, &self.machine).map_err(|why| why.diagnostic(&[cut], &self.machine, spot))?;
        let start = self.state.starts.number(&cut);
        self.add_pass(block, planned, start, output);
        self.state.after_thread = true;
        if retract_to.is_none() {
            let message = "the tool stays in the groove while Z brakes and marks it";
            let help = "let a G0 that moves only X follow: it is then made in step with the spindle";
            self.warnings.push(Diagnostic::warning("no-retract", spot, message, help));
        }
        Ok(())
    }

    /// Where the next block takes X, if it is a G0 that moves only X. The state is that of the G33 block.
    fn retract_ahead(&self, from: Point) -> Option<f64> {
        let parameters = &self.state.parameters;
        let next = self
            .lines_ahead()
            .take(LINES_AHEAD)
            .map(|(number, text)| read_line(number, text, parameters))
            .find(|line| !line.as_ref().is_ok_and(Line::is_empty))?
            .ok()?;
        let block = Block::new(&next, Motion::Thread).ok()?;
        if block.task != Task::Line(Motion::Rapid) || !block.only_moves() {
            return None;
        }
        let mut state = State { point: from, ..self.state.clone() };
        state.set_modes(&block);
        let value = |letter| block.word(letter).map(|word| word.value);
        let to = state.target(value('X'), value('Z'));
        let reachable = within_travel(&self.machine, Axis::X, to.x, block.spot).is_ok();
        (reachable && (to.z - from.z).abs() < SAME && (to.x - from.x).abs() > SAME).then_some(to.x)
    }

    /// G76: every pass of a thread, with the moves between them.
    pub(crate) fn thread_cycle(&mut self, block: &Block, output: &mut Output) -> Result<(), Diagnostic> {
        let cycle = self.words_of_cycle(block)?;
        let spot = block.spot_of_task();
        let depths = cycle.depths();
        if depths.len() > MOST_PASSES {
            let message = format!("the cycle would take more than {MOST_PASSES} passes");
            return Err(Diagnostic::error("bad-value", spot, message, "raise J, or lower R or H"));
        }
        let cuts: Vec<Cut> = depths.into_iter().map(|depth| cycle.cut(depth)).collect();
        let mut plans = Vec::with_capacity(cuts.len());
        for cut in &cuts {
            within_travel(&self.machine, Axis::X, cut.from.x + cut.approach_mm, spot)?;
            within_travel(&self.machine, Axis::Z, cut.from.z, spot)?;
            within_travel(&self.machine, Axis::Z, cut.to_z, spot)?;
            plans.push(plan(cut, &self.machine).map_err(|why| why.diagnostic(&cuts, &self.machine, spot))?);
        }
        for (cut, planned) in cuts.iter().zip(plans) {
            self.rapid_to(cut.from, output);
            self.add_pass(block, planned, 0, output);
        }
        let end = Point { x: cycle.from.x, z: cycle.to_z };
        if (self.state.rest.z - end.z).abs() > ROUNDING {
            self.rapid_to(end, output);
        }
        (self.state.point, self.state.after_thread) = (end, false);
        Ok(())
    }

    /// The words of a G76 block.
    fn words_of_cycle(&self, block: &Block) -> Result<Cycle, Diagnostic> {
        let (s_rpm, direction) = self.spindle_of_thread(block)?;
        let (unit, radius) = (self.state.unit_mm, self.state.radius_mm());
        let z = block.needed('Z', "G76", "where the thread ends")?;
        let p = block.needed('P', "G76", "the lead")?;
        let i =
            block.needed('I', "G76", "from the drive line to the crest, negative for an external thread")?;
        let j = block.needed('J', "G76", "the depth of the first pass")?;
        let k = block.needed('K', "G76", "the full depth of the thread")?;
        let from = self.state.point;
        let to_z = self.state.target(None, Some(z.value)).z;
        if (to_z - from.z).abs() < SAME {
            return Err(bad(&z, "the thread has no length", "let Z differ from where the tool stands"));
        }
        if i.value == 0.0 {
            return Err(bad(&i, "I is 0", "the drive line must be clear of the crest by I"));
        }
        if j.value <= 0.0 {
            return Err(bad(&j, "J must be positive", "J is the depth of the first pass, without sign"));
        }
        if k.value < j.value {
            return Err(bad(&k, "K is less than J", "K is the full depth, J the depth of the first pass"));
        }
        let h = optional(block, 'H', 0.0, |h| h >= 0.0, "a whole number of spring passes, 0 or above")?;
        let (taper_mm, taper) = self.tapers(block, (to_z - from.z).abs())?;
        Ok(Cycle {
            s_rpm,
            direction,
            from,
            to_z,
            lead_mm: lead(&p, p.value * unit)?,
            crest_mm: i.value * radius,
            first_mm: j.value * radius,
            full_mm: k.value * radius,
            degression: optional(block, 'R', 1.0, |r| (1.0..=DEGRESSION).contains(&r), "1 to 100")?,
            infeed_deg: optional(block, 'Q', 0.0, |q| q.abs() <= INFEED_DEG, "-80 to 80 degrees")?,
            springs: whole_number(block, 'H', h)?,
            taper_mm,
            taper_in: taper & 1 != 0,
            taper_out: taper & 2 != 0,
        })
    }

    /// E in mm and L: 0 none, 1 entry, 2 exit, 3 both.
    fn tapers(&self, block: &Block, drive_line_mm: f64) -> Result<(f64, u32), Diagnostic> {
        let which = optional(block, 'L', 0.0, |l| (0.0..=3.0).contains(&l), "0, 1, 2 or 3")?;
        let which = whole_number(block, 'L', which)?;
        let length = self.state.unit_mm * optional(block, 'E', 0.0, |e| e >= 0.0, "a length, 0 or above")?;
        if let Some(e) = block.word('E').filter(|_| which > 0 && length > 0.5 * drive_line_mm) {
            let message = format!("E is longer than half the drive line ({} mm)", short(drive_line_mm));
            return Err(bad(&e, &message, "shorten the taper"));
        }
        match block.word('L') {
            Some(l) if which > 0 && length == 0.0 => Err(bad(
                &l,
                "L asks for a taper that has no length",
                "give its length with E, or leave L out",
            )),
            None if length > 0.0 => {
                let e = block.needed('E', "G76", "the length of the taper")?;
                Err(bad(&e, "E without L: no taper would be cut", "add L1 (entry), L2 (exit) or L3 (both)"))
            }
            _ => Ok((length, which)),
        }
    }

    /// Speed and direction of a spindle that turns.
    fn spindle_of_thread(&self, block: &Block) -> Result<(f64, f64), Diagnostic> {
        let Some(rpm) = self.state.turning() else {
            let message = "a thread needs a turning spindle";
            let help = "start it in a block before or in this one, as in S400 M3";
            return Err(Diagnostic::error("spindle-not-turning", block.spot_of_task(), message, help));
        };
        Ok((rpm, self.state.spindle.sign()))
    }

    fn rapid_to(&mut self, target: Point, output: &mut Output) {
        if positions(target) != positions(self.state.rest) {
            output.push(Code::Line { target: positions(target), feed: Feed::Rapid });
            self.state.rest = target;
        }
    }

    fn add_pass(&mut self, block: &Block, planned: Plan, start: u32, output: &mut Output) {
        self.state.passes += 1;
        let pass = ThreadPass { pass: self.state.passes, start, ..planned.pass };
        let (x, z) = (pass.axis(Axis::X), pass.axis(Axis::Z));
        self.state.rest = Point { x: x.end.mm(), z: z.end.mm() };
        self.notes.push(PassNote {
            pass: pass.pass,
            line: block.spot.line,
            depth_mm: pass.depth_mm,
            start_z_mm: z.start.mm(),
            full_depth_z_mm: planned.full_depth_z_mm,
            delta_z_mm: planned.delta_z_mm,
            max_override_pct: 100.0 * pass.max_ratio,
            packet_bytes: size_of::<ThreadPass>(),
        });
        output.push(Code::Pass(pass));
    }
}

fn bad(word: &Word, message: &str, help: &str) -> Diagnostic {
    Diagnostic::error("bad-value", word.spot, message, help)
}

fn lead(word: &Word, mm: f64) -> Result<f64, Diagnostic> {
    let [low, high] = LEADS;
    if (low..=high).contains(&mm) {
        return Ok(mm);
    }
    let message = format!("{} mm is no lead", short(mm));
    let help =
        format!("a lead lies between {low} and {high} mm; its sign comes from the direction of the move");
    Err(bad(word, &message, &help))
}

/// The value of a word that may be left out.
fn optional(
    block: &Block,
    letter: char,
    default: f64,
    allowed: impl Fn(f64) -> bool,
    range: &str,
) -> Result<f64, Diagnostic> {
    let Some(word) = block.word(letter) else { return Ok(default) };
    if allowed(word.value) {
        return Ok(word.value);
    }
    Err(bad(&word, &format!("{letter}{} is out of range", short(word.value)), &format!("allowed: {range}")))
}

fn whole_number(block: &Block, letter: char, value: f64) -> Result<u32, Diagnostic> {
    match (whole(value).and_then(|n| u32::try_from(n).ok()), block.word(letter)) {
        (Some(number), _) => Ok(number),
        (None, word) => {
            let spot = word.map_or(block.spot, |word| word.spot);
            let message = format!("{letter}{} is not a whole number", short(value));
            Err(Diagnostic::error("bad-value", spot, message, "give a whole number"))
        }
    }
}
