//! Rigid taps: M29, G84 and G74.

use gcode::canon::{X, Y, Z};
use gcode::{Call, Dialect, Options, Place, Problem, Program, Sink};

use crate::driven::driven;

use super::recorded::{errors, outcome};

/// What turns and what moves along Z.
#[derive(Default)]
struct Taps(Vec<String>);

impl Sink for Taps {
    fn call(&mut self, _: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
        let text = match call {
            Call::StraightTraverse(end) => format!("rapid {} {} {}", end[X], end[Y], end[Z]),
            Call::StraightFeed(end) => format!("feed {}", end[Z]),
            Call::RigidTap(end, faster, dwell) => format!("tap {} x{faster} dwell {dwell}", end[Z]),
            Call::StartSpeedFeedSynch { lead, .. } => format!("lead {lead}"),
            Call::StopSpeedFeedSynch => return Ok(()),
            Call::StartSpindle(turn) => format!("{turn:?}"),
            Call::StopSpindle => "stop".to_owned(),
            Call::SetSpindleSpeed(s) => format!("S{s}"),
            _ => return Ok(()),
        };
        self.0.push(text);
        Ok(())
    }
}

/// What a program comes to, without faults, and the codes that it is warned of.
fn taps(dialect: Dialect, text: &str) -> (Vec<String>, Vec<&'static str>) {
    let options = Options { dialect, ..Options::default() };
    let text = format!("{text}\nM30\n");
    let driven = driven(Program::from_text("O0001.nc", text.as_str(), &options), Taps::default());
    assert!(driven.errors.is_empty(), "{:?}", driven.errors);
    (driven.sink.0, driven.warnings.iter().map(|warning| warning.code).collect())
}

#[test]
fn a_lathe_taps_from_r_and_goes_back_to_where_it_began() {
    let (made, warned) = taps(Dialect::Fanuc, "G97 M05\nG00 X0. Z10.\nM29 S500\nG84 Z-15. R5. F1.25\nG80");
    let wanted = [
        "stop",
        "rapid 0 0 10",
        "S500",
        "rapid 0 0 10",
        "rapid 0 0 5",
        "Clockwise",
        "lead 1.25",
        "tap -15 x1 dwell 0",
        "stop",
        "rapid 0 0 10",
        "stop",
    ];
    assert_eq!((made.as_slice(), warned.len()), (&wanted.map(str::to_owned)[..], 0));
    // Per minute F is lead times S; P waits at the bottom; a spindle that turns turns on.
    let (made, _) =
        taps(Dialect::Fanuc, "G97 S500 M03\nG00 X0. Z10.\nM29 S500\nG98 G84 Z-15. R5. P300 F625.\nG80");
    assert_eq!(made[6..10], ["lead 1.25", "tap -15 x1 dwell 0.3", "rapid 0 0 10", "stop"], "{made:?}");
}

#[test]
fn a_tap_in_pecks_comes_out_to_r_each_time() {
    let (made, _) =
        taps(Dialect::Fanuc, "G97 S500 M03\nG00 X0. Z10.\nM29 S500\nG84 Z-15. R5. Q8. F1.25\nG80");
    let depths: Vec<&String> = made.iter().filter(|made| made.starts_with("tap")).collect();
    assert_eq!(depths, ["tap -3 x1 dwell 0", "tap -11 x1 dwell 0", "tap -15 x1 dwell 0"]);
    assert_eq!(made.iter().filter(|made| *made == "lead 1.25").count(), 3);
}

/// A tap that goes in twice, for a clean thread.
#[test]
fn a_lathe_taps_as_often_as_k_says() {
    let (made, warned) = taps(Dialect::Fanuc, "G97 M05\nG00 X0. Z10.\nM29 S500\nG84 Z-15. R5. F1.25 K2\nG80");
    assert_eq!((made.iter().filter(|made| *made == "tap -15 x1 dwell 0").count(), warned.len()), (2, 0));
    let (pecks, _) = taps(Dialect::Fanuc, "G97 M05\nG00 X0. Z10.\nM29 S500\nG84 Z-15. R5. Q8. F1.25 K2\nG80");
    assert_eq!(pecks.iter().filter(|made| made.starts_with("tap")).count(), 6, "{pecks:?}");
}

#[test]
fn a_mill_taps_every_hole_with_either_hand() {
    let text = "G00 X0. Y0. Z20.\nM29 S400\nG99 G84 X10. Z-12. R3. F500.\nX20.\nG80";
    let (made, warned) = taps(Dialect::FanucMill, text);
    assert_eq!(warned.len(), 0);
    let hole = ["Clockwise", "lead 1.25", "tap -12 x1 dwell 0", "stop", "rapid 10 0 3"];
    let at = made.iter().position(|made| made == "Clockwise").expect("it taps");
    assert_eq!(made[at..at + 5], hole, "{made:?}");
    assert_eq!(made.iter().filter(|made| made.starts_with("tap")).count(), 2);
    let (made, _) =
        taps(Dialect::FanucMill, "G00 X0. Y0. Z20.\nM29 S400\nG95 G74 X10. Z-12. R3. Q5. F1.25\nG80");
    assert!(made.contains(&"Counterclockwise".to_owned()), "{made:?}");
    let depths: Vec<&String> = made.iter().filter(|made| made.starts_with("tap")).collect();
    assert_eq!(depths, ["tap -2 x1 dwell 0", "tap -7 x1 dwell 0", "tap -12 x1 dwell 0"]);
}

#[test]
fn a_tap_that_nobody_announced_is_rigid_and_told() {
    let lathe = "G97 S500 M03\nG00 X0. Z10.\nG84 Z-15. R5. F1.25\nZ-16.\nG80";
    let (made, warned) = taps(Dialect::Fanuc, lathe);
    assert!(made.iter().any(|made| made.starts_with("tap")) && warned == ["rigid-tap"], "{warned:?}");
    let mill = "S400 M03\nG00 X0. Y0. Z20.\nG84 X10. Z-12. R3. F500.\nG80";
    assert_eq!(taps(Dialect::FanucMill, mill).1, ["rigid-tap"]);
}

#[test]
fn what_no_tap_has_is_refused() {
    let start = "G00 X0. Z10.\n";
    assert_eq!(errors(&format!("{start}M29 S500\nG84 Z-15. R5.")), [(3, "missing-word")]);
    assert_eq!(errors(&format!("{start}M29\nG84 Z-15. R5. F1.25")), [(3, "missing-word")]);
    assert_eq!(errors(&format!("G97 S500 M04\n{start}M29\nG84 Z-15. R5. F1.25")), [(4, "spindle-direction")]);
    assert_eq!(errors(&format!("{start}M29 S500\nG84 Z-15. R5. Q-2. F1.25")), [(3, "bad-value")]);
    let surface = outcome(&format!("G50 S2000\nG96 S100 M03\n{start}M29\nG84 Z-15. R5. F1.25\nM30\n"));
    assert_eq!(surface.errors.first().map(|error| error.code), Some("bad-value"), "{:?}", surface.errors);
}
