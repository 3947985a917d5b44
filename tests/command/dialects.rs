//! Which language a program is read in, what is said of it, and `--strict`.

use crate::shop::Place;

const FANUC: &str = "O1000 (SHAFT)\nG97 S500 M03\nT0100\nG00 X40. Z2.\nG01 Z-30. F0.2\nU4.\nM30\n";
const SUBROUTINE: &str = "S500 M3\no100 sub\nG0 X40 Z2\no100 endsub\no100 call\nM2\n";

#[test]
fn a_program_is_read_as_what_it_is_and_the_reason_is_said() {
    let place = Place::new();
    place.write("shaft.nc", FANUC);
    place.write("call.ngc", SUBROUTINE);
    let fanuc = place.ask(&["check", "shaft.nc"]);
    assert_eq!(fanuc.status, Some(0), "{}", fanuc.stderr);
    assert_eq!(fanuc.stderr, "shaft.nc: read as fanuc (line 1: O with the number of a program)\n");
    let other = place.ask(&["check", "call.ngc"]);
    assert_eq!((other.status, other.stderr.as_str()), (Some(0), ""));
    for (file, dialect) in [("shaft.nc", "fanuc"), ("call.ngc", "linuxcnc")] {
        let json = place.ask(&["check", "--json", file]).stdout;
        let document: serde_json::Value = serde_json::from_str(&json).expect("a document");
        assert_eq!(document["dialect"], dialect);
    }
}

#[test]
fn errors_of_the_other_dialect_end_with_a_hint() {
    let place = Place::new();
    place.write("shaft.nc", FANUC);
    place.write("call.ngc", SUBROUTINE);
    for (file, asked, hint) in [("shaft.nc", "linuxcnc", "fanuc"), ("call.ngc", "fanuc", "linuxcnc")] {
        let answer = place.ask(&["check", file, "--dialect", asked]);
        assert_eq!(answer.status, Some(2));
        assert!(answer.stderr.trim_end().ends_with(&format!("try --dialect {hint}")), "{}", answer.stderr);
    }
}

/// The interpreter reads the copy in the run folder, and comes to the same.
#[test]
fn a_run_reads_it_alike_in_every_process_and_again() {
    let place = Place::new();
    place.write("shaft.nc", FANUC);
    let first = place.ask(&["run", "shaft.nc", "--trace", "none", "--out", "first"]);
    let again = place.ask(&["run", "first", "--in-process", "--trace", "none", "--out", "again"]);
    let hash = |text: &str| text.lines().find(|line| line.starts_with("trace")).map(str::to_owned);
    assert_eq!((first.status, again.status), (Some(0), Some(0)), "{} {}", first.stderr, again.stderr);
    assert!(hash(&first.stdout).is_some() && hash(&first.stdout) == hash(&again.stdout));
}

#[test]
fn strict_takes_warnings_for_errors() {
    let place = Place::new();
    place.write("standing.ngc", "G0 X40 Z2\nG1 Z-30 F100\nM2\n");
    let (lenient, strict) =
        (place.ask(&["check", "standing.ngc"]), place.ask(&["check", "standing.ngc", "--strict"]));
    assert_eq!((lenient.status, strict.status), (Some(0), Some(2)));
    assert!(strict.stderr.contains("error[spindle-not-turning]"), "{}", strict.stderr);
    let run = place.ask(&["run", "standing.ngc", "--strict", "--in-process", "--out", "out"]);
    assert_eq!(run.status, Some(2), "{}", run.stderr);
    assert!(!place.at("out").exists(), "nothing moved");
}

/// Whose machine has a tool table writes it into the machine file once.
#[test]
fn the_machine_file_names_the_tool_table() {
    let place = Place::new();
    let table = "[machine]\ntool_table = \"mine.tbl\"";
    std::fs::create_dir(place.at("shop")).expect("the place is new");
    place.write("shop/lathe.toml", machine::SMALL_LATHE.replacen("[machine]", table, 1));
    place.write("shop/mine.tbl", "T1 Z25 D0.8 Q2\n");
    place.write("offset.ngc", "T1 M6 G43\nG0 X40 Z2\nM2\n");
    let bare = place.ask(&["check", "offset.ngc"]);
    assert_eq!(bare.status, Some(2));
    assert!(
        bare.stderr.contains("there is no tool table") && bare.stderr.contains("tool_table under [machine]")
    );
    let machine = ["--machine", "shop/lathe.toml"];
    let check = place.ask(&["check", "offset.ngc", machine[0], machine[1]]);
    assert_eq!(check.status, Some(0), "{}", check.stderr);
    let run = ["run", "offset.ngc", machine[0], machine[1], "--trace", "none", "--out", "out"];
    let run = place.ask(&run);
    assert_eq!(run.status, Some(0), "{}", run.stderr);
    // The folder is enough to run it again.
    std::fs::remove_dir_all(place.at("shop")).expect("it was there");
    let again = place.ask(&["run", "out", "--in-process", "--trace", "none", "--out", "again"]);
    assert_eq!(again.status, Some(0), "{}", again.stderr);
    place.write("lost.toml", machine::SMALL_LATHE.replacen("[machine]", table, 1));
    let lost = place.ask(&["check", "offset.ngc", "--machine", "lost.toml"]);
    assert!(lost.status == Some(2) && lost.stderr.contains("mine.tbl"), "{}", lost.stderr);
}
