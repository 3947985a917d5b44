//! What each tool took: times, ways, forces. In: rows of the trace. Out: a table of s, mm, N, N·m, kW.

use std::collections::BTreeMap;

use protocol::{AxisState, Motion};
use rig::observe::{Summary, power_kw};
use rig::trace::Row;

use crate::table::{Column, Table};

/// A tool over the whole run.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ToolUse {
    number: u32,
    name: String,
    rapid_s: f64,
    feed_s: f64,
    thread_s: f64,
    waits_s: f64,
    way_mm: f64,
    force_max_n: f64,
    /// Sum of the tangential force over the rows in which there was one, and how many they were.
    force_sum_n: f64,
    cuts: u64,
    torque_max_nm: f64,
    power_max_kw: f64,
}

/// Every tool, in the order of their numbers.
#[derive(Clone, Debug, Default)]
pub(super) struct ToolUses {
    tools: BTreeMap<u32, ToolUse>,
    /// The true slides of the linear axes in the row before, and its cycle.
    before: Option<(u64, [f64; 3])>,
}

impl ToolUses {
    /// Takes the next row.
    pub(super) fn add(&mut self, summary: &Summary, row: &Row) {
        let number = row.led.tool;
        let tool = self.tools.entry(number).or_insert_with(|| {
            let name = summary.tools.get(&number).map(|tool| tool.name.clone()).unwrap_or_default();
            ToolUse { number, name, ..ToolUse::default() }
        });
        let apart = row.after(self.before.map(|(cycle, _)| cycle));
        let in_thread = |state| (AxisState::RunIn..=AxisState::RunOut).contains(&state);
        let time = match row.led.motion {
            _ if row
                .axes
                .iter()
                .any(|(_, axis)| in_thread(axis.state) || axis.state == AxisState::Leaving) =>
            {
                &mut tool.thread_s
            }
            Motion::Rapid => &mut tool.rapid_s,
            Motion::Feed => &mut tool.feed_s,
            Motion::None => &mut tool.waits_s,
        };
        // What is left out of a trace between two rows is like the second one: changes are kept.
        *time += apart.unwrap_or(1) as f64 * summary.cycle_s;
        let mut at = [0.0; 3];
        let linear = row.axes.iter().filter(|(axis, _)| !axis.is_rotary());
        at.iter_mut().zip(linear).for_each(|(at, (_, axis))| *at = axis.slide);
        let before = self.before.replace((row.cycle, at));
        if let Some((_, before)) = before.filter(|_| apart.is_some()) {
            let way = at.iter().zip(before).map(|(to, from)| (to - from) * (to - from)).sum::<f64>();
            tool.way_mm += libm::sqrt(way);
        }
        if row.cut.force > 0.0 {
            tool.force_max_n = tool.force_max_n.max(row.cut.force);
            tool.force_sum_n += row.cut.force;
            tool.cuts += 1;
            tool.torque_max_nm = tool.torque_max_nm.max(row.cut.torque.abs());
            tool.power_max_kw = tool.power_max_kw.max(power_kw(row.cut.torque.abs(), row.spindle_rpm));
        }
    }

    /// The table; nothing if no tool was selected.
    pub(super) fn table(&self) -> Option<Table> {
        if self.tools.keys().all(|number| *number == 0) {
            return None;
        }
        // Before the first tool is selected the machine only waits, as a rule.
        let is_idle = |tool: &ToolUse| tool.number == 0 && tool.rapid_s + tool.feed_s + tool.thread_s == 0.0;
        let tools: Vec<ToolUse> = self.tools.values().filter(|tool| !is_idle(tool)).cloned().collect();
        let seconds = [
            Column { name: "Tool", unit: "number", cell: |tool: &ToolUse| tool.number.to_string() },
            Column { name: "Name", unit: "", cell: |tool| tool.name.clone() },
            Column { name: "Rapid", unit: "s", cell: |tool| format!("{:.2}", tool.rapid_s) },
            Column { name: "Feed", unit: "s", cell: |tool| format!("{:.2}", tool.feed_s) },
            Column { name: "Thread", unit: "s", cell: |tool| format!("{:.2}", tool.thread_s) },
            Column { name: "Waits", unit: "s", cell: |tool| format!("{:.2}", tool.waits_s) },
            Column { name: "Way", unit: "mm", cell: |tool| format!("{:.1}", tool.way_mm) },
            Column { name: "Force", unit: "largest, N", cell: |tool| cut(tool, tool.force_max_n, 0) },
            Column {
                name: "Force",
                unit: "mean, N",
                cell: |tool| cut(tool, tool.force_sum_n / tool.cuts.max(1) as f64, 0),
            },
            Column { name: "Torque", unit: "largest, N·m", cell: |tool| cut(tool, tool.torque_max_nm, 2) },
            Column { name: "Power", unit: "largest, kW", cell: |tool| cut(tool, tool.power_max_kw, 2) },
        ];
        Some(Table::of("Tools", &seconds, &tools).with_caption(
            "Times by what the axes do; waits are dwells, pauses, the spindle that comes to speed, and the index \
             that a pass waits for. The way is that of the true slides. Force, torque and power are those of the \
             cut at the spindle, the mean over the time in which there was a force; the plant knows them of \
             threads.",
        ))
    }
}

/// What cutting took, if the tool cut anything that is known.
fn cut(tool: &ToolUse, value: f64, digits: usize) -> String {
    if tool.cuts == 0 { "–".into() } else { format!("{value:.digits$}") }
}
