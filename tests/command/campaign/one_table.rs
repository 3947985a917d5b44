//! `pitchlock campaign`: one table however it is made, whoever is killed meanwhile; what is of something else
//! is refused; a row says what makes it again.

use std::fs;
use std::process::{Child, Command, Stdio};

use parquet::file::reader::SerializedFileReader;
use parquet::record::Field;

use super::{made, soak, started_by, table};
use crate::shop::{Answer, Place, can_be_private, example, private, project, scenario, signal, until};

/// Rows of a table: names and values.
fn rows(place: &Place, folder: &str) -> Vec<Vec<(String, Field)>> {
    let file = fs::File::open(place.at(folder).join("campaign.parquet")).expect("a table");
    let reader = SerializedFileReader::new(file).expect("a Parquet file");
    let row = |row: parquet::record::Row| {
        row.get_column_iter().map(|(name, field)| (name.clone(), field.clone())).collect()
    };
    reader.into_iter().map(|read| row(read.expect("a row"))).collect()
}

fn field<'a>(row: &'a [(String, Field)], name: &str) -> &'a Field {
    &row.iter().find(|(other, _)| other == name).unwrap_or_else(|| panic!("no column {name}: {row:?}")).1
}

fn text(row: &[(String, Field)], name: &str) -> String {
    match field(row, name) {
        Field::Str(text) => text.clone(),
        other => panic!("{name} is {other}"),
    }
}

/// Starts a part of a campaign and leaves it alone.
fn started(place: &Place, arguments: &[&str]) -> Child {
    let mut command = place.pitchlock();
    command
        .arg("campaign")
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("it starts")
}

#[test]
fn the_table_is_the_same_however_its_jobs_are_made() {
    let place = Place::new();
    place.write("seeds.toml", soak(24, 4));
    let said = made(&place, &["seeds.toml", "--out", "whole"]);
    assert!(said.contains("24 rows of 6 jobs"), "{said}");
    // By hand: another order, one of them twice, with a folder of its own.
    for job in ["5", "0", "3", "1", "0", "4"] {
        made(&place, &["seeds.toml", "--out", "parts", "--job", job]);
    }
    let early = place.ask(&["campaign", "seeds.toml", "--out", "parts", "--merge"]);
    assert_eq!(early.status, Some(1), "{}", early.stdout);
    assert!(early.stderr.contains("1 of 6 jobs are not done, job 2 first"), "{}", early.stderr);
    made(&place, &["seeds.toml", "--out", "parts", "--job", "2"]);
    made(&place, &["seeds.toml", "--out", "parts", "--merge"]);
    assert_eq!(table(&place, "parts"), table(&place, "whole"));
    let seeds: Vec<Field> = rows(&place, "parts").iter().map(|row| field(row, "seed").clone()).collect();
    assert_eq!(seeds, (0..24).map(Field::Long).collect::<Vec<_>>());
    assert!(!place.at("parts/scratch").exists());
}

#[test]
fn who_is_killed_leaves_nobody_behind_and_nothing_half_made() {
    let place = Place::new();
    place.write("seeds.toml", soak(24, 4));
    made(&place, &["seeds.toml", "--out", "whole"]);
    let jobs = place.at("cut/jobs");
    let there = || fs::read_dir(&jobs).map_or(0, |entries| entries.flatten().count());
    for (many, how) in [(0, "KILL"), (1, "INT"), (2, "KILL"), (3, "TERM")] {
        let mut campaign = started(&place, &["seeds.toml", "--out", "cut", "--jobs", "2"]);
        until("jobs are made", || there() >= many && !started_by(campaign.id()).is_empty());
        let commands = started_by(campaign.id());
        signal(campaign.id(), how);
        let ended = campaign.wait().expect("it was started here");
        assert_ne!(ended.code(), Some(0), "{how}");
        for command in commands {
            until("its commands end, too", || !fs::exists(format!("/proc/{command}")).unwrap_or(false));
        }
        for entry in fs::read_dir(&jobs).into_iter().flatten().flatten() {
            let text = fs::read_to_string(entry.path()).expect("a file");
            let name = entry.file_name().into_string().expect("a name");
            assert!(
                !name.ends_with(".json") || serde_json::from_str::<serde_json::Value>(&text).is_ok(),
                "{name}"
            );
        }
    }
    made(&place, &["seeds.toml", "--out", "cut"]);
    assert_eq!(table(&place, "cut"), table(&place, "whole"));
    assert_eq!(there(), 6, "nothing half made is left");
    assert!(!place.at("cut/scratch").exists());
}

