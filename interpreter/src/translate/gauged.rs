//! The thread that a program says it cuts, which a gauge will judge. In: comments such as
//! `(thread, M20x2-6g)`, the passes as they are planned. Out: what the gauge asks, and
//! warnings where the passes cannot be that thread.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | lead | mm | advance of a pass in a turn: pitch · starts of the thread |
//! | hand | – | Z falls with the angle of the spindle along a right-hand thread |
//! | side | – | a screw is cut towards the axis, a nut away from it |

use std::collections::BTreeSet;

use gauge::{Drawn, Nominal, Side};
use gcode::canon::Units;
use gcode::problem::Blame;
use gcode::{Place, Problem};
use machine::Kinematics;
use protocol::ThreadPass;

use super::Translator;
use super::insert::Written;
use crate::reach::Done;
use crate::thread::Point;

/// Leads closer than this are one, mm.
const SAME_MM: f64 = 1e-4;

/// What to do where program and thread are not the same.
const HELP: &str = "change the passes, or the name in (thread, ...) or behind --gauge: 6g is a screw, 6G a nut, 6G EXTERNAL a screw";

/// Passes of one kind.
#[derive(Clone, Debug)]
struct Kind {
    place: Place,
    lead_mm: f64,
    /// Whether Z grows with the angle of the spindle.
    grows: bool,
    /// Unknown of a pass that moves X neither in nor out.
    side: Option<Side>,
    starts: BTreeSet<u32>,
    /// Its lead grows from the start: there is no length of one lead.
    changes: bool,
}

/// What is known of the thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gauged {
    /// Asked for with the run: the program is not asked then.
    asked: Option<Nominal>,
    said: Option<(Nominal, Place)>,
    /// The groove that is drawn.
    drawn: Option<Drawn>,
    kinds: Vec<Kind>,
    /// The insert that the program was written for.
    pub(super) written: Written,
}

impl Gauged {
    /// A gauge that is asked for with the run.
    pub(crate) fn ask(&mut self, nominal: Nominal) {
        self.asked = Some(nominal);
    }

    /// What will judge.
    pub(crate) fn nominal(&self) -> Option<&Nominal> {
        self.asked.as_ref().or(self.said.as_ref().map(|(nominal, _)| nominal))
    }

    /// The groove that is drawn.
    pub(crate) fn drawn(&self) -> Option<&Drawn> {
        self.drawn.as_ref()
    }

    /// A comment may draw the groove.
    fn drawing(&mut self, text: &str) -> Done {
        let wrong = |message: String, help: &str| Problem::error("bad-groove", Blame::Block, message, help);
        let Some((_, told)) = text
            .trim()
            .split_once(',')
            .filter(|(word, _)| word.trim_end() == "groove" || word.trim_end() == "GROOVE")
        else {
            return Ok(());
        };
        let drawn: Drawn =
            told.parse().map_err(|misread: gauge::Misread| wrong(misread.message, &misread.help))?;
        match &self.drawn {
            Some(before) if *before != drawn => {
                let help = "draw one groove: all passes of a program are held against it";
                Err(wrong("another groove is drawn before".into(), help))
            }
            _ => {
                self.drawn = Some(drawn);
                Ok(())
            }
        }
    }

    /// A comment may name the thread.
    fn comment(&mut self, text: &str, place: Place) -> Done {
        let text = text.trim();
        let ends = |c: char| !(c.is_alphanumeric() || c == '_');
        let (word, rest) = text.split_at(text.find(ends).unwrap_or(text.len()));
        let wrong = |message: String, help: &str| Problem::error("bad-thread", Blame::Block, message, help);
        if !word.eq_ignore_ascii_case("thread") {
            let alike = ["threads", "gauge"].iter().any(|other| word.eq_ignore_ascii_case(other));
            let name = rest.trim_start().trim_start_matches([',', ':']).trim();
            if alike && name.parse::<Nominal>().is_ok() {
                let help = format!("write (thread, {name})");
                return Err(wrong(format!("a comment ({word} ...) asks for no gauge"), &help));
            }
            return Ok(());
        }
        let Some(name) = rest.trim_start().strip_prefix(',') else {
            let behind = rest.trim_start().trim_start_matches(':');
            let meant = behind.trim().parse::<Nominal>().is_ok();
            let refused =
                || Err(wrong("a comma is missing behind thread".into(), "write (thread, M20x2-6g)"));
            return if meant { refused() } else { Ok(()) };
        };
        let named = name.trim().parse::<Nominal>();
        let nominal = named.map_err(|misread| wrong(misread.message, &misread.help))?;
        match &self.said {
            Some((before, _)) if *before != nominal => {
                let message = format!("the thread is {} here, and {} before", nominal.name, before.name);
                let help = "name one thread: a gauge judges all passes of a program as one thread";
                Err(wrong(message, help))
            }
            _ => {
                self.said.get_or_insert((nominal, place));
                Ok(())
            }
        }
    }

