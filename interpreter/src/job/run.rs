//! A job where it stands: within a program, or as a program of its own. In: its text, and what is in force. Out: items, and
//! where the tool is then.

use gcode::files::ToolTable;
use gcode::job::Job as Source;
use gcode::problem::{Blame, Problem, Severity, short};
use gcode::{Place, canon::FeedMode};
use protocol::{Code, Machine, PerAxis, Position, SpindleMode, machine::Kinematics};

use super::row::Row;
use super::text::{self, Text};
use super::{Coolant, Fault, Header, Job, JobNote, Kind, Move, Planned, contour, seam, surface, within};
use crate::translate::{Done, Translator};

/// Highest feed, mm/min.
const HIGHEST_FEED: f64 = 1e6;

/// The keys of a job, which have been read; what is left to say is on which machine, and where.
type Plan = Box<dyn FnOnce(&Job) -> Result<Planned, Fault>>;

/// What a plan depends on, but for the machine.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Asked {
    text: String,
    origin_mm: [f64; 3],
    feed_mm_min: f64,
    rest: PerAxis<Position>,
}

impl Translator {
    /// A job. What is wrong with it is reported with its place in the text.
    pub(crate) fn job(&mut self, place: Place, source: &Source, tools: &ToolTable) -> Done {
        match self.planned(place, source, tools) {
            Ok(planned) => self.begin(place, planned),
            Err(fault) => self.blame(place, source, fault, Severity::Error),
        }
        Ok(())
    }

    fn planned(&mut self, place: Place, source: &Source, tools: &ToolTable) -> Result<Planned, Fault> {
        let text = Text::read(&source.text)?;
        let header = text.header.clone();
        suits(header.kind, &self.machine)?;
        let other_tool = other_tool(tools, source, &header, text.diameter_mm())?;
        let plan: Plan = match header.kind {
            Kind::Contour => text.keys().map(|keys| Box::new(move |job: &Job| contour::plan(keys, job)) as _),
            Kind::Surface => text.keys().map(|keys| Box::new(move |job: &Job| surface::plan(keys, job)) as _),
            Kind::Seam => text.keys().map(|keys| Box::new(move |job: &Job| seam::plan(keys, job)) as _),
        }?;
        self.prepare(place, source, &header)?;
        let job = Job {
            machine: &self.machine,
            is_file: source.is_file,
            origin_mm: self.origin(source, &header)?,
            feed_mm_min: self.feed_of_job(source, &header)?,
            chord_mm: within(
                "chord_mm",
                header.chord_mm.unwrap_or(self.machine.path.chord_mm),
                protocol::Trace::CHORD_MM,
                "mm",
            )?,
            correction: header.correction,
            rest: self.positions(&self.rest),
        };
        let asked = Asked {
            text: source.text.clone(),
            origin_mm: job.origin_mm,
            feed_mm_min: job.feed_mm_min,
            rest: job.rest,
        };
        // The next pass of a loop often asks for the same.
        let planned = match self.last_job.take() {
            Some((last, planned)) if last == asked => planned,
            _ => plan(&job)?,
        };
        self.last_job = Some((asked, planned.clone()));
        for warning in other_tool.into_iter().chain(planned.warnings.iter().cloned()) {
            self.blame(place, source, warning, Severity::Warning);
        }
        if header.kind != Kind::Seam && !self.spindle.turns() {
            let help = if source.is_file { "give spindle_rpm" } else { "start it before, as in S8000 M3" };
            let fault = Fault::new("", "the spindle does not turn while the tool cuts", help);
            self.blame(place, source, fault, Severity::Warning);
        }
        let mut facts = vec![("name", header.name.unwrap_or_default())];
        facts.retain(|(_, name)| !name.is_empty());
        facts.extend(planned.facts.iter().cloned());
        self.jobs.push(JobNote { line: source.line, facts });
        Ok(planned)
    }

    /// What only a job file says: tool, spindle, coolant.
    fn prepare(&mut self, place: Place, source: &Source, header: &Header) -> Result<(), Fault> {
        if !source.is_file {
            return refuse_in_program(header);
        }
        if let Some(number) = header.tool_number {
            let number = i32::try_from(number).unwrap_or(i32::MAX);
            let refused = |problem: Box<Problem>| Fault {
                code: problem.code,
                ..Fault::new("tool_number", problem.message, problem.help)
            };
            self.select_tool(place, number).map_err(refused)?;
        }
        if let Some(rpm) = header.spindle_rpm {
            let highest = self.machine.spindle.max_rpm;
            if highest <= 0.0 {
                let message = format!("{} has no spindle", self.machine.machine.name);
                return Err(Fault::new("spindle_rpm", message, "leave spindle_rpm out"));
            }
            within("spindle_rpm", rpm, [-highest, highest], "1/min (spindle.max_rpm)")?;
            let turn = if rpm < 0.0 { SpindleMode::Counterclockwise } else { SpindleMode::Clockwise };
            self.spindle.turn(turn, rpm.abs());
        }
        let coolant = header.coolant.unwrap_or(Coolant::Off);
        self.coolant(place.line, coolant == Coolant::Mist, coolant == Coolant::Flood);
        Ok(())
    }

