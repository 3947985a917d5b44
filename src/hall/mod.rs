//! `pitchlock hall`: many machines on several computers in one view, which only looks. In: a file that names
//! them. Out: a list that is drawn again and again, or one document.

mod file;

use std::{io::IsTerminal as _, path::PathBuf, process::ExitCode};

use clap::Args;
use process::{
    ipc::time::Moment,
    link::{Said, Watch, Watched, shown},
};
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

Exit status of --json, and without a terminal that can draw: 0 all have answered, 1 some have not, 2 the file or a key is wrong.";

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

/// A hall.
#[derive(Debug)]
struct Hall {
    name: String,
    /// Names of its machines, and what the link has to know.
    machines: Vec<(String, Watch)>,
}

impl Hall {
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

    /// The list, as it is drawn, in so many columns and lines of a terminal, if it is one. If there are more
    /// machines, those with faults come first, then those that do not answer.
    fn drawn(&self, all: &[Watched], room: Option<(u16, u16)>) -> String {
        let mut machines: Vec<_> = self.machines.iter().map(|(name, _)| name).zip(all).collect();
        // Without the head of the page and of the list, and the line behind all.
        let most = room.map_or(usize::MAX, |(_, lines)| usize::from(lines).saturating_sub(3).max(2));
        let mut folded = Vec::new();
        if machines.len() > most {
            machines.sort_by_key(|(_, watched)| urgency(watched));
            folded = machines.split_off(most - 1);
        }
        let mut rows =
            vec![["machine", "faults", "does", "program", "line", "passes", "time"].map(str::to_owned)];
        rows.extend(machines.into_iter().map(|(name, watched)| row(name, watched)));
        let width = |column: usize| rows.iter().map(|row| terminal::width(&row[column])).max().unwrap_or(0);
        let widths: Vec<usize> = (0..7).map(width).collect();
        let silent = all.iter().filter(|watched| !answers(watched)).count();
        let mut lines = vec![format!("{}: {} machines, {silent} do not answer", line(&self.name), all.len())];
        lines.extend(rows.iter().map(|row| {
            let filled =
                |(cell, width): (&String, &usize)| cell.clone() + &" ".repeat(width - terminal::width(cell));
            let cells = row.iter().zip(&widths).map(filled);
            cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
        }));
        if !folded.is_empty() {
            let with = folded.iter().filter(|(_, watched)| urgency(watched) == Urgency::Faults).count();
            let with = if with > 0 { format!(", {with} of them with faults") } else { String::new() };
            lines.push(format!("and {} more{with}", folded.len()));
        }
        let columns = room.map_or(usize::MAX, |(columns, _)| columns.into());
        // What has no room is not left out unseen.
        let cut = |line: &String| {
            let (mut line, long) = (line.clone(), terminal::width(line) > columns);
            while long && terminal::width(&line) >= columns && line.pop().is_some() {}
            line + if long { "…" } else { "" }
        };
        lines.iter().map(cut).fold(String::new(), |text, line: String| text + &line + "\n")
    }
}

/// Whether a machine answers, with what it does now, and lets itself be looked at. The first answer after a
/// time in which nobody looked is of before that time.
fn answers(watched: &Watched) -> bool {
    watched.silent_s.max(watched.age_s) < SILENT_S && watched.seen.is_some() && watched.why.is_none()
}

/// What is seen first.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Urgency {
    Faults,
    Silent,
    None,
}

fn urgency(watched: &Watched) -> Urgency {
    let faults = watched.seen.as_ref().and_then(|seen| seen["faults"].as_array());
    match faults.is_some_and(|faults| !faults.is_empty()) {
        true => Urgency::Faults,
        false if !answers(watched) => Urgency::Silent,
        false => Urgency::None,
    }
}

/// A text of somebody else in one line.
fn line(text: &str) -> String {
    shown(text.lines().next().unwrap_or_default())
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
    [name.to_owned(), faults, does, text("program"), number("line"), passes, time].map(|cell| line(&cell))
}

