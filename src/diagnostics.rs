//! What was found in a program as one JSON document, for editors: `pitchlock check --json`.
//!
//! ```json
//! { "version": 1, "program": "part.ngc", "dialect": "linuxcnc", "errors": 1, "warnings": 0, "moves": 12,
//!   "time_s": null, "gauge": null, "error": null,
//!   "diagnostics": [
//!   { "file": "part.ngc", "line": 2, "column": 8, "end_column": 10, "severity": "error",
//!     "code": "unused-word", "message": "no code of this block uses Q", "help": "leave it out" } ],
//!   "passes": [
//!   { "pass": 1, "line": 9, "depth_mm": 0.2, "x_mm": 9.8, "start_z_mm": 8.0,
//!     "full_depth_z_mm": [ 5.0, -20.0 ], "max_override_pct": 120.0 } ] }
//! ```
//! `error` is why nothing could be judged, or null. `gauge` is the name of the thread that a gauge will
//! judge, null without one. `time_s` is the time the program takes at 100 % override, s, to the microsecond;
//! null where an error keeps it from running. Lines and columns count from 1, columns in characters;
//! `end_column` is that of the character behind the last. X is a radius; `depth_mm` is null where the program
//! does not say where the crest is. `certificate` is there with `--certify` alone, and where there is a
//! thread (docs/certificate.md). `speed_variation` of a pass is there where its speed is varied
//! (docs/speed-variation.md). `references` are the runs that the program begins with: `axis`, `method`,
//! `position_mm`; there is none where there are none.

use std::path::Path;

use gcode::{Diagnostic, Severity};
use interpreter::{CornerNote, PassNote};
use serde::Serialize;

use crate::{
    certificate::Certificate, error::CliError, program::Program, references::Reference,
    varied::SpeedVariation,
};

/// The document.
#[derive(Debug, Serialize)]
pub(crate) struct Document<'a> {
    version: u32,
    program: String,
    dialect: Option<&'a str>,
    errors: usize,
    warnings: usize,
    moves: u64,
    time_s: Option<f64>,
    gauge: Option<&'a str>,
    /// All of them, in the order of the program.
    gauges: Vec<&'a str>,
    error: Option<String>,
    diagnostics: Vec<Entry<'a>>,
    passes: Vec<Pass>,
    /// The reference runs that the program begins with.
    #[serde(skip_serializing_if = "<[Reference]>::is_empty")]
    references: &'a [Reference],
    #[serde(skip_serializing_if = "Option::is_none")]
    certificate: Option<&'a Certificate>,
}

#[derive(Debug, Serialize)]
struct Entry<'a> {
    file: &'a str,
    line: u32,
    column: u32,
    end_column: u32,
    severity: String,
    code: &'a str,
    message: &'a str,
    help: &'a str,
}

#[derive(Debug, Serialize)]
struct Pass {
    pass: u32,
    line: u32,
    /// The axis of the places below: Z, or X of a thread on a face.
    along: &'static str,
    depth_mm: Option<f64>,
    /// X at full depth; on a face Z.
    x_mm: f64,
    start_z_mm: f64,
    full_depth_z_mm: [f64; 2],
    max_override_pct: f64,
    /// How much deeper than the last pass of its start, and chip thickness; null where nobody knows.
    deeper_mm: Option<f64>,
    chip_mm: Option<f64>,
    /// Of a tap.
    #[serde(skip_serializing_if = "Option::is_none")]
    tap: Option<Tap>,
    #[serde(skip_serializing_if = "Option::is_none")]
    speed_variation: Option<SpeedVariation>,
    /// Lead along the thread where it ends, of one that changes.
    #[serde(skip_serializing_if = "Option::is_none")]
    end_lead_mm: Option<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    corners: Vec<Corner>,
    #[serde(skip_serializing_if = "Option::is_none")]
    blunt: Option<Blunt>,
}

/// What a pass of a blunt start leaves: turns of the groove behind the face at which the ridge begins, the
/// angle over which it rises, where along Z of the machine it is whole.
#[derive(Debug, Serialize)]
struct Blunt {
    turns: f64,
    over_deg: f64,
    whole_from_z_mm: f64,
}

