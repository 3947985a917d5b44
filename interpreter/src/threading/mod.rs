//! Synchronised motion: G33 and the threading cycles. In: a block or a cycle, where the axes rest. Out:
//! passes, and the timed moves to their starts.
//!
//! A G33 waits until it is known what comes next: a G0 that moves only X becomes its retract, made in step
//! with the spindle.

mod words;

use gcode::canon::{Units, X, Z};
use gcode::problem::Blame;
use gcode::{Place, Problem};
use machine::{Machine, Varied};
use protocol::{Axis, AxisLaw, Code, PerAxis, Position, ThreadPass, Variation, WayOut};

use crate::frame::Frame;
use crate::pass_note::{PassNote, bytes_of};
use crate::reach::{Done, within_travel};
use crate::tapping;
use crate::thread::{
    Along, Blunt, Cut, Cycle, Infeeds, MOST_PASSES, Next, Plan, Point, Policy, Said, Single, Starts, Table,
    plan, plans, rounded, top_share, varied,
};

pub(crate) use words::{cycle_on_machine, single};

/// Positions closer than this are one, mm or degrees: the quantum of the wire.
pub(crate) const SAME: f64 = 1e-9;
/// Leads a thread may have, mm.
const LEADS: [f64; 2] = [0.001, 1000.0];
/// The end of a law may miss the programmed one by this much, mm.
const ROUNDING: f64 = 1e-8;

/// A G33 that waits for its retract.
#[derive(Clone, Debug)]
struct Held {
    place: Place,
    single: Single,
    policy: Policy,
    variation: Option<Variation>,
    origin: Point,
}

/// The threads of a program.
#[derive(Default)]
pub(crate) struct Threads {
    held: Option<Held>,
    policy: Policy,
    said: Said,
    table: Table,
    blunt: Blunt,
    /// The variation that machine code has told so far.
    told: Option<Variation>,
    passes: u32,
    pub(crate) starts: Starts,
    pub(crate) infeeds: Infeeds,
    notes: Vec<PassNote>,
    /// What is wrong with passes that can be cut.
    doubts: Vec<Problem>,
}

/// A G33 that has been planned.
pub(crate) struct Released {
    /// Where it stands in the program, and where zero of the program lay there.
    pub(crate) place: Place,
    pub(crate) origin: Point,
    /// The pass; else why there is none.
    pub(crate) pass: Result<ThreadPass, Box<Problem>>,
}

impl Threads {
    /// The passes so far.
    pub(crate) fn notes(&self) -> &[PassNote] {
        &self.notes
    }

    /// A comment may say what makes the tool leave the threads that follow, how the speed is varied in them,
    /// which leads they have, or that their ridge begins bluntly.
    pub(crate) fn comment(&mut self, text: &str) -> Done {
        let by_others = ["thread_milling", "thread_whirling"];
        if let Some(word) = by_others.into_iter().find(|word| begins_with(text, word)) {
            let message =
                format!("{word}: the tool would turn by itself, and here one edge follows the spindle");
            let help = "cut the thread by G33 (G32), G76 or a tap; on a mill a helix of G2 or G3 with Z has the way \
                        of a thread mill, at a feed and not in step with a spindle";
            return Err(Problem::error("not-available", Blame::Block, message, help));
        }
        self.policy.comment(text)?;
        self.said.comment(text)?;
        self.blunt.comment(text)?;
        self.table.comment(text)
    }

    /// The leads that the program says along Z.
    pub(crate) fn table(&self) -> &Table {
        &self.table
    }

    /// Whether cycles make the beginning of a ridge.
    pub(crate) fn is_blunt(&self) -> bool {
        self.blunt.is_in_force()
    }

    /// What machine code has to tell of the speed before a pass.
    pub(crate) fn tells(&mut self, pass: u32) -> Option<Code> {
        let note = self.notes.iter().rfind(|note| note.pass == pass)?;
        let variation = note.varied.map(|(variation, _)| variation);
        (variation != self.told).then(|| {
            self.told = variation;
            Code::Variation(variation)
        })
    }

