//! Offsets, parameters and tools where shops have them: parameter files, LinuxCNC's description of a machine,
//! `offsets`, and what a run leaves.

use std::fs;

use crate::shop::Place;

const INI: &str = "[DISPLAY]\nLATHE = 1\n[KINS]\nKINEMATICS = trivkins coordinates=XZ\n[TRAJ]\nLINEAR_UNITS = mm\n[RS274NGC]\n\
    PARAMETER_FILE = lathe.var\nSUBROUTINE_PATH = subs:missing\nRS274NGC_STARTUP_CODE = G7 G18 G90 M9 M5\n[EMCIO]\nTOOL_TABLE = tool.tbl\n\
    [AXIS_X]\nMIN_LIMIT = -2\nMAX_LIMIT = 90\nMAX_VELOCITY = 33.5\nMAX_ACCELERATION = 1e9\n[JOINT_1]\nHOME = 40\n[AXIS_Z]\nMIN_LIMIT = -250\n";
/// G7 of the startup code makes X60 a radius of 30; the program changes offsets and a tool.
const PROGRAM: &str =
    "T1 M6 G43\nG0 X60 Z2\no<face> call\nG10 L2 P2 Z-50\nG10 L1 P1 Z26\n#31=5 #32=6\nG92 Z0\nM2\n";

fn shop() -> Place {
    let place = Place::new();
    fs::create_dir_all(place.at("shop/subs")).expect("the place is new");
    place.write("shop/lathe.ini", INI);
    place.write("shop/lathe.var", "; zero of the chuck\n31\t0.0\n5223  -100.5   (face)\n");
    place.write("shop/tool.tbl", "T1 P1 Z25 D0.8 Q2 ;rough\n");
    place.write("shop/subs/face.ngc", "o<face> sub\nG0 X50\no<face> endsub\n");
    place.write("part.ngc", PROGRAM);
    place
}

#[test]
fn a_description_of_linuxcnc_is_taken_as_it_is_and_its_files_are_only_read() {
    let place = shop();
    let read = |name: &str| fs::read_to_string(place.at(name)).expect("it is there");
    let before = ["shop/lathe.var", "shop/tool.tbl"].map(read);
    let ini = ["--ini", "shop/lathe.ini"];
    let check = place.ask(&["check", "part.ngc", ini[0], ini[1]]);
    assert_eq!(check.status, Some(0), "{}", check.stderr);
    for told in [
        "took travel of X: -2 to 90 mm",
        "took speed of X: 33.5 mm/s",
        "left acceleration of X, 1000000000 mm/s²: the drive of the machine file makes",
        "took home of Z: 40 mm",
        "took travel of Z: -250 to",
        "took parameters, to read them: shop/lathe.var",
        "took tool table, to read it: shop/tool.tbl",
        "took startup code G7 G18 G90 M9 M5",
        "left subroutines of shop/missing: there is no such folder",
    ] {
        assert!(check.stderr.contains(told), "{told}\n{}", check.stderr);
    }
    assert!(place.ask(&["check", "part.ngc", "-q", ini[0], ini[1]]).stderr.is_empty());
    let run = place.ask(&["run", "part.ngc", ini[0], ini[1], "--trace", "csv", "--out", "first"]);
    assert_eq!(run.status, Some(0), "{}", run.stderr);
    assert_eq!(["shop/lathe.var", "shop/tool.tbl"].map(read), before, "they belong to that machine");
    // G54 and the tool count: the last point of X is 25 as a radius, Z is 2 - 100.5 + 25.
    let trace = read("first/trace.csv");
    let mut rows = csv(&trace);
    let (head, last) = (rows.next().expect("a head"), rows.last().expect("a cycle"));
    let at = |name: &str| {
        let column = head.iter().position(|column| *column == name).expect("the trace has it");
        last[column].parse::<f64>().expect("a number")
    };
    assert!((at("x_commanded") - 25.0).abs() < 1e-6 && (at("z_commanded") + 73.5).abs() < 1e-6);
    // The folder is enough to run it again.
    fs::remove_dir_all(place.at("shop")).expect("it was there");
    let again = place.ask(&["run", "first", "--in-process", "--trace", "none", "--out", "again"]);
    assert_eq!((again.status, again.stderr.as_str()), (Some(0), ""));
    let hash = |text: &str| text.lines().find(|line| line.starts_with("trace")).map(str::to_owned);
    assert!(hash(&run.stdout).is_some() && hash(&run.stdout) == hash(&again.stdout));
}

