//! The panel of a machine, as the launcher has it. In: every control cycle, presses. Out: what is shown,
//! requests for the machine, answers. It never waits for anybody.

use std::{path::Path, time::Duration};

use ::panel::{MachineSeen, Point, ProgramSeen, ToPanel};
use process::ipc::time::Moment;
use protocol::{Arrival, Input, Taken, operator::Request};
use rig::observe::{Observer, Record, Summary};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::{
    session::{Session, Who, request},
    view::{self, Counts},
    web::Web,
};
use crate::{
    error::CliError,
    run::{Setup, folder::PRESSES},
};

/// Control cycles between two looks at the way of the tool, and at whether something is to be shown.
const EVERY: u64 = 16;
/// Between two states that are shown.
const SHOWN: Duration = Duration::from_millis(40);
/// The tool has gone on when it is so far from where it was, mm.
const FAR_MM: f32 = 0.02;
/// Most places of its way that are kept; then every second one is left out.
const MOST_PLACES: usize = 8192;
/// Most presses that are taken at once, and that may be on their way to the plant.
const MOST_PRESSES: usize = 8;
const MOST_WAITING: usize = 32;

/// The panel.
pub(crate) struct Live {
    /// The command ends with the run.
    pub(crate) ends_with_its_run: bool,
    web: Web,
    session: Session,
    /// What stays the same during a run, to be told again to a panel that was started again.
    still: Map<String, Value>,
    steps: u64,
    cycle_s: f64,
    trail: Vec<Point>,
    /// How many of these the panel knows.
    told: usize,
    shown: Moment,
    lists: Option<Counts>,
    /// Per cent that came before its request was whole.
    value: f64,
    /// The panel does not know what stays the same.
    stale: bool,
}

fn fields(of: &impl Serialize) -> Map<String, Value> {
    match serde_json::to_value(of) {
        Ok(Value::Object(fields)) => fields,
        _ => Map::new(),
    }
}

impl Live {
    /// Nothing runs yet.
    pub(crate) fn new(web: Web, ends_with_its_run: bool) -> Live {
        Live {
            ends_with_its_run,
            web,
            session: Session::default(),
            still: Map::new(),
            steps: 0,
            cycle_s: 0.0,
            trail: Vec::new(),
            told: 0,
            shown: Moment::now(),
            lists: None,
            value: 0.0,
            stale: true,
        }
    }

    /// These fields are shown until they are others.
    pub(crate) fn stands(&mut self, more: Map<String, Value>) {
        self.still.extend(more);
        self.stale = true;
    }

    /// A run begins.
    pub(crate) fn begins(&mut self, program: &ProgramSeen, machine: &MachineSeen, steps: u64) {
        self.session = Session::default();
        (self.steps, self.cycle_s) = (steps, machine.cycle_s);
        self.trail.clear();
        self.lists = None;
        // These change from now on.
        self.still.retain(|name, _| name != "state" && name != "words");
        let (program, machine) = (json!(program), json!(machine));
        let empty = json!([]);
        let none = json!({
            "program": program, "machine": machine, "outcome": null,
            "passes": empty, "messages": empty, "faults": empty,
        });
        self.stands(fields(&none));
    }

    /// Looks after the panel, and tells it what it has to know before what changes.
    fn look(&mut self) {
        self.stale |= self.web.look();
        if self.stale && self.web.link.offer(&ToPanel::NoTrail) {
            self.web.link.answer(&ToPanel::Set(self.still.clone()));
            (self.stale, self.told, self.lists) = (false, 0, None);
        }
        // What is on its way goes on.
        self.web.link.is_free();
    }

