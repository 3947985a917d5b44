//! `pitchlock thread NAME`: a part program that cuts it. In: the name, what is wished, the machine. Out: the
//! program, checked by the interpreter for that machine, and what it is made of.
//!
//! What only the machine knows is found by asking it: a speed that its axes cannot follow is lowered until
//! they can, and the programmed end goes as far behind the full thread as the way out takes.

use std::{fmt::Write as _, process::ExitCode};

use gauge::NominalError;
use interpreter::{Check, Interpreter, Language, Severity};
use machine::{Machine, ProgramDialect};
use metrology::Thread;
use recipe::{Dialect, Infeed, Order, Recipe, Refused, Tool, Units};
use serde_json::json;

use super::{ThreadArgs, WriteArgs, refused};
use crate::{error::CliError, screen, words, written};

/// How often speed and end are tried.
const MOST_TRIES: u32 = 200;
/// What an infeasible speed is lowered to.
const SLOWER: f64 = 0.95;
/// Threads with less between their flanks are cut with a flat tip, degrees.
const LEAST_SHARP_DEG: f64 = 50.0;
/// A share of the speed that was meant below which a longer way before the face helps more.
const SLOWEST: f64 = 0.1;
/// The diagnostic that a lower speed helps against.
const TOO_FAST: &str = "pass-not-feasible";

/// A recipe that a machine can cut.
struct Fitted {
    recipe: Recipe,
    check: Check,
    program: String,
    /// The speed that was meant, if the axes cannot follow it, 1/min.
    meant_rpm: Option<f64>,
}

