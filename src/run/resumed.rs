//! `pitchlock run RUN_DIR --resume`: what is known of a run that was broken off and what is not, where its
//! program begins again, and how the tool gets there. In: what is left of the run. Out: the machine at rest
//! and a plan; both told before anything moves.

use std::{
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
};

use rig::{
    observe::{Observer, ResumedReport},
    resume::{Changed, Plan, Stands},
};
use serde_json::{Value, json};
use sim_plant::{Plant, Scenario};

use super::{args::RunArgs, folder::BEFORE};
use crate::{
    entered::{in_force, moved},
    error::CliError,
    journal,
    program::Program,
    replay::Left,
    screen, words,
};

/// A run that goes on with another one.
pub(crate) struct Resumed {
    /// The machine, switched on again.
    pub(crate) plant: Plant,
    /// Who has seen what was cut so far.
    pub(crate) observer: Observer,
    /// How it is gone on with.
    pub(crate) plan: Plan,
    /// The same in the summary.
    pub(crate) report: ResumedReport,
    /// Folder of that run.
    from: PathBuf,
    left: Left,
    /// Another tool table is named.
    with_tools: bool,
}

impl Resumed {
    /// Brings the machine of a run to rest and finds how its program is gone on with; the program then tells
    /// its messages where they come.
    ///
    /// # Errors
    /// It is not gone on with, and why.
    pub(super) fn new(
        left: Left,
        scenario: Scenario,
        program: &mut Program,
        [args, asked]: [&RunArgs; 2],
    ) -> Result<Resumed, CliError> {
        let machine = &left.recorded.machine;
        if let Some((axis, _)) = machine.axes().find(|(_, config)| config.reference.is_some()) {
            return Err(CliError::Input(format!(
                "{axis} has a reference run ([axis.{}.reference]), and nobody knows where it stands behind a break; its \
                 tool may stand in the part: free it by hand, then begin at a line, --from LINE",
                axis.name()
            )));
        }
        let making = words::Phase::begin("making the machine of the run again");
        let (mut plant, observer) = left.at_rest(scenario)?;
        drop(making);
        let items = program.items(&args.program, &args.language.language(), &left.recorded.machine)?;
        let plan = left.plan(&mut plant, items.map_while(Result::ok).fuse())?;
        let (begun_at, before) = (plan.modal.steps, plan.steps_before());
        if let Some(check) = &mut program.check {
            check.messages.retain(|note| note.after >= begun_at);
            check.messages.iter_mut().for_each(|note| note.after = note.after - begun_at + before);
        }
        program.steps = program.steps.saturating_sub(begun_at) + before;
        let from = PathBuf::from(&left.recorded.name);
        let report = ResumedReport {
            run: left.recorded.name.clone(),
            known_cycle: left.state().cycle,
            line: plan.line,
            pass: plan.pass,
            ..ResumedReport::default()
        };
        let with_tools = asked.language.tools.is_some();
        Ok(Resumed { plant, observer, plan, report, from, left, with_tools })
    }

    /// Says all of it: a run on standard error, a dry run on standard output.
    pub(super) fn tell(&self, args: &RunArgs, quiet: bool) {
        match (args.dry_run, args.json) {
            (true, true) => screen::print(&format!("{:#}\n", self.as_json())),
            (true, false) => screen::print(&self.told()),
            (false, false) if !quiet => words::say(&self.told()),
            _ => {}
        }
    }

    fn told(&self) -> String {
        let mut text = match &self.left.known {
            Some((record, state)) => journal::told(*record, state, false),
            None => "known     nothing: its journal has no whole record\n".into(),
        };
        for unknown in self.unknown() {
            let _ = writeln!(text, "not known {unknown}");
        }
        let _ = writeln!(text, "stands    {}", stands(self.plan.stands));
        for item in &self.plan.way {
            let _ = writeln!(text, "way       {}", moved(item, &self.left.recorded.machine));
        }
        if let Some(change) = self.change() {
            let _ = writeln!(text, "tool      {change}");
        }
        let what = self.plan.pass.map_or_else(String::new, |pass| format!(", pass {pass}, whole"));
        let _ = writeln!(text, "begins    at line {}{what}", self.plan.line);
        let _ = writeln!(text, "in force  {}", in_force(&self.plan.modal));
        text
    }