    /// What is wrong with passes that can be cut, since it was asked last.
    pub(crate) fn take_doubts(&mut self) -> Vec<Problem> {
        std::mem::take(&mut self.doubts)
    }

    /// Whether a G33 waits for its retract.
    pub(crate) fn waits(&self) -> bool {
        self.held.is_some()
    }

    /// The line of the one that waits, and how many legs its chain has so far.
    pub(crate) fn waits_with(&self) -> Option<(u32, usize)> {
        self.held.as_ref().map(|held| (held.place.line, held.single.legs.len()))
    }

    /// Along which axis the one that waits runs.
    pub(crate) fn waits_along(&self) -> Along {
        self.held.as_ref().map_or(Along::Z, |held| held.single.along())
    }

    /// A G33 waits from now on.
    pub(crate) fn hold(&mut self, place: Place, single: Single, origin: Point, machine: &Machine) {
        let variation = self.said.variation(machine);
        self.held = Some(Held { place, single, policy: self.policy, variation, origin });
    }

    /// A thread goes on from the G33 that waits: one chain.
    pub(crate) fn go_on(&mut self, next: Single, frame: Units) -> Done {
        let Some(held) = &mut self.held else { return Ok(()) };
        if next.start_deg != 0.0 && next.start_deg != held.single.start_deg {
            let message = "a thread that goes on from another one has no start angle of its own";
            let help = "leave Q out, or put a G0 between the threads";
            return Err(Problem::error("bad-value", Blame::Word('Q'), message, help));
        }
        let before = held.single.legs.len();
        for leg in next.legs {
            if let Some(why) = held.single.contradicts(&leg) {
                held.single.legs.truncate(before);
                return Err(why.problem(frame));
            }
            held.single.legs.push(leg);
        }
        Ok(())
    }

    /// Where zero of the program lies in a pass, and the tool that cuts it.
    pub(crate) fn lies_at(&mut self, pass: u32, origin: Point, tool: Option<u32>) {
        let noted = self.notes.iter_mut().rfind(|note| note.pass == pass);
        noted.into_iter().for_each(|note| (note.origin_mm, note.tool) = ([origin.x, origin.z], tool));
    }

    /// Plans the G33 that waits, if there is one. `rest` is where the axes are before it.
    pub(crate) fn release(
        &mut self,
        next: Next,
        rest: &PerAxis<Position>,
        machine: &Machine,
    ) -> Option<Released> {
        let Held { place, single, policy, variation, origin } = self.held.take()?;
        let units = single.units;
        let cut = Cut { top_share: top_share(variation), ..Single { next, ..single }.cut() };
        let planned = plan(&cut, machine).map_err(|why| why.problem(&[cut], units, machine));
        let planned = planned.and_then(|plan| Ok((plan, varied(&plan.pass, variation, machine)?)));
        let pass = match planned {
            Ok((mut planned, varied)) => {
                let start = self.starts.number(&cut, place);
                planned.pass.out.leaves = policy.leaves(planned.pass.out.leaves);
                if next == Next::Stays {
                    // Nobody knows where the tool may go back to the start: a hold cuts the pass to its end.
                    planned.pass.out.leaves &= !WayOut::ON_HOLD;
                }
                Ok(self.number((place, units), (planned, varied), &cut, start, rest, machine))
            }
            Err(problem) => Err(Box::new(Problem { blame: Blame::Line(place.line), ..*problem })),
        };
        Some(Released { place, origin, pass })
    }

