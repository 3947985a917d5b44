//! Published experiments, made again with the code that moves the machine. In: an experiment, the machine on
//! its stand. Out: its findings as text for the screen, as one JSON document of rows, and as a page.
//!
//! An experiment is a function that gives `Findings`: rows of its own type, and what is to be said, tabled
//! and drawn of them. What is done with findings is the same for all, and stands in this file. Experiments
//! that move a machine do so on a [`Stand`].
#![forbid(unsafe_code)]

mod approach;
mod chatter;
mod feed;
mod findings;
mod observer;
mod page;
mod positioner;
mod profiles;
mod reference;
mod resolution;
mod stand;
mod surface;
mod sweep;

use clap::ValueEnum;
use machine::Kinematics;
use report::table::Place;
use serde::Serialize;

pub use findings::ExperimentError;
pub use stand::Stand;

use findings::Findings;

/// Version of the JSON document.
const VERSION: u32 = 1;

/// The experiments.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Name {
    /// X moves to depth in step with the spindle: servo errors of six structures of feedforward.
    Approach,
    /// What a varied spindle speed does against chatter: a stability chart, and threads.
    Chatter,
    /// Feed with a smooth jerk: the examples of the published method with their figures put right, and whole
    /// blocks.
    Feed,
    /// How well the spindle's angle is known from its encoder, and what that makes of a helix.
    Observer,
    /// What errors of its drives do to the beam of a positioner, which drives an accuracy needs, and a seam.
    Positioner,
    /// What an approach leaves in a lightly damped mode, for six laws of motion.
    Profiles,
    /// The reference simulation of the servo axis, made again: its figures beside those of this machine.
    Reference,
    /// What rounded positions do to speed, acceleration and servo error, and how fine they have to be.
    Resolution,
    /// How far feed ratios miss curves and surfaces, as published and put right.
    Surface,
    /// Servo error of X over passes, overrides and wrong beliefs.
    Sweep,
}

impl Name {
    /// As the command line has it.
    pub fn text(self) -> &'static str {
        match self {
            Name::Approach => "approach",
            Name::Chatter => "chatter",
            Name::Feed => "feed",
            Name::Observer => "observer",
            Name::Surface => "surface",
            Name::Sweep => "sweep",
            Name::Positioner => "positioner",
            Name::Profiles => "profiles",
            Name::Reference => "reference",
            Name::Resolution => "resolution",
        }
    }

    /// What kind of machine it moves, so that `--machine` says which one; none if it takes none: that of
    /// `surface` is the small mill.
    pub fn moves(self) -> Option<Kinematics> {
        match self {
            Name::Approach | Name::Chatter | Name::Observer | Name::Resolution | Name::Sweep => {
                Some(Kinematics::Lathe)
            }
            Name::Positioner => Some(Kinematics::Positioner),
            Name::Feed | Name::Profiles | Name::Reference | Name::Surface => None,
        }
    }
}

/// The JSON document.
#[derive(Serialize)]
struct Document<'a, R> {
    experiment: &'a str,
    version: u32,
    seed: u64,
    rows: &'a [R],
}

/// Findings as they are shown.
pub struct Made {
    /// The tables that are for a terminal, the notes, the result.
    pub screen: String,
    /// The rows as one JSON document, with its end of line.
    pub json: String,
    /// The page, HTML with everything in it.
    pub page: String,
}

impl Name {
    /// Makes the experiment; `again` is the command that makes it again.
    ///
    /// # Errors
    /// The machine on the stand is not one for it, or does not do what it needs.
    pub fn make(self, stand: &Stand, again: &str) -> Result<Made, ExperimentError> {
        match self {
            Name::Approach => shown(self, stand, again, &approach::findings(stand)?),
            Name::Chatter => shown(self, stand, again, &chatter::findings(stand)?),
            Name::Feed => shown(self, stand, again, &feed::findings()?),
            Name::Observer => shown(self, stand, again, &observer::findings(stand)?),
            Name::Surface => shown(self, stand, again, &surface::findings(stand)?),
            Name::Sweep => shown(self, stand, again, &sweep::findings(stand)?),
            Name::Positioner => shown(self, stand, again, &positioner::findings(stand)?),
            Name::Profiles => shown(self, stand, again, &profiles::findings()),
            Name::Reference => shown(self, stand, again, &reference::findings(stand)?),
            Name::Resolution => shown(self, stand, again, &resolution::findings(stand)?),
        }
    }
}

fn shown<R: Serialize>(
    experiment: Name,
    stand: &Stand,
    again: &str,
    found: &Findings<R>,
) -> Result<Made, ExperimentError> {
    let name = experiment.text();
    let document = Document { experiment: name, version: VERSION, seed: stand.seed, rows: &found.rows };
    let json = serde_json::to_string_pretty(&document);
    let json = json.map_err(|error| ExperimentError::Machine(error.to_string()))? + "\n";
    Ok(Made { screen: screen(found), json, page: page::html(name, again, found) })
}

/// What a terminal shows: the tables that are for it, the notes, the result.
fn screen<R>(found: &Findings<R>) -> String {
    let shown = found.tables.iter().filter(|table| table.place == Place::Everywhere);
    let tables = shown.map(|table| format!("{}\n\n{}\n", table.title, table.text()));
    let paragraph = |lines: &[String]| {
        let lines: String = lines.iter().map(|line| format!("{line}\n")).collect();
        if lines.is_empty() { lines } else { lines + "\n" }
    };
    tables.collect::<String>() + &paragraph(&found.notes) + &paragraph(&found.short)
}
