//! The threads that a program says it cuts, which gauges will judge. In: comments such as
//! `(thread, M20x2-6g)`, the passes as they are planned. Out: what the gauges ask, of which passes, and
//! warnings where those cannot be that thread.
//!
//! A name holds for what follows, up to the next one; what comes before the first belongs to the first.
//! Within a chain it holds from the block that it stands in front of.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | lead | mm | advance of a pass in a turn: pitch · starts of the thread |
//! | hand | – | Z falls with the angle of the spindle along a right-hand thread |
//! | side | – | a screw is cut towards the axis, a nut away from it |

use std::collections::{BTreeMap, BTreeSet};

use gauge::{Drawn, Nominal, Side};
use gcode::canon::Units;
use gcode::problem::Blame;
use gcode::{Place, Problem};
use machine::Kinematics;
use protocol::ThreadPass;

use super::Translator;
use super::insert::Written;
use crate::reach::Done;
use crate::thread::{Point, Single};

/// Leads closer than this are one, mm.
const SAME_MM: f64 = 1e-4;

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
    /// A tap has all of its starts.
    is_tap: bool,
    /// Its lead grows from the start: there is no length of one lead.
    changes: bool,
}

/// Passes that one gauge judges.
#[derive(Clone, Debug, Default)]
struct Passes {
    kinds: Vec<Kind>,
    /// Each by its number, and where along Z of the machine it begins to be this thread, mm: nothing where it
    /// is from its beginning.
    from_mm: BTreeMap<u32, Option<f64>>,
    /// Where its ridges are whole along Z of the machine, mm, behind a blunt start.
    whole_from_mm: Option<f64>,
}

/// A thread that somebody named.
#[derive(Clone, Debug)]
struct Named {
    nominal: Nominal,
    /// Where; of one that is asked for with the run nowhere.
    place: Option<Place>,
    passes: Passes,
}

/// A thread that a gauge judges, and the passes that cut it.
#[derive(Clone, Debug, PartialEq)]
pub struct GaugedThread {
    /// What the gauge asks.
    pub nominal: Nominal,
    /// Its passes by their numbers, and where along Z of the machine each begins to be this thread, mm:
    /// nothing where it is from its beginning.
    pub from_mm: BTreeMap<u32, Option<f64>>,
}

/// What is known of the threads.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gauged {
    named: Vec<Named>,
    /// Which of them was named last.
    now: usize,
    /// What is cut before the first name.
    before: Passes,
    /// The blocks of a chain so far that begin a thread: which one, where along Z of the machine, mm, and its
    /// lead along Z, mm, with whether that changes.
    legs: Vec<Begins>,
    /// The groove that is drawn.
    drawn: Option<Drawn>,
    /// The insert that the program was written for.
    pub(super) written: Written,
}

/// Where a block of a chain begins a thread.
#[derive(Clone, Copy, Debug)]
struct Begins {
    named: usize,
    from_mm: f64,
    lead_mm: f64,
    changes: bool,
}

impl Gauged {
    /// A gauge that is asked for with the run: the program is not asked then.
    pub(crate) fn ask(&mut self, nominal: Nominal) {
        self.named = vec![Named { nominal, place: None, passes: Passes::default() }];
    }

    fn is_asked(&self) -> bool {
        self.named.first().is_some_and(|first| first.place.is_none())
    }

    /// What will judge.
    pub(crate) fn threads(&self) -> Vec<GaugedThread> {
        let thread = |Named { nominal, passes, .. }: &Named| GaugedThread {
            nominal: nominal.clone(),
            from_mm: passes.begin_mm(),
        };
        self.named.iter().map(thread).collect()
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
        if !self.is_asked() {
            let known = self.named.iter().position(|named| named.nominal == nominal);
            self.now = known.unwrap_or_else(|| {
                let passes = std::mem::take(&mut self.before);
                self.named.push(Named { nominal, place: Some(place), passes });
                self.named.len() - 1
            });
        }
        Ok(())
    }

