//! `pitchlock hall`: many machines on several computers in one view, which only looks. In: a file that names
//! them. Out: a list that is drawn again and again, or one document.

use std::{
    fmt::Write as _,
    io::IsTerminal as _,
    path::{Path, PathBuf},
    process::ExitCode,
};

use clap::Args;
use process::{
    ipc::time::Moment,
    link::{Said, Watch, Watched},
};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::{
    error::CliError,
    run::{hosts, interrupts::Interrupts},
    screen,
};

pub(crate) const HELP: &str = "Examples:
  pitchlock hall hall.toml            a list of all machines, drawn again four times a second; Ctrl-C ends it
  pitchlock hall hall.toml --json     one document for programs: as soon as all have answered, or after 2 s

hall.toml:
  [hall]
  name = \"Hall 1\"                     optional
  key = \"shop.key\"                    of every machine that names no other, beside this file

  [[machine]]
  name = \"lathe 1\"
  at = \"10.0.0.2:7447\"                where `pitchlock serve --listen` waits there
  key = \"lathe-1.key\"                 only if it has one of its own

Nobody presses anything from here: `pitchlock panel --at` does that. A machine that does not answer is shown with how long
that is so.

Exit status of --json, and without a terminal: 0 all have answered, 1 some have not, 2 the file or a key is wrong.";

#[derive(Clone, Debug, Args)]
pub(crate) struct HallArgs {
    /// File that names the machines (TOML).
    file: PathBuf,
    /// Print one JSON document, and nothing else.
    #[arg(long)]
    pub(crate) json: bool,
}

/// So long without an answer a machine does not answer, s. It is asked four times a second.
const SILENT_S: f64 = 1.0;
/// So long a single look waits for all to answer, s.
const LOOK_S: f64 = 2.0;
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

/// A hall.
#[derive(Debug)]
struct Hall {
    name: String,
    /// Names of its machines, and what the link has to know.
    machines: Vec<(String, Watch)>,
}

/// Whether this is HOST:PORT.
fn is_address(text: &str) -> bool {
    let parts = text.rsplit_once(':');
    parts.is_some_and(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok_and(|port| port > 0))
}

impl Hall {
    /// Reads one.
    fn read(path: &Path) -> Result<Hall, CliError> {
        let wrong = |error: &dyn std::fmt::Display| CliError::file(path, error);
        let text = intake::text(path, intake::SETTINGS).map_err(|error| wrong(&error))?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        Hall::of(&text, &name, path.parent().unwrap_or(Path::new(""))).map_err(|error| wrong(&error))
    }

    fn of(text: &str, name: &str, folder: &Path) -> Result<Hall, String> {
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
            if name.trim().is_empty() || name.chars().any(char::is_control) {
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
            let Some(key) = own.or_else(|| key.clone()) else {
                return Err(format!(
                    "{place}: no key\nhelp: key = \"FILE\" here, or for all machines in [hall]"
                ));
            };
            machines.push((name, Watch { at, key: folder.join(key) }));
        }
        Ok(Hall { name: named.unwrap_or_else(|| name.to_owned()), machines })
    }

    /// One document of all that is known.
    fn document(&self, all: &[Watched]) -> Value {
        let machine = |((name, watch), watched): (&(String, Watch), &Watched)| {
            let answers = answers(watched);
            json!({
                "name": name,
                "at": watch.at,
                "answers": answers,
                "silent_s": watched.silent_s,
                "seen": watched.seen,
                "age_s": watched.seen.as_ref().map(|_| watched.age_s),
                "why": watched.why,
            })
        };
        json!({ "hall": self.name, "machines": self.machines.iter().zip(all).map(machine).collect::<Vec<_>>() })
    }

    /// The list, as it is drawn.
    fn drawn(&self, all: &[Watched]) -> String {
        let mut rows =
            vec![["machine", "does", "program", "line", "passes", "time", "faults"].map(str::to_owned)];
        rows.extend(self.machines.iter().zip(all).map(|((name, _), watched)| row(name, watched)));
        let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..7).map(width).collect();
        let silent = all.iter().filter(|watched| !answers(watched)).count();
        let mut text = format!("{}: {} machines, {silent} do not answer\n", self.name, all.len());
        for row in &rows {
            let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:width$}"));
            let _ = writeln!(text, "{}", cells.collect::<Vec<_>>().join("  ").trim_end());
        }
        text
    }
}

/// Whether a machine answers, with what it does now, and lets itself be looked at. The first answer after a
/// time in which nobody looked is of before that time.
fn answers(watched: &Watched) -> bool {
    watched.silent_s.max(watched.age_s) < SILENT_S && watched.seen.is_some() && watched.why.is_none()
}

/// A machine in the list.
fn row(name: &str, watched: &Watched) -> [String; 7] {
    let seen = watched.seen.as_ref().unwrap_or(&Value::Null);
    let text = |field: &str| seen[field].as_str().unwrap_or_default().to_owned();
    let number = |field: &str| seen[field].as_u64().map(|number| number.to_string()).unwrap_or_default();
    let does = match (&watched.why, watched.silent_s) {
        (Some(why), _) => format!("is not shown: {}", why.lines().next().unwrap_or_default()),
        (None, silent_s) if silent_s >= SILENT_S => {
            format!(
                "does not answer for {silent_s:.0} s; was {}",
                seen["mode"].as_str().unwrap_or("never seen")
            )
        }
        (None, _) if seen.is_null() => "is asked".into(),
        // Its launcher sums up a run, or stands.
        (None, _) if watched.age_s >= SILENT_S => format!("{}, {:.0} s ago", text("mode"), watched.age_s),
        (None, _) if seen["panel"] == true => format!("{}, at a panel", text("mode")),
        (None, _) => text("mode"),
    };
    let passes = match (seen["passes"][0].as_u64(), seen["passes"][1].as_u64()) {
        (Some(done), Some(all @ 1..)) => format!("{done} of {all}"),
        _ => String::new(),
    };
    let time = seen["time_s"].as_f64().map(|seconds| format!("{seconds:.1} s")).unwrap_or_default();
    let faults = seen["faults"].as_array().into_iter().flatten().filter_map(|fault| fault["code"].as_str());
    let faults = faults.collect::<Vec<_>>().join(", ");
    [name.to_owned(), does, text("program"), number("line"), passes, time, faults]
}

