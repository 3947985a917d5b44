//! `pitchlock thread NAME`: programs that cut it, of two hundred names, in both dialects, judged by the
//! gauge; `--limits`: limits as a table and as a document; refusals with place and remedy.

use machine::{Machine, ProgramDialect};
use protocol::Code;

use crate::shop::{Place, project};
use serde_json::Value;

fn document(place: &Place, name: &str) -> Value {
    let answer = place.ask(&["thread", name, "--limits", "--json"]);
    assert_eq!(answer.status, Some(0), "{name}: {}", answer.stderr);
    serde_json::from_str(&answer.stdout).expect("one document and nothing else")
}

#[test]
fn a_document_has_the_members_of_the_name_in_mm() {
    let place = Place::new();
    let both = document(&place, "M20x2");
    let asked = [&both["name"], &both["complete"], &both["standard"]];
    assert_eq!(asked.map(|text| text.as_str()), ["M20x2", "M20x2-6g/6H", "ISO 965 M"].map(Some));
    assert_eq!((&both["ext"]["d2_max"], &both["ext"]["d2_min"]), (&18.663.into(), &18.503.into()));
    assert_eq!((&both["int"]["D1_min"], &both["int"]["D_min"]), (&17.835.into(), &20.0.into()));
    assert!(both.get("inch").is_none());

    let screw = document(&place, "1/4-20 UNC-2A");
    assert!(screw.get("int").is_none());
    assert_eq!((&screw["ext"]["d2_max"], &screw["inch"]["ext"]["d2_max"]), (&5.49656.into(), &0.2164.into()));

    let two = document(&place, "Tr40x14P7 LH external");
    let profile = &two["profile"];
    assert_eq!(
        (&profile["lead_mm"], &profile["starts"], &profile["left_hand"]),
        (&14.0.into(), &2.into(), &true.into())
    );
}

/// Every name of the reference is one that the command takes, and gives its sizes.
#[test]
fn reference_threads_have_their_keys() {
    let folder = std::env::var_os("PITCHLOCK_REFERENCE_DIR");
    let folder = folder.map_or_else(|| project().join("tests/reference"), std::path::PathBuf::from);
    let text = std::fs::read_to_string(folder.join("threads.json")).expect("there is a reference");
    let reference: Value = serde_json::from_str(&text).expect("a document");
    let cases = reference["threads"].as_array().expect("cases");
    assert!(!cases.is_empty());
    let place = Place::new();
    for case in cases.iter().step_by(5) {
        let id = case["id"].as_str().expect("a name");
        let got = document(&place, id);
        assert_eq!((&got["name"], &got["standard"]), (&case["id"], &case["standard"]));
        for member in ["ext", "int"] {
            for key in case["published"][member].as_object().iter().flat_map(|sizes| sizes.keys()) {
                assert!(got[member][key].is_f64(), "{id}: {member} {key}: {got}");
            }
        }
    }
}

