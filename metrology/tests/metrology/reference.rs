//! `threads.json`: limits from public tables, some of which are known to be wrong.

use metrology::Thread;
use serde::Deserialize;
use testing::reference::read;

use crate::compare::{Cell, Sizes, cells};

/// What the file has, and the standards do not: name, size, why.
const FAULTS: [(&str, &str, &str); 10] = [
    (
        "M14x1.25-6g/6H",
        "D2_max",
        "T_D2 of 170 for 180, as in the rows of M16x1.25 and M18x1.25 of the same table",
    ),
    ("Tr175x8-7e/7H", "d3_max", "a_c of 0.25 for 0.5: ISO 2901 has 0.5 from P = 6 to 12"),
    ("Tr175x8-7e/7H", "d3_min", "the same"),
    ("Tr175x8-7e/7H", "D_min", "the same"),
    ("Tr95x12-7e/7H", "d2_min", "T_d2 of the range above 180 mm"),
    ("Tr95x12-7e/7H", "d3_min", "the same"),
    ("Tr95x12-7e/7H", "D2_max", "T_D2 of the range above 180 mm"),
    ("Rd80 x 1/6", "d2", "a misprint of 77.883: a pitch diameter above the nominal one"),
    ("module worm m3 z1=2 d44", "gamma_deg", "the angle of a rounded tangent: arctan 6/44 is 7.765166"),
    ("NPT 2 1/2-8", "E1", "2.762156 in full, one unit of the last place away"),
];

#[derive(Deserialize)]
struct File {
    threads: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    id: String,
    standard: String,
    published: Members,
    mm: Members,
    /// Where the file itself says that it differs from the formula, and why.
    #[serde(default)]
    marked: serde_json::Value,
}

#[derive(Deserialize)]
struct Members {
    ext: Option<Sizes>,
    int: Option<Sizes>,
}

/// Every published size of a text like the file beside ours, and whether it is known to differ.
pub(crate) fn of(text: &str) -> Vec<(Cell, bool)> {
    all(serde_json::from_str(text).expect("of the form of the file"))
}

fn all(File { threads }: File) -> Vec<(Cell, bool)> {
    assert!(!threads.is_empty(), "no cases");
    let mut all = Vec::new();
    for case in threads {
        let thread: Thread = case.id.parse().unwrap_or_else(|misread| panic!("{}: {misread}", case.id));
        assert_eq!(thread.standard(), case.standard, "{}", case.id);
        for cell in cells(&case.id, case.published.ext.as_ref(), case.published.int.as_ref()) {
            let fault =
                FAULTS.iter().any(|(id, key, _)| (*id, *key) == (case.id.as_str(), cell.key.as_str()));
            let marked = fault || case.marked.get(&cell.key).is_some();
            all.push((cell, marked));
        }
    }
    all
}

#[test]
fn reference_threads_agree_in_the_last_place_or_differ_as_they_are_known_to() {
    let wrong = all(read("threads.json")).into_iter().filter(|(cell, marked)| cell.agrees() == *marked);
    let wrong: Vec<String> = wrong.map(|(cell, _)| cell.to_string()).collect();
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// The same sizes in mm, which a document has.
#[test]
fn reference_threads_agree_in_mm() {
    let File { threads } = read("threads.json");
    for case in threads {
        let limits = case.id.parse::<Thread>().expect("the other test reads it").limits();
        for (side, member) in limits.members() {
            let published = match side {
                metrology::Side::External => &case.mm.ext,
                metrology::Side::Internal => &case.mm.int,
            };
            for (size, mm) in member.sizes_mm() {
                let Some(want) = published.as_ref().and_then(|sizes| sizes.get(size.key(side))) else {
                    continue;
                };
                let fault = FAULTS.iter().any(|(id, key, _)| (*id, *key) == (&case.id, size.key(side)));
                let marked = fault || case.marked.get(size.key(side)).is_some();
                // The file has four places.
                assert!(
                    marked || (mm - want).abs() < 0.51e-4,
                    "{} {}: {mm}, {want}",
                    case.id,
                    size.key(side)
                );
            }
        }
    }
}
