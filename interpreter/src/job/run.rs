//! A job where it stands: within a program, or as a program of its own. In: its text, and what is in force.
//! Out: what a job file sets before it begins, moves and work, warnings; or what is wrong, by key.

use gcode::Job as Source;
use gcode::Place;
use gcode::files::ToolTable;
use gcode::problem::{Blame, Problem, Severity, short};
use machine::{Kinematics, Machine};
use protocol::{PerAxis, Position};

use super::row::Row;
use super::text::{self, Text};
use super::{Coolant, Fault, Header, Job, JobNote, Kind, Planned, contour, seam, surface, within};
use crate::auxiliary::find_tool;
use crate::frame::Frame;
use crate::modal::HIGHEST_FEED;

/// The keys of a job, which have been read; what is left to say is on which machine, and where.
type Plan = Box<dyn FnOnce(&Job) -> Result<Planned, Fault>>;

/// What a plan depends on, but for the machine.
#[derive(Clone, Debug, PartialEq)]
struct Asked {
    text: String,
    origin_mm: [f64; 3],
    feed_mm_min: f64,
    rest: PerAxis<Position>,
}

/// What is in force where a job stands.
pub(crate) struct InForce<'a> {
    pub(crate) machine: &'a Machine,
    pub(crate) frame: &'a Frame,
    /// F under G94, mm/min.
    pub(crate) feed_mm_min: Option<f64>,
    /// Where the axes rest.
    pub(crate) rest: PerAxis<Position>,
    pub(crate) spindle_turns: bool,
}

/// What only a job file says, to be set before the job begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setup {
    pub(crate) tool: Option<u32>,
    /// Speed of the spindle, 1/min; negative counterclockwise.
    pub(crate) spindle_rpm: Option<f64>,
    pub(crate) coolant: Coolant,
}

/// A job that can begin.
pub(crate) struct Ready {
    /// Of a job file.
    pub(crate) setup: Option<Setup>,
    pub(crate) planned: Planned,
    /// With their places.
    pub(crate) warnings: Vec<(Place, Problem)>,
}

/// The jobs of a program.
#[derive(Default)]
pub(crate) struct Jobs {
    notes: Vec<JobNote>,
    /// The last one that could be done.
    last: Option<(Asked, Planned)>,
}

impl Jobs {
    /// The jobs so far.
    pub(crate) fn notes(&self) -> &[JobNote] {
        &self.notes
    }

    /// Plans a job. What is wrong with it has its place in the text.
    pub(crate) fn plan(
        &mut self,
        place: Place,
        source: &Source,
        tools: &ToolTable,
        in_force: &InForce<'_>,
    ) -> Result<Ready, (Place, Problem)> {
        let blamed = |fault, severity| blame(place, source, fault, severity);
        let (setup, planned, warnings) =
            self.planned(source, tools, in_force).map_err(|fault| blamed(fault, Severity::Error))?;
        let warnings = warnings.into_iter().map(|fault| blamed(fault, Severity::Warning)).collect();
        Ok(Ready { setup, planned, warnings })
    }

    fn planned(
        &mut self,
        source: &Source,
        tools: &ToolTable,
        in_force: &InForce<'_>,
    ) -> Result<(Option<Setup>, Planned, Vec<Fault>), Fault> {
        let text = Text::read(&source.text)?;
        let header = text.header.clone();
        let InForce { machine, rest, .. } = *in_force;
        suits(header.kind, machine)?;
        let other_tool = other_tool(tools, source, &header, text.diameter_mm())?;
        let plan: Plan = match header.kind {
            Kind::Contour => text.keys().map(|keys| Box::new(move |job: &Job| contour::plan(keys, job)) as _),
            Kind::Surface => text.keys().map(|keys| Box::new(move |job: &Job| surface::plan(keys, job)) as _),
            Kind::Seam => text.keys().map(|keys| Box::new(move |job: &Job| seam::plan(keys, job)) as _),
        }?;
        let setup = setup(source, &header, machine)?;
        let chord_mm = header.chord_mm.unwrap_or(machine.path.chord_mm);
        let job = Job {
            machine,
            is_file: source.is_file,
            origin_mm: origin(source, &header, in_force.frame)?,
            feed_mm_min: feed(source, &header, in_force.feed_mm_min)?,
            chord_mm: within("chord_mm", chord_mm, protocol::Work::CHORD_MM, "mm")?,
            correction: header.correction,
            rest,
        };
        let asked =
            Asked { text: source.text.clone(), origin_mm: job.origin_mm, feed_mm_min: job.feed_mm_min, rest };
        // The next pass of a loop often asks for the same.
        let planned = match self.last.take() {
            Some((last, planned)) if last == asked => planned,
            _ => plan(&job)?,
        };
        self.last = Some((asked, planned.clone()));
        let mut warnings: Vec<Fault> = other_tool.into_iter().chain(planned.warnings.clone()).collect();
        let speed = setup.and_then(|setup| setup.spindle_rpm);
        if header.kind != Kind::Seam && !speed.map_or(in_force.spindle_turns, |rpm| rpm != 0.0) {
            let help = if source.is_file { "give spindle_rpm" } else { "start it before, as in S8000 M3" };
            warnings.push(Fault::new("", "the spindle does not turn while the tool cuts", help));
        }
        let mut facts = vec![("name", header.name.unwrap_or_default())];
        facts.retain(|(_, name)| !name.is_empty());
        facts.extend(planned.facts.iter().cloned());
        self.notes.push(JobNote { line: source.line, facts });
        Ok((setup, planned, warnings))
    }
}

