//! No word is ignored, and nothing a file can hold makes the interpreter panic.

use std::sync::LazyLock;

use interpreter::{Interpreter, Severity, check};
use machine::Machine;
use proptest::prelude::*;

/// Read once.
static PLAIN: LazyLock<Machine> = LazyLock::new(Machine::plain);

/// States a block may meet. What a word changes shows in at least one of them.
const BEFORE: [&str; 5] = [
    "G21 G90 G94 G8 F77 S300 M3 G0 X31 Z23",
    "G20 G91 G95 G7 F.01 S200 M4\nG1 X-.4 Z-.4",
    "G7 G0 X40 Z30 S150 M3\nG33 Z10 K2",
    "G95 F.2 G7 G0 X40 Z30 S150 M3\nG33 Z10 K2",
    "G0 X60 Z60",
];

/// Blocks that show what is in force: motion, units, diameter, increments, feed, spindle.
const AFTER: &str = "X.7 Z.3\nG1 X.8 Z.4\nG0 X.3 Z.2\nM3\nS123\nM5\nM3\nG4 P.5\nM2";

/// Words that name the only state this machine has: they change nothing wherever they stand.
const WITHOUT_EFFECT: [&str; 6] = ["G18", "G54", "G97", "G90.1", "G91.1", "G91.10"];

/// What a program does, in words; diagnostics without their columns, which move when a word goes.
fn effect(before: &str, block: &str) -> String {
    let program = format!("{before}\n{block}\n{AFTER}\n");
    let mut interpreter = Interpreter::of_text("p", program, &PLAIN);
    let items: Vec<String> = (&mut interpreter)
        .map(|item| match item {
            Ok(item) => format!("{item:?}"),
            Err(error) => format!("{} {} {}", error.line, error.code, error.message),
        })
        .collect();
    let warnings = interpreter.warnings().iter().map(|warning| warning.message.clone());
    items.into_iter().chain(warnings).collect::<Vec<_>>().join("\n")
}

/// Whether the block itself is refused.
fn refused(before: &str, block: &str) -> bool {
    let program = format!("{before}\n{block}\n{AFTER}\n");
    let line = before.lines().count() as u32 + 1;
    Interpreter::of_text("p", program, &PLAIN)
        .filter_map(Result::err)
        .any(|diagnostic| diagnostic.line == line && diagnostic.severity == Severity::Error)
}

/// A word; M2 and M30 are left out, because after them nothing shows what the words beside them changed.
fn word() -> impl Strategy<Value = String> {
    let known = prop::sample::select(vec![
        "G0", "G1", "G4", "G7", "G8", "G18", "G20", "G21", "G33", "G54", "G76", "G90", "G91", "G90.1",
        "G91.1", "G94", "G95", "G97", "M3", "M4", "M5",
    ]);
    let letter = prop::sample::select(('A'..='Z').filter(|c| *c != 'N').collect::<Vec<char>>());
    let value = prop::sample::select(vec!["-13.5", "-1", "0.3", "1.7", "2", "3", "11", "41", "96", "450"]);
    prop_oneof![
        3 => known.prop_map(str::to_owned),
        4 => (letter, value.clone())
            .prop_map(|(letter, value)| format!("{letter}{value}"))
            .prop_filter("ends the program", |word| word != "M2"),
        3 => (prop::sample::select(vec!['X', 'Z', 'F', 'S', 'P', 'K']), value)
            .prop_map(|(letter, value)| format!("{letter}{value}")),
    ]
}

fn block() -> impl Strategy<Value = Vec<String>> {
    let cycle = "G76 P1.7 Z-17 I-2 J0.3 K0.9";
    let whole = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
    let optional =
        prop::sample::subsequence(vec!["R1.7", "Q21", "H2", "L2", "E1.3", "S310", "F5", "G91"], 0..8);
    prop_oneof![
        4 => prop::collection::vec(word(), 1..6),
        1 => optional.prop_map(move |words| {
            whole(cycle).into_iter().chain(words.into_iter().map(str::to_owned)).collect()
        }),
        1 => prop::collection::vec(word(), 0..2)
            .prop_map(move |words| whole("G33 Z-9.5 K1.7").into_iter().chain(words).collect()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, failure_persistence: None, ..ProptestConfig::default() })]

    /// Each word of a block that is accepted changes what the program does, in one of the states before it.
    #[test]
    fn no_word_is_ignored(words in block()) {
        let all = words.join(" ");
        if BEFORE.into_iter().all(|before| refused(before, &all)) {
            return Ok(());
        }
        let effects = BEFORE.map(|before| effect(before, &all));
        for (n, word) in words.iter().enumerate() {
            let without: Vec<&str> =
                words.iter().enumerate().filter(|(m, _)| *m != n).map(|(_, word)| word.as_str()).collect();
            let without = without.join(" ");
            let seen = BEFORE.iter().zip(&effects).any(|(before, all)| *all != effect(before, &without));
            prop_assert!(seen || WITHOUT_EFFECT.contains(&word.as_str()), "{word} of \"{all}\" does nothing");
        }
    }

    #[test]
    fn random_bytes_do_not_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let source = String::from_utf8_lossy(&bytes).into_owned();
        let check = check("random", &source, &PLAIN);
        for diagnostic in &check.diagnostics {
            let _ = diagnostic.render(true);
        }
    }

    #[test]
    fn random_letters_and_digits_do_not_panic(source in "([GMXZFSTPKIJREHLQN#\\[\\]=;%/()*+.,0-9a-z \n-]{0,12}\n?){0,40}") {
        let check = check("random", &source, &PLAIN);
        for diagnostic in &check.diagnostics {
            prop_assert!(!diagnostic.help.is_empty() && diagnostic.line >= 1 && diagnostic.column >= 1);
            let _ = diagnostic.render(false);
        }
    }

    #[test]
    fn random_threads_do_not_panic(
        s in 0.0..4000.0f64, p in -1.0..50.0f64, z in -450.0..250.0f64, i in -30.0..30.0f64, j in 0.0..5.0f64,
        k in 0.0..8.0f64, e in 0.0..40.0f64, l in 0..4u32, q in -80.0..80.0f64, small in prop::bool::ANY,
    ) {
        let scale = if small { 1e-3 } else { 1.0 };
        let (s, p, i) = (s * scale, p * scale, i * scale);
        let cycle = format!("G76 P{p:.6} Z{z:.4} I{i:.6} J{j:.5} K{k:.5} E{e:.4} L{l} Q{q:.2} R2");
        let source = format!("S{s:.4} M3\nG0 X40 Z10\n{cycle}\nG33 X{k:.5} Z{z:.4} K{p:.6}\nG0 X50\nM2\n");
        let check = check("random", &source, &PLAIN);
        prop_assert!(!check.is_good() || check.time_s > 0.0);
    }
}