    /// A block of a chain: where it begins, and whether it goes on from the one before.
    fn leg(&mut self, single: &Single, goes_on: bool) {
        if !goes_on {
            self.legs.clear();
        }
        let (leg, named) = (&single.legs[0], self.now);
        if self.legs.last().is_none_or(|last| last.named != named) {
            let (lead_mm, changes) = (leg.lead.z.abs(), leg.growth.z != 0.0);
            self.legs.push(Begins { named, from_mm: single.from.z, lead_mm, changes });
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
        let starts = [pass.start].into();
        let kind = Kind { place, lead_mm, grows, side, starts, is_tap: pass.returns(), changes };
        // A chain that nobody named in between is one thread from its beginning.
        let legs = std::mem::take(&mut self.legs);
        let first = legs.first().map_or(self.now, |leg| leg.named);
        self.passes(first).take(pass.pass, None, kind.clone());
        for leg in legs.iter().skip(1) {
            let kind = Kind { lead_mm: leg.lead_mm, changes: leg.changes, ..kind.clone() };
            self.passes(leg.named).take(pass.pass, Some(leg.from_mm), kind);
        }
    }

    /// The passes of a thread.
    fn passes(&mut self, named: usize) -> &mut Passes {
        self.named.get_mut(named).map_or(&mut self.before, |named| &mut named.passes)
    }

    /// Threads that are to be judged and are not cut. `end`: where the program ends.
    pub(crate) fn misses(&self, end: Place) -> Vec<(Place, Box<Problem>)> {
        let missing = self.named.iter().filter(|named| named.passes.kinds.is_empty());
        let told = |Named { nominal, place, .. }: &Named| {
            let place = place.unwrap_or(end);
            let help = "cut it by G33, G32, G76, G92 or a tap, or leave out (thread, ...) and --gauge";
            let where_not = if self.named.len() > 1 { "no thread behind that name" } else { "no thread" };
            let message = format!("a gauge is asked for {}, and the program cuts {where_not}", nominal.name);
            (place, Problem::warning("gauge-differs", Blame::Line(place.line), message, help))
        };
        missing.map(told).collect()
    }

    /// What the passes have that their thread does not have.
    fn contradictions(&self, units: Units) -> Vec<(Place, Box<Problem>)> {
        let of = |Named { nominal, passes, .. }: &Named| {
            passes.kinds.iter().filter_map(|kind| against(nominal, kind, units)).collect::<Vec<_>>()
        };
        self.named.iter().flat_map(of).collect()
    }
}

impl Passes {
    /// Where each pass begins to be this thread: behind a blunt start none does before that is over.
    fn begin_mm(&self) -> BTreeMap<u32, Option<f64>> {
        let begin = |(pass, from): (&u32, &Option<f64>)| (*pass, from.or(self.whole_from_mm));
        self.from_mm.iter().map(begin).collect()
    }

    /// Takes a pass of a blunt start: it cuts no groove.
    fn take_blunt(&mut self, pass: u32, whole_from_mm: f64, grows: bool) {
        self.from_mm.insert(pass, None);
        let farther = |mm: f64| if grows { mm.max(whole_from_mm) } else { mm.min(whole_from_mm) };
        self.whole_from_mm = Some(self.whole_from_mm.map_or(whole_from_mm, farther));
    }