/// Shows a hall.
pub(crate) fn hall(args: &HallArgs) -> Result<ExitCode, CliError> {
    let hall = Hall::read(&args.file)?;
    let mut interrupts = Interrupts::catch()?;
    let machines: Vec<_> = hall.machines.iter().map(|(_, watch)| watch.clone()).collect();
    let mut link = hosts::hall(&machines)?;
    // A dumb terminal cannot draw again.
    let dumb = std::env::var_os("TERM").is_none_or(|term| term == "dumb");
    let once = args.json || dumb || !std::io::stdout().is_terminal();
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
            screen::print(&format!("\u{1b}[H\u{1b}[J{}", hall.drawn(&all, terminal::size())));
        }
    }
    link.end();
    if !once {
        return Ok(ExitCode::SUCCESS);
    }
    screen::print(&if args.json { format!("{}\n", hall.document(&all)) } else { hall.drawn(&all, None) });
    Ok(if all.iter().all(answers) { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

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
        let text = hall.drawn(&all, None);
        let lines: Vec<_> =
            text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
        assert_eq!(lines[0], "hall: 3 machines, 2 do not answer");
        assert_eq!(lines[2], "one servo-error auto m20x2.ngc 12 3 of 9 6.2 s");
        let narrow = hall.drawn(&all, Some((40, 24)));
        assert!(
            narrow.contains("servo-error") && narrow.lines().nth(2).is_some_and(|line| line.ends_with('…'))
        );
        assert_eq!(lines[3], "two does not answer for 4 s; was off");
        assert_eq!(lines[4], "three is not shown: b:3 has another key");
        let document = hall.document(&all);
        assert_eq!(document["machines"][0]["seen"], seen);
        assert_eq!(document["machines"][1]["answers"], false);
        let of_before = Watched { seen: Some(seen), age_s: 17.0, ..Watched::default() };
        assert_eq!(hall.document(&[of_before])["machines"][0]["answers"], false);
    }

    #[test]
    fn more_machines_than_lines_are_folded_and_faults_come_first() {
        let entry = |number: usize| format!("[[machine]]\nname = \"m{number}\"\nat = \"b:{}\"\n", number + 1);
        let text: String = (0..20).map(entry).collect();
        let hall = Hall::of(&format!("[hall]\nkey = \"k\"\n{text}"), "hall", Path::new("")).expect("a hall");
        let mut all =
            vec![Watched { seen: Some(json!({ "mode": "off", "faults": [] })), ..Watched::default() }; 20];
        assert_eq!(hall.drawn(&all, Some((80, 23))).lines().count(), 22, "all of them have room");
        all[17].seen = Some(json!({ "mode": "fault", "faults": [{ "code": "servo-error" }] }));
        all[12].silent_s = 9.0;
        let drawn = |lines: u16| {
            let text = hall.drawn(&all, Some((24, lines)));
            assert!(text.lines().count() < usize::from(lines), "no line more than there are: {text}");
            assert!(text.lines().all(|line| line.chars().count() <= 24), "{text}");
            let lines =
                text.lines().skip(2).map(|line| line.split(' ').next().unwrap_or_default().to_owned());
            (lines.collect::<Vec<_>>(), text.lines().last().unwrap_or_default().to_owned())
        };
        let (rows, last) = drawn(8);
        assert_eq!(
            (rows, last.as_str()),
            (["m17", "m12", "m0", "m1", "and"].map(str::to_owned).to_vec(), "and 16 more")
        );
        all.iter_mut()
            .for_each(|watched| watched.seen.clone_from(&Some(json!({ "faults": [{ "code": "x" }] }))));
        let text = hall.drawn(&all, Some((80, 8)));
        assert!(text.ends_with("and 16 more, 16 of them with faults\n"), "{text}");
    }

    /// What steers a terminal, whoever says it, is written out.
    #[test]
    fn nothing_that_is_shown_of_a_machine_steers_the_terminal() {
        let text = "[hall]\nname = \"\\u001b[2J\\u0007hall\"\nkey = \"k\"\n[[machine]]\nname = \"a\"\nat = \"b:1\"\n";
        let hall = Hall::of(text, "hall", Path::new("")).expect("a hall");
        let evil = "\u{1b}]0;x\u{7}\u{9b}31m\u{202e}\rprogram\n\u{8}";
        let seen = json!({ "mode": evil, "program": evil, "faults": [{ "code": evil }] });
        for watched in [
            Watched { seen: Some(seen), ..Watched::default() },
            Watched { why: Some(evil.into()), ..Watched::default() },
        ] {
            let text = hall.drawn(&[watched], None);
            assert!(!text.contains(|letter: char| letter != '\n' && letter.is_control()), "{text:?}");
            assert!(text.contains("\\u{1b}[2J\\u{7}hall") && text.contains("\\u{202e}"), "{text}");
            assert_eq!(text.lines().count(), 3, "{text}");
        }
    }
}