fn csv(text: &str) -> impl Iterator<Item = Vec<&str>> {
    text.lines().map(|line| line.split(',').collect())
}

#[test]
fn what_is_wrong_with_a_description_is_named() {
    let place = shop();
    for (old, new, told) in [
        ("MAX_LIMIT = 90", "MAX_LIMIT = -9", "axis.x.travel_mm"),
        ("MAX_VELOCITY = 33.5", "MAX_VELOCITY = fast", "[AXIS_X]MAX_VELOCITY: `fast` is not a number"),
        ("G7 G18 G90 M9 M5", "G7 G18 G99999", "the startup code `G7 G18 G99999`"),
        ("G7 G18 G90 M9 M5", "G0 X5", "it moves an axis"),
        ("G7 G18 G90 M9 M5", "G90 M3 S100", "an M code other than M5 and M9"),
    ] {
        assert!(INI.contains(old));
        place.write("shop/lathe.ini", INI.replacen(old, new, 1));
        let check = place.ask(&["check", "part.ngc", "--ini", "shop/lathe.ini"]);
        assert!(check.status == Some(2) && check.stderr.contains(told), "{told}\n{}", check.stderr);
    }
}

#[test]
fn a_run_to_its_end_keeps_what_its_program_has_set_and_nothing_else_changes() {
    let place = shop();
    let files = ["--parameters", "shop/lathe.var", "--tools", "shop/tool.tbl", "--subroutines", "shop/subs"];
    let run = |program: &str, out: &str, more: &[&str]| {
        let mut args = vec!["run", program, "--in-process", "--trace", "none", "--out", out];
        args.extend(more);
        place.ask(&args)
    };
    let read = |name: &str| fs::read_to_string(place.at(name)).expect("it is there");
    let before = ["shop/lathe.var", "shop/tool.tbl"].map(read);
    // Neither reading nor a run that is broken off keeps anything.
    place.write("stop.toml", "[[event]]\nat = { time_s = 0.1 }\nstop = true\n");
    let mut check = vec!["check", "part.ngc"];
    check.extend(files);
    assert_eq!(place.ask(&check).status, Some(0));
    let mut stopped = files.to_vec();
    stopped.extend(["--scenario", "stop.toml"]);
    assert_eq!(run("part.ngc", "stopped", &stopped).status, Some(1));
    assert_eq!(["shop/lathe.var", "shop/tool.tbl"].map(read), before);
    let done = run("part.ngc", "done", &files);
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    // #32 is not in the file, so it is not kept; G92 is, as on LinuxCNC.
    let kept = "; zero of the chuck\n31\t5.000000\n5210\t1.000000\n5213\t2.000000\n5223  -100.5   (face)\n5243\t-50.000000\n";
    assert_eq!(read("shop/lathe.var"), kept);
    assert_eq!(read("shop/tool.tbl"), "T1 P1 Z26 D0.8 Q2 ;rough\n");
    assert_eq!(read("done/parameters.var"), before[0], "the folder has what the run began with");
    let again = run("done", "again", &[]);
    assert_eq!((again.status, read("done/parameters.var")), (Some(0), before[0].clone()));
    // The machine file may name the file, and one that is not there yet is made.
    let named = "[machine]\nparameters = \"own.var\"\ntool_table = \"tool.tbl\"";
    place.write("shop/lathe.toml", machine::SMALL_LATHE.replacen("[machine]", named, 1));
    place.write("zero.ngc", "G10 L2 P1 Z-20\nM2\n");
    let first = run("zero.ngc", "zero", &["--machine", "shop/lathe.toml"]);
    assert!(
        first.status == Some(0) && first.stderr.contains("own.var: is not there yet"),
        "{}",
        first.stderr
    );
    let own = read("shop/own.var");
    assert!(own.contains("5223\t-20.000000\n") && own.lines().count() == 119, "{own}");
}

