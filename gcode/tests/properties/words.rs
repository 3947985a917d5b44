//! No word is ignored: a block that is accepted without one of its words does something else, in one of the
//! states that it may meet.

use gcode::Dialect;
use proptest::prelude::*;

use crate::blocks::{Effect, block, effect};

/// States a block may meet. What a word changes shows in at least one of them.
const BEFORE: &[&str] = &[
    "G21 G90 G94 G8 G17 G97 F77 S300 M3\nG0 X31 Y11 Z23 A1 B1 C1",
    "G20 G91 G95 G7 G18 G99 G90.1 G61.1 F.01 S200 M4\nG0 X.4 Y.3 Z.4\nG90.1 G90\nG2 X.4 Z2.4 I.2 K1.4\nG91",
    "T1 M6\nG43 G55 G19 G93 M8 M49\nG92 X1 Y2 Z3 A4 B5 C6\nG1 X9 Y8 Z7 F3\nM70\nG94 G17",
    "G18 G7 G64 P.5 Q.5\nM53 P0\nF90 S500 M3\nG96 D900 S50\nG0 X40 Z30\nG33 Z10 K2",
    "F50 S100 M3 T4 M6\nG10 L2 P1 X5 Y6 Z7 R20\nG10 L2 P2 X1\nG52 X1 Y1 Z1 A1 B1 C1\nG92.2\nM70\nG98 G81 X1 Y1 Z-3 R20 L2",
    "T1 M6\nG43 F50 G18\nM50 P0\nM51 P0\nM52 P1\nG42.1 D.2 L1\nG1 X5 Z9\nX7 Z19",
    "T4 M6\nF50 G17 G41 D4\nG1 X5 Y9\nX35 Y9",
    "G18 G8 T2 M6\nF50 S100 M3\nG0 X100 Z50\nG30.1\nG28.1\nG80\nM5",
    "F50 G98\nG0 X8 Y4 Z9\nG99 G83 X1 Y1 Z-3 R4 Q1",
];

/// Shows what is in force.
const AFTER: &str = "(DEBUG,#<_feed>)\nX.7 Y.3 Z.2\nG40\nG0 X3 Y4 Z5 A1 B2 C3\nG1 X9 Y8 Z7 F3\nG91 X.1\nM72\nG90 X1\nG0 X0 Y0 Z0\n\
    G17 G2 X2 Y0 I1 F2\nG1 X4 Y4 Z4 F1\nG81 Z-3 R9 F2\nG80\nG92.3\nG0 X1 Y1 Z1 A1 B1 C1\nG55 G0 X2 Y2 Z2\nG54\nG28\nG30\nG0 Z20\nG81 X1 Z-3 R2 F9\nG80\nM6\n\
    G43\nG0 X1 Y1 Z1\nT3 M6\nG43\nG0 X1 Y1 Z1\nG41\nG1 X5 Y5 F9\nG40\nM48\nM3\nG97 S100\nM5\nM9\n\
    (DEBUG,#5220 #5399 #<_feed> #<_rpm> #<_metric> #<_absolute> #<_lathe_diameter_mode> #<_motion_mode> #5211 #5410)\nM2";

const BEFORE_FANUC: &[&str] = &[
    "G21 G97 G99 S300 M03 F.2\nG00 X50. Z5.",
    "G20 G98 F5.\nT0101 M08\nG97 S200 M04\nG00 X2. Z.4",
    "T0303 S200 M03\nG50 S2500\nG96 S200\nG00 X60. Z60.\nG42 G01 X30. Z5. F.2\nZ-5.",
    "G55 T0202 S400 M03 F.3\nG52 X1. Z1.\nG00 X40. Z4.\nG76 P031030 Q50 R.1",
    "S400 M03 F.3\nG00 X40. Z4.\nG90 X30. Z-20. R-2.\nX28.",
    "S400 M03 F.3\nG00 X40. Z4.\nG92 X30. Z-20. F2. R-2. Q90000\nX28.",
    "S400 M03 F.3\nG00 X40. Z4.\nG94 X30. Z-2. R-2.\nZ-3.",
    "S400 M03 F.3\nG00 X0 Z4.\nG98",
    "S100 M03 F.3\nG00 X0 Z4.\nG74 R3.\nG75 R2.\nG41 G01 X10.",
];

