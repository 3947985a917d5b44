//! Blocks that say something: codes with the words they need, words they may have, and words that belong to
//! nothing; and what a program does, as text.

use gcode::files::{Tool, ToolTable};
use gcode::{Call, Dialect, Limits, Options, Place, Problem, Program, Sink, Step};
use proptest::prelude::*;

/// Codes with the words they need, and after `|` words they may have.
pub(crate) const LINUXCNC: &[&str] = &[
    "G0|X1.5 Y-2 Z3 A4 F20 G53 G40",
    "G1|X1.5 Y-2 Z3 B5 C-6 F20 G53 G91",
    "G1 @5 ^30|Z2 F30",
    "G2 X41 Y21 I5 J5|Z4 P2 F10 G17",
    "G3 X38 Y18 R12|Z2 F15 P1 G17",
    "G18 G2 X42 Z28 I3 K4|Y4 F10",
    "G4 P1.5|F3 S100 M5",
    "G10 L2 P2 X3|Y4 Z5 R10 A7",
    "G10 L20 P1 Z5|X3 Y4 C2",
    "G10 L1 P3 Z7|X3 Y4 R.5 I10 J20 Q5",
    "G10 L11 P3 Z7|X3 R.5",
    "G28|X1 Z2",
    "G30|Y1",
    "G28.1",
    "G30.1",
    "G33 Z-5 K1.5|X2 $0",
    "G33.1 Z-5 K1.5|I2",
    "G38.2 Z-3|X7 F10",
    "G38.5 Z-3|Y7 F10",
    "G40|X3",
    "G41 D3|X3 G1",
    "G42.1 D2|L2 G0 Z4",
    "G43 H2|G0 X4",
    "G43.1 Z3|X2 G91",
    "G43.2 H4",
    "G49|X7",
    "G52 X3|Y4 Z5",
    "G54|X4",
    "G56|G0 X4",
    "G59.3",
    "G61|G1 X4",
    "G61.1",
    "G64|P.1 Q.2",
    "G73 Z-9 R2 Q3|X4 Y5 L2",
    "G76 P2 Z-20 I-2 J.4 K1.2|R1.5 Q20 H2 E2 L2",
    "G80|X3 G0",
    "G81 Z-3 R2|X4 Y5 L3 G98 G99 G91",
    "G82 Z-3 R2 P.7|X4 L2",
    "G83 Z-3 R2 Q.8|Y5 L2",
    "G84 Z-3 R2|X4 P.5 $0",
    "G85 Z-3 R2|X4 L2",
    "G86 Z-3 R2 P.3|X4",
    "G89 Z-3 R2 P.4|Y4",
    "G92 X3|Y4 Z5",
    "G92.1",
    "G92.2",
    "G92.3",
    "G93|G1 X3 F4",
    "G94|F5",
    "G95|F.5",
    "G96 S100|D2000 M3",
    "G97|S100",
    "T3 M6|G43 S100",
    "T2",
    "M61 Q4|S100",
    "M3|S100 $0",
    "M4|S100",
    "M5",
    "M19 R90|Q2 P1",
    "M7|M8",
    "M9",
    "M48",
    "M50|P0",
    "M51|P0",
    "M52|P1",
    "M53|P0",
    "M62 P3|G1 X4",
    "M65 P2",
    "M66 P1|L3 Q5",
    "M66 E1|L0",
    "M67 E1 Q5",
    "M68 E2 Q6",
    "M70",
    "M71",
    "M72",
    "M0",
    "M1|X3",
    "X4|Y5 Z2 F8 S9",
    "Z-4|R3 L2 P1 Q1",
    "G7|X7",
    "G8|G90 G91 G20 G21 G17 G18 G19 G90.1 G91.1 X8",
    "S400|F30",
    "o2",
];

