//! The order of execution: a block does the same as its codes in lines of their own, in the order that the
//! language says.

use gcode::Dialect;
use proptest::prelude::*;

use crate::blocks::effect;

/// One of each list, or none, in the order in which LinuxCNC executes them.
const STAGES: &[&[&str]] = &[
    &["G97"],
    &["G94", "G95"],
    &["F90"],
    &["S700"],
    &["T1", "T3"],
    &["M6"],
    &["M3", "M4", "M5"],
    &["M7", "M9"],
    &["M8"],
    &["M48", "M49", "M50 P0", "M53 P1"],
    &["G17", "G18", "G19"],
    &["G20", "G21"],
    &["G7", "G8"],
    &["G40"],
    &["G49", "G43"],
    &["G54", "G55", "G59.1"],
    &["G61", "G61.1", "G64"],
    &["G90", "G91"],
    &["G90.1", "G91.1"],
    &["G98", "G99"],
    &[
        "G52 X1 Z2",
        "G92 X1 Y3",
        "G10 L2 X3 Z4 R0",
        "G28",
        "G30.1",
        "G0 X3 Y2",
        "G1 X7 Z4",
        "G38.3 Z3",
        "G80",
        "X5 Y7",
    ],
    &["M0", "M1", "M60"],
];

/// The same for FANUC.
const STAGES_FANUC: &[&[&str]] = &[
    &["T0101", "T0202"],
    &["G97"],
    &["G98", "G99"],
    &["F.3"],
    &["S300"],
    &["M03", "M04", "M08"],
    &["G40"],
    &["G54", "G55"],
    &["G00 X40. Z3.", "G01 U3. W-1.", "X30."],
    &["M00", "M01", "M05", "M09"],
];

/// The same on a mill of FANUC.
const STAGES_MILL: &[&[&str]] = &[
    &["G94", "G95"],
    &["F90."],
    &["S700"],
    &["T1 M06", "T3"],
    &["M03", "M04", "M08"],
    &["G17", "G18"],
    &["G90", "G91"],
    &["G98", "G99"],
    &["G69"],
    &["G54", "G55", "G54.1 P3"],
    &["G43 H1", "G49", "G44 H2"],
    &["G00 X4. Z3.", "G01 Y3. A1.", "X3.", "G28 Z9.", "G52 X1.", "G81 Z-3. R2.", "G92 X1. Y3."],
    &["M00", "M01", "M05", "M09"],
];

const BEFORE: &str = "G21 F100 S200 M3\nG0 X1 Y2 Z3";
const BEFORE_FANUC: &str = "G21 F.1 S200 M03\nG00 X50. Z6.";
const BEFORE_MILL: &str = "G21 F100. S200 M03\nG00 X1. Y2. Z3.";

fn stages(stages: &'static [&'static [&'static str]]) -> impl Strategy<Value = Vec<&'static str>> {
    prop::collection::vec(any::<prop::sample::Index>(), stages.len()).prop_flat_map(move |indexes| {
        let chosen: Vec<&'static str> =
            stages.iter().zip(indexes).map(|(stage, index)| stage[index.index(stage.len())]).collect();
        let count = chosen.len();
        prop::sample::subsequence(chosen, 1..count.min(8))
    })
}

fn split(dialect: Dialect, before: &str, parts: &[&str]) -> Result<(), TestCaseError> {
    let together = effect(dialect, &format!("{before}\n{}\nX9. Z8.\nM30\n", parts.join(" ")));
    if !together.errors.is_empty() {
        return Ok(());
    }
    let apart = effect(dialect, &format!("{before}\n{}\nX9. Z8.\nM30\n", parts.join("\n")));
    prop_assert_eq!((together.calls, together.errors), (apart.calls, apart.errors));
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_block_is_its_codes_one_after_the_other(parts in stages(STAGES)) {
        split(Dialect::Linuxcnc, BEFORE, &parts)?;
    }

    #[test]
    fn a_block_of_a_fanuc_mill_is_its_codes_one_after_the_other(parts in stages(STAGES_MILL)) {
        split(Dialect::FanucMill, BEFORE_MILL, &parts)?;
    }

    #[test]
    fn a_fanuc_block_is_its_codes_one_after_the_other(parts in stages(STAGES_FANUC)) {
        split(Dialect::Fanuc, BEFORE_FANUC, &parts)?;
    }
}