const AFTER_FANUC: &str = "X29. Z2.\nU1. W-1.\nG40\nG00 X50. Z6.\nG01 X51. F.2\nG04 P1\nG74 Z-20. Q3000 F.1\nG75 X20. P2000 F.1\n\
    M03 S100\nG76 X26. Z-20. P1840 Q400 F1.5\nG80\nG96 S100\nG97 S100\nT0200\nG01 X1. Z1.\nT0202\nG00 X3. Z3.\nG54 X3. Z4.\nG55 X3.\nM05\nM09\nM30";

const BEFORE_MILL: &[&str] = &[
    "G21 S300 M03 F77.\nG00 X31. Y11. Z23. A1. B1. C1.",
    "G20 G91 S200 M04 G95 F.01\nG18 G99 G61 G00 X.4 Y.3 Z.4\nG90 G02 X.4 Z2.4 I.2 K1.\nG91",
    "T1 M06\nG43 H1 G55 G19 M08 S100 M03\nG92 X1. Y2. Z3. A4. B5. C6.\nG93 G01 X9. Y8. Z7. F3.\nG17",
    "F50. S100 M03\nG10 L2 P1 X5. Y6. Z7.\nG52 X1. Y1. Z1.\nG10 L20 P3 X4.\nG54.1 P3\nG98 G81 X1. Y1. Z-3. R20. K2",
    "T4 M06\nF50. S100 M03\nG41 D4 G01 X5. Y9.\nX35. Y9.",
    "T3 M06\nS100 M03 F50.\nG44 H3 G00 X8. Y4. Z9.\nG99 G83 X1. Y1. Z-3. R4. Q1. F30.",
    "S100 M03 F50.\nG00 X8. Y4. Z9.\nG68 X1. Y1. R20.\nG00 X3.",
    "S100 M03 F50. D2 H2\nG00 X100. Y4. Z50. M08\nG80\nM05",
];

const AFTER_MILL: &str = "X.7 Y.3 Z.2\nG40\nG00 X3. Y4. Z5. A1. B2. C3.\nG01 X9. Y8. Z7. F3.\nG91 X.1\nG90 X1.\nG00 X0. Y0. Z0.\nG17 G02 X2. Y0. I1. J0.\n\
    G81 Z-3. R9. F2.\nG82 X1.\nG83 X2. Q1.\nX3. K2\nG80\nG69\nG00 X1. Y1. Z1.\nG55 G00 X2. Y2. Z2.\nG54 X1.\nG54.1 P4 X1. Y2.\nG54\n\
    G43 G00 Z9.\nG28 X1. Y1. Z1.\nG43 H1 Z4.\nG43 H2 Z4.\nG49\nT2 M06\nG41 G01 X20. Y20.\nX30. Y0.\nG40 X40.\nX0.\nT4 M06\nG41 G01 X20. Y20.\nX30. Y0.\nG40\nX0.\nG41 D4 X20. Y20.\nX30.\nG40 X50.\nX0.\n\
    M06\nG43 Z3.\nM03\nG97 S100\nG94 F20.\nX7.\nM05\nM09\nM30";

/// Words that may say what is so without them: the only spindle, one turn of an arc, one hole, the factor 1,
/// every cut of G76 alike, what M52 and M66 do; G80 ends cycles that this control does not have.
fn may_do_nothing(dialect: Dialect, word: &str, words: &[String]) -> bool {
    let beside = |codes: &[&str]| words.iter().any(|other| codes.contains(&other.as_str()));
    match word {
        "$0" => true,
        "P1" | "P2" if beside(&["M50", "M51", "M52", "M53"]) => true,
        "P1" => beside(&["G2", "G3"]),
        "L0" => beside(&["M66"]),
        "K1" | "L1" => ('1'..='9').any(|last| beside(&[&format!("G8{last}")])) || beside(&["G73", "G74"]),
        "I1" => beside(&["G33.1"]),
        "R1" => beside(&["G76"]),
        "G80" => dialect == Dialect::Fanuc,
        _ => false,
    }
}