    /// Takes a pass of a kind.
    fn take(&mut self, pass: u32, from_mm: Option<f64>, kind: Kind) {
        self.from_mm.entry(pass).or_insert(from_mm);
        let same = |other: &&mut Kind| {
            (other.lead_mm, other.grows, other.side, other.is_tap, other.changes)
                == (kind.lead_mm, kind.grows, kind.side, kind.is_tap, kind.changes)
        };
        match self.kinds.iter_mut().find(same) {
            Some(known) => known.starts.extend(kind.starts),
            None => self.kinds.push(kind),
        }
    }
}

/// What passes of a kind have that the thread does not have, and what to do about it.
fn against(nominal: &Nominal, kind: &Kind, units: Units) -> Option<(Place, Box<Problem>)> {
    let Nominal { name, pitch_mm, starts, .. } = nominal;
    let (lead_mm, mut found) = (pitch_mm * f64::from(*starts), Vec::new());
    if (kind.lead_mm - lead_mm).abs() > SAME_MM {
        let of = if *starts == 1 {
            String::new()
        } else {
            format!(": {starts} starts of {}", units.length(*pitch_mm))
        };
        let (cut, asked) = (units.length(kind.lead_mm), units.length(lead_mm));
        let help = format!("a lead of {asked} is that of {name}");
        found.push((format!("the thread advances by {cut} in a turn, and {name} by {asked}{of}"), help));
    } else if !kind.is_tap && kind.starts.len() != *starts as usize {
        let (cut, s) = (kind.starts.len(), if *starts == 1 { "" } else { "s" });
        let message = match cut < *starts as usize {
            true => format!("{cut} of the {starts} starts of {name} are cut"),
            false => format!("the passes lie in {cut} grooves, and {name} has {starts} start{s}"),
        };
        found.push((message, format!("cut {starts} groove{s}, each pass from a start of its own groove")));
    }
    if kind.changes {
        let message =
            format!("the lead grows from the start, and {name} has one lead: no gauge judges this thread");
        found.push((message, "a lead that grows is judged by (groove, ...)".into()));
    }
    if kind.side.is_some_and(|side| side != nominal.side) {
        let what = match nominal.side {
            Side::External => "a nut is cut here, away from the axis, and {name} is a screw",
            Side::Internal => "a screw is cut here, towards the axis, and {name} is a nut",
        };
        let help = "6g is a screw, 6H and 6G are nuts, 6G EXTERNAL is a screw";
        found.push((what.replace("{name}", name), help.into()));
    }
    if kind.grows != nominal.grows {
        let [cut, asked] = [kind.grows, nominal.grows].map(|left| if left { "left" } else { "right" });
        let message = format!("the thread is {cut}-hand here, and {name} is {asked}-hand");
        found.push((message, "the spindle turned the other way, or the cut led the other way, changes the hand; LH behind a name is left-hand".into()));
    }
    // A line is blamed once for each code: all in one.
    let (messages, helps): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    let help =
        format!("change the passes, or the name in (thread, ...) or behind --gauge: {}", helps.join("; "));
    let told = || Problem::warning("gauge-differs", Blame::Line(kind.place.line), messages.join("; "), help);
    (!messages.is_empty()).then(|| (kind.place, told()))
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

    /// A block of a chain was programmed; it may go on from the one before.
    pub(super) fn gauge_sees_leg(&mut self, single: &Single, goes_on: bool) {
        self.gauged.leg(single, goes_on);
    }

    /// A pass was programmed where the part lay at `origin`.
    pub(super) fn gauge_sees_pass(&mut self, place: Place, pass: &ThreadPass, origin: Point) {
        match self.threads.notes().iter().rfind(|note| note.pass == pass.pass).and_then(|note| note.blunt) {
            Some(blunt) => {
                let now = self.gauged.now;
                self.gauged.passes(now).take_blunt(pass.pass, blunt.whole_from_mm, pass.lead_mm > 0.0);
            }
            None => self.gauged.pass(place, pass, origin),
        }
    }

    /// The program is over.
    pub(super) fn gauge_tells(&mut self) {
        for (place, problem) in self.gauged.contradictions(self.modal.frame.units) {
            self.output.report(place, *problem);
        }
        if self.machine.general.kinematics == Kinematics::Lathe {
            let mut cut = self.gauged.named.iter().filter(|named| !named.passes.kinds.is_empty());
            let unknown = cut.find_map(|named| self.drilled.crest_unknown(&named.nominal));
            if let Some((place, problem)) = unknown {
                self.output.report(place, *problem);
            }
        }
        for (place, problem) in self.threads.starts.beside(self.modal.frame.units) {
            self.output.report(place, *problem);
        }
        for (place, problem) in self.threads.infeeds.rubs(self.modal.frame.units) {
            self.output.report(place, *problem);
        }
    }
}
