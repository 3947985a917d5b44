//! The panel of a machine, as the launcher has it. In: every control cycle, presses. Out: what is shown,
//! requests for the machine, answers. It never waits for anybody.

use std::{os::fd::BorrowedFd, path::Path, time::Duration};

use ::panel::{MachineSeen, Point, ProgramSeen, ToPanel};
use process::ipc::time::{Moment, sleep_until};
use protocol::{Arrival, Input, Taken, operator::Request};
use rig::observe::{Observer, Record, Summary};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::{
    hand::Hand,
    known::Known,
    mode::{Mode, Press},
    said::is_in_pass,
    scope::Rows,
    session::{Presses, Session, Who, request},
    tables::Tables,
    tool::Change,
    view::{self, Counts},
    web::{Web, in_a_hall},
};
use crate::{error::CliError, run::folder::PRESSES};

/// Control cycles between two looks at the way of the tool, and at whether something is to be shown.
const EVERY: u64 = 16;
/// So long a panel that ends with its run is waited for until it has heard how that ended, and between two
/// looks.
const TOLD: Duration = Duration::from_secs(1);
const SHORT_NAP: Duration = Duration::from_millis(1);
/// Between two states that are shown.
const SHOWN: Duration = Duration::from_millis(40);
/// The tool has gone on when it is so far from where it was, mm.
const FAR_MM: f32 = 0.02;
/// Most places of its way that are kept; then every second one is left out.
const MOST_PLACES: usize = 8192;
/// Most presses that are taken at once, and that may be on their way to the plant.
const MOST_PRESSES: usize = 8;
const MOST_WAITING: usize = 32;
/// Most requests that one press becomes.
const REQUESTS_OF_A_PRESS: usize = 2;

/// The panel.
pub(crate) struct Live {
    /// The command ends with the run.
    pub(crate) ends_with_its_run: bool,
    pub(super) web: Web,
    pub(super) session: Session,
    /// What stays the same during a run, to be told again to a panel that was started again.
    pub(super) still: Map<String, Value>,
    pub(super) known: Known,
    /// Turns of the spindle, and the place of the tool, in the cycle before.
    turned: Option<(f64, Point)>,
    trail: Vec<Point>,
    /// Axes that were not referenced in the cycle before, bit by bit.
    lost: u8,
    /// The panel is to forget the way before.
    forgets: bool,
    /// How many of these the panel knows.
    told: usize,
    shown: Moment,
    lists: Option<Counts>,
    /// Per cent that came before its request was whole.
    value: f64,
    /// The panel does not know what stays the same, and what of it it has not been told.
    stale: bool,
    untold: Map<String, Value>,
    /// What was shown of the run last.
    last: Map<String, Value>,
    /// Work by hand, if the run is that.
    pub(super) hand: Option<Hand>,
    pub(super) mode: Mode,
    pub(super) change: Change,
    /// Offsets and tools.
    pub(super) tables: Tables,
    /// What goes to the scope, and whether the panel was told of it anew.
    pub(super) rows: Rows,
    anew: bool,
}

impl Drop for Live {
    fn drop(&mut self) {
        // Whoever ends a panel that stays does not wait for it.
        if self.ends_with_its_run {
            self.web.goes();
        }
    }
}

/// A document as its fields.
pub(super) fn fields(of: &impl Serialize) -> Map<String, Value> {
    match serde_json::to_value(of) {
        Ok(Value::Object(fields)) => fields,
        _ => Map::new(),
    }
}

impl Live {
    /// Nothing runs yet.
    pub(crate) fn new(web: Web, ends_with_its_run: bool, tables: Tables) -> Live {
        let rows = Rows::of(tables.machine());
        let still = fields(&json!({ "signals": rows.signals() }));
        Live {
            ends_with_its_run,
            web,
            session: Session::default(),
            still,
            known: Known::default(),
            turned: None,
            trail: Vec::new(),
            lost: 0,
            forgets: false,
            told: 0,
            shown: Moment::now(),
            lists: None,
            value: 0.0,
            stale: true,
            untold: Map::new(),
            last: Map::new(),
            hand: None,
            mode: Mode::Off,
            change: Change::default(),
            tables,
            rows,
            anew: false,
        }
    }

    /// These fields are shown until they are others.
    pub(crate) fn stands(&mut self, more: Map<String, Value>) {
        self.untold.extend(more.clone());
        self.still.extend(more);
    }

    /// A run begins.
    pub(crate) fn begins(
        &mut self,
        program: &ProgramSeen,
        machine: &MachineSeen,
        known: (Known, Vec<Point>),
    ) {
        self.session = Session::default();
        let (known, way) = known;
        (self.known, self.turned) = (known, None);
        self.trail.clear();
        self.lists = None;
        // These change from now on.
        self.still.retain(|name, _| name != "state" && name != "words");
        let (program, machine) = (json!(program), json!(machine));
        let empty = json!([]);
        let none = json!({
            "program": program, "machine": machine, "outcome": null, "part": null, "way": way,
            "passes": empty, "messages": empty, "faults": empty, "signals": self.rows.signals(),
            "blocks": self.known.plan.by_hand,
        });
        self.stands(fields(&none));
        self.stale = true;
    }

