//! `threads.json`: limits from public tables, some of which are known to be wrong.

use metrology::{Side, Thread};
use serde::Deserialize;
use serde_json::Value;
use testing::reference::read;

use crate::compare::{Cell, Sizes, cells};

/// What the file has, and the standards do not: name, size, what it has, why.
const FAULTS: [(&str, &str, f64, &str); 10] = [
    ("M14x1.25-6g/6H", "D2_max", 13.358, "T_D2 of 170 for 180, as M16x1.25 and M18x1.25 of that table"),
    ("Tr175x8-7e/7H", "d3_max", 166.5, "a_c of 0.25 for 0.5: ISO 2901 has 0.5 from P = 6 to 12"),
    ("Tr175x8-7e/7H", "d3_min", 165.837, "the same"),
    ("Tr175x8-7e/7H", "D_min", 175.5, "the same"),
    ("Tr95x12-7e/7H", "d2_min", 88.3, "T_d2 of the range above 180 mm"),
    ("Tr95x12-7e/7H", "d3_min", 81.177, "the same"),
    ("Tr95x12-7e/7H", "D2_max", 89.71, "T_D2 of the range above 180 mm"),
    ("Rd80 x 1/6", "d2", 87.883, "a misprint of 77.883: a pitch diameter above the nominal one"),
    ("module worm m3 z1=2 d44", "gamma_deg", 7.765148, "the angle of a rounded tangent"),
    ("NPT 2 1/2-8", "E1", 2.76215, "2.762156 in full, one unit of the last place away"),
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
    /// Where the file itself says that it differs from the formula: keys, or a text that names them.
    #[serde(default)]
    marked: Value,
}

#[derive(Deserialize)]
struct Members {
    ext: Option<Sizes>,
    int: Option<Sizes>,
}

impl Members {
    fn of(&self, side: Side) -> Option<&Sizes> {
        match side {
            Side::External => self.ext.as_ref(),
            Side::Internal => self.int.as_ref(),
        }
    }
}

impl Case {
    /// Whether a published size is known to be wrong.
    fn is_known(&self, key: &str, published: f64) -> bool {
        let fault = |(id, of, value, _): &(&str, &str, f64, &str)| {
            (*id, *of) == (self.id.as_str(), key) && *value == published
        };
        let marked = match &self.marked {
            Value::Object(keys) => keys.contains_key(key),
            Value::Array(keys) => keys.iter().any(|of| of == key),
            Value::String(text) => {
                text.split(|letter: char| !letter.is_alphanumeric() && letter != '_').any(|of| of == key)
            }
            _ => false,
        };
        marked || FAULTS.iter().any(fault)
    }
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
        let cells = cells(&case.id, case.published.of(Side::External), case.published.of(Side::Internal));
        all.extend(cells.into_iter().map(|cell| {
            let known = case.is_known(&cell.key, cell.published);
            (cell, known)
        }));
    }
    all
}

#[test]
fn reference_threads_agree_in_the_last_place_or_differ_as_they_are_known_to() {
    let wrong = all(read("threads.json")).into_iter().filter(|(cell, known)| cell.agrees() == *known);
    let wrong: Vec<String> = wrong.map(|(cell, _)| cell.to_string()).collect();
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// The same sizes in mm, four places, as they stand in a document.
#[test]
fn reference_threads_agree_in_mm() {
    let File { threads } = read("threads.json");
    let mut compared = 0;
    for case in threads {
        let limits = case.id.parse::<Thread>().expect("the other test reads it").limits();
        for (side, member) in limits.members() {
            let (mm, published) = (case.mm.of(side), case.published.of(side));
            for (size, got) in member.sizes_mm() {
                let key = size.key(side);
                let Some((want, published)) =
                    mm.and_then(|mm| mm.get(key)).zip(published.and_then(|all| all.get(key)))
                else {
                    continue;
                };
                let known = case.is_known(key, *published);
                assert!(known || (got - want).abs() < 0.51e-4, "{} {key}: {got}, {want}", case.id);
                compared += 1;
            }
        }
    }
    assert!(compared > 0, "nothing to compare");
}