#[test]
fn offsets_are_listed_set_and_loaded() {
    let place = shop();
    let read = |name: &str| fs::read_to_string(place.at(name)).expect("it is there");
    let named = "[machine]\nparameters = \"lathe.var\"\ntool_table = \"tool.tbl\"";
    place.write("shop/lathe.toml", machine::SMALL_LATHE.replacen("[machine]", named, 1));
    let offsets = |args: &[&str]| {
        let mut all = vec!["offsets"];
        all.extend(args);
        all.extend(["--machine", "shop/lathe.toml"]);
        place.ask(&all)
    };
    for set in
        [&["set", "G54", "X0.5"][..], &["set", "g59.3", "Z-2.25", "R30"], &["set", "t1", "--add", "X-0.02"]]
    {
        let answer = offsets(set);
        assert_eq!((answer.status, answer.stderr.as_str()), (Some(0), ""));
    }
    assert_eq!(offsets(&["set", "T1", "--add", "X-0.02"]).status, Some(0));
    let answer = offsets(&["set", "T7", "--add", "X-0.02"]);
    assert!(
        answer.status == Some(2) && answer.stderr.contains("T7 is not in the tool table"),
        "{}",
        answer.stderr
    );
    let var = "; zero of the chuck\n31\t0.0\n5221\t0.500000\n5223  -100.5   (face)\n5383\t-2.250000\n5390\t30.000000\n";
    assert_eq!(read("shop/lathe.var"), var);
    assert_eq!(read("shop/tool.tbl"), "T1 P1 Z25 D0.8 Q2 X-0.04 ;rough\n");
    let list = offsets(&["list"]).stdout;
    for line in ["G54   X0.5 Z-100.5\n", "G59.3 X0 Z-2.25 R30\n", "T1    X-0.04 Z25 D0.8 Q2  ;rough\n"] {
        assert!(list.contains(line), "{line}{list}");
    }
    let json: serde_json::Value = serde_json::from_str(&offsets(&["list", "--json"]).stdout).expect("JSON");
    assert_eq!((json["systems"][0]["Z"].as_f64(), json["in_force"].as_str()), (Some(-100.5), Some("G54")));
    assert_eq!((json["tool_offsets"][0]["X"].as_f64(), json["units"].as_str()), (Some(-0.04), Some("mm")));
    // A list can be loaded: here into files that are not there yet.
    place.write("list.txt", list);
    let files = ["--parameters", "copy.var", "--tools", "copy.tbl"];
    let load = place.ask(&["offsets", "load", "list.txt", files[0], files[1], files[2], files[3]]);
    assert_eq!(load.status, Some(0), "{}", load.stderr);
    assert!(
        read("copy.var").contains("5223\t-100.500000\n") && read("copy.var").contains("5163\t100.000000\n")
    );
    assert_eq!(read("copy.tbl"), "T1 P1 X-0.04 Z25 D0.8 Q2\n");
    // All of a file or nothing.
    place.write("bad.txt", "G54 X7 ; this is right\nT1 Q12\nG60 X1\n");
    for (args, told) in [
        (&["load", "bad.txt"][..], "bad.txt:3: `G60` is neither"),
        (&["set", "G54", "Q1"], "G54 has no word `Q1`"),
        (&["set", "G54", "Xa"], "`Xa` of G54 is not a word"),
        (&["set", "T1", "Q12"], "Q12"),
    ] {
        let answer = offsets(args);
        assert!(answer.status == Some(2) && answer.stderr.contains(told), "{told}\n{}", answer.stderr);
    }
    assert_eq!(read("shop/lathe.var"), var);
    let nothing = place.ask(&["offsets", "set", "G54", "X1"]);
    assert!(nothing.status == Some(2) && nothing.stderr.contains("--parameters FILE"), "{}", nothing.stderr);
}

