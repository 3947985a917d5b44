//! `pitchlock check`: programs are read to their end, nothing moves.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    path::{Path, PathBuf},
    process::ExitCode,
};

use clap::Args;
use gauge::Nominal;
use interpreter::{BluntNote, CornerNote, Language, PassNote, Severity};
use machine::Machine;
use process::shell::LanguageArgs;
use protocol::Axis;

use crate::{
    args::{MachineArgs, seed},
    certificate::{self, Certificate},
    diagnostics::Document,
    error::CliError,
    gauged::{self, GaugeArgs},
    program::Program,
    references, screen, varied,
    words::{self, counted},
    written::{self, Made},
};

/// What stands for standard input.
const PIPE: &str = "-";

#[derive(Clone, Debug, Args)]
pub(crate) struct CheckArgs {
    /// Part programs (G-code), jobs (`.toml`) or machine code (`.mc`); `-`: G-code from standard input.
    #[arg(value_name = "FILE", required = true)]
    pub(crate) programs: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) language: LanguageArgs,
    #[command(flatten)]
    pub(crate) machine: MachineArgs,
    #[command(flatten)]
    pub(crate) gauge: GaugeArgs,
    #[command(flatten)]
    pub(crate) certify: CertifyArgs,
    /// Print one JSON document, for editors, and nothing else; of several programs an array of them.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What threads will be, before they are cut.
#[derive(Clone, Debug, Args)]
pub(crate) struct CertifyArgs {
    /// Cut the threads once on the simulated machine and tell what each pass takes and is off by.
    #[arg(long)]
    certify: bool,
    /// Write that as a page (HTML) as well; of one program.
    #[arg(long, value_name = "FILE", requires = "certify")]
    page: Option<PathBuf>,
    /// Of everything random about the simulated machine.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = seed, requires = "certify")]
    seed: u64,
}

/// Reports every diagnostic, every pass, and the time each program takes.
pub(crate) fn check(args: &CheckArgs, quiet: bool) -> Result<ExitCode, CliError> {
    args.can_be()?;
    let judged: Vec<_> = match judges(args, quiet) {
        Ok((machine, language, gauge)) => {
            let judge = |path: &PathBuf| {
                let program = judge(path, &language, &machine, gauge.clone())?;
                let certificate = args.certify.certificate(&program, path, &language, &machine)?;
                Ok((program, certificate))
            };
            args.programs.iter().map(judge).collect()
        }
        // JSON tells that of the programs, and it is the same of all.
        Err(error) if args.json => vec![Err(error)],
        Err(error) => return Err(error),
    };
    if args.json {
        let judged: Vec<_> = args.programs.iter().zip(&judged).collect();
        let documents: Vec<_> = judged.iter().map(|(path, one)| Document::of(path, one)).collect();
        let text = match &documents[..] {
            [one] => serde_json::to_string_pretty(one),
            all => serde_json::to_string_pretty(all),
        };
        let text = text.map_err(|error| CliError::Machine(error.to_string()))?;
        screen::print(&format!("{text}\n"));
    } else {
        tell(args, &judged, quiet);
    }
    if let (Some(page), [Ok((_, Some(certificate)))]) = (&args.certify.page, &judged[..]) {
        args.write(page, certificate)?;
    }
    Ok(ExitCode::from(judged.iter().map(status).max().unwrap_or(0)))
}

/// A program, and what its threads will be if somebody asked for that.
type Judged = Result<(Program, Option<Certificate>), CliError>;

/// 0 good; 3 the part would not be; 2 the program is not; 1 the computer failed.
fn status(one: &Judged) -> u8 {
    match one {
        Ok((program, _)) if program.found(Severity::Error) > 0 => 2,
        Ok((_, Some(certificate))) if !certificate.is_good() => 3,
        Ok(_) => 0,
        Err(CliError::Input(_)) => 2,
        Err(CliError::Machine(_)) => 1,
    }
}

impl CertifyArgs {
    /// The certificate of a program, if it is asked for, and there is one to be had.
    fn certificate(
        &self,
        program: &Program,
        path: &Path,
        language: &Language,
        machine: &Machine,
    ) -> Result<Option<Certificate>, CliError> {
        if !self.certify || program.found(Severity::Error) > 0 {
            return Ok(None);
        }
        certificate::certify(program, path, language, machine, self.seed)
    }
}

