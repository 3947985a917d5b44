//! What a run keeps of itself, and what is measured for the next one: any bytes in its place.

use std::sync::LazyLock;

use gauge::pickup::{self, Asked, pick_up};
use interpreter::{Interpreter, Language};
use machine::Machine;
use protocol::Item;
use rig::{
    journal::{State, has_other_version, latest},
    observe::Summary,
    replay::Arrivals,
    resume,
};
use zerocopy::FromBytes as _;

/// The bytes as the summary of a run: what can be read can be written and read again.
pub fn summary(bytes: &[u8]) {
    if let Ok(summary) = serde_json::from_slice::<Summary>(bytes) {
        let text = serde_json::to_string(&summary).expect("it can be written");
        assert!(serde_json::from_str::<Summary>(&text).is_ok(), "{text}");
    }
}

/// The bytes as the language of a run folder: what can be read can be written and read again as the same.
pub fn language(bytes: &[u8]) {
    match toml::from_str::<Language>(&String::from_utf8_lossy(bytes)) {
        Ok(language) => {
            let text = toml::to_string(&language).expect("it can be written");
            assert_eq!(toml::from_str(&text), Ok(language), "{text}");
        }
        Err(refused) => assert!(!refused.to_string().is_empty()),
    }
}

/// The bytes as the arrivals of a run: refused by a line, or written and read again as the same.
pub fn arrivals(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else { return };
    match Arrivals::from_text(text) {
        Ok(arrivals) if arrivals.gap.is_none() => {
            // It is written by this version, whoever wrote what was read.
            let again = Arrivals::from_text(&arrivals.text());
            let by = again.as_ref().ok().and_then(|again| again.by.clone());
            assert_eq!(again, Ok(Arrivals { by, ended: true, ..arrivals }));
        }
        Ok(_) => {}
        Err(refused) => assert!(refused.starts_with("line "), "{refused}"),
    }
}

/// The bytes as the arrivals of a run whose processes were all killed: the lines before the first damaged
/// one.
pub fn arrivals_live(bytes: &[u8]) {
    let left = Arrivals::left(bytes);
    let changes: Vec<u64> = left.changes.iter().map(|(cycle, ..)| *cycle).collect();
    // A line that is whole and means something else was not written by us.
    let known = [5004, 5005, 7000, 7100];
    assert!(changes.iter().zip(known).all(|(read, written)| *read == written), "{changes:?}");
}

/// A lathe and a program of it, read once.
static PROGRAM: LazyLock<(Machine, Vec<Item>)> = LazyLock::new(|| {
    let machine = Machine::plain();
    let text =
        "G18 G21 G90 G8 G94 G97\nM3 S800\nG0 X12 Z12\nG1 Z5 F600\nG0 X9\nG33 Z-6 K1.5\nG0 X12\nM5\nM2\n";
    let items = Interpreter::of_text("fuzz", text.to_string(), &machine).map_while(Result::ok).collect();
    (machine, items)
});

/// The bytes as a journal; and as what a whole record of one says, by which a program is gone on with from
/// where the machine is at home: refused, or a plan.
pub fn journal(bytes: &[u8]) {
    let _ = (latest::<State>(bytes), has_other_version::<State>(bytes));
    let mut content = [0; size_of::<State>()];
    content.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
    let Ok(state) = State::read_from_bytes(&content) else { return };
    let (machine, items) = &*PROGRAM;
    match resume::plan(machine, || items.iter().copied(), &state, &machine.home()) {
        Ok(plan) => assert!(plan.before.iter().all(|item| item.check().is_ok()), "{plan:?}"),
        Err(refused) => assert!(!refused.to_string().is_empty()),
    }
}

/// The bytes as a trace in each of its forms: rows, or refused by the name of the file.
pub fn trace(bytes: &[u8]) {
    for form in ["mcap", "csv"] {
        let path = std::env::temp_dir().join(format!("pitchlock-fuzz-{}.{form}", std::process::id()));
        std::fs::write(&path, bytes).expect("room for temporary files");
        let mut rows = 0;
        let read = rig::trace::read(&path, |_| rows += 1);
        let _ = std::fs::remove_file(&path);
        if let Err(refused) = read {
            assert!(refused.to_string().contains("pitchlock-fuzz"), "{refused}");
        }
    }
}

/// The bytes as touches of a thread: refused by a line, or a thread that is found or not.
pub fn touches(bytes: &[u8]) {
    match pickup::touches(&String::from_utf8_lossy(bytes)) {
        Ok(touches) => {
            let asked = Asked { lead_mm: -2.0, starts: 2, noise_mm: 0.005, lead_error_mm: 0.01 };
            if let Ok(found) = pick_up(&touches, &asked) {
                assert!(found.lead_mm.value.is_finite() && found.phase_mm.value.is_finite(), "{found:?}");
            }
        }
        Err(refused) => assert!(refused.starts_with("line "), "{refused}"),
    }
}