    /// Looks after the panel, and tells it what it has to know before what changes.
    pub(super) fn look(&mut self) {
        self.stale |= self.web.look();
        if self.stale && self.web.link.offer(&ToPanel::NoTrail) {
            self.web.link.answer(&self.rows.head());
            self.web.link.answer(&ToPanel::Set(self.still.clone()));
            self.anew = true;
            (self.stale, self.told, self.forgets, self.lists) = (false, 0, false, None);
            self.untold.clear();
        }
        if !self.stale && !self.untold.is_empty() && self.web.link.offer(&ToPanel::Set(self.untold.clone())) {
            self.untold.clear();
        }
        self.draw();
        let (still, last, mode) = (&self.still, &self.last, self.mode);
        self.web.is_asked(|| in_a_hall(still, last, mode));
        // What is on its way goes on.
        self.web.link.is_free();
    }

    /// Whether the panel has all that stands, or is none.
    fn is_told(&mut self) -> bool {
        self.web.link.is_broken() || !self.stale && self.untold.is_empty() && self.web.link.is_free()
    }

    /// Whether the scope has begun anew since somebody asked.
    pub(super) fn told_anew(&mut self) -> bool {
        std::mem::take(&mut self.anew)
    }

    /// One control cycle of a run.
    pub(crate) fn cycle(&mut self, record: &Record, observer: &Observer) {
        let cycle = record.truth.cycle.0;
        if let Some(hand) = &mut self.hand {
            hand.cycle(record);
            self.known.is_drawn_by_hand(hand.moved_mm());
        }
        self.known.cycle(record, self.hand.as_ref().map(|hand| hand.in_hand));
        if self.mode != Mode::Playback {
            self.mode = Mode::of(record, self.hand.as_ref().map(Hand::doing));
        }
        self.change.cycle(record.machine);
        if std::mem::replace(&mut self.lost, record.machine.unreferenced) & !record.machine.unreferenced != 0
        {
            // Where the tool has gone before is known no more than where it began.
            self.trail.clear();
            (self.forgets, self.turned) = (true, None);
        }
        self.takes_a_turn(record);
        if self.rows.cycle(record, observer) {
            self.sends_rows();
        }
        let last = record.truth.measurement.last != 0;
        if !(last || cycle.is_multiple_of(EVERY)) {
            return;
        }
        let place = self.known.place(record);
        let far = |(before, kind): &Point| {
            *kind != place.1 || before.iter().zip(&place.0).any(|(one, other)| (one - other).abs() > FAR_MM)
        };
        if self.trail.last().is_none_or(far) {
            self.goes_through(place);
        }
        if last || self.shown.elapsed() >= SHOWN {
            self.show(record, observer);
        }
    }

    /// Sends rows of the scope to a panel that knows what they are.
    pub(super) fn sends_rows(&mut self) {
        self.rows.send((!self.stale).then_some(&mut self.web.link));
    }

    /// The tool has come to a place.
    fn goes_through(&mut self, place: Point) {
        self.trail.push(place);
        if self.trail.len() > MOST_PLACES {
            let told = thinned(&mut self.trail);
            self.told = told.iter().take(self.told).filter(|kept| **kept).count();
        }
    }

    /// Where the tool is when the index goes by in a pass, between two cycles.
    fn takes_a_turn(&mut self, record: &Record) {
        let now = record.truth.spindle_deg / 360.0;
        let Some((turns, from)) = self.turned.take() else {
            self.turned = is_in_pass(record).then(|| (now, self.known.place(record)));
            return;
        };
        if turns.floor() == now.floor() && is_in_pass(record) {
            // The line from here to where the index goes by is as straight as one cycle.
            self.turned = Some((now, self.known.place(record)));
            return;
        }
        let place = self.known.place(record);
        if place.1 == view::IN_PASS {
            let share = ((turns.floor().max(now.floor()) - turns) / (now - turns)) as f32;
            let at = from.0.iter().zip(&place.0).map(|(one, other)| one + share * (other - one));
            self.goes_through((at.collect(), view::AT_THE_INDEX));
            self.turned = Some((now, place));
        }
    }

    /// Shows this cycle, if the panel has taken the one before.
    fn show(&mut self, record: &Record, observer: &Observer) {
        self.shown = Moment::now();
        let seen = view::seen(record, observer, self.lists, &mut self.known);
        let mut shown = fields(&seen);
        self.shows_hand(&mut shown);
        self.shows_zero(record);
        self.last.extend(shown.clone());
        if self.stale || !self.web.link.offer(&ToPanel::Set(shown)) {
            return;
        }
        self.lists = Some(Counts::of(observer));
        self.draw();
    }