#[test]
fn what_was_made_of_something_else_is_refused() {
    let place = Place::new();
    place.write("seeds.toml", soak(8, 4));
    made(&place, &["seeds.toml", "--out", "made"]);
    let whole = fs::read_to_string(place.at("made/jobs/00001.json")).expect("a job");
    let refused = |text: &str, says: &str| {
        place.write("made/jobs/00001.json", text);
        for part in [vec!["--merge"], vec!["--job", "1"], vec![]] {
            let answer = place.ask(&[&["campaign", "seeds.toml", "--out", "made"], part.as_slice()].concat());
            assert_eq!(answer.status, Some(2), "{says} {part:?}: {}", answer.stdout);
            assert!(
                answer.stderr.contains(says) && answer.stderr.contains("00001.json"),
                "{says}: {}",
                answer.stderr
            );
        }
    };
    refused(&whole[..whole.len() / 2], "is not what a job leaves");
    refused("", "is not what a job leaves");
    refused(&whole.replace("\"job\":1,\"rows\"", "\"job\":0,\"rows\""), "is of job 0");
    refused(&whole.replacen("\"made_of\":\"", "\"made_of\":\"0", 1), "was made of another campaign file");
    place.write("made/jobs/00001.json", &whole);
    made(&place, &["seeds.toml", "--out", "made", "--merge"]);
    place.write("seeds.toml", soak(8, 4) + "# another word\n");
    let other = place.ask(&["campaign", "seeds.toml", "--out", "made", "--merge"]);
    assert_eq!(other.status, Some(2), "{}", other.stdout);
    assert!(other.stderr.contains("name a new folder with --out"), "{}", other.stderr);
}

/// A signal, a file that changes: whatever says nothing of the machine is no row.
#[test]
fn what_happens_to_the_computer_is_not_kept() {
    let place = Place::new();
    let program = "G21 G90\nG1 X5 F100\nG4 P400\nM2\n";
    let bogged = scenario("bogged-spindle");
    let meanwhile = |out: &str, more: &str, does: &dyn Fn(u32), says: &str| {
        place.write("part.ngc", program);
        place.write("one.toml", format!("command = [\"run\", \"part.ngc\"{more}]\n"));
        let mut command = place.pitchlock();
        command.args(["campaign", "one.toml", "--out", out]).stdout(Stdio::null()).stderr(Stdio::piped());
        let campaign = command.spawn().expect("it starts");
        until("its command runs", || !started_by(campaign.id()).is_empty());
        does(started_by(campaign.id())[0]);
        let ended = campaign.wait_with_output().expect("it was started here");
        let said = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert!(
            ended.status.code().is_some_and(|status| status != 0) && said.contains(says),
            "{says}: {said}"
        );
        assert_eq!(fs::read_dir(place.at(out).join("jobs")).expect("a folder").count(), 0, "{says}");
    };
    let under_scenario = format!(", \"--scenario={}\"", bogged.display());
    for signal_name in ["TERM", "INT", "KILL", "HUP"] {
        let ends = |command| signal(command, signal_name);
        meanwhile(signal_name, "", &ends, "job 0: `pitchlock run part.ngc` was");
        // A scenario may stop a run as well, and this one does not.
        let out = format!("{signal_name}-in-a-scenario");
        meanwhile(&out, &under_scenario, &ends, "bogged-spindle.toml` was");
    }
    let changes = |_| drop(place.write("part.ngc", program.replace("X5", "X6")));
    meanwhile("changed", "", &changes, "has changed meanwhile");
}

