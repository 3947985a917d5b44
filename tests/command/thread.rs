//! `pitchlock thread NAME --limits`: limits as a table and as a document, refusals with place and remedy.

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
    assert!(answer.stderr.contains("add --limits"), "{}", answer.stderr);
}

/// What docs/metrology.md shows is what the command prints.
#[test]
fn the_page_shows_what_is_printed() {
    let place = Place::new();
    let page = std::fs::read_to_string(project().join("docs/metrology.md")).expect("there is a page");
    let mut shown = 0;
    for block in page.split("\n```text\n$ pitchlock ").skip(1) {
        let (command, rest) = block.split_once('\n').expect("a command and what it prints");
        let printed = rest.split("\n```").next().unwrap_or_default();
        let answer = place.ask(&command.split_whitespace().collect::<Vec<_>>());
        let got = format!("{}{}", answer.stdout, answer.stderr);
        assert_eq!(got.trim_end(), printed.trim_end(), "{command}");
        shown += 1;
    }
    assert!(shown >= 2, "{shown}");
}