/// Writes the program.
pub(super) fn command(
    name: &str,
    thread: &Thread,
    args: &ThreadArgs,
    quiet: bool,
) -> Result<ExitCode, CliError> {
    let asked = &args.program;
    if let Some(path) = &asked.output {
        written::new_or(path, None)?;
    }
    let (machine, _) = asked.machine.read()?;
    let order = order(asked, thread, &machine)?;
    let recipe = Recipe::of(thread, &order).map_err(|error| without_recipe(&error, thread))?;
    let units = asked.units.unwrap_or(match thread.limits().unit {
        metrology::Unit::Mm => Units::Mm,
        metrology::Unit::Inch => Units::Inch,
    });
    let fitted = fitted(recipe, asked.dialect, units, &machine)?;
    if let Some(path) = &asked.output {
        written::put(path, &fitted.program)?;
    }
    let told = told(&fitted, asked, &machine);
    if args.json {
        let document = document(name, &fitted, asked);
        let text = serde_json::to_string_pretty(&document);
        screen::print(&(text.map_err(|error| CliError::Machine(error.to_string()))? + "\n"));
    } else {
        words::say(if quiet { "" } else { &told });
        words::flush(false);
        if asked.output.is_none() {
            screen::print(&fitted.program);
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Why there is no recipe, and which argument helps.
fn without_recipe(error: &Refused, thread: &Thread) -> CliError {
    let profile = thread.profile();
    CliError::Input(match error {
        Refused::Thread(NominalError::NoLimits) => format!(
            "{}: no limits of the pitch diameter are known for this standard\nhelp: give yours by --pitch-diameter \
             LEAST..MOST, mm: the basic one is {:.3}",
            thread, profile.pitch_diameter_mm
        ),
        _ => error.to_string(),
    })
}

/// The wishes.
fn order(asked: &WriteArgs, thread: &Thread, machine: &Machine) -> Result<Order, CliError> {
    if machine.spindle.is_none() {
        return Err(CliError::Input(format!("{}: a thread needs a spindle", asked.machine.name())));
    }
    let own = machine.tool(asked.tool_number).and_then(|tool| Some((tool, tool.angle_deg?)));
    let tool = match (&asked.tool, own) {
        (Some(name), _) => name.parse().map_err(|misread| refused(name, &misread))?,
        (None, Some((tool, angle_deg))) => {
            let [width, nose] = [tool.width_mm, tool.nose_mm].map(Option::unwrap_or_default);
            Tool::measured(tool.name.clone(), angle_deg, width, nose)
        }
        (None, None) if thread.profile().flank_deg.iter().sum::<f64>() < LEAST_SHARP_DEG => {
            let text = format!(
                "{thread}: a sharp tool would go very deep\nhelp: name the insert, as in --tool {}, or its shape, as in \
                 --tool 'A30 W1.9'; or --tool sharp",
                an_insert(thread)
            );
            return Err(CliError::Input(text));
        }
        (None, None) => Tool::sharp(),
    };
    let nose = asked.nose.filter(|nose| !(0.0..=10.0).contains(nose));
    if let Some(nose) = nose {
        return Err(CliError::Input(format!("--nose {nose}: a nose has 0 to 10 mm")));
    }
    let infeed = match (asked.infeed, asked.off_flank) {
        (Some(Infeed::Modified(_)), Some(off_deg)) => Some(Infeed::Modified(off_deg)),
        (Some(_), Some(_)) => return Err(CliError::Input("--off-flank goes with --infeed modified".into())),
        (infeed, _) => infeed,
    };
    Ok(Order {
        tool: asked.nose.into_iter().fold(tool, Tool::with_nose_mm),
        tool_number: asked.tool_number,
        pitch_diameter_mm: asked.pitch_diameter,
        material: asked.material,
        length_mm: asked.length,
        start_mm: asked.start,
        s_rpm: asked.speed,
        most_rpm: machine.spindle.max_rpm,
        infeed,
        law: asked.law,
        passes: asked.passes,
        most_force_n: asked.most_force,
        most_power_kw: asked.most_power,
        springs: asked.springs,
        least_mm: asked.least_cut,
        sequence: asked.starts_by,
        turn: !asked.no_turn,
        written_out: asked.written_out,
    })
}

/// The designation of an insert that would do, or nearly.
fn an_insert(thread: &Thread) -> String {
    let profile = thread.profile();
    let side = if thread.side() == Some(gauge::Side::Internal) { 'I' } else { 'E' };
    let hand = if profile.left_hand { 'L' } else { 'R' };
    match thread.to_string() {
        name if name.contains("ACME") => format!("16{side}{hand}{:.0}ACME", 25.4 / profile.pitch_mm),
        name if name.starts_with("module") => {
            format!("27{side}{hand}MOD{}", profile.pitch_mm / std::f64::consts::PI)
        }
        _ => format!("22{side}{hand}TR{}", profile.pitch_mm),
    }
}

/// The recipe as the machine can cut it.
fn fitted(mut recipe: Recipe, dialect: Dialect, units: Units, machine: &Machine) -> Result<Fitted, CliError> {
    let language = Language {
        dialect: Some(match dialect {
            Dialect::Linuxcnc => ProgramDialect::Linuxcnc,
            Dialect::Fanuc => ProgramDialect::Fanuc,
        }),
        ..Language::default()
    };
    let meant_rpm = recipe.s_rpm;
    for _ in 0..MOST_TRIES {
        let program = recipe::program(&recipe, dialect, units);
        let check = checked(&program, &language, machine)?;
        let error = check.diagnostics.iter().find(|found| found.severity == Severity::Error);
        match error {
            Some(error) if error.code == TOO_FAST && recipe.s_rpm > 1.0 => {
                let slower = SLOWER * recipe.s_rpm;
                recipe = recipe.at_rpm(slower);
            }
            Some(error) => {
                let text = format!("this machine cannot cut it:\n{}", error.render(false));
                return Err(CliError::Input(text));
            }
            // The run-in takes more than the way before the face.
            None if check.passes.iter().any(|pass| pass.full_depth_mm[0] < 0.0) => {
                let slower = SLOWER * recipe.s_rpm;
                if slower < SLOWEST * meant_rpm {
                    let start = recipe.start_mm;
                    let text = format!(
                        "the run-in takes more than the {start} mm before the face\nhelp: start farther off, by --start"
                    );
                    return Err(CliError::Input(text));
                }
                recipe = recipe.at_rpm(slower);
            }
            None => {
                let full = check.passes.iter().map(|pass| pass.full_depth_mm[1]).fold(f64::MIN, f64::max);
                // The gauge needs what was asked for in all passes.
                let short = full + recipe.length_mm;
                if short <= 1e-6 {
                    let meant_rpm = (recipe.s_rpm < meant_rpm).then_some(meant_rpm);
                    return Ok(Fitted { recipe, check, program, meant_rpm });
                }
                let end = recipe.end_mm - short - 0.05;
                recipe = recipe.to_end_mm(end);
            }
        }
    }
    Err(CliError::Input(format!("no speed was found at which {} can be cut", recipe.thread)))
}

fn checked(program: &str, language: &Language, machine: &Machine) -> Result<Check, CliError> {
    let opened = interpreter::open_text("thread", program.as_bytes().to_vec(), language, machine);
    let opened = opened.map_err(|error| CliError::Input(error.to_string()))?;
    Ok(interpreter::check_interpreter(Interpreter::new(opened, machine), machine, |_| ()))
}

/// The lines of a machine file for the tools: once it has one, it needs all that are called.
fn tool_lines(recipe: &Recipe, machine: &Machine) -> String {
    let edge = recipe.edge;
    let angle: f64 = edge.flank_deg.iter().sum();
    let (turning, name) = recipe.turning_tool();
    let mut lines = String::new();
    if recipe.turn && machine.tool(turning).is_none() {
        let _ = write!(lines, "[tools.{turning}]\nname = \"{name}\"\n\n");
    }
    let (number, name) = (recipe.tool_number, &recipe.tool.name);
    let _ = write!(lines, "[tools.{number}]\nname = {name:?}\nangle_deg = {angle}\n");
    if edge.nose_mm > 0.0 {
        let _ = writeln!(lines, "nose_mm = {:.4}", edge.nose_mm);
    }
    if recipe.width_mm > 0.0 {
        let _ = writeln!(lines, "width_mm = {:.4}", recipe.width_mm);
    }
    lines
}

/// Whether the machine file has the tool as the recipe takes it to be.
fn is_known(recipe: &Recipe, machine: &Machine) -> bool {
    let edge = recipe.edge;
    let Some(tool) = machine.tool(recipe.tool_number).filter(|tool| tool.angle_deg.is_some()) else {
        return edge.nose_mm == 0.0 && recipe.width_mm == 0.0;
    };
    let [width, nose] = [tool.width_mm, tool.nose_mm].map(Option::unwrap_or_default);
    let same = |a: f64, b: f64| (a - b).abs() < 1e-3;
    let angle: f64 = edge.flank_deg.iter().sum();
    same(tool.angle_deg.unwrap_or(angle), angle) && same(width, recipe.width_mm) && same(nose, edge.nose_mm)
}

/// What people are told.
fn told(fitted: &Fitted, asked: &WriteArgs, machine: &Machine) -> String {
    let Fitted { recipe, check, meant_rpm, .. } = fitted;
    let crest = if recipe.side() == gauge::Side::External { "outside" } else { "bore" };
    let mut text = format!(
        "{}, {}, in {}\n{crest:<9} {:.3} mm, tip of the tool at {:.3}, so {:.3} deep\n",
        recipe.thread,
        recipe.tool,
        recipe.material.text(),
        recipe.crest_mm,
        recipe.root_mm,
        recipe.depth_mm
    );
    let [least, most] = recipe.material.speeds_m_min();
    let _ = writeln!(
        text,
        "speed     {} 1/min, {:.0} m/min (makers say {least:.0} to {most:.0})",
        recipe.s_rpm,
        recipe.speed_m_min()
    );
    let most = machine.spindle.max_rpm;
    if asked.speed.is_none() && meant_rpm.is_none() && recipe.s_rpm >= most {
        let _ = writeln!(
            text,
            "          the spindle of this machine does no more ({most} 1/min, spindle.max_rpm)"
        );
    }
    if let Some(meant) = meant_rpm {
        let _ = writeln!(
            text,
            "          the axes follow no more in {} mm before the face; {meant} 1/min was meant",
            recipe.start_mm
        );
    }
    let starts =
        if recipe.starts() == 1 { String::new() } else { format!(" in each of {} starts", recipe.starts()) };
    let _ = writeln!(
        text,
        "infeed    {}, {} and {}{starts}",
        recipe.infeed.text(),
        words::counted(recipe.passes.len() as u64, "pass", "passes"),
        words::counted(recipe.springs.into(), "spring", "springs")
    );
    let _ = writeln!(
        text,
        "length    {} mm of full thread; Z goes to {}, so {:.1} mm behind it must be free",
        recipe.length_mm,
        recipe.end_mm,
        -recipe.end_mm - recipe.length_mm
    );
    text += &passes_told(recipe);
    let _ =
        writeln!(text, "\npower     {:.2} kW at most\ntime      {:.0} s", recipe.power_kw(), check.time_s);
    if !is_known(recipe, machine) {
        let lines = tool_lines(recipe, machine);
        let _ = writeln!(
            text,
            "\nthe depth is that of this tool: write it into the machine file that you cut and run with\n\n{lines}"
        );
    }
    if let Some(path) = &asked.output {
        let _ = writeln!(text, "written   {}", path.display());
    }
    text
}

/// The table of the passes.
fn passes_told(recipe: &Recipe) -> String {
    let mut text = String::from("\n  pass   depth     cut    area   force  torque\n");
    let mut before = 0.0;
    for (n, pass) in recipe.passes.iter().enumerate() {
        let _ = writeln!(
            text,
            "  {:>4}{:>8.3}{:>8.3}{:>8.3}{:>8.0}{:>8.2}",
            n + 1,
            pass.depth_mm,
            pass.depth_mm - before,
            pass.area_mm2,
            pass.force_n,
            recipe.torque_nm(pass)
        );
        before = pass.depth_mm;
    }
    text + "        mm      mm     mm²       N     N·m\n"
}

/// The same for programs.
fn document(name: &str, fitted: &Fitted, asked: &WriteArgs) -> serde_json::Value {
    let Fitted { recipe, check, program, meant_rpm } = fitted;
    let pass = |pass: &recipe::Pass| json!({ "depth_mm": pass.depth_mm, "beside_mm": pass.beside_mm, "area_mm2": pass.area_mm2, "force_n": pass.force_n, "torque_nm": recipe.torque_nm(pass) });
    json!({
        "version": 1,
        "name": name,
        "complete": recipe.thread.to_string(),
        "standard": recipe.thread.standard(),
        "tool": {
            "name": recipe.tool.name, "number": recipe.tool_number, "flank_deg": recipe.edge.flank_deg,
            "nose_mm": recipe.edge.nose_mm, "width_mm": recipe.width_mm,
        },
        "material": recipe.material.name(),
        "crest_mm": recipe.crest_mm,
        "root_mm": recipe.root_mm,
        "depth_mm": recipe.depth_mm,
        "lead_mm": recipe.lead_mm,
        "starts": recipe.starts(),
        "s_rpm": recipe.s_rpm,
        "speed_m_min": recipe.speed_m_min(),
        "meant_rpm": meant_rpm,
        "start_mm": recipe.start_mm,
        "end_mm": recipe.end_mm,
        "length_mm": recipe.length_mm,
        "infeed": recipe.infeed.text(),
        "passes": recipe.passes.iter().map(pass).collect::<Vec<_>>(),
        "springs": recipe.springs,
        "power_kw": recipe.power_kw(),
        "time_s": check.time_s,
        "file": asked.output,
        "program": program,
    })
}
