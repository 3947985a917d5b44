//! A blunt (Higbee) start as the program says it: `(blunt_start, Z0 T0.9 D0.1)`, `(blunt_start, off)`. A
//! threading cycle in its force takes the thin beginning of the ridge away instead of cutting the groove. In:
//! the text of a comment; a cycle, mm. Out: its cuts, or a problem that says what would do.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | f, T, D | mm, rev, mm | face of the part; turns behind it at which the ridge begins; step between two passes at most |
//! | L, φ, z | mm, deg, mm | lead, start angle of the groove, where its thread ends, Z growing along the thread |
//! | k, N | – | number of a pass, from 1; how many there are |
//!
//! ```text
//! N = ⌈T L/D⌉,  δ = k T L/N;   φ' = φ + 360 δ/L:  the helix lies by δ beside the groove, towards the face
//!                              z' = f + T L − δ:  it ends where the groove is T turns behind the face (M260)
//! ```
//! All of them leave at one angle of the spindle, however fast that turns: there the ridge begins. What is
//! left between two passes is D²/(8 r) high under a nose of radius r, and nothing under a flat as wide as D.

use gcode::Problem;
use gcode::problem::{Blame, short};
use machine::{Machine, RunOut};
use motion::Stroke;

use super::cut::Cut;
use super::cycle::{Cycle, MOST_PASSES};
use super::flank::largest;
use super::plan::Plan;
use crate::frame::Frame;

const WORD: &str = "blunt_start";
/// Turns behind the face at which a ridge may begin: behind one and a half it is whole in any case.
const MOST_TURNS: f64 = 2.0;
/// A count of passes that is whole but for a rounding.
const ROUNDING: f64 = 1e-9;

/// What the program asks for: Z of the face and the step between passes in its units, turns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Blunt(Option<Asked>);

#[derive(Clone, Copy, Debug, PartialEq)]
struct Asked {
    face: f64,
    turns: f64,
    step: f64,
}

/// What a pass of a blunt start leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BluntNote {
    /// Turns of the groove behind the face at which the ridge begins.
    pub turns: f64,
    /// Angle over which the tool leaves: over it the ridge rises from the root to its crest, degrees.
    pub over_deg: f64,
    /// Where along Z of the machine the groove is beside which the ridge is whole, mm.
    pub whole_from_mm: f64,
}

impl Blunt {
    /// Takes a comment; most of them say nothing of it.
    ///
    /// # Errors
    /// It begins with the word, and what follows is no blunt start.
    pub(crate) fn comment(&mut self, text: &str) -> Result<(), Box<Problem>> {
        let text = text.trim();
        let ends = |c: char| !(c.is_alphanumeric() || matches!(c, '_' | '-'));
        let (word, rest) = text.split_at(text.find(ends).unwrap_or(text.len()));
        let told = rest.trim_start().strip_prefix(',');
        if !word.eq_ignore_ascii_case(WORD) {
            let alike = [WORD, "bluntstart", "blunt", "higbee"];
            let joined = word.replace('-', "_");
            let says = told.is_some() && alike.iter().any(|other| joined.eq_ignore_ascii_case(other));
            return if says {
                wrong(format!("{word:?} is no word that asks for a blunt start"))
            } else {
                Ok(())
            };
        }
        let Some(told) = told else { return wrong(format!("a comma is missing behind {WORD}")) };
        self.0 = if told.trim().eq_ignore_ascii_case("off") { None } else { Some(read(told)?) };
        Ok(())
    }

    /// Whether cycles take the beginning of the ridge away.
    pub(crate) fn is_in_force(&self) -> bool {
        self.0.is_some()
    }

    /// Why something is not cut while it is in force.
    pub(crate) fn refuses(what: &str) -> Box<Problem> {
        let message =
            format!("{what} while ({WORD}, ...) is in force: only a cycle says how its groove lies");
        let help = format!("write ({WORD}, off) before it, or cut the thread and its start by G76 or G92");
        Problem::error("not-available", Blame::Block, message, help)
    }

