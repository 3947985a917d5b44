//! LinuxCNC's description of a machine (`.ini`) as it lies in its folder. In: the file, and the machine whose
//! mechanics it has not. Out: the text of a machine file with its travel and speeds, files for programs that
//! it names, and in words what was taken and what was not.
//!
//! | taken | from |
//! |---|---|
//! | lathe or mill, if no machine file says so | `[DISPLAY]LATHE`, `[KINS]KINEMATICS`, `[TRAJ]COORDINATES` |
//! | travel, home | `MIN_LIMIT`, `MAX_LIMIT` of `[AXIS_X]` or `[JOINT_0]`, `HOME` of `[JOINT_0]` |
//! | speed, acceleration | `MAX_VELOCITY`, `MAX_ACCELERATION`, unless they are beyond what the machine file has: its drives are the ones that move |
//! | files for programs | `[RS274NGC]`, `[EMCIO]TOOL_TABLE`, `[DISPLAY]PROGRAM_PREFIX` |

use std::{fmt::Write as _, io, path::Path};

use gcode::canon::Units;
use gcode::files::MachineFile;
use machine::{AxisConfig, Kinematics, Machine};
use process::shell::LanguageArgs;
use protocol::Axis;
use toml_edit::{DocumentMut, Item, TableLike, value};

use crate::{
    args::{MachineArgs, machine_of},
    error::CliError,
    screen,
};

/// Millimetres in an inch.
const INCH: f64 = 25.4;

/// Reads a description: the machine with the text of its file. What it names for programs goes into
/// `language`, where nothing else was asked for.
pub(crate) fn read(
    path: &Path,
    base: &MachineArgs,
    language: &mut LanguageArgs,
    notes: &mut String,
) -> Result<(Machine, String), CliError> {
    let ini = MachineFile::read(path).map_err(|error| CliError::Input(error.to_string()))?;
    for warning in &ini.warnings {
        *notes += &warning.render(screen::colour(&io::stderr()));
        notes.push('\n');
    }
    let name = path.display();
    let text = match &base.machine {
        Some(_) => base.read()?.1,
        None => kinematics(&ini).example().to_owned(),
    };
    let machine = machine_of(&base.name(), &text)?;
    let (mut took, mut left) = (Vec::new(), Vec::new());
    let text = limited(&text, &machine, &ini, &mut took, &mut left)
        .map_err(|error| CliError::Input(format!("{name}: {error}")))?;
    let machine = machine_of(&format!("{name}, with what it has not from {}", base.name()), &text)?;
    files(&ini, language, &mut took, &mut left);
    for (what, list) in [("took", &took), ("left", &left)] {
        list.iter().for_each(|line| *notes += &format!("{name}: {what} {line}\n"));
    }
    let _ = writeln!(notes, "{name}: spindle, drives, jerk and cycles are those of {}", base.name());
    Ok((machine, text))
}

/// What kind of machine it describes.
fn kinematics(ini: &MachineFile) -> Kinematics {
    let lathe = ini.entry("DISPLAY", "LATHE").is_some_and(|value| value != "0");
    if lathe || !coordinates(ini).contains('Y') { Kinematics::Lathe } else { Kinematics::Mill }
}

/// Letters of the axes in the order of their joints.
fn coordinates(ini: &MachineFile) -> String {
    let kinematics = ini.entry("KINS", "KINEMATICS").unwrap_or_default();
    let named = kinematics.split_whitespace().find_map(|word| word.strip_prefix("coordinates="));
    let letters = named.or_else(|| ini.entry("TRAJ", "COORDINATES")).unwrap_or("XYZ");
    letters.to_ascii_uppercase().split_whitespace().collect()
}

/// The text of a machine file with the travel and the speeds of a description.
fn limited(
    text: &str,
    machine: &Machine,
    ini: &MachineFile,
    took: &mut Vec<String>,
    left: &mut Vec<String>,
) -> Result<String, String> {
    let mut document: DocumentMut = text.parse().map_err(|error| format!("{error}"))?;
    let coordinates = coordinates(ini);
    for letter in coordinates.chars() {
        let found = machine.axes().find(|(axis, _)| axis.name().eq_ignore_ascii_case(&letter.to_string()));
        let Some((axis, config)) = found else {
            left.push(format!("axis {letter}, which the machine file has not"));
            continue;
        };
        let section = document.get_mut("axis").and_then(|axes| axes.get_mut(axis.name()));
        let section = section.and_then(Item::as_table_like_mut);
        let section = section.ok_or_else(|| format!("[axis.{}] is missing", axis.name()))?;
        let limits = Limits::of(ini, axis, coordinates.find(letter).unwrap_or(0))?;
        limits.write(axis, config, section, took, left);
    }
    for (axis, _) in machine.axes().filter(|(axis, _)| !coordinates.contains(&axis.name().to_uppercase())) {
        left.push(format!("axis {} of the machine file as it is: the description has none", axis.name()));
    }
    Ok(document.to_string())
}