    /// One control cycle of a run.
    pub(crate) fn cycle(&mut self, record: &Record, observer: &Observer) {
        let cycle = record.truth.cycle.0;
        if !cycle.is_multiple_of(EVERY) {
            return;
        }
        let place = view::place(record);
        let far = |(before, kind): &Point| {
            *kind != place.1 || before.iter().zip(&place.0).any(|(one, other)| (one - other).abs() > FAR_MM)
        };
        if self.trail.last().is_none_or(far) {
            self.trail.push(place);
            if self.trail.len() > MOST_PLACES {
                let mut keep = false;
                self.trail.retain(|_| {
                    keep = !keep;
                    keep
                });
                self.told = self.told.div_ceil(2);
            }
        }
        let last = record.truth.measurement.last != 0;
        if last || self.shown.elapsed() >= SHOWN {
            self.show(record, observer);
        }
    }

    /// Shows this cycle, if the panel has taken the one before.
    fn show(&mut self, record: &Record, observer: &Observer) {
        self.shown = Moment::now();
        let seen = view::seen(record, observer, self.lists, self.steps, self.cycle_s);
        let link = &mut self.web.link;
        if self.stale || !link.offer(&ToPanel::Set(fields(&seen))) {
            return;
        }
        self.lists = Some(Counts::of(observer));
        let more = self.trail.get(self.told..).unwrap_or_default();
        if !more.is_empty() && link.is_free() && link.offer(&ToPanel::Trail(more.to_vec())) {
            self.told = self.trail.len();
        }
    }

    /// Looks after the panel, and takes what was pressed: what is to be sent to the plant.
    pub(crate) fn presses(&mut self) -> Vec<Request> {
        self.look();
        let mut requests = Vec::new();
        for _ in 0..MOST_PRESSES {
            let Some(press) = self.web.link.press() else { break };
            let wanted = request(press.kind, press.value).filter(|_| self.session.waiting() < MOST_WAITING);
            match wanted {
                Some(request) => {
                    self.session.sent(request, Who::Panel(press.ticket));
                    requests.push(request);
                }
                None => {
                    self.refuse(press.ticket, "too-many", "presses come faster than the machine takes them")
                }
            }
        }
        requests
    }

    /// Whether somebody has pressed start, while nothing runs; everything else is refused.
    pub(crate) fn is_started(&mut self) -> bool {
        self.look();
        while let Some(press) = self.web.link.press() {
            if press.kind == protocol::OperatorRequest::pack(0, Request::CycleStart).kind {
                self.web.link.answer(&ToPanel::Taken { ticket: press.ticket, cycle: 0 });
                return true;
            }
            self.refuse(press.ticket, "not-running", "no program runs; start starts it");
        }
        false
    }

    fn refuse(&mut self, ticket: u64, code: &str, why: &str) {
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
        self.stands(fields(&json!({ "outcome": summary.outcome })));
        self.look();
        let path = folder.join(PRESSES);
        let written = self.session.events().map(|text| intake::replace(&path, text.as_bytes()));
        written.transpose().map(drop).map_err(|error| CliError::file(&path, error))
    }
}

/// What stays the same during a run.
pub(crate) fn stays(setup: &Setup, observer: &Observer, text: Option<String>) -> (ProgramSeen, MachineSeen) {
    let Setup { machine, program, folder, .. } = setup;
    let axes: Vec<_> = machine.axes().collect();
    let notes = program.check.as_ref();
    let origin_mm = notes.and_then(|check| {
        let of_pass = check.passes.first().map(|note| note.origin_mm);
        of_pass.or_else(|| check.origins_mm.values().next().copied())
    });
    let name = folder.program.file_name().unwrap_or_default().to_string_lossy().into_owned();
    (
        ProgramSeen {
            name,
            text,
            passes: program.passes(),
            time_s: program.time_s,
            folder: folder.path.display().to_string(),
        },
        MachineSeen {
            name: machine.general.name.clone(),
            kinematics: machine.general.kinematics.name().into(),
            axes: axes.iter().map(|(axis, _)| axis.name().to_ascii_uppercase()).collect(),
            travel: axes.iter().map(|(_, config)| config.travel_mm).collect(),
            cycle_s: machine.general.cycle_s,
            max_rpm: machine.spindle.max_rpm,
            pace: setup.pace.to_string(),
            stock: observer.stock().and_then(|stock| serde_json::to_value(stock).ok()),
            origin_mm,
        },
    )
}