    /// Tells where the tool has gone since it was told last.
    fn draw(&mut self) {
        let link = &mut self.web.link;
        if !self.stale && self.forgets && link.is_free() && link.offer(&ToPanel::NoTrail) {
            (self.told, self.forgets) = (0, false);
        }
        if self.forgets {
            return;
        }
        let more = self.trail.get(self.told..).unwrap_or_default();
        if !self.stale && !more.is_empty() && link.is_free() && link.offer(&ToPanel::Trail(more.to_vec())) {
            self.told = self.trail.len();
        }
    }

    /// What can be read as soon as somebody presses something.
    pub(crate) fn waits(&self) -> Option<BorrowedFd<'_>> {
        self.web.link.waits()
    }

    /// Looks after the panel, and takes what was pressed.
    pub(crate) fn presses(&mut self) -> Presses {
        self.look();
        let mut taken = Presses::default();
        for _ in 0..MOST_PRESSES {
            let Some(press) = self.web.link.press() else { break };
            if self.session.waiting() + REQUESTS_OF_A_PRESS > MOST_WAITING {
                self.refuse(press.ticket, "too-many", "presses come faster than the machine takes them");
                continue;
            }
            if let Some(asked) = &press.hand {
                self.takes_by_hand(press.ticket, asked, &mut taken);
                continue;
            }
            let wanted = request(press.kind, press.value);
            let starts = wanted == Some(Request::CycleStart);
            match (wanted, starts.then(|| self.mode.refuses(Press::Start)).flatten()) {
                (Some(request), None) => {
                    self.session.sent(request, Who::Panel(press.ticket));
                    taken.requests.push(request);
                }
                (_, Some(why)) => {
                    let over = matches!(self.mode, Mode::Stopping | Mode::Faulted);
                    self.refuse(press.ticket, if over { "not-running" } else { "not-now" }, why);
                }
                (None, None) => self.refuse(press.ticket, "unknown", "the machine has no such key"),
            }
        }
        taken
    }

    pub(super) fn refuse(&mut self, ticket: u64, code: &str, why: &str) {
        let (code, why) = (code.to_owned(), why.to_owned());
        self.web.link.answer(&ToPanel::Refused { ticket, code, why });
    }

    /// Somebody else than the panel asks the plant for something.
    pub(crate) fn sent(&mut self, request: Request, who: Who) {
        self.session.sent(request, who);
    }

    /// The plant tells what it took, in processes.
    pub(crate) fn arrived(&mut self, arrival: &Arrival) {
        match arrival.unpack() {
            Some((Input::OperatorValue, Taken::This(bits))) => self.value = f64::from_bits(bits),
            Some((Input::Operator, Taken::This(kind))) => {
                let value = std::mem::take(&mut self.value);
                if let Some(request) = request(kind as u32, value) {
                    self.taken(arrival.cycle, request);
                }
            }
            _ => {}
        }
    }

    /// The plant took a request in a cycle.
    pub(crate) fn taken(&mut self, cycle: u64, request: Request) {
        if let Some(Who::Panel(ticket)) = self.session.taken(cycle, request) {
            self.web.link.answer(&ToPanel::Taken { ticket, cycle });
        }
    }

    /// The run is over: what was pressed goes into its folder.
    pub(crate) fn ends(&mut self, summary: &Summary, folder: &Path) -> Result<(), CliError> {
        for ticket in self.session.lost() {
            self.refuse(ticket, "not-running", "the run was over before the machine took it");
        }
        // One that was busy, or is started again behind the run, shows how it ended, too.
        let last = std::mem::take(&mut self.last);
        let ended = view::ended(last, summary, self.tables.machine(), folder);
        self.stands(ended);
        self.look();
        let until = Moment::now().after(TOLD);
        while self.ends_with_its_run && !self.is_told() && Moment::now() < until {
            sleep_until(Moment::now().after(SHORT_NAP));
            self.look();
        }
        let path = folder.join(PRESSES);
        let written = self.session.events().map(|text| intake::replace(&path, text.as_bytes()));
        written.transpose().map(drop).map_err(|error| CliError::file(&path, error))
    }
}

/// Leaves out every second place; of those at which the index went by none as long as others are more. What
/// was kept.
fn thinned(trail: &mut Vec<Point>) -> Vec<bool> {
    let marks = trail.iter().filter(|(_, kind)| *kind == view::AT_THE_INDEX).count();
    let all = 2 * marks > trail.len();
    let mut keep = false;
    let kept: Vec<_> = trail
        .iter()
        .map(|(_, kind)| {
            let mark = *kind == view::AT_THE_INDEX && !all;
            keep ^= !mark;
            mark || keep
        })
        .collect();
    let mut which = kept.iter();
    trail.retain(|_| which.next().is_some_and(|kept| *kept));
    kept
}