/// Shows a hall.
pub(crate) fn hall(args: &HallArgs) -> Result<ExitCode, CliError> {
    let hall = Hall::read(&args.file)?;
    let mut interrupts = Interrupts::catch()?;
    let machines: Vec<_> = hall.machines.iter().map(|(_, watch)| watch.clone()).collect();
    let mut link = hosts::hall(&machines)?;
    let once = args.json || !std::io::stdout().is_terminal();
    let deadline = Moment::in_s(LOOK_S);
    let mut all = vec![Watched::default(); machines.len()];
    loop {
        match link.says() {
            Some(Said::Machines(now)) if now.len() == all.len() => all = now,
            Some(Said::Refused(text)) => return Err(CliError::Input(text)),
            Some(Said::Why(text)) => return Err(CliError::Machine(text)),
            Some(_) => continue,
            None if link.is_over() => {
                return Err(CliError::Machine("what looks at the machines has ended".into()));
            }
            None if !once || !deadline.passed() => {
                if interrupts.is_wished() {
                    break;
                }
                continue;
            }
            None => {}
        }
        let known = all.iter().all(|watched| answers(watched) || watched.why.is_some());
        if once && (known || deadline.passed()) || interrupts.is_wished() {
            break;
        }
        if !once {
            // The list from the first line on, and nothing of the one before.
            screen::print(&format!("\u{1b}[H\u{1b}[J{}", hall.drawn(&all)));
        }
    }
    link.end();
    if !once {
        return Ok(ExitCode::SUCCESS);
    }
    screen::print(&if args.json { format!("{}\n", hall.document(&all)) } else { hall.drawn(&all) });
    Ok(if all.iter().all(answers) { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_with_a_hall_is_named_with_its_place_and_the_remedy() {
        let one = |rest: &str| format!("[hall]\nkey = \"k\"\n[[machine]]\nname = \"a\"\n{rest}");
        let good = one("at = \"b:1\"\n[[machine]]\nname = \"c\"\nat = \"[::1]:2\"\nkey = \"/own\"\n");
        let hall = Hall::of(&good, "file", Path::new("folder")).expect("a hall");
        assert_eq!(hall.name, "file");
        let keys: Vec<_> = hall.machines.iter().map(|(_, watch)| watch.key.display().to_string()).collect();
        assert_eq!(keys, ["folder/k", "/own"]);
        for (text, told) in [
            (String::new(), "[[machine]] names one"),
            (one("at = \"b\"\n"), "machine 1, \"a\": at = \"b\""),
            (one("at = \"b:0\"\n"), "HOST:PORT"),
            (one("at = \"b:1\"\nadress = 1\n"), "line 6"),
            (one(""), "missing field `at`"),
            (
                one("at = \"b:1\"\n[[machine]]\nname = \"a\"\nat = \"c:1\"\n"),
                "machine 2, \"a\": machine 1 has this",
            ),
            ("[[machine]]\nname = \"a\"\nat = \"b:1\"\n".into(), "no key\nhelp: "),
            ("[[machine]]\nname = \"\"\nat = \"b:1\"\n".into(), "a name is a line of text"),
        ] {
            let error = Hall::of(&text, "file", Path::new("")).expect_err(&text);
            assert!(error.contains(told), "{text}: {error}");
        }
    }

    #[test]
    fn each_machine_is_a_line_and_silence_has_its_time() {
        let hall = Hall::of(
            "[hall]\nkey = \"k\"\n[[machine]]\nname = \"one\"\nat = \"b:1\"\n[[machine]]\nname = \"two\"\nat = \"b:2\"\n\
             [[machine]]\nname = \"three\"\nat = \"b:3\"\n",
            "hall",
            Path::new(""),
        )
        .expect("a hall");
        let seen = json!({ "mode": "auto", "program": "m20x2.ngc", "line": 12, "passes": [3, 9], "time_s": 6.25,
            "faults": [{ "code": "servo-error" }] });
        let other = Watched { why: Some("b:3 has another key\nhelp: …".into()), ..Watched::default() };
        let all = [
            Watched { seen: Some(seen.clone()), ..Watched::default() },
            Watched { seen: Some(json!({ "mode": "off" })), silent_s: 4.2, ..Watched::default() },
            other,
        ];
        let text = hall.drawn(&all);
        let lines: Vec<_> =
            text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
        assert_eq!(lines[0], "hall: 3 machines, 2 do not answer");
        assert_eq!(lines[2], "one auto m20x2.ngc 12 3 of 9 6.2 s servo-error");
        assert_eq!(lines[3], "two does not answer for 4 s; was off");
        assert_eq!(lines[4], "three is not shown: b:3 has another key");
        let document = hall.document(&all);
        assert_eq!(document["machines"][0]["seen"], seen);
        assert_eq!(document["machines"][1]["answers"], false);
        let of_before = Watched { seen: Some(seen), age_s: 17.0, ..Watched::default() };
        assert_eq!(hall.document(&[of_before])["machines"][0]["answers"], false);
    }
}