pub(crate) const FANUC: &[&str] = &[
    "G00|X40. Z2. U3. W-2.",
    "G01|X40. W-2. F.3 ,R1.",
    "G01 Z-20. ,C1.|F.2",
    "G02 X34. Z-12. R10.|F.2",
    "G03 U6. W-4. I0 K-5.|F.2",
    "G04 P500",
    "G04 X1.5",
    "G04 U.5|S300",
    "G10 P2 X.1|Z.2 R.8 Q3",
    "G20|X1. F.01",
    "G21|X33.",
    "G28 U0|W0",
    "G32 Z-20. F2.|X24. Q90000",
    "G40|X40.",
    "G41|G01 X40.",
    "G42|G00 X40. Z2.",
    "G50 S1500",
    "G50 X60.|Z5.",
    "G52 X1.|Z2.",
    "G54|X33.",
    "G57|G00 Z2.",
    "G53 X-10.|Z-20.",
    "G74 R1.",
    "G74 Z-20. Q3000 F.1|X20. P2000 R.2",
    "G75 R.5",
    "G75 X20. P2000 F.1|Z-20. Q3000 R.2",
    "G76 P020060 Q100 R0.05",
    "G76 X26. Z-20. P1840 Q400 F1.5|R-1.",
    "G90 X26. Z-20.|R-1. F.2",
    "G92 X26. Z-20. F1.5|R-1. Q180000",
    "G94 X20. Z-2.|R-1. F.2",
    "G96 S150|M03",
    "G97|S500",
    "G98|F100.",
    "G99|F.1",
    "T0202|X33.",
    "T0100",
    "M03|S300",
    "M05",
    "M08",
    "M09|X33.",
    "M00",
    "M01",
    "X25.|Z3. F.4 S200",
    "U2.|W3.",
    "G80",
];

pub(crate) const FANUC_MILL: &[&str] = &[
    "G00|X4. Y2. Z3. A5.",
    "G01|X4. Y-2. Z3. B5. F30. G90 G91",
    "G02 X34. Y12. R20.|Z2. F20. G17",
    "G03 X36. Y16. I3. J3.|F20. Z1.",
    "G18 G02 X34. Z9. R30.|F20. Y1.",
    "G04 P500",
    "G04 X1.5|S300",
    "G09 G01 X4.|F20.",
    "G10 L2 P1 X1.|Y2. Z3. A4.",
    "G10 L20 P4 X1.|Y2.",
    "G10 L10 P1 R5.",
    "G10 L12 P2 R.3",
    "G17|G01 X3.",
    "G20|X1. F1.",
    "G21|X33.",
    "G28 Z0.|X1.",
    "G30 Z0.|Y1.",
    "G40|X4.",
    "G41 D4|G01 X4. Y20.",
    "G42 D4|G00 X40. Y2.",
    "G43 H1|Z5. G00",
    "G44 H2|G00 Z5.",
    "G49|Z7.",
    "G52 X1.|Y1. Z2.",
    "G54|X3.",
    "G57|G00 Y2.",
    "G54.1 P3|X3.",
    "G154 P2|Y3.",
    "G53 X-1.|Y1.",
    "G61|G01 X3.",
    "G64",
    "G68 X1. Y2. R30.",
    "G69|X3.",
    "G73 Z-9. R2. Q3.|X1. Y5. F20.",
    "G74 Z-9. R2.|X1. F20.",
    "G80|X3. G00",
    "G81 Z-8. R2.|X1. Y3. F80. K2 G98 G99 G91",
    "G82 Z-3. R2. P500|X4. L2",
    "G83 Z-12. R2. Q3.|Y5. K2",
    "G84 Z-3. R2.|X4. F20.",
    "G85 Z-3. R2.|X4.",
    "G86 Z-3. R2.|X4.",
    "G88 Z-3. R2.|X4. P300",
    "G89 Z-3. R2. P200|Y4.",
    "G90|X3.",
    "G91|X3. Z.5",
    "G92 X0.|Y0. Z1.",
    "G93|G01 X1. F4.",
    "G94|F100.",
    "G95|F.1",
    "G97|S500",
    "G98|Z5.",
    "G99|F30.",
    "T3 M06|G43 S100",
    "T2",
    "M03|S300",
    "M04|S300",
    "M05",
    "M08",
    "M09|X3.",
    "M00",
    "M01",
    "X2.|Y3. Z1. F40. S200",
    "H1",
    "D4",
    "Z-4.|R3. K2 P100 Q1.",
];