#[test]
fn a_table_shows_inches_where_the_standard_is_in_inches() {
    let place = Place::new();
    let answer = place.ask(&["thread", "1 1/8-7", "UNC-2A", "--limits"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    for line in [
        "1 1/8-7 UNC-2A, ASME B1.1 UN\n",
        "external           mm       in\n",
        "d2_max        26.1620   1.0300  largest pitch diameter\n",
    ] {
        assert!(answer.stdout.contains(line), "{line}{}", answer.stdout);
    }
    assert!(!answer.stdout.contains("internal"), "{}", answer.stdout);
}

#[test]
fn what_is_not_understood_is_shown_with_what_is() {
    let place = Place::new();
    for (name, words) in [
        (
            "M20x2-6k",
            ["  M20x2-6k\n        ^^\n", "help: a screw has position e, f, g or h", "1/4-20 UNC-2A/2B"],
        ),
        ("1/2-14 NPTF", ["         ^^^^\n", "ASME B1.20.3", "NPT 1/2-14"]),
        ("½ inch", ["  ^", "write a name as in", "G1/2-A"]),
    ] {
        let answer = place.ask(&["thread", name, "--limits"]);
        assert_eq!((answer.status, answer.stdout.as_str()), (Some(2), ""), "{name}");
        assert!(words.iter().all(|word| answer.stderr.contains(word)), "{name}: {}", answer.stderr);
    }
    let answer = place.ask(&["thread", "M20"]);
    assert_eq!((answer.status, answer.stdout.as_str()), (Some(2), ""));
    assert!(answer.stderr.contains("as in M20x2-6g or M20x2-6H"), "{}", answer.stderr);
}

/// What docs/metrology.md and docs/recipe.md show is what the command prints.
#[test]
fn the_page_shows_what_is_printed() {
    let place = Place::new();
    let pages = ["docs/metrology.md", "docs/recipe.md"].map(|page| project().join(page));
    let page = pages.map(|page| std::fs::read_to_string(page).expect("there is a page")).concat();
    let mut shown = 0;
    for block in page.split("\n```text\n$ pitchlock ").skip(1) {
        let (command, rest) = block.split_once('\n').expect("a command and what it prints");
        let printed = rest.split("\n```").next().unwrap_or_default();
        let answer = place.ask(&command.split_whitespace().collect::<Vec<_>>());
        let got = format!("{}{}", answer.stdout, answer.stderr);
        assert_eq!(got.trim_end(), printed.trim_end(), "{command}");
        shown += 1;
    }
    assert!(shown >= 4, "{shown}");
}

/// A line of `names.txt`: name, tool, more arguments.
fn asked(line: &str) -> Vec<String> {
    let mut parts = line.split('|').map(str::trim);
    let mut args = vec![parts.next().expect("a name").to_owned()];
    if let Some(tool) = parts.next().filter(|tool| !tool.is_empty()) {
        args.extend(["--tool".to_owned(), tool.to_owned()]);
    }
    args.extend(parts.flat_map(str::split_whitespace).map(str::to_owned));
    args
}

/// The threads that are written.
fn names() -> impl Iterator<Item = &'static str> {
    include_str!("names.txt").lines().filter(|line| !line.starts_with('#'))
}

/// What is written of a thread in a dialect.
fn written(place: &Place, line: &str, dialect: &str) -> Value {
    let mut args = vec!["thread".to_owned(), "--json".into(), "--dialect".into(), dialect.into()];
    args.extend(asked(line));
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let answer = place.ask(&args);
    assert_eq!(answer.status, Some(0), "{line}: {}", answer.stderr);
    serde_json::from_str(&answer.stdout).expect("a document")
}

/// The machine file with the tools that a recipe is for.
fn with_its_tools(recipe: &Value) -> String {
    let tool = &recipe["tool"];
    let number = |key: &str| tool[key].as_f64().expect("a number");
    let angle: f64 = tool["flank_deg"].as_array().expect("two").iter().filter_map(Value::as_f64).sum();
    let [nose, width] = ["nose_mm", "width_mm"].map(number);
    let width = if width > 0.0 { format!("width_mm = {width}\n") } else { String::new() };
    format!(
        "{}\n[tools.1]\nname = \"turning\"\n[tools.2]\nname = \"boring\"\n[tools.3]\nname = \"thread\"\n\
         angle_deg = {angle}\nnose_mm = {nose}\n{width}",
        machine::SMALL_LATHE
    )
}

/// Whether two passes say the same: a lead in inches, or along a cone, is told with eight places.
fn same(one: &Code, other: &Code) -> bool {
    let is_number = |c: char| c.is_ascii_digit() || c == '.' || c == 'e' || c == '-';
    let [one, other] = [one, other].map(|code| format!("{code:?}"));
    let [one, other] = [&one, &other].map(|text| text.split(|c: char| !is_number(c)));
    let close = |(a, b): (&str, &str)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 1e-6 * a.abs().max(1e-3),
        _ => a == b,
    };
    one.clone().count() == other.clone().count() && one.zip(other).all(close)
}

/// Both dialects make the same passes, of every thread.
#[test]
fn both_dialects_make_the_same_passes() {
    let place = Place::new();
    assert!(names().count() >= 200);
    for line in names() {
        let recipes = ["linuxcnc", "fanuc"].map(|dialect| written(&place, line, dialect));
        let passes = [ProgramDialect::Linuxcnc, ProgramDialect::Fanuc].map(|dialect| {
            let recipe = &recipes[usize::from(dialect == ProgramDialect::Fanuc)];
            let mut machine = Machine::from_toml(&with_its_tools(recipe)).expect("a machine");
            machine.general.dialect = dialect;
            let check = interpreter::check(line, recipe["program"].as_str().expect("a program"), &machine);
            assert!(check.is_good(), "{line}: {:?}", check.diagnostics);
            let passes = check.items.into_iter().map(|item| item.code);
            passes.filter(|code| matches!(code, Code::Pass(_))).collect::<Vec<_>>()
        });
        let [one, other] = &passes;
        assert!(!one.is_empty() && one.len() == other.len(), "{line}: {} {}", one.len(), other.len());
        let differ = one.iter().zip(other).find(|(one, other)| !same(one, other));
        assert!(differ.is_none(), "{line}: {differ:#?}");
    }
}