    /// What nobody knows.
    fn unknown(&self) -> Vec<String> {
        let mut unknown = vec![match &self.left.known {
            Some((_, state)) => format!(
                "what was done after control cycle {}: what may not be done is done again",
                state.cycle
            ),
            None => "how far it came: it begins where the tool may have been first".into(),
        }];
        if self.left.record_is_damaged() {
            let text = "what was done at the panel, or failed, last: the end of arrivals.txt or arrivals.live is damaged or lost, and the \
                        machine is made again without it";
            unknown.push(text.into());
        }
        if !self.left.has_an_end() {
            let text = "whether its machine lost its power, as is taken here: one whose launcher alone was killed comes to rest by an \
                        emergency stop, and its tool leaves the thread";
            unknown.push(text.into());
        }
        if let Stands::InPass(pass) = self.plan.stands {
            unknown.push(format!(
                "what the tool did to the groove of pass {pass} while the spindle ran down, if it stood in it: look at it"
            ));
        }
        if self.left.tools_of_before().is_some() {
            let text = "whether the new tool is in place already: the journal has not seen that it was put in, so the way is that of \
                        the one before";
            unknown.push(text.into());
        }
        let edge = match self.plan.changed {
            Some(_) => "whether the new tool stands where its table says: the groove lies by it",
            None => "whether the edge of the tool is whole",
        };
        unknown.push(format!("whether the part is held as it was, and {edge}"));
        unknown
    }

    /// What another tool table changes.
    fn change(&self) -> Option<String> {
        match self.plan.changed {
            Some(Changed { by_mm: [x_mm, z_mm], .. }) => Some(format!(
                "by the new table where it begins X {x_mm:+.3} Z {z_mm:+.3} mm from the one before: put it in where the old one \
                 has come out, before the last move of the way"
            )),
            None if self.with_tools => Some("as it was: the table that is named changes no move".into()),
            None => None,
        }
    }

    fn as_json(&self) -> Value {
        let Plan { modal, line, pass, way, .. } = &self.plan;
        json!({
            "version": 1,
            "known": self.left.known.as_ref().map(|(record, state)| journal::as_json(*record, state)),
            "not_known": self.unknown(),
            "stands": stands(self.plan.stands),
            "way": way.iter().map(|item| moved(item, &self.left.recorded.machine)).collect::<Vec<String>>(),
            "line": line,
            "pass": pass,
            "passes_done": modal.passes,
            "steps_done": modal.steps,
            "tool": modal.tool,
            "tool_changed_mm": self.plan.changed.map(|changed| changed.by_mm),
        })
    }

    /// Keeps in the folder of the new run all that is needed to make the one before again.
    pub(super) fn keep(&self, folder: &Path) -> Result<(), CliError> {
        let to = folder.join(BEFORE);
        copy(&self.from, &to).map_err(|error| CliError::file(&to, error))
    }
}

/// Copies a run folder without its trace and its report.
fn copy(from: &Path, to: &Path) -> std::io::Result<()> {
    fs::create_dir(to)?;
    for file in fs::read_dir(from)? {
        let file = file?;
        let (name, place) = (file.file_name(), to.join(file.file_name()));
        let text = name.to_string_lossy();
        if text == BEFORE {
            copy(&file.path(), &place)?;
        } else if file.file_type()?.is_file()
            && !["trace.", "report."].iter().any(|left| text.starts_with(left))
        {
            fs::copy(file.path(), &place)?;
            fs::File::open(&place)?.sync_all()?;
        }
    }
    Ok(())
}

fn stands(stands: Stands) -> String {
    match stands {
        Stands::InPass(pass) => format!("the tool, where pass {pass} leads it"),
        Stands::OnRapid(line) => format!("the tool, on the rapid of line {line}"),
        Stands::OnContour(line) => format!("the tool, on the contour, in line {line}"),
        Stands::Above => "the tool, over the part".into(),
        Stands::AtRest => "the tool, where the program leaves it".into(),
    }
}