/// Where a tap brakes in front of its depth, mm; the highest speed that lets it, 1/min; speed of the way out
/// as a multiple of S; what it takes, s.
#[derive(Debug, Serialize)]
struct Tap {
    brakes_mm: f64,
    top_rpm: f64,
    return_ratio: f64,
    seconds: f64,
}

/// A corner of a chain, and how it is rounded.
#[derive(Debug, Serialize)]
struct Corner {
    line: u32,
    x_mm: f64,
    z_mm: f64,
    window_deg: f64,
    off_mm: f64,
}

impl<'a> Document<'a> {
    /// The document of everything that was found in a program, or of why nothing was.
    pub(crate) fn of(
        path: &Path,
        judged: &'a Result<(Program, Option<Certificate>), CliError>,
    ) -> Document<'a> {
        let program = path.display().to_string();
        let empty = Document {
            version: 1,
            program,
            dialect: None,
            errors: 1,
            warnings: 0,
            moves: 0,
            time_s: None,
            gauge: None,
            gauges: Vec::new(),
            error: None,
            diagnostics: Vec::new(),
            passes: Vec::new(),
            references: &[],
            certificate: None,
        };
        let (judged, certificate) = match judged {
            Ok((judged, certificate)) => (judged, certificate.as_ref()),
            Err(error) => return Document { error: Some(error.to_string()), ..empty },
        };
        let pass =
            |note: &PassNote| Pass { chip_mm: judged.chips_mm.get(&note.pass).copied(), ..Pass::from(note) };
        let (errors, warnings) = (judged.found(Severity::Error), judged.found(Severity::Warning));
        Document {
            dialect: Some(judged.dialect),
            errors,
            warnings,
            moves: judged.moves,
            time_s: (errors == 0).then(|| (judged.time_s * 1e6).round() / 1e6),
            gauge: judged.gauges.first().map(|thread| thread.nominal.name.as_str()),
            gauges: judged.gauges.iter().map(|thread| thread.nominal.name.as_str()).collect(),
            diagnostics: judged.diagnostics().iter().map(Entry::from).collect(),
            passes: judged.check.iter().flat_map(|check| &check.passes).map(pass).collect(),
            references: &judged.references,
            certificate,
            ..empty
        }
    }
}

impl From<&CornerNote> for Corner {
    fn from(note: &CornerNote) -> Corner {
        let CornerNote { line, at_mm: [x_mm, z_mm], window_deg, off_mm } = *note;
        Corner { line, x_mm, z_mm, window_deg, off_mm }
    }
}

impl From<&PassNote> for Pass {
    fn from(note: &PassNote) -> Pass {
        Pass {
            pass: note.pass,
            line: note.line,
            along: note.along.name(),
            depth_mm: note.depth_mm,
            x_mm: note.across_mm,
            start_z_mm: note.start_mm,
            full_depth_z_mm: note.full_depth_mm,
            max_override_pct: note.max_override_pct,
            deeper_mm: note.infeed_mm.map(|[deeper, _]| deeper),
            chip_mm: None,
            tap: note.tap.map(|tap| Tap {
                brakes_mm: tap.brakes_mm,
                top_rpm: tap.top_rpm,
                return_ratio: tap.return_ratio,
                seconds: tap.seconds,
            }),
            speed_variation: SpeedVariation::of(note),
            end_lead_mm: note.end_lead_mm,
            corners: note.corners.iter().map(Corner::from).collect(),
            blunt: note.blunt.map(|blunt| Blunt {
                turns: blunt.turns,
                over_deg: blunt.over_deg,
                whole_from_z_mm: blunt.whole_from_mm,
            }),
        }
    }
}

impl<'a> From<&'a Diagnostic> for Entry<'a> {
    fn from(diagnostic: &'a Diagnostic) -> Entry<'a> {
        let Diagnostic { file, line, column, text, span, code, severity, message, help } = diagnostic;
        let length = text.get(span.clone()).map_or(0, |blamed| blamed.chars().count() as u32);
        Entry {
            file,
            line: *line,
            column: *column,
            end_column: column + length,
            severity: severity.to_string(),
            code,
            message,
            help,
        }
    }
}