/// What a description says of an axis, mm or degrees.
#[derive(Debug, Default)]
struct Limits {
    travel: [Option<f64>; 2],
    home: Option<f64>,
    velocity: Option<f64>,
    acceleration: Option<f64>,
}

impl Limits {
    fn of(ini: &MachineFile, axis: Axis, joint: usize) -> Result<Limits, String> {
        let letter = axis.name().to_uppercase();
        let [of_axis, of_joint, old] =
            [format!("AXIS_{letter}"), format!("JOINT_{joint}"), format!("AXIS_{joint}")];
        let inch = ini.units == Some(Units::Inch) && !axis.is_rotary();
        let number = |sections: &[&String], key: &str| {
            let found = sections.iter().find_map(|section| Some((section, ini.entry(section, key)?)));
            let Some((section, text)) = found else { return Ok(None) };
            match text.parse::<f64>() {
                Ok(number) if number.is_finite() => Ok(Some(if inch { number * INCH } else { number })),
                _ => Err(format!("[{section}]{key}: `{text}` is not a number")),
            }
        };
        let (axis, joint) = ([&of_axis, &of_joint, &old], [&of_joint, &old]);
        Ok(Limits {
            travel: [number(&axis, "MIN_LIMIT")?, number(&axis, "MAX_LIMIT")?],
            home: number(&joint, "HOME")?,
            velocity: number(&axis, "MAX_VELOCITY")?,
            acceleration: number(&axis, "MAX_ACCELERATION")?,
        })
    }

    /// Writes what is possible into the section of an axis.
    fn write(
        &self,
        axis: Axis,
        config: &AxisConfig,
        section: &mut dyn TableLike,
        took: &mut Vec<String>,
        left: &mut Vec<String>,
    ) {
        let (name, unit) = (axis.name().to_uppercase(), axis.unit());
        let key = |name: &str| if axis.is_rotary() { name.replace("mm", "deg") } else { name.into() };
        let [low, high] = [0, 1].map(|end| self.travel[end].unwrap_or(config.travel_mm[end]));
        if self.travel.iter().any(Option::is_some) {
            section.insert(&key("travel_mm"), value([low, high].into_iter().collect::<toml_edit::Array>()));
            took.push(format!("travel of {name}: {low} to {high} {unit}"));
        }
        let asked = self.home.unwrap_or(config.home_mm);
        let home = if low <= high { asked.clamp(low, high) } else { asked };
        if home != config.home_mm {
            section.insert(&key("home_mm"), value(home));
            took.push(format!("home of {name}: {home} {unit}"));
        }
        if self.home.is_some_and(|asked| asked != home) {
            left.push(format!("home of {name} at {asked} {unit}, which is beyond its travel"));
        }
        for (word, asked, has, key, unit) in [
            ("speed", self.velocity, config.velocity_mm_s, key("velocity_mm_s"), format!("{unit}/s")),
            (
                "acceleration",
                self.acceleration,
                config.acceleration_mm_s2,
                key("acceleration_mm_s2"),
                format!("{unit}/s²"),
            ),
        ] {
            match asked {
                Some(asked) if asked > 0.0 && asked <= has => {
                    section.insert(&key, value(asked));
                    took.push(format!("{word} of {name}: {asked} {unit}"));
                }
                Some(asked) => {
                    left.push(format!(
                        "{word} of {name}, {asked} {unit}: the drive of the machine file makes {has}"
                    ));
                }
                None => {}
            }
        }
    }
}

/// Files and codes that a description names for programs.
fn files(ini: &MachineFile, language: &mut LanguageArgs, took: &mut Vec<String>, left: &mut Vec<String>) {
    let mut file =
        |what: &str, named: &Option<std::path::PathBuf>, asked: &mut Option<std::path::PathBuf>| {
            let Some(named) = named else { return };
            match asked {
                Some(asked) => {
                    left.push(format!("{what} {}: {} was asked for", named.display(), asked.display()))
                }
                None => {
                    took.push(format!("{what} {}", named.display()));
                    *asked = Some(named.clone());
                }
            }
        };
    file("parameters, to read them:", &ini.parameter_file, &mut language.parameters);
    file("tool table, to read it:", &ini.tool_table, &mut language.tools);
    for folder in &ini.subroutine_folders {
        if folder.is_dir() {
            took.push(format!("subroutines of {}", folder.display()));
            language.subroutines.push(folder.clone());
        } else {
            left.push(format!("subroutines of {}: there is no such folder", folder.display()));
        }
    }
    if let Some(startup) = &ini.startup {
        took.push(format!("startup code {startup}"));
    }
}
