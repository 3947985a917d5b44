//! Names: forms that people write, refusals with place and remedy, and any bytes at all.

use metrology::{Misread, Thread, UNDERSTOOD};
use proptest::prelude::*;

fn read(name: &str) -> String {
    name.parse::<Thread>().map_or_else(|misread| panic!("{name}: {misread}"), |thread| thread.to_string())
}

#[test]
fn names_are_completed() {
    for (written, complete) in [
        ("M20", "M20x2.5-6g/6H"),
        ("M20x2", "M20x2-6g/6H"),
        ("m20X2", "M20x2-6g/6H"),
        ("M 20 × 1,5 - 6g", "M20x1.5-6g"),
        ("M20*2-6H/6g", "M20x2-6g/6H"),
        ("M6-4g6g", "M6x1-4g6g"),
        ("M1.2", "M1.2x0.25-6h/5H"),
        ("M20x2-LH", "M20x2-6g/6H LH"),
        ("M20x2-6g-LH", "M20x2-6g LH"),
        ("M16xPh3P1.5-6H", "M16xPh3P1.5-6H"),
        ("M16x3P1.5", "M16xPh3P1.5-6g/6H"),
        ("MJ6x1", "MJ6x1-4h6h/4H5H"),
        ("Tr40x7", "Tr40x7-7e/7H"),
        ("TR40X14P7", "Tr40x14P7-7e/7H"),
        ("Tr40x14(P7)LH-8e", "Tr40x14P7-8e LH"),
        ("1/4-20 UNC", "1/4-20 UNC-2A/2B"),
        ("#10-32 UNF-2A", "10-32 UNF-2A"),
        ("No. 10-32 UNF 2B", "10-32 UNF-2B"),
        ("10-32 UNF-3A/3B", "10-32 UNF-3A/3B"),
        ("0-80 unf-2a", "0-80 UNF-2A"),
        ("1-8 UNC-2A", "1-8 UNC-2A"),
        ("1 1/8-8 UNR-2A", "1 1/8-8 UNR-2A"),
        ("1-1/8-7 UNC-1A", "1 1/8-7 UNC-1A"),
        (".250-28 UNRF-2A", "0.25-28 UNRF-2A"),
        ("1/4 UNC-2A", "1/4-20 UNC-2A"),
        ("#10 UNF", "10-32 UNF-2A/2B"),
        ("10 UNF", "10-32 UNF-2A/2B"),
        ("2 1/4 UNC-3B", "2 1/4-4.5 UNC-3B"),
        ("1.0625 UNEF", "1.0625-18 UNEF-2A/2B"),
        ("1/2-10 ACME", "1/2-10 ACME-2G"),
        ("1.0-5 ACME", "1.0-5 ACME-2G"),
        ("G1.0", "G1-A"),
        ("3/4-6 ACME internal", "3/4-6 ACME-2G internal"),
        ("1/2-14 NPT", "NPT 1/2-14"),
        ("3/4 NPT", "NPT 3/4-14"),
        ("G1/2", "G1/2-A"),
        ("G 1 1/4 B", "G1 1/4-B"),
        ("Rp1/2", "Rp1/2"),
        ("3/16-24 BSW", "BSW 3/16-24"),
        ("Rd80x1/6", "Rd80 x 1/6"),
        ("worm m3 z1=2 d44", "module worm m3 z1=2 d44"),
        ("worm dp8 z1=2 d44", "worm DP8 z1=2 d44"),
    ] {
        assert_eq!(read(written), complete);
        assert_eq!(read(complete), complete);
    }
}

/// Number 1 has 64 threads and more; one inch has up to 32.
#[test]
fn a_bare_number_is_a_small_size_or_inches() {
    for (name, major_mm) in [
        ("2-56 UNC", 2.1844),
        ("1-72 UNF", 1.8542),
        ("1-32 UN", 25.4),
        ("12-24 UNC", 5.4864),
        ("2-8 UN", 50.8),
    ] {
        let thread: Thread = name.parse().expect("a name");
        assert!((thread.profile().major_mm - major_mm).abs() < 1e-9, "{name}");
    }
}

