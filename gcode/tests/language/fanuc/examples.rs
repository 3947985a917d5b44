//! The programs of `examples/fanuc`.

use super::recorded::{fanuc, run};
use gcode::Program;

#[test]
fn examples_are_sound() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/fanuc");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let mut options = fanuc();
        options.tools =
            gcode::files::ToolTable::parse("tools", "T1 D1.6 Q3\nT2 D0.8 Q3\nT3 Q8\nT4 Q8\nT5 Q7\n").unwrap();
        let path = entry.unwrap().path();
        let outcome = run(Program::open(&path, &options).unwrap());
        let said: Vec<String> = outcome
            .errors
            .iter()
            .chain(&outcome.warnings)
            .map(|diagnostic| diagnostic.render(false))
            .collect();
        assert!(said.is_empty(), "{}", said.concat());
        // A tap is a call of its own, between few moves; the domed face is cut in three passes.
        let least = match path.file_name().and_then(|name| name.to_str()) {
            Some("tap-peck.nc") => 3,
            Some("domed-face.nc") => 15,
            _ => 30,
        };
        assert!(outcome.sink.moves.len() > least, "{}: {}", path.display(), outcome.sink.moves.len());
        count += 1;
    }
    assert_eq!(count, 8);
}