impl CheckArgs {
    /// Whether what is asked for goes together.
    fn can_be(&self) -> Result<(), CliError> {
        let refused = |text: &str| Err(CliError::Input(text.into()));
        if self.certify.page.is_some() && self.programs.len() > 1 {
            return refused("--page is for one program: name one, or leave --page out");
        }
        if self.certify.certify && self.programs.iter().any(|path| path == Path::new(PIPE)) {
            return refused("--certify reads a program twice, and standard input is read once: name a file");
        }
        Ok(())
    }

    /// Writes the page.
    fn write(&self, page: &Path, certificate: &Certificate) -> Result<(), CliError> {
        let program = self.programs.first().map_or_else(String::new, |path| path.display().to_string());
        let machine = self.machine.machine.as_ref();
        let machine = machine.map_or_else(String::new, |path| format!(" --machine {}", path.display()));
        let again = format!("pitchlock check {program}{machine} --certify --seed {}", self.certify.seed);
        written::write(page, Made::Page, certificate::html(certificate, &program, &again))
    }
}

/// What all programs are judged with.
fn judges(args: &CheckArgs, quiet: bool) -> Result<(Machine, Language, Option<Nominal>), CliError> {
    let shop = args.machine.with_language(&args.language)?;
    words::say(if args.json || quiet { "" } else { &shop.notes });
    Ok((shop.machine, shop.language.language(), args.gauge.read()?))
}

fn judge(
    path: &Path,
    language: &Language,
    machine: &Machine,
    gauge: Option<Nominal>,
) -> Result<Program, CliError> {
    let text = if path == Path::new(PIPE) {
        let read = intake::all(std::io::stdin().lock(), intake::SHOWN);
        Some(read.map_err(|error| CliError::file(path, error))?)
    } else {
        None
    };
    Program::judge(path, text, language, machine, gauge)
}

/// What people see: each program under its name if there are several, and how many are good.
fn tell(args: &CheckArgs, judged: &[Judged], quiet: bool) {
    let several = args.programs.len() > 1;
    for (path, one) in args.programs.iter().zip(judged) {
        match one {
            Ok((program, certificate)) => {
                words::say(&program.messages);
                let head = if several { format!("{}: ", path.display()) } else { String::new() };
                if !quiet {
                    words::flush(false);
                    let certified = certificate.as_ref().map(Certificate::text).unwrap_or_default();
                    let none = args.certify.certify && certified.is_empty();
                    let none = if none { "certificate: none, there is no thread to cut\n" } else { "" };
                    screen::print(&(head + &findings(program) + &certified + none));
                }
            }
            Err(error) => {
                error.report();
            }
        }
    }
    if several && !quiet {
        let good = judged.iter().filter(|one| status(one) == 0).count();
        words::flush(false);
        screen::print(&format!(
            "{} of {} are good\n",
            good,
            counted(judged.len() as u64, "program", "programs")
        ));
    }
}

/// The taps of a program: where they go, where the spindle brakes, how fast it may turn at most.
fn taps(text: &mut String, passes: &[PassNote]) {
    let taps = passes.iter().filter_map(|pass| Some((pass, pass.tap?)));
    for (at, (pass, tap)) in taps.enumerate() {
        if at == 0 {
            let _ = writeln!(
                text,
                "tap   line    start Z  on the helix from Z  depth Z  brakes before mm  highest 1/min  out times  takes s"
            );
        }
        let [from, to] = pass.full_depth_mm;
        let _ = writeln!(
            text,
            "{:>3}  {:>5}  {:>9.4}  {:>19.4}  {:>7.3}  {:>16.3}  {:>13.0}  {:>9.2}  {:>7.2}",
            pass.pass,
            pass.line,
            pass.start_mm,
            from,
            to,
            tap.brakes_mm,
            tap.top_rpm,
            tap.return_ratio,
            tap.seconds
        );
    }
}

/// How the corners of chains are rounded: each by the pass in which that shows most.
fn corners(passes: &[PassNote]) -> String {
    let mut worst: BTreeMap<u32, CornerNote> = BTreeMap::new();
    for corner in passes.iter().flat_map(|pass| &pass.corners) {
        let known = worst.entry(corner.line).or_insert(*corner);
        if corner.off_mm > known.off_mm {
            *known = *corner;
        }
    }
    let mut text = String::new();
    for CornerNote { line, at_mm: [x, z], window_deg, off_mm } in worst.values() {
        let _ = writeln!(
            text,
            "corner    line {line}: at X{x:.3} Z{z:.3} the lead changes over {window_deg:.1} degrees, at most \
             {off_mm:.4} mm from the programmed corner"
        );
    }
    text
}