/// What is refused, the part of it that is pointed at, and words of message and help.
#[test]
fn refusals_have_their_place_and_a_remedy() {
    let mut wrong = Vec::new();
    for (name, part, words) in [
        ("", "", "M20x2-6g"),
        ("Q20", "Q", "1/4-20 UNC-2A"),
        ("M", "", "diameter is missing"),
        ("M20x", "", "pitch is missing"),
        ("M20x2q", "q", "is not understood"),
        ("M21", "21", "no coarse pitch"),
        ("M400x4", "400", "355 mm"),
        ("M20x1.3", "1.3", "1.25, 1.5"),
        ("M5x4", "4", "a third"),
        ("M20x2-6k", "6k", "e, f, g or h"),
        ("M20x2-6c", "6c", "a, b, c and d"),
        ("M20x2-6AZ", "6A", "965-5"),
        ("M20x2-6E", "6E", "G or H"),
        ("M20x2-7h6h/2H", "2H", "grades 4, 5, 6, 7, 8"),
        ("M20x2-6g6H", "6g6H", "write a /"),
        ("M20x2-6g/6h", "6g/6h", "two classes"),
        ("M3x0.5-8g", "8g", "0.8"),
        ("MJ4x0.7", "4", "needs a class"),
        ("M16xPh3P2", "3P2", "not a number of pitches"),
        ("Tr40", "40", "Tr40x7"),
        ("Tr40x7.5", "7.5", "7, 8, 9"),
        ("Tr40x7-6e", "6e", "8c, 9c"),
        ("Tr40x7-8c", "8c", "7e and 8e"),
        ("1/4 UN", "1/4", "threads per inch"),
        ("1 UNC", "1", "threads per inch"),
        ("1/4-28 UNC", "1/4-28", "1/4-20"),
        ("3/16-24 UNF-2A", "3/16-24", "3/16-24 UNS"),
        ("1/4-20", "", "series"),
        ("1/4-20 UNX-2A", "UNX", "UNEF"),
        ("1/4-20 UNJC-1A", "1A", "2A and 3A"),
        ("BUTT 2-4", "BUTT", "size comes first"),
        ("1/4-20 BUTT-2A", "1/4-20", "1/2 to 12 in"),
        ("2-4 BUTT-1A", "1A", "2A and 3A"),
        ("2 BUTT", "2", "threads per inch"),
        ("2-4 PUSH", "PUSH", "not known"),
        ("1/4-20 UNC-4A", "4A", "1A, 2A, 3A"),
        ("1/4-2 UNS", "1/4-2", "do not fit"),
        ("#7-32 UNC", "#7", "6, 8, 10"),
        ("#10-32 BSW", "#10-32", "only unified"),
        ("#10-22 UNS", "#10-22", "0.190-22 UNS"),
        ("UNC 1/4-20", "UNC", "size comes first"),
        ("1/2-10 ACME-2C", "2C", "centralizing"),
        ("1/2-13 NPT", "1/2-13", "1/2-14 NPT"),
        ("7/16 NPT", "7/16", "3/8, 1/2"),
        ("1/2-14 NPTF", "NPTF", "B1.20.3"),
        ("G9", "9", "5 1/2, 6"),
        ("S20x3", "S", "buttress"),
        ("BSPP 1/2", "BSPP", "G1/2-A"),
        ("Rd80x1/7", "80x1/7", "10, 8, 6 or 4"),
        ("M20x2-6g internal", "M20x2-6g internal", "other member"),
    ] {
        let misread = name.parse::<Thread>().expect_err(name);
        let Misread { span, message, help } = &misread;
        let shown = name.get(span.clone()).unwrap_or_else(|| panic!("{name}: {span:?}"));
        if shown != part || !format!("{message} {help}").contains(words) {
            wrong.push(format!("{name}: {shown:?} {message}; {help}"));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// The list for people shows names that are understood.
#[test]
fn what_is_said_to_be_understood_is() {
    let mut count = 0;
    for line in UNDERSTOOD.lines() {
        let names = line.split("   ").next().expect("a line has names").split(", ");
        for name in names.filter(|name| !name.contains("behind any")) {
            read(name);
            count += 1;
        }
    }
    assert!(count > 20, "{count}");
}

/// Whatever is read has finite limits and a name that is read as the same; whatever is not has a place.
fn check(text: &str) -> Result<(), TestCaseError> {
    match text.parse::<Thread>() {
        Ok(thread) => {
            for (side, member) in thread.limits().members() {
                for (size, mm) in member.sizes_mm() {
                    prop_assert!(mm.is_finite() && mm > 0.0, "{text}: {} {mm}", size.key(side));
                }
            }
            prop_assert!(thread.profile().triangle_mm() > 0.0 && !thread.note().is_empty());
            let name = thread.to_string();
            prop_assert_eq!(name.parse::<Thread>(), Ok(thread), "{}", text);
        }
        Err(Misread { span, message, help }) => {
            prop_assert!(text.get(span).is_some() && !message.is_empty() && !help.is_empty(), "{text}");
        }
    }
    Ok(())
}

const KNOWN: [&str; 17] = [
    "M20x2-6g/6H",
    "M16xPh3P1.5-4g6g LH",
    "MJ6x1-4h6h/4H5H",
    "Tr40x14(P7)LH-8e/8H",
    "Tr10x2-8c",
    "1/4-20 UNC-2A/2B",
    "1 1/8-8 UNRS-3A external",
    "#10-32 UNF-3A",
    "1/4-28 UNJF-3A/3B",
    "2.5-8 PUSH-BUTT-2A LH",
    "1.125-5 ACME-3G internal",
    "NPT 1 1/2-11.5",
    "G1 1/4-B",
    "Rp1/2",
    "Rd105 x 1/4",
    "module worm m3 z1=2 d44",
    "worm DP8 z1=2 d44",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn any_text_is_read_or_refused(text in any::<String>()) {
        check(&text)?;
    }

    /// Names with bytes changed, left out, doubled and swapped with those of others.
    #[test]
    fn mutations_of_names_are_read_or_refused(
        name in proptest::sample::select(KNOWN.to_vec()),
        other in proptest::sample::select(KNOWN.to_vec()),
        edits in prop::collection::vec((0_usize..40, 0_u8..4, "[ -~×,½]"), 1..6),
    ) {
        let mut letters: Vec<char> = name.chars().collect();
        for (at, kind, letter) in edits {
            let at = at % (letters.len() + 1);
            match kind {
                0 => letters.insert(at, letter.chars().next().unwrap_or(' ')),
                1 => drop(letters.drain(at.min(letters.len())..(at + 1).min(letters.len()))),
                2 => letters.splice(at.., other.chars().skip(at)).for_each(drop),
                _ => letters.extend(other.chars().take(at)),
            }
        }
        check(&letters.into_iter().collect::<String>())?;
    }
}
