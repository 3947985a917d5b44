//! Outputs and inputs. In: the changes of a summary. Out: a table of them in the order of their coming.

use rig::observe::Summary;

use crate::table::{Column, Table, six};

/// So many changes are shown.
const SHOWN: usize = 200;

struct Change<'a> {
    cycle: u64,
    at_s: f64,
    line: u32,
    what: &'static str,
    number: u32,
    name: &'a str,
    state: String,
}

/// The table; nothing if no output and no input changed.
pub(super) fn table(summary: &Summary) -> Option<Table> {
    let on = |on: bool| if on { "on" } else { "off" }.to_owned();
    let change = |cycle: u64, line, what, number, name, state| {
        let at_s = cycle as f64 * summary.cycle_s;
        Change { cycle, at_s, line, what, number, name, state }
    };
    let outputs = summary.outputs.iter();
    let outputs = outputs.map(|one| change(one.cycle, one.line, "output", one.number, &one.name, on(one.on)));
    let analog = summary.analog_outputs.iter();
    let analog =
        analog.map(|one| change(one.cycle, one.line, "analog", one.number, &one.name, six(one.value)));
    let inputs = summary.inputs.iter();
    let inputs = inputs.map(|one| change(one.cycle, one.line, "input", one.number, &one.name, on(one.on)));
    let mut changes: Vec<Change<'_>> = outputs.chain(analog).chain(inputs).collect();
    if changes.is_empty() {
        return None;
    }
    changes.sort_by_key(|change| change.cycle);
    let more = changes.len().saturating_sub(SHOWN);
    changes.truncate(SHOWN);
    let columns = [
        Column { name: "Time", unit: "s", cell: |one: &Change<'_>| format!("{:.3}", one.at_s) },
        Column { name: "Line", unit: "", cell: |one| one.line.to_string() },
        Column { name: "What", unit: "", cell: |one| format!("{} {}", one.what, one.number) },
        Column { name: "Name", unit: "", cell: |one| one.name.to_owned() },
        Column { name: "State", unit: "", cell: |one| one.state.clone() },
    ];
    let told = if more > 0 { format!(" {more} more changes are in summary.json.") } else { String::new() };
    let caption = "An output changes in the tick that is told, an input in the first cycle that shows it. The line \
                   is the one executed then; 0 before the program.";
    Some(Table::of("Outputs and inputs", &columns, &changes).with_caption(format!("{caption}{told}")))
}

#[cfg(test)]
mod tests {
    use rig::observe::{AnalogReport, SignalReport, Summary};

    use super::{SHOWN, table};

    fn signal(number: u32, on: bool, cycle: u64) -> SignalReport {
        SignalReport { number, name: format!("name {number}"), on, line: 7, cycle }
    }

    #[test]
    fn changes_stand_in_the_order_of_their_coming() {
        let air = AnalogReport { number: 1, name: "air".into(), value: 2.5, line: 8, cycle: 1500 };
        let summary = Summary {
            cycle_s: 0.001,
            outputs: vec![signal(3, true, 1000), signal(3, false, 3000)],
            analog_outputs: vec![air],
            inputs: vec![signal(2, true, 2000)],
            ..Summary::default()
        };
        let rows = table(&summary).expect("there are changes").rows;
        let rows: Vec<String> = rows.iter().map(|row| row.join("|")).collect();
        assert_eq!(
            rows,
            [
                "1.000|7|output 3|name 3|on",
                "1.500|8|analog 1|air|2.5",
                "2.000|7|input 2|name 2|on",
                "3.000|7|output 3|name 3|off",
            ]
        );
        assert!(table(&Summary::default()).is_none());
        let many = (0..SHOWN as u64 + 5).map(|cycle| signal(1, cycle % 2 == 0, cycle)).collect();
        let many = table(&Summary { outputs: many, ..Summary::default() }).expect("there are changes");
        assert!(many.rows.len() == SHOWN && many.caption.contains("5 more changes"), "{}", many.caption);
    }
}
