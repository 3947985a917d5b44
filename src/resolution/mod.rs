//! `pitchlock resolution`: how fine positions, speeds, accelerations and jerks have to be for the parts of a
//! machine, and whether its encoders and its wire are. In: a machine file, or limits of a motion; a
//! tolerance. Out: tables on the screen, one JSON document, a page with pictures.
//!
//! The equations are in `adviser::resolution` (M28–M35) and `adviser::tolerance` (M94); M95 says what a
//! tolerance is on an axis that turns, and a count of the spindle along a thread:
//!
//! ```text
//! angle = P/r · 180/π  (P in µm on the radius r in mm: thousandths of a degree)
//! way of a count = F/(4 N)                                                                (M95)
//! ```

mod document;
mod figures;
mod needs;
mod page;
mod read;
mod tables;
mod unseen;
mod verdict;

use std::{path::PathBuf, process::ExitCode};

use adviser::{resolution::Steps, tolerance::Grade};
use clap::Args;
use machine::Machine;

use crate::{
    args::MachineArgs,
    error::CliError,
    screen,
    written::{self, Made},
};
use needs::AxisNeeds;

pub(crate) const HELP: &str = "Examples:
  pitchlock resolution                                           the built-in lathe, parts of 50 mm in IT7
  pitchlock resolution --machine my-mill.toml --grade IT5 --size 120
  pitchlock resolution --tolerance 6 --page needs.html           with pictures
  pitchlock resolution --feed 30000 --acceleration 2 --jerk 10 --cycle 2500 --counts 1000
                                                                 no machine file: a motion in counts of 1 µm

A tolerance is divided into ten steps, a highest feed into 30000, a highest acceleration into 1000, a jerk into 100: that
is what is needed. D says how many times a count is coarser than that; up to 1 is fine. D of speed, acceleration and jerk
matters where they are made by differences of counts. X of a lathe makes diameters: it gets half of the tolerance. See
docs/resolution.md.

Exit status: 0 done, whatever the verdict (--json has it as \"fine\"), 2 an argument or the machine file is wrong.";

#[derive(Clone, Debug, Args)]
pub(crate) struct ResolutionArgs {
    #[command(flatten)]
    machine: MachineArgs,
    /// Tolerance grade of the parts, ISO 286: IT01, IT0, IT1 … IT18 [default: IT7].
    #[arg(long, value_name = "IT", help_heading = "Parts")]
    grade: Option<String>,
    /// Their nominal size, mm [default: 50].
    #[arg(long, value_name = "MM", help_heading = "Parts")]
    size: Option<f64>,
    /// Their tolerance, µm, instead of grade and size.
    #[arg(long, value_name = "UM", help_heading = "Parts")]
    tolerance: Option<f64>,
    /// Where a rotary axis holds it, mm from its centre [default: half the size].
    #[arg(long, value_name = "MM", help_heading = "Parts")]
    radius: Option<f64>,
    /// Longest lead of threads, mm [default: 5].
    #[arg(long, value_name = "MM", help_heading = "Parts")]
    lead: Option<f64>,
    /// Highest feed, mm/min.
    #[arg(long, value_name = "MM_MIN", help_heading = "Motion, instead of a machine file")]
    feed: Option<f64>,
    /// Highest acceleration, m/s².
    #[arg(long, value_name = "M_S2", help_heading = "Motion, instead of a machine file")]
    acceleration: Option<f64>,
    /// Highest jerk, m/s³.
    #[arg(long, value_name = "M_S3", help_heading = "Motion, instead of a machine file")]
    jerk: Option<f64>,
    /// Cycles of the control, Hz.
    #[arg(long, value_name = "HZ", help_heading = "Motion, instead of a machine file")]
    cycle: Option<f64>,
    /// Counts of position per mm [default: 1000].
    #[arg(long, value_name = "PER_MM", help_heading = "Motion, instead of a machine file")]
    counts: Option<f64>,
    /// K_m: steps of position to the tolerance.
    #[arg(long, value_name = "N", default_value_t = 10.0, help_heading = "Steps")]
    k_m: f64,
    /// K_F: steps of speed to the highest feed; 1e4 to 3e4.
    #[arg(long, value_name = "N", default_value_t = 3e4, help_heading = "Steps")]
    k_f: f64,
    /// K_a: steps to the highest acceleration; 1000 or more.
    #[arg(long, value_name = "N", default_value_t = 1000.0, help_heading = "Steps")]
    k_a: f64,
    /// K_J: steps to the highest jerk; 100 or more.
    #[arg(long, value_name = "N", default_value_t = 100.0, help_heading = "Steps")]
    k_j: f64,
    /// Page with tables and pictures.
    #[arg(long, value_name = "PAGE.html")]
    page: Option<PathBuf>,
    /// Print one JSON document, and nothing else.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What is asked, and of whom.
struct Asked {
    source: Source,
    parts: Parts,
    steps: Steps,
    axes: Vec<AxisNeeds>,
}

/// Of whom.
enum Source {
    /// A machine, and the longest lead of its threads, mm.
    Machine { machine: Box<Machine>, lead_mm: f64 },
    /// A motion.
    Given,
}

/// The tolerance of the parts.
struct Parts {
    um: f64,
    /// Grade and nominal size in mm that it comes from.
    grade: Option<(Grade, f64)>,
    /// Where rotary axes hold it, mm; none if there are none.
    radius_mm: Option<f64>,
}

impl Asked {
    /// The machine, for people.
    fn name(&self) -> &str {
        match &self.source {
            Source::Machine { machine, .. } => &machine.general.name,
            Source::Given => "given motion",
        }
    }

    /// Whether an axis makes diameters.
    fn is_diameter(&self, needs: &AxisNeeds) -> bool {
        match (&self.source, &needs.axis) {
            (Source::Machine { machine, .. }, Some((axis, _))) => read::is_diameter(machine, *axis),
            _ => false,
        }
    }

    /// Axes that need and have the same stand together: the needs, and the names of all.
    fn groups(&self) -> Vec<(&AxisNeeds, String)> {
        let mut groups: Vec<(&AxisNeeds, String)> = Vec::new();
        for needs in &self.axes {
            match groups.iter_mut().find(|(first, _)| first.is_like(needs)) {
                Some((_, names)) => names.push_str(&format!(", {}", needs.name())),
                None => groups.push((needs, needs.name())),
            }
        }
        groups
    }
}

/// Says what is needed, and what there is.
pub(crate) fn resolution(args: &ResolutionArgs, quiet: bool) -> Result<ExitCode, CliError> {
    let asked = read::asked(args)?;
    let verdicts = verdict::of(&asked);
    if let Some(path) = &args.page {
        let html = page::html(&read::again(args), &asked, &verdicts);
        written::write(path, Made::Page, html)?;
    }
    if args.json {
        screen::print(&document::json(&asked, &verdicts)?);
    } else if !quiet {
        let page = args.page.as_ref().map_or(String::new(), |path| format!("\npage    {}\n", path.display()));
        screen::print(&format!("{}{page}", tables::text(&asked, &verdicts)));
    }
    Ok(ExitCode::SUCCESS)
}