fn no_word_is_ignored(dialect: Dialect, words: &[String]) -> Result<(), TestCaseError> {
    let (befores, after) = match dialect {
        Dialect::Linuxcnc => (BEFORE, AFTER),
        Dialect::Fanuc => (BEFORE_FANUC, AFTER_FANUC),
        Dialect::FanucMill => (BEFORE_MILL, AFTER_MILL),
    };
    let line = |before: &str| before.lines().count() as u32 + 1;
    let of =
        |before: &str, words: &[&str]| effect(dialect, &format!("{before}\n{}\n{after}\n", words.join(" ")));
    let all: Vec<&str> = words.iter().map(String::as_str).collect();
    let whole: Vec<_> = befores.iter().map(|before| of(before, &all)).collect();
    let accepted =
        |(before, effect): (&&str, &Effect)| effect.errors.iter().all(|(at, _)| *at != line(before));
    if !befores.iter().zip(&whole).any(accepted) {
        return Ok(());
    }
    for (n, word) in words.iter().enumerate() {
        let mut without = all.clone();
        without.remove(n);
        let does = |words: &[&str], whole: &Effect, before: &str| of(before, words) != *whole;
        let seen = befores.iter().zip(&whole).any(|(before, whole)| does(&without, whole, before));
        // A code may name what is in force in all states that accept the other words. Alone it has to do
        // something.
        let is_code = word.starts_with(['G', 'M']);
        let seen = seen || is_code && befores.iter().any(|before| does(&[], &of(before, &[word]), before));
        prop_assert!(
            seen || may_do_nothing(dialect, word, words),
            "{word} of \"{}\" does nothing",
            all.join(" ")
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_word_is_ignored_linuxcnc(words in block(Dialect::Linuxcnc)) {
        no_word_is_ignored(Dialect::Linuxcnc, &words)?;
    }

    #[test]
    fn no_word_is_ignored_fanuc(words in block(Dialect::Fanuc)) {
        no_word_is_ignored(Dialect::Fanuc, &words)?;
    }

    #[test]
    fn no_word_is_ignored_on_a_fanuc_mill(words in block(Dialect::FanucMill)) {
        no_word_is_ignored(Dialect::FanucMill, &words)?;
    }
}

/// A state that is not reached would show nothing.
#[test]
fn states_are_reached_without_errors() {
    let of = |dialect, befores: &[&str], end| {
        for before in befores {
            let effect = effect(dialect, &format!("{before}\n{end}\n"));
            assert_eq!(effect.errors, [], "{before}");
        }
    };
    of(Dialect::Linuxcnc, BEFORE, "G40\nM2");
    of(Dialect::Fanuc, BEFORE_FANUC, "G40 M30");
    of(Dialect::FanucMill, BEFORE_MILL, "G40\nM30");
}

/// What the properties found.
#[test]
fn words_without_effect_are_reported() {
    let warned = |dialect, text: &str| effect(dialect, text).warnings.join("\n");
    let inverse = "G93\nF4\nG1 X1 F2\nG94\nM2\n";
    assert_eq!(
        warned(Dialect::Linuxcnc, inverse),
        "no-effect F does nothing here: under G93 it is for the move of its block alone"
    );
    let begin = "S400 M03 F.3\nG00 X50. Z4.\nG74 R1.\nG75 R1.\n";
    let pecks = warned(Dialect::Fanuc, &format!("{begin}G74 Z-20. P2000 Q3000\nG75 X20. P2000 Q3000\nM30\n"));
    assert!(pecks.contains("P does nothing here") && pecks.contains("Q does nothing here"), "{pecks}");
    let both = warned(Dialect::Fanuc, &format!("{begin}G74 X40. Z-20. P2000 Q3000\nM30\n"));
    assert!(!both.contains("does nothing"), "{both}");
}
