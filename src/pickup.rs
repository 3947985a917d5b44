//! `pitchlock pick-up FILE`: where a thread that is there lies. In: touches of its groove. Out: phase, lead
//! and taper with what they may be off, and where a program has to start to enter the groove.

use std::{fmt::Write as _, path::PathBuf, process::ExitCode};

use clap::Args;
use gauge::pickup::{Asked, FEWEST, Found, NotFound, Value, pick_up, touches};
use serde_json::json;

use crate::{error::CliError, screen};

pub(crate) const HELP: &str = "Example:
  pitchlock pick-up touches.txt --lead -2 --start 8

The file has a line for each touch: the angle of the spindle from its index in degrees, Z in mm, and perhaps X (a radius)
in mm, of a probe that sits in the groove. # begins a comment. Three touches at least, at angles that are not in even
steps, at least a few turns apart.

Everything is told with what it may be off, with a confidence of 95 %. docs/pick-up.md says how to touch and how to go on.

Exit status: 0 found; 1 the touches are not those of such a thread; 2 the file or an argument is wrong.";

/// A Z beyond is none, mm.
const MOST_MM: f64 = 1e5;
/// A start that may be off by more than this share of the pitch enters no groove.
const MOST_OF_PITCH: f64 = 0.1;

#[derive(Clone, Debug, Args)]
pub(crate) struct PickUpArgs {
    /// The touches.
    pub(crate) file: PathBuf,
    /// Nominal lead, mm per turn: negative where Z falls while the spindle turns as in the cut.
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub(crate) lead: f64,
    /// Starts of the thread.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) starts: u32,
    /// The probe is off by so much at most, µm.
    #[arg(long, value_name = "UM", default_value_t = 5.0)]
    pub(crate) noise_um: f64,
    /// The lead of the thread may be off by so much, µm per turn.
    #[arg(long, value_name = "UM", default_value_t = 10.0)]
    pub(crate) lead_error_um: f64,
    /// Z near which the program shall start, mm.
    #[arg(long, value_name = "MM", default_value_t = 0.0, allow_negative_numbers = true)]
    pub(crate) start: f64,
    /// Print one JSON document, and nothing else.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Finds the thread and prints it.
pub(crate) fn command(args: &PickUpArgs) -> Result<ExitCode, CliError> {
    let text =
        intake::text(&args.file, intake::SETTINGS).map_err(|error| CliError::file(&args.file, error))?;
    let touches = touches(&text).map_err(|error| CliError::file(&args.file, error))?;
    let asked = Asked {
        lead_mm: args.lead,
        starts: args.starts,
        noise_mm: 1e-3 * args.noise_um,
        lead_error_mm: 1e-3 * args.lead_error_um,
    };
    if !args.start.is_finite() || args.start.abs() > MOST_MM {
        return Err(CliError::Input(format!("--start {}: this is no Z of a machine", args.start)));
    }
    let found = pick_up(&touches, &asked).map_err(|error| refused(args, &error))?;
    let start = found.start_near(args.start);
    if start.within > MOST_OF_PITCH * found.pitch_mm {
        return Err(CliError::Machine(format!(
            "{}: at Z {:.4} mm the groove may be {:.1} µm off, more than a tenth of the pitch: touch more often or better, \
             or nearer to --start",
            args.file.display(),
            start.value,
            1e3 * start.within
        )));
    }
    screen::print(&if args.json { as_json(&found, start) } else { told(&found, start) });
    Ok(ExitCode::SUCCESS)
}

/// What is wrong with the file is an error of the input, what is wrong with the thread is not.
fn refused(args: &PickUpArgs, error: &NotFound) -> CliError {
    let file = args.file.display();
    let lead = args.lead;
    let text = match *error {
        NotFound::TooFew => format!("{file}: a thread needs {FEWEST} touches at least"),
        NotFound::Number => format!(
            "{file}: a number is out of range; the lead is not 0, the noise more than 0, starts 1 or more"
        ),
        NotFound::OnePlace => {
            format!("{file}: all touches are in one place of the thread: touch it some turns away as well")
        }
        NotFound::Ambiguous(most) => format!(
            "{file}: the touches lie more than {most:.1} turns apart, and with a lead that may be off by {} µm it is \
             not known which turns they are: touch nearer, or say less with --lead-error-um",
            args.lead_error_um
        ),
        NotFound::BadFit(mm) => {
            return CliError::Machine(format!(
                "{file}: these are not touches of one thread of lead {lead} mm: one is {:.1} µm off, and the probe only \
                 {} µm; another lead or number of starts, or a touch beside the groove",
                1e3 * mm,
                args.noise_um
            ));
        }
        NotFound::OtherLead(mm) => {
            return CliError::Machine(format!(
                "{file}: the thread has a lead of {mm:.4} mm, which is more than {} µm from {lead} mm",
                args.lead_error_um
            ));
        }
        NotFound::BadTaper(mm) => {
            return CliError::Machine(format!(
                "{file}: X is not on one cone: one touch is {:.1} µm off; leave X out, or touch again",
                1e3 * mm
            ));
        }
    };
    CliError::Input(text)
}

fn told(found: &Found, start: Value) -> String {
    let Found { phase_mm, angle_deg, lead_mm, taper, farthest_mm, .. } = found;
    let um = |mm: f64| 1e3 * mm;
    let mut text = format!(
        "phase     the groove is at Z {:.4} mm ± {:.1} µm at {angle_deg:.2}° from the index\n\
         lead      {:.5} mm ± {:.2} µm per turn\n",
        phase_mm.value,
        um(phase_mm.within),
        lead_mm.value,
        um(lead_mm.within)
    );
    if let Some(Value { value, within }) = taper {
        let _ = writeln!(text, "taper     X {value:.6} ± {within:.6} per mm of Z");
    }
    let _ = write!(
        text,
        "touches   within {:.1} µm of that\nstart     at Z {:.4} mm ± {:.1} µm: a pass that starts there enters the groove;\n          \
         a cycle with infeed along the flank has to start K tan Q before it (docs/pick-up.md)\n",
        um(*farthest_mm),
        start.value,
        um(start.within)
    );
    text
}

fn as_json(found: &Found, start: Value) -> String {
    let Found { phase_mm, angle_deg, lead_mm, taper, farthest_mm, pitch_mm } = found;
    let value = |Value { value, within }: &Value| json!({ "value": value, "within": within });
    let document = json!({
        "version": 1,
        "phase_mm": value(phase_mm),
        "angle_deg": angle_deg,
        "lead_mm": value(lead_mm),
        "taper": taper.as_ref().map(value),
        "farthest_mm": farthest_mm,
        "pitch_mm": pitch_mm,
        "start_mm": value(&start),
    });
    format!("{document:#}\n")
}