#[test]
fn words_that_cannot_be_are_refused_and_nothing_is_written() {
    let place = Place::new();
    place.write("tool.tbl", "T3 D0.8 Q2\n");
    place.write("lathe.var", "5221 1.0\n");
    place.write("twice.txt", "G54 X0\nT3 X1\nG54 X2\n");
    let files = ["--tools", "tool.tbl", "--parameters", "lathe.var"];
    for (words, told) in [
        (&["set", "G54", "X1", "Z2", "X3"][..], "X of G54 stands twice"),
        (&["set", "T3", "--add", "Q1"], "cannot be added to"),
        (&["set", "T3", "D-0.8"], "a diameter is 0 or more"),
        (&["set", "T3", "--add", "D-0.9"], "a diameter is 0 or more"),
        (&["set", "G55", "R361"], "more than a turn"),
        (&["set", "T3", "I-400"], "more than a turn"),
        (&["load", "twice.txt"], "X of G54 stands twice"),
    ] {
        let answer = place.ask(&[&["offsets"], words, &files].concat());
        assert!(answer.status == Some(2) && answer.stderr.contains(told), "{words:?}: {}", answer.stderr);
    }
    let read = |name: &str| std::fs::read_to_string(place.at(name)).expect("it is there");
    assert_eq!((read("tool.tbl").as_str(), read("lathe.var").as_str()), ("T3 D0.8 Q2\n", "5221 1.0\n"));
}

/// Three who set offsets at once: nothing of what any of them has set is lost, and what is added is added.
#[test]
fn changes_at_the_same_time_are_all_kept() {
    const EACH: usize = 8;
    let place = Place::new();
    let tools: String = (1..=2 * EACH + 1).map(|tool| format!("T{tool} P{tool} Z1\n")).collect();
    place.write("tool.tbl", tools);
    let set = |words: &str| {
        let words: Vec<&str> = words.split(' ').chain(["--tools", "tool.tbl"]).collect();
        let answer = place.ask(&[&["offsets", "set"][..], &words].concat());
        assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    };
    std::thread::scope(|scope| {
        for first in [1, 1 + EACH] {
            scope.spawn(move || (first..first + EACH).for_each(|tool| set(&format!("T{tool} X{tool}"))));
        }
        scope.spawn(|| (0..EACH).for_each(|_| set(&format!("T{} --add X0.5", 2 * EACH + 1))));
    });
    let expected: Vec<String> = (1..=2 * EACH)
        .map(|tool| format!("T{tool} P{tool} Z1 X{tool}"))
        .chain([format!("T{0} P{0} Z1 X{1}", 2 * EACH + 1, EACH / 2)])
        .collect();
    let text = std::fs::read_to_string(place.at("tool.tbl")).expect("it is there");
    assert_eq!(text.lines().collect::<Vec<_>>(), expected);
}

/// The setup of a part and the wear of its tools may be files of their own; a word stands in one of them.
#[test]
fn several_files_are_loaded_at_once_or_not_at_all() {
    let place = shop();
    let files = ["--parameters", "shop/lathe.var", "--tools", "shop/tool.tbl"];
    place.write("setup.txt", "G54 X0 Z-112.4\n");
    place.write("wear.txt", "T1 Z24.98\n");
    place.write("twice.txt", "G54 Z-100\n");
    let load = |names: &[&str]| place.ask(&[&["offsets", "load"], names, &files].concat());
    let before = fs::read_to_string(place.at("shop/lathe.var")).expect("it is there");
    let refused = load(&["setup.txt", "twice.txt"]);
    assert_eq!(refused.status, Some(2));
    assert!(refused.stderr.contains("Z of G54 stands twice"), "{}", refused.stderr);
    assert_eq!(fs::read_to_string(place.at("shop/lathe.var")).expect("it is there"), before);
    let loaded = load(&["setup.txt", "wear.txt"]);
    assert_eq!(loaded.status, Some(0), "{}", loaded.stderr);
    let listed = place.ask(&[&["offsets", "list"][..], &files].concat()).stdout;
    assert!(listed.contains("Z-112.4") && listed.contains("Z24.98"), "{listed}");
}