/// A disk that is full at the first byte, at the last, and between: the jobs that had no room are made when
/// there is some, and the table is that of a disk with room.
#[test]
fn a_full_disk_costs_jobs_and_no_rows() {
    if !can_be_private("a_full_disk_costs_jobs_and_no_rows") {
        return;
    }
    let place = Place::new();
    place.write("seeds.toml", soak(3, 1));
    made(&place, &["seeds.toml", "--out", "whole"]);
    fs::create_dir(place.at("disk")).expect("a folder");
    let mut full = 0;
    for room in (0..=60).step_by(4) {
        let script = format!(
            "mount -t tmpfs -o size=256k none disk && \
             head -c $((256 - {room}))k /dev/zero >disk/filler; \
             \"$0\" campaign seeds.toml --out disk/made -q; echo first $?; rm disk/filler; \
             \"$0\" campaign seeds.toml --out disk/made -q; echo then $?; cp disk/made/campaign.parquet {room}"
        );
        let answer = Answer::from(private(&place, &script).output().expect("sh"));
        let said = answer.stdout + &answer.stderr;
        full += u64::from(said.contains("first 1"));
        assert!(said.contains("first 1") || said.contains("first 0"), "{room} kB: {said}");
        assert!(said.contains("then 0"), "{room} kB: {said}");
        let other = fs::read(place.at(&room.to_string())).expect("a table");
        assert_eq!(other, table(&place, "whole"), "{room} kB: {said}");
    }
    assert!(full >= 3, "the disk was full {full} times");
}

#[test]
fn a_folder_of_somebody_else_is_left_alone() {
    let place = Place::new();
    place.write("seeds.toml", soak(4, 4));
    for name in ["scratch", "jobs", "machines"] {
        fs::create_dir_all(place.at("mine").join(name)).expect("a folder");
        place.write(&format!("mine/{name}/00000.json"), "precious");
    }
    for part in [vec![], vec!["--merge"], vec!["--slurm"], vec!["--job", "0"]] {
        let answer = place.ask(&[&["campaign", "seeds.toml", "--out", "mine"], part.as_slice()].concat());
        assert_eq!(answer.status, Some(2), "{part:?}: {}", answer.stdout);
        assert!(answer.stderr.contains("mine: other files are in this folder already"), "{}", answer.stderr);
    }
    for name in ["scratch", "jobs", "machines"] {
        let there = fs::read_to_string(place.at(&format!("mine/{name}/00000.json"))).expect("it is there");
        assert_eq!(there, "precious");
    }
    assert_eq!(fs::read_dir(place.at("mine")).expect("a folder").count(), 3);
}