    /// A pass whose zero lies at `origin`.
    fn pass(&mut self, place: Place, pass: &ThreadPass, origin: Point) {
        let outwards = if pass.returns() { Some(true) } else { pass.cuts_outwards(origin.x) };
        let side = outwards.map(|away| if away { Side::Internal } else { Side::External });
        let (lead_mm, grows) = (pass.lead_mm.abs(), pass.lead_mm * pass.direction > 0.0);
        let along = pass.axis(pass.along());
        let locked_deg = along.run_in_c0_deg + along.run_in_dc_deg;
        let changes = pass.corners().next().is_some_and(|corner| corner.c_deg < locked_deg);
        let same = |kind: &&mut Kind| {
            (kind.lead_mm, kind.grows, kind.side, kind.changes) == (lead_mm, grows, side, changes)
        };
        match self.kinds.iter_mut().find(same) {
            Some(kind) => _ = kind.starts.insert(pass.start),
            None => {
                self.kinds.push(Kind { place, lead_mm, grows, side, starts: [pass.start].into(), changes })
            }
        }
    }

    /// No thread was cut, though one is to be judged. `end`: where the program ends.
    pub(crate) fn misses(&self, end: Place) -> Option<(Place, Box<Problem>)> {
        let nominal = self.nominal().filter(|_| self.kinds.is_empty())?;
        let place = self.said.as_ref().filter(|_| self.asked.is_none()).map_or(end, |(_, place)| *place);
        let help = "cut it by G33, G32, G76, G92 or a tap, or leave out (thread, ...) and --gauge";
        let message = format!("a gauge is asked for {}, and the program cuts no thread", nominal.name);
        Some((place, Problem::warning("gauge-differs", Blame::Line(place.line), message, help)))
    }

    /// What the passes have that the thread does not have.
    fn contradictions(&self, units: Units) -> Vec<(Place, Box<Problem>)> {
        let Some(nominal) = self.nominal() else { return Vec::new() };
        self.kinds.iter().flat_map(|kind| against(nominal, kind, units)).collect()
    }
}

/// What passes of a kind have that the thread does not have.
fn against(nominal: &Nominal, kind: &Kind, units: Units) -> Vec<(Place, Box<Problem>)> {
    let Nominal { name, pitch_mm, starts, .. } = nominal;
    let (lead_mm, mut found) = (pitch_mm * f64::from(*starts), Vec::new());
    if (kind.lead_mm - lead_mm).abs() > SAME_MM {
        let of = if *starts == 1 {
            String::new()
        } else {
            format!(": {starts} starts of {}", units.length(*pitch_mm))
        };
        let (cut, asked) = (units.length(kind.lead_mm), units.length(lead_mm));
        found.push(format!("the thread advances by {cut} in a turn, and {name} by {asked}{of}"));
    } else if kind.starts.len() < *starts as usize {
        found.push(format!("{} of the {starts} starts of {name} are cut", kind.starts.len()));
    } else if kind.starts.len() > *starts as usize {
        let s = if *starts == 1 { "" } else { "s" };
        found.push(format!(
            "the passes lie in {} grooves, and {name} has {starts} start{s}",
            kind.starts.len()
        ));
    }
    if kind.changes {
        found.push(format!(
            "the lead grows from the start, and {name} has one lead: no gauge judges this thread"
        ));
    }
    if kind.side.is_some_and(|side| side != nominal.side) {
        let what = match nominal.side {
            Side::External => "a nut is cut here, away from the axis, and {name} is a screw",
            Side::Internal => "a screw is cut here, towards the axis, and {name} is a nut",
        };
        found.push(what.replace("{name}", name));
    }
    if kind.grows != nominal.grows {
        let [cut, asked] = [kind.grows, nominal.grows].map(|left| if left { "left" } else { "right" });
        found.push(format!("the thread is {cut}-hand here, and {name} is {asked}-hand"));
    }
    let blame = Blame::Line(kind.place.line);
    let told = |message| (kind.place, Problem::warning("gauge-differs", blame, message, HELP));
    // A line is blamed once for each code: all in one.
    (!found.is_empty()).then(|| told(found.join("; "))).into_iter().collect()
}

impl Translator {
    /// The gauge that judges, if there is one.
    pub(crate) fn gauged(&self) -> &Gauged {
        &self.gauged
    }

    /// A gauge that is asked for with the run.
    pub(crate) fn has_gauge(&mut self, nominal: Nominal) {
        self.gauged.ask(nominal);
    }

    /// A comment may name the thread, which on a mill is that of a tap; of a lathe it may describe the
    /// insert or draw a groove.
    pub(super) fn take_thread(&mut self, text: &str) -> Done {
        match self.machine.general.kinematics {
            Kinematics::Positioner => return Ok(()),
            Kinematics::Mill => {}
            Kinematics::Lathe => {
                self.take_insert(text)?;
                self.gauged.drawing(text)?;
            }
        }
        self.gauged.comment(text, self.place())
    }

    /// A pass was programmed where the part lay at `origin`.
    pub(super) fn gauge_sees_pass(&mut self, place: Place, pass: &ThreadPass, origin: Point) {
        self.gauged.pass(place, pass, origin);
    }

    /// The program is over.
    pub(super) fn gauge_tells(&mut self) {
        for (place, problem) in self.gauged.contradictions(self.modal.frame.units) {
            self.output.report(place, *problem);
        }
        for (place, problem) in self.threads.starts.beside(self.modal.frame.units) {
            self.output.report(place, *problem);
        }
        for (place, problem) in self.threads.infeeds.rubs(self.modal.frame.units) {
            self.output.report(place, *problem);
        }
    }
}