/// The threads by name are cut on the machine that is built in, and their gauges find them good: every
/// eighth of them, or all with `PITCHLOCK_THREADS=all`.
#[test]
fn threads_by_name_are_good() {
    let place = Place::new();
    let every = if std::env::var_os("PITCHLOCK_THREADS").is_some_and(|all| all == "all") { 1 } else { 8 };
    for line in names().step_by(every).chain(names().filter(|line| every > 1 && line.contains("--"))) {
        let recipe = written(&place, line, "linuxcnc");
        place.write("part.ngc", recipe["program"].as_str().expect("a program"));
        place.write("tools.toml", with_its_tools(&recipe));
        place.clear("out");
        let run =
            ["run", "part.ngc", "--machine", "tools.toml", "--in-process", "--trace", "none", "--out", "out"];
        let answer = place.ask(&run);
        let gauge =
            answer.stdout.lines().find(|line| line.starts_with("gauge ")).unwrap_or_default().to_owned();
        assert!(answer.status == Some(0) && gauge.contains(" good: "), "{line}: {gauge}\n{}", answer.stderr);
    }
}

/// What is wished wrongly is told with what would be right, and nothing is written.
#[test]
fn wishes_out_of_range_are_refused() {
    let place = Place::new();
    for (args, told) in [
        (&["M20x2"][..], "the screw or the nut?"),
        (&["M20x2-6g", "--tool", "16ER1.5ISO"], "its pitch is 1.5000 mm"),
        (&["M20x2-6g", "--tool", "16QQ"], "16ER2.0ISO"),
        (&["M20x2-6g", "--length", "0"], "length: 0 is not within"),
        (&["M20x2-6g", "--length", "900"], "this machine cannot cut it"),
        (&["M20x2-6g", "--start", "0.1"], "start farther off"),
        (&["M20x2-6g", "--passes", "0"], "0 is not in 1..=200"),
        (&["M20x2-6g", "--most-force", "0"], "force: 0 is not within"),
        (&["M20x2-6g", "--most-power", "1e9"], "power: 1000000000 is not within"),
        (&["M20x2-6g", "--most-force", "20"], "lower the least cut"),
        (&["M20x2-6g", "--most-force", "200", "--passes", "9"], "cannot be used with"),
        (&["M20x2-6g", "--speed", "90000"], "speed: 90000 is not within"),
        (&["M20x2-6g", "--off-flank", "2", "--infeed", "radial"], "--infeed modified"),
        (&["M20x2-6g", "--pitch-diameter", "19..18"], "is not a range"),
        (&["M20x2-6g", "--tool", "A60 R2"], "its tip is wider"),
        (&["M20x2-6g", "--tool", "A60 R0.5"], "too blunt"),
        (&["Tr40x7-7e"], "--tool 22ERTR7"),
        (&["Tr40x14P7-7H", "LH"], "--tool 22ILTR7"),
        (&["BSW 1/2-12 external"], "--pitch-diameter LEAST..MOST"),
        (&["M2-6H"], "no way back"),
    ] {
        let args: Vec<&str> = ["thread", "-o", "part.ngc"].iter().chain(args).copied().collect();
        let answer = place.ask(&args);
        assert_eq!(answer.status, Some(2), "{args:?}: {}", answer.stderr);
        assert!(answer.stderr.contains(told), "{args:?}: {}", answer.stderr);
        assert!(!place.at("part.ngc").exists(), "{args:?}");
    }
}

/// A program that is there is left alone: somebody may have changed it.
/// No pass takes more than is allowed, one pass fewer would, and every force is that of Kienzle's law.
#[test]
fn force_and_power_set_the_number_of_passes() {
    let place = Place::new();
    let of = |more: &str| {
        let mut args = vec!["thread", "--json", "M20x2-6g", "--infeed", "radial", "--law", "depth"];
        args.extend(more.split_whitespace());
        let answer = place.ask(&args);
        let written: Value = serde_json::from_str(&answer.stdout).expect("a document");
        let passes = written["passes"].as_array().expect("passes").clone();
        let most = passes.iter().filter_map(|pass| pass["force_n"].as_f64()).fold(0.0, f64::max);
        (written, passes, most)
    };
    let (_, by_pitch, most) = of("");
    assert!(most > 400.0, "{most}");
    let (document, passes, most) = of("--most-force 300");
    assert!(most <= 300.0 && passes.len() > by_pitch.len(), "{most}");
    let (.., one_fewer) = of(&format!("--passes {}", passes.len() - 1));
    assert!(one_fewer > 300.0, "{one_fewer}");
    let mut before = 0.0;
    for pass in &passes {
        let [depth, area, force] =
            ["depth_mm", "area_mm2", "force_n"].map(|key| pass[key].as_f64().expect(key));
        // A sharp tool of 60°, straight in: both flanks.
        let tangent = libm::tan(30f64.to_radians());
        assert!((area - tangent * (depth * depth - before * before)).abs() < 1e-9, "{pass}");
        let edge = 2.0 * depth / libm::cos(30f64.to_radians());
        let told = 1500.0 * area * libm::pow(area / edge, -0.22);
        assert!((force - told).abs() < 1e-6, "{force} {told}");
        before = depth;
    }
    let speed = document["speed_m_min"].as_f64().expect("a speed");
    let power = document["power_kw"].as_f64().expect("a power");
    assert!((power - most * speed / 60e3).abs() < 1e-9, "{power}");
    let (document, ..) = of("--most-power 0.5");
    assert!(document["power_kw"].as_f64().expect("a power") <= 0.5, "{document}");
}