#[test]
fn every_value_has_its_rows_and_each_row_what_makes_it_again() {
    let place = Place::new();
    fs::copy(example("m20x2.ngc"), place.at("part.ngc")).expect("a program");
    let file = "command = [\"run\", \"part.ngc\", \"--seed\", \"{seed}\", \"--gauge\", \"{thread}\"]\nseeds = \"3..5\"\nper_job = 3\n\
                [vary]\n\"axis.x.mass_kg\" = [1700, 2000]\nthread = [\"M20x2-6g\", \"M20x2-4h\"]\n";
    place.write("mass.toml", file);
    made(&place, &["mass.toml", "--jobs", "2"]);
    let rows = rows(&place, "campaigns/mass");
    let passes = rows.iter().filter(|row| *field(row, "job") == Field::Long(0)).count();
    assert_eq!(rows.len(), 8 * passes / 3, "eight runs, three of them in a job");
    let again = |row: &[(String, Field)]| {
        let command = text(row, "command");
        let words: Vec<&str> = command.split_whitespace().skip(1).collect();
        let out = place.at("again");
        place.clear("again");
        let mut command = place.pitchlock();
        command.args(words).args(["--json", "--trace", "none", "--out"]).arg(&out);
        let output = command.output().expect("it runs");
        let summary: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a summary");
        assert_eq!(summary["trace_hash"], text(row, "trace_hash"), "{row:?}");
        let status = output.status.code().map(i64::from);
        assert_eq!(status.map(Field::Long).as_ref(), Some(field(row, "status")));
    };
    again(&rows[0]);
    again(&rows[rows.len() - 1]);
    let hashes: std::collections::BTreeSet<String> = rows.iter().map(|row| text(row, "trace_hash")).collect();
    assert_eq!(hashes.len(), 4, "two masses, two seeds; the gauge moves nothing");
    let mut drawn: Vec<(String, String)> =
        rows.iter().map(|row| (field(row, "axis.x.mass_kg").to_string(), text(row, "thread"))).collect();
    drawn.dedup();
    assert_eq!(drawn.len(), 4, "{drawn:?}");
}

#[test]
fn what_is_refused_is_a_row_with_its_reason() {
    let place = Place::new();
    place.write("part.ngc", "G21 G90\nG1 X5 F100\nM2\n");
    place.write(
        "feeds.toml",
        "command = [\"run\", \"{program}\"]\n[vary]\nprogram = [\"part.ngc\", \"none.ngc\"]\n",
    );
    let said = made(&place, &["feeds.toml"]);
    assert!(
        said.contains("2 rows of 2 jobs")
            && said.contains("1 with status 2, such as: pitchlock run none.ngc"),
        "{said}"
    );
    let rows = rows(&place, "campaigns/feeds");
    assert!(text(&rows[1], "error").contains("none.ngc"), "{rows:?}");
    assert_eq!(field(&rows[0], "error"), &Field::Null);
    place.write("feeds.toml", "command = [\"run\", \"none.ngc\"]\n");
    let none = place.ask(&["campaign", "feeds.toml", "--out", "none"]);
    assert_eq!(none.status, Some(1), "a campaign of nothing but refusals is none: {}", none.stdout);
}