/// What the passes of blunt starts leave, a line for each block.
fn blunt_starts(passes: &[PassNote]) -> String {
    let blunt = passes.iter().filter_map(|pass| Some((pass.line, pass.blunt?)));
    let mut lines: BTreeMap<u32, (BluntNote, u64)> = BTreeMap::new();
    blunt.for_each(|(line, note)| lines.entry(line).or_insert((note, 0)).1 += 1);
    let mut text = String::new();
    for (line, (BluntNote { turns, over_deg, whole_from_mm }, passes)) in lines {
        let _ = writeln!(
            text,
            "blunt     line {line}: {} take the ridge away up to {turns} turns behind the face; then it rises over \
             {over_deg:.1} degrees, and is whole from Z{whole_from_mm:.3} on",
            counted(passes, "pass", "passes")
        );
    }
    text
}

fn findings(program: &Program) -> String {
    let mut text = String::new();
    let moves = program.moves;
    let (errors, warnings) = (program.found(Severity::Error), program.found(Severity::Warning));
    let (errors_found, warnings_found) =
        (counted(errors as u64, "error", "errors"), counted(warnings as u64, "warning", "warnings"));
    let _ = writeln!(text, "{errors_found}, {warnings_found}, {}", counted(moves, "move", "moves"));
    let first = "the program begins with its run, whose time is not foretold";
    text += &references::told(&program.references, first);
    for job in program.check.iter().flat_map(|check| &check.jobs) {
        let _ = writeln!(text, "job       line {}", job.line);
        for (what, value) in &job.facts {
            let _ = writeln!(text, "  {what:<9} {value}");
        }
    }
    let passes = program.check.as_ref().map_or(&[][..], |check| &check.passes);
    let mut headed = None;
    for pass in passes.iter().filter(|pass| pass.tap.is_none()) {
        let [from, to] = pass.full_depth_mm;
        if headed.replace(pass.along) != Some(pass.along) {
            let axis = pass.along;
            let _ = writeln!(
                text,
                "pass  line  depth mm    start {axis}  full depth from {axis}     to {axis}  chip mm  highest %"
            );
        }
        // Where the program does not say where the crest is, the radius of the part that the pass goes to, or
        // the place of a thread on a face, is all that is known.
        let [x, z] = pass.origin_mm;
        let (of, origin_mm) = if pass.along == Axis::Z { ("R", x) } else { ("Z", z) };
        let depth = || format!("{of}{:.3}", pass.across_mm - origin_mm);
        let depth = pass.depth_mm.map_or_else(depth, |depth| format!("{depth:.4}"));
        let chip = program.chips_mm.get(&pass.pass).map_or("–".into(), |chip| format!("{chip:.3}"));
        let _ = writeln!(
            text,
            "{:>4}  {:>4}  {:>8}  {:>9.4}  {:>17.4}  {:>7.3}  {chip:>7}  {:>9.0}",
            pass.pass, pass.line, depth, pass.start_mm, from, to, pass.max_override_pct
        );
    }
    taps(&mut text, passes);
    text += &corners(passes);
    text += &blunt_starts(passes);
    if !passes.is_empty() {
        let axes = match passes.iter().any(|pass| pass.along == Axis::X) {
            true => "X (a radius) and Z are those",
            false => "Z is that",
        };
        let _ = writeln!(text, "{axes} of the machine: coordinate system and tool offset are added");
    }
    for line in varied::lines(passes) {
        let _ = writeln!(text, "{line}");
    }
    if let Some(drawn) = program.check.as_ref().and_then(|check| check.groove.as_ref()) {
        let [low, high] = drawn.ends_mm();
        let (along, times) = if drawn.on_face() { ("diameters", 2.0) } else { ("Z", 1.0) };
        let [low, high, within] = [times * low, times * high, drawn.within_mm];
        let _ = writeln!(
            text,
            "groove from {along} {low:.3} to {high:.3}: along its axis and in depth within {within} mm"
        );
    }
    for thread in &program.gauges {
        let _ = writeln!(text, "gauge {}", gauged::told(&thread.nominal));
    }
    if errors == 0 {
        let _ = writeln!(text, "about {:.1} s on the machine at 100 % override", program.time_s);
    }
    text
}
