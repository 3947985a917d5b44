//! `pitchlock thread NAME`: a thread by its name. What its standard asks of it (`limits.rs`), or a part
//! program that cuts it (`write.rs`).

mod limits;
mod write;

use std::{path::PathBuf, process::ExitCode};

use clap::Args;
use metrology::{Misread, Thread, UNDERSTOOD};
use process::shell::{Named, one_of};
use recipe::{Dialect, Infeed, Law, Material, Sequence, Units};

use crate::{args::MachineArgs, error::CliError, screen};

pub(crate) const HELP: &str = "Examples:
  pitchlock thread M20x2-6g -o bolt.ngc                  a program that cuts it
  pitchlock thread M20x2-6g --tool 16ER2.0ISO --material stainless --dialect fanuc -o bolt.nc
  pitchlock thread Tr40x14P7-7e --length 60 --starts-by depth --infeed alternate -o screw.ngc
  pitchlock run bolt.ngc                                 its gauge judges what was cut
  pitchlock thread M20x2-6g --limits                     what the standard asks of a screw
  pitchlock thread M20 --limits                          coarse pitch, 6g/6H: screw and nut
  pitchlock thread 1/4-20 UNC-2A/2B --limits --json      as one JSON document

Names, with d for external and D for internal threads in the answer:
  M20, M20x2, M20x2-6g/6H, MJ6x1-4h6h/4H5H, Tr40x7-7e/7H, Tr40x14P7-8e, 1/4-20 UNC-2A, #10-32 UNF-3A/3B, 1 1/8-8 UNR,
  1/4-28 UNJF-3A, 2-4 BUTT-2A, 1/2-10 ACME-2G, 1/2-14 NPT, G1/2-A, R1/2, BSW 3/16-24, Rd105 x 1/4, module worm m3 z1=2 d44;
  behind any of them LH, external or internal; quote what a shell would take for its own, as in '#10-32 UNF'

Tools, for --tool: an insert as in 16ER2.0ISO, 16IR14UN, 16ERAG60, 22ERTR6; a shape as in 'A60 R0.1' or 'A30 W1.9' (angle
between the flanks, nose, flat, mm); sharp. Without it the tool of that number in the machine file, if it has an
angle_deg there; else a sharp one. The tool that cuts must have this shape: the depth is that of its tip.

How depth, passes and speed are found, and what each standard sets: docs/recipe.md, docs/metrology.md.

Exit status: 0 done, 2 the name is not understood, the tool does not fit, or an argument is wrong.";

/// Dialects of what is written.
const DIALECTS: [Named<Dialect>; 2] = [
    (Dialect::Linuxcnc, "linuxcnc", "LinuxCNC, X words are diameters (G7)"),
    (Dialect::Fanuc, "fanuc", "FANUC lathe, G-code system A"),
];
const UNITS: [Named<Units>; 2] = [(Units::Mm, "mm", "G21"), (Units::Inch, "inch", "G20")];
const SEQUENCES: [Named<Sequence>; 2] = [
    (Sequence::ByStart, "start", "every pass of one start, then the next start"),
    (Sequence::ByDepth, "depth", "every start at one depth, then the next depth"),
];
const LAWS: [Named<Law>; 4] = [
    (Law::Root, "root", "by the square root of the number of the pass, as threading cycles do"),
    (Law::EqualArea, "area", "equal area, the flat and the corners of the tip counted"),
    (Law::EqualDepth, "depth", "equal depth"),
    (Law::Table, "table", "as tables of tool makers have it"),
];
const MATERIALS: [Named<Material>; 7] = {
    let mut all = [(Material::Steel, "", ""); 7];
    let mut n = 0;
    while n < all.len() {
        let material = Material::ALL[n];
        all[n] = (material, material.name(), material.text());
        n += 1;
    }
    all
};
/// Infeeds by name; the modified one is so many degrees off the flank.
const INFEEDS: [Named<Infeed>; 4] = [
    (Infeed::Radial, "radial", "straight in"),
    (Infeed::Flank, "flank", "along the flank behind the tool"),
    (Infeed::Modified(OFF_DEG), "modified", "a degree off that flank, or as --off-flank says"),
    (Infeed::Alternating, "alternate", "along one flank and the other in turns"),
];
/// How far the modified infeed is off the flank, degrees.
const OFF_DEG: f64 = 1.0;

#[derive(Clone, Debug, Args)]
pub(crate) struct ThreadArgs {
    /// Name of the thread, as on a drawing; its words may stand apart.
    #[arg(required = true, num_args = 1.., value_name = "NAME")]
    name: Vec<String>,
    /// Print the limits of its diameters, and write no program.
    #[arg(long)]
    limits: bool,
    /// Print one JSON document, and nothing else.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    program: WriteArgs,
}