#[test]
fn a_wrong_file_is_told_before_anything_is_made() {
    let place = Place::new();
    let soak = "command = [\"soak\", \"--seeds\", \"{seeds}\"]\n";
    let run = "command = [\"run\", \"part.ngc\"]\n";
    place.write("keeps.toml", "[machine]\nparameters = \"p.var\"\n");
    let wrong = [
        ("", "command"),
        ("command = []\n", "begin with one of soak, experiment, tune, run"),
        ("command = [\"panel\"]\n", "\"panel\" cannot be made many times"),
        (soak, "seeds is missing"),
        ("command = [\"soak\", \"--seeds\", \"0..9\"]\n", "soak takes seeds"),
        (&format!("{soak}seeds = \"9..3\"\n"), "seeds: 9..3 holds no seed"),
        (&format!("{soak}seeds = \"many\"\n"), "such as 0..2000"),
        (&format!("{soak}seeds = \"0..20\"\nper_job = 0\n"), "per_job: 1 or more"),
        (&format!("{soak}seeds = \"0..20\"\nper_jobs = 3\n"), "per_jobs"),
        (&format!("{soak}seeds = \"0..90000000000\"\n"), "more than 1000000 runs"),
        (&format!("{soak}seeds = \"0..20\"\nmachine = \"a.toml\"\n"), "soak draws its machines itself"),
        (&format!("{run}seeds = \"0..20\"\n"), "no word of the command has {seed}"),
        ("command = [\"run\", \"{seed}{seeds}\"]\nseeds = \"0..2\"\n", "keep one of them"),
        ("command = [\"run\", \"{part}\"]\n", "{part} has no values"),
        ("command = [\"run\", \"a.ngc\", \"--json\"]\n", "a campaign says --json itself"),
        ("command = [\"run\", \"a.ngc\", \"--parameters\", \"p.var\"]\n", "nothing with --parameters"),
        ("command = [\"run\", \"a.ngc\", \"--clock=real\"]\n", "nothing with --clock"),
        (&format!("{run}[vary]\n\"machine.parameters\" = [\"p.var\"]\n"), "machine.parameters: a run writes"),
        (&format!("{run}machine = \"keeps.toml\"\n"), "machine.parameters: a run writes this file"),
        ("command = [\"run\", \"a.ngc\", \"--machine=m.toml\"]\n", "say the machine file as machine"),
        (&format!("{run}[vary]\n\"axis.x.mass_kg\" = 3\n"), "a list of values"),
        (&format!("{run}[vary]\n\"axis.x.mass_kg\" = []\n"), "one or more"),
        (&format!("{run}[vary]\n\"axis.x.mass_kg\" = [-1]\n"), "no machine with axis.x.mass_kg = -1"),
        (&format!("{run}[vary]\n\"axis.w.mass_kg\" = [1]\n"), "the machine file has no [axis.w]"),
        (
            &format!("{run}[vary]\nmass = [1]\n"),
            "neither {mass} in the command nor a key of the machine file",
        ),
        (&format!("{run}[vary]\n\"job\" = [1]\n"), "a column of that name already"),
        (&format!("{run}machine = \"none.toml\"\n"), "none.toml"),
    ];
    for (text, says) in wrong {
        place.write("wrong.toml", text);
        let answer = place.ask(&["campaign", "wrong.toml"]);
        assert_eq!(answer.status, Some(2), "{text}: {}", answer.stderr);
        let named = answer.stderr.starts_with("error: wrong.toml: ");
        assert!(named && answer.stderr.contains(says), "{text}: {}", answer.stderr);
        assert!(!place.at("campaigns/wrong/jobs/00000.json").exists(), "{text}");
    }
    place.write("good.toml", self::soak(8, 4));
    let beyond = place.ask(&["campaign", "good.toml", "--job", "2"]);
    assert_eq!(
        (beyond.status, beyond.stderr.contains("the jobs 0 to 1")),
        (Some(2), true),
        "{}",
        beyond.stderr
    );
}

#[test]
fn the_campaigns_of_the_examples_are_some() {
    let place = Place::new();
    for file in fs::read_dir(project().join("examples/campaigns")).expect("examples").flatten() {
        let file = file.path().display().to_string();
        let answer = place.ask(&["campaign", &file, "--out", "made", "--slurm"]);
        assert_eq!(answer.status, Some(0), "{file}: {}", answer.stderr);
        place.clear("made");
    }
}

/// Hands a script for a scheduler to the shell, with a scheduler that makes its tasks one by one.
#[test]
fn a_script_names_the_jobs_that_are_not_done() {
    let place = Place::new();
    place.write("it's.toml", soak(16, 4));
    made(&place, &["it's.toml", "--job", "1"]);
    let script = made(&place, &["it's.toml", "--slurm"]);
    assert!(script.contains("#SBATCH --array=0,2-3\n"), "{script}");
    let path = place.write("slurm.sh", &script);
    for task in ["0", "2", "3"] {
        let ran = Command::new("sh").arg(&path).env("SLURM_ARRAY_TASK_ID", task).output().expect("a shell");
        assert!(ran.status.success(), "{task}: {}", String::from_utf8_lossy(&ran.stderr));
    }
    let done = place.ask(&["campaign", "it's.toml", "--slurm"]);
    assert_eq!(done.status, Some(1), "{}", done.stdout);
    assert!(done.stderr.contains("every job is done"), "{}", done.stderr);
    made(&place, &["it's.toml", "--merge"]);
}
