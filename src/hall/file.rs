//! The file that names the machines of a hall. In: TOML. Out: a hall, or what is wrong with it, its place and
//! the remedy.

use std::path::{Path, PathBuf};

use process::link::{Watch, shown};
use serde::Deserialize;

use super::Hall;
use crate::error::CliError;

/// Most machines of a hall.
const MOST: usize = 64;

/// The file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct HallFile {
    #[serde(default)]
    hall: Head,
    #[serde(default)]
    machine: Vec<Entry>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    name: Option<String>,
    key: Option<PathBuf>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    name: String,
    at: String,
    key: Option<PathBuf>,
}

/// Whether this is HOST:PORT.
fn is_address(text: &str) -> bool {
    let parts = text.rsplit_once(':');
    let is_port = |port: &str| {
        port.bytes().all(|digit| digit.is_ascii_digit()) && port.parse::<u16>().is_ok_and(|port| port > 0)
    };
    parts.is_some_and(|(host, port)| !host.is_empty() && is_port(port))
}

impl Hall {
    /// Reads one.
    pub(super) fn read(path: &Path) -> Result<Hall, CliError> {
        let wrong = |error: &dyn std::fmt::Display| CliError::file(path, error);
        let text = intake::text(path, intake::SETTINGS).map_err(|error| wrong(&error))?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let hall =
            Hall::of(&text, &name, path.parent().unwrap_or(Path::new(""))).map_err(|error| wrong(&error))?;
        let missing = (1..).zip(&hall.machines).find(|(_, (_, watch))| !watch.key.exists());
        missing.map_or(Ok(()), |(number, (name, watch))| {
            let help =
                "`pitchlock-link key FILE` makes one; here it is that which `pitchlock serve` has there";
            let key = watch.key.display();
            Err(wrong(&format!("machine {number}, {name:?}: there is no key {key}\nhelp: {help}")))
        })?;
        Ok(hall)
    }

    pub(super) fn of(text: &str, name: &str, folder: &Path) -> Result<Hall, String> {
        let file: HallFile = toml::from_str(text).map_err(|error| error.to_string())?;
        let HallFile { hall: Head { name: named, key }, machine: entries } = file;
        if entries.is_empty() || entries.len() > MOST {
            return Err(format!(
                "{} machines\nhelp: [[machine]] names one, 1 to {MOST} of them",
                entries.len()
            ));
        }
        let mut machines: Vec<(String, Watch)> = Vec::new();
        for (number, entry) in (1..).zip(entries) {
            let Entry { name, at, key: own } = entry;
            let place = format!("machine {number}, {name:?}");
            if name.trim().is_empty() || name.contains('\n') || shown(&name) != name {
                return Err(format!("{place}: name\nhelp: a name is a line of text"));
            }
            if let Some(before) = machines.iter().position(|(before, _)| *before == name) {
                return Err(format!(
                    "{place}: machine {} has this name\nhelp: give it another one",
                    before + 1
                ));
            }
            if !is_address(&at) {
                return Err(format!("{place}: at = {at:?}\nhelp: HOST:PORT, as in \"10.0.0.2:7447\""));
            }
            if let Some((before, _)) = machines.iter().find(|(_, watch)| watch.at == at) {
                return Err(format!(
                    "{place}: at = {at:?} is that of {before:?}\nhelp: each machine has an address of its own"
                ));
            }
            let Some(key) = own.or_else(|| key.clone()) else {
                return Err(format!(
                    "{place}: no key\nhelp: key = \"FILE\" here, or for all machines in [hall]"
                ));
            };
            machines.push((name, Watch { at, key: folder.join(key) }));
        }
        Ok(Hall { name: named.unwrap_or_else(|| name.to_owned()), machines })
    }
}