    /// Machine position of the zero of the formulas, mm.
    fn origin(&self, source: &Source, header: &Header) -> Result<[f64; 3], Fault> {
        // The offsets of a positioner are those of its axes: where the part lies a seam says itself.
        if source.is_file || header.kind == Kind::Seam {
            return match header.origin_mm {
                None if header.kind == Kind::Seam => Ok([0.0; 3]),
                None => Err(Fault::new(
                    "",
                    "origin_mm is missing",
                    "give the machine position of the zero of the formulas, as in origin_mm = [0.0, 0.0, -50.0]",
                )),
                Some(Row(origin)) if origin.iter().all(|mm| mm.abs() < 1e6) => Ok(origin),
                Some(_) => Err(Fault::new("origin_mm", "that is no position of a machine", "give it in mm")),
            };
        }
        if self.frame.rotation_deg != 0.0 {
            let message = "a job in a coordinate system turned about Z";
            return Err(Fault::new("", message, "turn it back with G10 L2 R0"));
        }
        let [x, y, z, ..] = self.frame.machine(&[0.0; 6]);
        Ok([x, y, z])
    }

    fn feed_of_job(&self, source: &Source, header: &Header) -> Result<f64, Fault> {
        match header.feed_mm_min {
            Some(feed) => within("feed_mm_min", feed, [0.001, HIGHEST_FEED], "mm/min"),
            None if !source.is_file && self.feed_mode == FeedMode::PerMinute && self.feed > 0.0 => {
                Ok(self.feed)
            }
            None => {
                let help = if source.is_file { "give it" } else { "give it, or an F word under G94 before" };
                Err(Fault::new("", "feed_mm_min is missing", help))
            }
        }
    }

    /// Sends the items of a job.
    fn begin(&mut self, place: Place, planned: Planned) {
        self.go(place.line, &planned.approach);
        for (slot, formula) in (0..).zip(planned.formulas) {
            self.push(place.line, Code::Formula { slot, formula });
        }
        for trace in planned.traces {
            self.push(place.line, Code::Trace(trace));
        }
        self.rest = self.machine.machine.kinematics.point(&planned.end.map(Position::mm));
        self.go(place.line, &planned.retract);
        (self.point, self.asked, self.after_thread) = (self.rest, self.rest, false);
    }

    /// Moves around the work.
    fn go(&mut self, line: u32, moves: &[Move]) {
        for step in moves {
            self.push(line, Code::Line { target: step.to, feed: step.feed });
            self.rest = self.machine.machine.kinematics.point(&step.to.map(Position::mm));
        }
    }

    /// Reports a fault of a job where it stands in the text.
    fn blame(&mut self, place: Place, source: &Source, fault: Fault, severity: Severity) {
        let bytes = text::bytes(&source.text, &fault);
        let (line, span) = source.place(bytes.start, bytes.end);
        let there = Place { line, ..place };
        let blame = if span.start < span.end { Blame::Part(there, span) } else { Blame::At(there) };
        let problem = Problem { code: fault.code, severity, blame, message: fault.message, help: fault.help };
        self.report(there, problem);
    }
}

/// Refuses a tool that the table does not have, if there is one; warns of another diameter than that of the job, mm.
fn other_tool(
    tools: &ToolTable,
    source: &Source,
    header: &Header,
    diameter_mm: Option<f64>,
) -> Result<Option<Fault>, Fault> {
    let number = header.tool_number.and_then(|number| i32::try_from(number).ok());
    let tool = match number {
        _ if !source.is_file => Some(&tools.in_spindle),
        Some(number) if number != 0 && !tools.is_empty() => Some(tools.find(number).ok_or_else(|| {
            let message = format!("tool {number} is not in the tool table");
            let fault = Fault::new("tool_number", message, "enter it in the table, or name another tool");
            Fault { code: "unknown-tool", ..fault }
        })?),
        _ => None,
    };
    let (Some(tool), Some(mm)) = (tool.filter(|tool| tool.diameter > 0.0), diameter_mm) else {
        return Ok(None);
    };
    let message = format!(
        "tool {} has a diameter of {} mm in the tool table, that of the job {} mm",
        tool.number,
        short(tool.diameter),
        short(mm)
    );
    let differs = (tool.diameter - mm).abs() > 1e-6;
    Ok(differs.then(|| {
        Fault::new("tool.diameter_mm", message, "the path is that of the job: correct either of them")
    }))
}

/// Refuses a job of a kind that the machine cannot do, before anything else is said of it.
fn suits(kind: Kind, machine: &Machine) -> Result<(), Fault> {
    let (suited, message, help): (&[Kinematics], _, _) = match kind {
        Kind::Surface => (&[Kinematics::Mill], "a surface needs a mill", "\"mill\""),
        Kind::Contour => (
            &[Kinematics::Mill, Kinematics::Lathe],
            "a contour needs a mill or a lathe",
            "\"mill\" or \"lathe\"",
        ),
        Kind::Seam => (&[Kinematics::Positioner], "a seam needs a positioner", "\"positioner\""),
    };
    if suited.contains(&machine.machine.kinematics) {
        return Ok(());
    }
    let message = format!("{message}, and {} is none", machine.machine.name);
    Err(Fault::new("kind", message, format!("choose a machine file with kinematics = {help}")))
}

/// Keys that G-code around a job says otherwise.
fn refuse_in_program(header: &Header) -> Result<(), Fault> {
    let given = [
        ("name", header.name.is_some(), "write a comment"),
        (
            "origin_mm",
            header.origin_mm.is_some() && header.kind != Kind::Seam,
            "the zero is that of the coordinates in force: G54, G92",
        ),
        ("spindle_rpm", header.spindle_rpm.is_some(), "write S and M3 before"),
        ("tool_number", header.tool_number.is_some(), "write T and M6 before"),
        ("coolant", header.coolant.is_some(), "write M7 or M8 before"),
    ];
    match given.into_iter().find(|(_, given, _)| *given) {
        Some((key, _, help)) => Err(Fault::new(key, format!("{key} belongs to a job file"), help)),
        None => Ok(()),
    }
}