/// What is wished of the program.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "The program")]
pub(crate) struct WriteArgs {
    /// Write it there; without it the program is printed.
    #[arg(short, long, value_name = "FILE", conflicts_with = "limits")]
    output: Option<PathBuf>,
    /// Dialect.
    #[arg(long, value_parser = one_of(&DIALECTS), default_value = "linuxcnc")]
    dialect: Dialect,
    /// Unit of its lengths; without it that of the standard.
    #[arg(long, value_parser = one_of(&UNITS))]
    units: Option<Units>,
    /// The tool: an insert, a shape, or sharp.
    #[arg(long, value_name = "TOOL")]
    tool: Option<String>,
    /// Number of the tool.
    #[arg(long, value_name = "T", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=99))]
    tool_number: u32,
    /// Radius of its nose, mm, where that of the insert is known.
    #[arg(long, value_name = "MM")]
    nose: Option<f64>,
    /// Limits of the pitch diameter, mm, instead of those of the standard; needed where it sets none.
    #[arg(long, value_name = "LEAST..MOST", value_parser = limits_of)]
    pitch_diameter: Option<[f64; 2]>,
    /// Material.
    #[arg(long, value_parser = one_of(&MATERIALS), default_value = "steel")]
    material: Material,
    /// Length of full thread from the face at Z 0, mm; without it the length that usually engages.
    #[arg(long, value_name = "MM")]
    length: Option<f64>,
    /// How far before the face the tool starts, mm; without it four leads, 5 mm at least.
    #[arg(long, value_name = "MM")]
    start: Option<f64>,
    /// Spindle speed, 1/min; without it by material and diameter.
    #[arg(long, value_name = "RPM")]
    speed: Option<f64>,
    /// Number of passes, springs not counted; without it by pitch and depth.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=200))]
    passes: Option<u32>,
    /// As many passes as keep the cutting force below this, N.
    #[arg(long, value_name = "N", conflicts_with = "passes")]
    most_force: Option<f64>,
    /// As many passes as keep the power of the cut below this, kW.
    #[arg(long, value_name = "KW", conflicts_with = "passes")]
    most_power: Option<f64>,
    /// How often the full depth is cut again.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(0..=20))]
    springs: u32,
    /// No cut is shallower than this, mm of radius.
    #[arg(long, value_name = "MM", default_value_t = 0.025)]
    least_cut: f64,
    /// Where beside the groove the passes run; without it along a flank, straight in if the flanks differ.
    #[arg(long, value_parser = one_of(&INFEEDS))]
    infeed: Option<Infeed>,
    /// How far the modified infeed is off the flank, degrees.
    #[arg(long, value_name = "DEG", requires = "infeed")]
    off_flank: Option<f64>,
    /// How deep the passes go; without it root, of a flat tip area.
    #[arg(long, value_parser = one_of(&LAWS))]
    law: Option<Law>,
    /// Order of the starts of a thread.
    #[arg(long, value_parser = one_of(&SEQUENCES), default_value = "start")]
    starts_by: Sequence,
    /// The crest is there already: do not turn it.
    #[arg(long)]
    no_turn: bool,
    /// Every pass as a block of its own, even where a threading cycle says the same.
    #[arg(long)]
    written_out: bool,
    #[command(flatten)]
    machine: MachineArgs,
}

/// Reads `LEAST..MOST`.
fn limits_of(text: &str) -> Result<[f64; 2], String> {
    let wrong = || format!("{text:?} is not a range, as in 18.503..18.663");
    let (least, most) = text.split_once("..").ok_or_else(wrong)?;
    let number = |text: &str| text.trim().replace(',', ".").parse().map_err(|_| wrong());
    let [least, most]: [f64; 2] = [number(least)?, number(most)?];
    if 0.0 < least && least <= most && most.is_finite() { Ok([least, most]) } else { Err(wrong()) }
}

/// Prints what was asked of a thread.
pub(crate) fn thread(args: &ThreadArgs, quiet: bool) -> Result<ExitCode, CliError> {
    let name = args.name.join(" ");
    let thread: Thread = name.parse().map_err(|misread| refused(&name, &misread))?;
    if !args.limits {
        return write::command(&name, &thread, args, quiet);
    }
    let json = |error: serde_json::Error| CliError::Machine(error.to_string());
    screen::print(&if args.json {
        serde_json::to_string_pretty(&limits::document(&name, &thread)).map_err(json)? + "\n"
    } else {
        limits::text(&thread)
    });
    Ok(ExitCode::SUCCESS)
}

/// Where the name is wrong, and what is understood.
pub(crate) fn refused(name: &str, misread: &Misread) -> CliError {
    let Misread { span, message, help } = misread;
    let letters = |range: &str| range.chars().count();
    let before = letters(&name[..span.start]);
    let marks = "^".repeat(letters(&name[span.clone()]).max(1));
    let understood: String = UNDERSTOOD.lines().map(|line| format!("  {line}\n")).collect();
    CliError::Input(format!(
        "{message}\n\n  {name}\n  {:before$}{marks}\n\nhelp: {help}\n\nunderstood are\n{understood}",
        ""
    ))
}