    /// Every pass of a threading cycle, each from the start point of its cut.
    pub(crate) fn cycle(
        &mut self,
        place: Place,
        cycle: &Cycle,
        rest: &PerAxis<Position>,
        (frame, machine): (&Frame, &Machine),
    ) -> Result<Vec<(Point, ThreadPass)>, Box<Problem>> {
        let depths = cycle.depths();
        let deepest = depths.iter().copied().fold(0.0, f64::max);
        if depths.len() > MOST_PASSES {
            let message = format!("the cycle would take more than {MOST_PASSES} passes");
            let help = "raise the depth of the first pass, or lower the degression";
            return Err(Problem::error("bad-value", Blame::Block, message, help));
        }
        let variation = self.said.variation(machine);
        let blunt = self.blunt.cuts(cycle, frame)?;
        let laid_out = blunt.as_ref().map(|_| Blunt::machine(machine));
        let laid_out = laid_out.as_ref().unwrap_or(machine);
        let mut cuts = blunt.unwrap_or_else(|| depths.into_iter().map(|depth| cycle.cut(depth)).collect());
        cuts.iter_mut().for_each(|cut| cut.top_share = top_share(variation));
        for cut in &cuts {
            within_travel(machine, Axis::X, cut.from.x + cut.approach_mm, Blame::Block)?;
            within_travel(machine, Axis::Z, cut.from.z, Blame::Block)?;
            within_travel(machine, Axis::Z, cut.to_mm, Blame::Block)?;
        }
        let (mut plans, doubt) = plans(cycle, &mut cuts, place.line, laid_out)?;
        let varied = plans.iter().map(|plan| varied(&plan.pass, variation, machine));
        let varied = varied.collect::<Result<Vec<_>, _>>()?;
        self.doubts.extend(doubt);
        plans.iter_mut().for_each(|plan| plan.pass.out.leaves = self.policy.leaves(plan.pass.out.leaves));
        // A pass of a blunt start lies beside the groove that it belongs to.
        let groove = self.is_blunt().then(|| cycle.cut(deepest)).or(cuts.first().copied());
        let start = groove.map_or(0, |cut| self.starts.number(&cut, place));
        let passes = cuts.iter().zip(plans.into_iter().zip(varied));
        Ok(passes
            .map(|(cut, planned)| {
                let blunt = self.blunt.note(cut, &planned.0, frame);
                let pass = self.number((place, cycle.units), planned, cut, start, rest, machine);
                self.notes.iter_mut().next_back().into_iter().for_each(|note| note.blunt = blunt);
                (cut.from, pass)
            })
            .collect())
    }

    /// Gives a pass its number, a law of rest to the axes that it does not move, and a note.
    fn number(
        &mut self,
        (place, units): (Place, Units),
        (planned, varied): (Plan, Option<(Variation, Varied)>),
        cut: &Cut,
        start: u32,
        rest: &PerAxis<Position>,
        machine: &Machine,
    ) -> ThreadPass {
        self.passes += 1;
        let mut pass = ThreadPass { pass: self.passes, start, ..planned.pass };
        for (axis, _) in machine.axes().filter(|(axis, _)| !matches!(axis, Axis::X | Axis::Z)) {
            let at = rest[axis.index()];
            pass.axes[axis.index()] = AxisLaw { start: at, end: at, ..AxisLaw::default() };
        }
        let shallow = mostly_shallow((place.line, units), cut, planned.full_depth_mm);
        if let Some(doubt) = shallow.filter(|_| !self.is_blunt()) {
            // Of the passes of a cycle the deepest, which comes last, takes the longest way out.
            self.doubts.retain(|other| (other.code, other.blame) != (doubt.code, doubt.blame));
            self.doubts.push(doubt);
        }
        let (across, line) = (pass.axis(cut.along.lifts()), place.line);
        let infeed_mm = if self.is_blunt() { None } else { self.infeeds.beyond(cut, start, place) };
        self.notes.push(PassNote {
            pass: pass.pass,
            line,
            along: cut.along.axis(),
            depth_mm: cut.depth_is_told.then_some(pass.depth_mm),
            across_mm: across.start.mm() + across.stroke_mm,
            start_mm: pass.axis(cut.along.axis()).start.mm(),
            full_depth_mm: planned.full_depth_mm,
            delta_mm: planned.delta_mm,
            max_override_pct: 100.0 * varied.map_or(pass.max_ratio, |(_, varied)| varied.max_ratio),
            packet_bytes: bytes_of(line, pass),
            origin_mm: [0.0; 2],
            corners: rounded(cut, &pass),
            end_lead_mm: (!cut.chain.bends().is_empty()).then(|| cut.along.of(cut.at_its_end()[0])),
            tap: None,
            infeed_mm,
            tool: None,
            varied,
            blunt: None,
        });
        pass
    }