/// Words that may belong to nothing.
const STRAY: &[&str] = &[
    "P1", "P2", "Q2", "Q3", "R1", "R2.", "L1", "L2", "H1", "D1", "E1", "I1", "J1", "K1", "F7", "S70", "T1",
    "X3.", "Y6.", "Z-9.", "A2", "B2", "C2", "U9.", "V1", "W1.", "@2", "^5", "$0", ",C1.", "G53", "G90",
    "G91", "G80", "G98", "G99", "M7", "M8", "M3", "M9", "M5", "G94", "G17", "G54", "G40", "G61", "M48",
];

/// A block of a dialect, word by word; no letter stands twice with the same code.
pub(crate) fn block(dialect: Dialect) -> impl Strategy<Value = Vec<String>> {
    let shapes = match dialect {
        Dialect::Linuxcnc => LINUXCNC,
        Dialect::Fanuc => FANUC,
        Dialect::FanucMill => FANUC_MILL,
    };
    let chosen = (
        prop::sample::select(shapes),
        any::<u32>(),
        prop::collection::vec(prop::sample::select(STRAY), 0..3),
    );
    chosen.prop_map(|(shape, which, stray)| {
        let (needed, optional) = shape.split_once('|').unwrap_or((shape, ""));
        let optional = optional.split_whitespace().enumerate().filter(|(bit, _)| which >> bit & 1 == 1);
        let mut words: Vec<String> = needed.split_whitespace().map(str::to_owned).collect();
        words.extend(optional.map(|(_, word)| word.to_owned()));
        if which >> 30 == 0 {
            words.extend(stray.into_iter().map(str::to_owned));
        }
        words
    })
}

/// What a program does: its calls, and what is wrong with it (without columns, which move when a word moves).
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Effect {
    pub(crate) calls: Vec<String>,
    /// Lines with errors, and what is said.
    pub(crate) errors: Vec<(u32, String)>,
    pub(crate) warnings: Vec<String>,
}

impl Sink for Effect {
    fn call(&mut self, _: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
        if !matches!(call, Call::Note(_) | Call::Comment(_)) {
            self.calls.push(format!("{call:?}"));
        }
        Ok(())
    }
}

/// Tools 1 to 4: a length, a radius, an orientation; the last one is a mill.
fn tools() -> ToolTable {
    let mut table = ToolTable::default();
    for number in 1..=4 {
        let size = f64::from(number);
        let offset = [size - 0.5, 0.0, 10.0 * size, 0.0, 0.0, 0.0];
        let orientation = if number == 4 { 0 } else { number as u8 + 4 };
        table.set(Tool {
            number,
            pocket: number,
            offset,
            diameter: 0.4 * size,
            orientation,
            ..Tool::default()
        });
    }
    table
}

pub(crate) fn effect(dialect: Dialect, text: &str) -> Effect {
    let limits = Limits { blocks_without_motion: 1000, ..Limits::default() };
    let mut program =
        Program::from_text("p", text, &Options { dialect, tools: tools(), limits, ..Options::default() });
    let mut effect = Effect::default();
    loop {
        match program.step(&mut effect) {
            Ok(Step::More) => {}
            Ok(Step::Ended) => break,
            Err(error) => effect.errors.push((error.line, format!("{} {}", error.code, error.message))),
        }
    }
    let warnings = program.take_warnings();
    effect.warnings =
        warnings.iter().map(|warning| format!("{} {}", warning.code, warning.message)).collect();
    effect
}