    /// The cuts that a cycle makes, if the program asks for a blunt start; `frame` says where its face lies.
    ///
    /// # Errors
    /// The face does not lie within the thread, or it would take too many passes.
    pub(crate) fn cuts(&self, cycle: &Cycle, frame: &Frame) -> Result<Option<Vec<Cut>>, Box<Problem>> {
        let Some(Asked { face, turns, step }) = self.0 else { return Ok(None) };
        let (face_mm, step_mm) = (frame.z_on_machine(face), step * frame.unit());
        let groove = cycle.cut(cycle.depths().into_iter().fold(0.0, f64::max));
        let (towards, lead) = (groove.lead_mm().signum(), groove.lead_mm().abs());
        let ends_mm = face_mm + towards * turns * lead;
        if (face_mm - groove.from.z) * towards <= 0.0 || (groove.to_mm - ends_mm) * towards <= 0.0 {
            let message = format!(
                "the thread does not go from before Z{} to more than {} turns behind it",
                short(face),
                short(turns)
            );
            let help = format!(
                "let Z of ({WORD}, ...) be that of the face of the part, and T the turns until the ridge begins"
            );
            return Err(Problem::error("bad-value", Blame::Block, message, help));
        }
        let passes = (turns * lead / step_mm - ROUNDING).ceil().max(1.0);
        if passes > MOST_PASSES as f64 {
            let message = format!("the blunt start would take more than {MOST_PASSES} passes");
            return Err(Problem::error("bad-value", Blame::Block, message, "let D be larger"));
        }
        let slope = groove.rise_mm() / groove.lead_mm();
        let cut = |number: u32| {
            let beside = turns * lead * f64::from(number) / passes;
            let to_mm = ends_mm - towards * beside;
            Cut {
                start_deg: (groove.start_deg + 360.0 * beside / lead).rem_euclid(360.0),
                to_mm,
                retract_mm: -groove.approach_mm - slope * (to_mm - groove.from.z),
                depth_mm: 0.0,
                depth_is_told: false,
                entry: None,
                exit: None,
                ..groove
            }
        };
        Ok(Some((1..=passes as u32).map(cut).collect()))
    }

    /// The machine as passes of a blunt start are laid out for: full depth goes to their end.
    pub(crate) fn machine(machine: &Machine) -> Machine {
        let mut other = machine.clone();
        other.threading.run_out = RunOut::Beyond;
        other
    }

    /// What a pass leaves.
    pub(crate) fn note(&self, cut: &Cut, plan: &Plan, frame: &Frame) -> Option<BluntNote> {
        let Asked { face, turns, .. } = self.0?;
        let law = plan.pass.axis(cut.along.lifts());
        let out = Stroke::new(1.0, 1.0);
        let share = largest(1.0, |share| out.at(share).s * cut.retract_mm.abs() <= cut.clear_mm);
        let lead = cut.lead_mm();
        let behind = turns * lead + lead * law.retract_dc_deg / 360.0;
        Some(BluntNote {
            turns,
            over_deg: share * law.retract_dc_deg,
            whole_from_mm: frame.z_on_machine(face) + behind.abs() * lead.signum(),
        })
    }
}

fn wrong<T>(message: String) -> Result<T, Box<Problem>> {
    let help = "write (blunt_start, Z0 T0.9 D0.1): the face of the part, the turns behind it at which the ridge begins \
                (up to 2), the step between two passes; or (blunt_start, off)";
    Err(Problem::error("bad-value", Blame::Block, message, help))
}

/// `Z0 T0.9 D0.1`, in any order.
fn read(told: &str) -> Result<Asked, Box<Problem>> {
    let mut said = [None; 3];
    for word in told.split_whitespace() {
        let (letter, number) = word.split_at(word.chars().next().map_or(0, char::len_utf8));
        let which = ["Z", "T", "D"].iter().position(|name| letter.eq_ignore_ascii_case(name));
        let value = number.parse::<f64>().ok().filter(|value| value.is_finite());
        match which.zip(value) {
            Some((which, value)) if said[which].is_none() => said[which] = Some(value),
            _ => return wrong(format!("{word:?} is no word of {WORD}, or stands there twice")),
        }
    }
    let [Some(face), Some(turns), Some(step)] = said else {
        return wrong(format!("{WORD} needs Z, T and D"));
    };
    if !(turns > 0.0 && turns <= MOST_TURNS) || step <= 0.0 {
        return wrong(format!("T{} D{} of {WORD} is out of range", short(turns), short(step)));
    }
    Ok(Asked { face, turns, step })
}