/// What a job file sets; a job in a program leaves that to the G-code around it.
fn setup(source: &Source, header: &Header, machine: &Machine) -> Result<Option<Setup>, Fault> {
    if !source.is_file {
        return refuse_in_program(header).map(|()| None);
    }
    if let Some(number) = header.tool_number {
        find_tool(number, machine).map_err(|problem| Fault {
            code: problem.code,
            ..Fault::new("tool_number", problem.message, problem.help)
        })?;
    }
    if let Some(rpm) = header.spindle_rpm {
        let highest = machine.spindle.max_rpm;
        if highest <= 0.0 {
            let message = format!("{} has no spindle", machine.general.name);
            return Err(Fault::new("spindle_rpm", message, "leave spindle_rpm out"));
        }
        within("spindle_rpm", rpm, [-highest, highest], "1/min (spindle.max_rpm)")?;
    }
    let Header { tool_number: tool, spindle_rpm, .. } = *header;
    Ok(Some(Setup { tool, spindle_rpm, coolant: header.coolant.unwrap_or(Coolant::Off) }))
}

/// Machine position of the zero of the formulas, mm.
fn origin(source: &Source, header: &Header, frame: &Frame) -> Result<[f64; 3], Fault> {
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
            Some(_) => {
                Err(Fault::new("origin_mm", "this is not a position that a machine has", "give it in mm"))
            }
        };
    }
    if frame.rotation_deg != 0.0 {
        let message = "a job in a coordinate system turned about Z";
        return Err(Fault::new("", message, "turn it back with G10 L2 R0"));
    }
    let [x, y, z, ..] = frame.machine(&[0.0; 6]);
    Ok([x, y, z])
}

/// Feed of a job, mm/min.
fn feed(source: &Source, header: &Header, in_force: Option<f64>) -> Result<f64, Fault> {
    match (header.feed_mm_min, in_force) {
        (Some(feed), _) => within("feed_mm_min", feed, [0.001, HIGHEST_FEED], "mm/min"),
        (None, Some(feed)) if !source.is_file => Ok(feed),
        _ => {
            let help = if source.is_file { "give it" } else { "give it, or an F word under G94 before" };
            Err(Fault::new("", "feed_mm_min is missing", help))
        }
    }
}

/// A fault of a job where it stands in the text.
fn blame(place: Place, source: &Source, fault: Fault, severity: Severity) -> (Place, Problem) {
    let bytes = text::bytes(&source.text, &fault);
    let (line, span) = source.place(bytes.start, bytes.end);
    let there = Place { line, ..place };
    let blame = if span.start < span.end { Blame::Part(there, span) } else { Blame::At(there) };
    let problem = Problem { code: fault.code, severity, blame, message: fault.message, help: fault.help };
    (there, problem)
}

/// Refuses a tool that the table does not have, if there is one; warns of another diameter than that of the
/// job, mm.
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
            let fault = Fault::new(
                "tool_number",
                message,
                "enter it in the tool table (--tools FILE), or name another tool",
            );
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
    if suited.contains(&machine.general.kinematics) {
        return Ok(());
    }
    let message = format!("{message}, which {} is not", machine.general.name);
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