#[test]
fn a_program_that_is_there_is_not_overwritten() {
    let place = Place::new();
    let first = place.ask(&["thread", "M20x2-6g", "-o", "bolt.ngc"]);
    assert_eq!(first.status, Some(0), "{}", first.stderr);
    let text = std::fs::read_to_string(place.at("bolt.ngc")).expect("a program");
    let second = place.ask(&["thread", "M24x3-6g", "-o", "bolt.ngc"]);
    assert_eq!(second.status, Some(2));
    assert_eq!(std::fs::read_to_string(place.at("bolt.ngc")).expect("the same"), text);
    assert!(first.stderr.contains("outside   19.822 mm"), "{}", first.stderr);
}

/// A number that cannot be is refused with what can, below 0 as well.
#[test]
fn numbers_out_of_range_are_refused_with_their_range() {
    let place = Place::new();
    place.write("part.ngc", "G0 X50\nM2\n");
    for (arguments, told) in [
        (&["thread", "M6x1-6g", "--springs", "-1"][..], "-1 is not in 0..=20"),
        (&["thread", "M6x1-6g", "--passes", "0"], "0 is not in 1..=200"),
        (&["thread", "M6x1-6g", "--passes", "-3"], "-3 is not in 1..=200"),
        (&["thread", "M6x1-6g", "--tool-number", "100"], "100 is not in 1..=99"),
        (&["thread", "M6x1-6g", "--speed", "-5"], "speed: -5 is not within 1 to 3000"),
        (&["thread", "M6x1-6g", "--length", "-4"], "length: -4 is not within 0.1 to 2000"),
        (&["thread", "M6x1-6g", "--start", "-2"], "start: -2 is not within 0.1 to 500"),
        (&["thread", "M6x1-6g", "--nose", "-1"], "a nose has 0 to 10 mm"),
        (&["thread", "M6x1-6g", "--least-cut", "-1"], "least cut: -1 is not within 0.001 to 0.5"),
        (&["thread", "M6x1-6g", "--most-force", "-1"], "force: -1 is not within 1 to"),
        (&["thread", "M6x1-6g", "--most-power", "-1"], "power: -1 is not within 0.001 to 1000"),
        (&["thread", "M6x1-6g", "--infeed", "modified", "--off-flank", "-3"], "-3 is not within 0 to 30"),
        (&["run", "part.ngc", "--seed", "-1"], "a seed is a whole number from 0 to"),
        (&["run", "part.ngc", "--seed", "1.5"], "a seed is a whole number from 0 to"),
        (&["run", "part.ngc", "--pace", "-1"], "0.05 to 1000, or max"),
        (&["run", "part.ngc", "--watchdog-s", "-1"], "seconds, 0 to 1000000"),
        (&["check", "part.ngc", "--certify", "--seed", "-1"], "a seed is a whole number from 0 to"),
        (&["check", "part.ngc", "--block-delete=-1"], "-1 is not in 1..=9"),
    ] {
        let answer = place.ask(arguments);
        assert_eq!(answer.status, Some(2), "{arguments:?}: {}", answer.stderr);
        assert!(answer.stderr.contains(told), "{arguments:?}: {}", answer.stderr);
    }
    assert!(!place.at("runs").exists(), "nothing ran");
}

/// What makes a speed lower than usual is said; a pitch that has no end is written in six decimals.
#[test]
fn the_reason_of_a_speed_is_told_and_names_are_short() {
    let place = Place::new();
    let slow = place.ask(&["thread", "M6x1-6g", "--material", "aluminium", "-o", "bolt.ngc"]);
    assert_eq!(slow.status, Some(0), "{}", slow.stderr);
    assert!(
        slow.stderr.contains("does no more (3000 1/min, spindle.max_rpm)")
            || slow.stdout.contains("spindle.max_rpm")
    );
    let own = ["thread", "1/4-12 UNS-2A", "--pitch-diameter", "4.9..5", "-o", "own.ngc"];
    let answer = place.ask(&own);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let program = std::fs::read_to_string(place.at("own.ngc")).expect("it is written");
    assert!(program.contains("(thread, P2.116667 D2 4.9000..5.0000 A60"), "{program}");
}