    /// What makes the axes leave a pass, if the machine file says `otherwise` of what the program does not.
    pub(crate) fn leaves(&self, otherwise: u32) -> u32 {
        self.policy.leaves(otherwise)
    }

    /// Gives a tap its number and a note; `across_mm` is X.
    pub(crate) fn tap(&mut self, place: Place, planned: tapping::Planned, across_mm: f64) -> ThreadPass {
        self.passes += 1;
        let pass = ThreadPass { pass: self.passes, ..planned.pass };
        let law = pass.axis(Axis::Z);
        let depth_deg = pass.thread_end_deg - law.run_in_c0_deg - 0.5 * law.run_in_dc_deg;
        self.notes.push(PassNote {
            pass: pass.pass,
            line: place.line,
            along: Axis::Z,
            depth_mm: None,
            across_mm,
            start_mm: law.start.mm(),
            full_depth_mm: [planned.on_helix_mm, law.start.mm() + law.lead_mm * depth_deg / 360.0],
            delta_mm: [planned.run_in_mm; 2],
            max_override_pct: 100.0 * pass.max_ratio,
            packet_bytes: bytes_of(place.line, pass),
            origin_mm: [0.0; 2],
            tap: Some(planned.note),
            infeed_mm: None,
            tool: None,
            varied: None,
            blunt: None,
            corners: Vec::new(),
            end_lead_mm: None,
        });
        pass
    }
}

/// A thread that is at full depth over less than half of its length: run-in and run-out take the rest.
fn mostly_shallow((line, units): (u32, Units), cut: &Cut, [from, to]: [f64; 2]) -> Option<Problem> {
    const LEAST_SHARE: f64 = 0.5;
    let taper_mm = cut.exit.map_or(0.0, |taper| taper.length_mm);
    let [full, whole] = [to, cut.to_mm].map(|end| (end - from).abs());
    let message = format!(
        "the thread is at full depth over {} of its {}: then {} has to leave, as fast as it is",
        units.length(full),
        units.length(whole),
        cut.along.lifts()
    );
    let help = "a slower spindle leaves over less of it; or cut the thread farther, into a groove";
    (full < LEAST_SHARE * (whole - taper_mm))
        .then(|| *Problem::warning("mostly-shallow", Blame::Line(line), message, help))
}

/// Whether this word stands alone at the beginning of a comment, or with a comma behind it.
fn begins_with(text: &str, word: &str) -> bool {
    let text = text.trim();
    let rest = text
        .get(..word.len())
        .filter(|begins| begins.eq_ignore_ascii_case(word))
        .map(|_| &text[word.len()..]);
    rest.is_some_and(|rest| rest.is_empty() || rest.trim_start().starts_with(','))
}

/// X and Z of a point.
pub(crate) fn in_plane(point: &gcode::Pose) -> Point {
    Point { x: point[X], z: point[Z] }
}

/// A point with other X and Z.
pub(crate) fn in_plane_of(point: &gcode::Pose, Point { x, z }: Point) -> gcode::Pose {
    let mut moved = *point;
    (moved[X], moved[Z]) = (x, z);
    moved
}

pub(crate) fn check_lead(mm: f64, letter: char, units: Units) -> Done {
    let [low, high] = LEADS;
    if (low..=high).contains(&mm) {
        return Ok(());
    }
    let message = format!("{} is not a lead", units.length(mm));
    let [low, high] = [low, high].map(|mm| units.length(mm));
    let help = format!("a lead lies between {low} and {high}; its sign comes from the direction of the move");
    Err(Problem::error("bad-value", Blame::Word(letter), message, help))
}

/// Whether two points are so far apart in X or Z that a move between them is worth making.
pub(crate) fn is_apart(one: &gcode::Pose, other: &gcode::Pose) -> bool {
    (one[Z] - other[Z]).abs().max((one[X] - other[X]).abs()) > ROUNDING
}
