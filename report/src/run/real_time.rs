//! A run in real time. In: what its processes say of themselves. Out: tables of how late they woke, how long
//! they worked, and what came before late cycles.

use rig::observe::{LateCycle, RealTimeReport, Summary, Times};

use crate::table::{Column, Place, Table};

/// One row: what a process has timed.
struct Row<'a> {
    process: &'a str,
    what: &'static str,
    times: &'a Times,
}

/// The tables; none of a run in virtual time.
pub(super) fn tables(summary: &Summary) -> Vec<Table> {
    let mut rows = Vec::new();
    for report in &summary.real_time {
        let all = [("wake-up", &report.wake_up), ("answer", &report.answer), ("frame", &report.frame)];
        let timed = all.into_iter().filter_map(|(what, times)| Some((what, times.as_ref()?)));
        rows.extend(timed.map(|(what, times)| Row { process: &report.process, what, times }));
    }
    if rows.is_empty() {
        return Vec::new();
    }
    let columns = [
        Column { name: "Process", unit: "", cell: |row: &Row<'_>| row.process.to_owned() },
        Column { name: "What", unit: "", cell: |row| row.what.to_owned() },
        Column { name: "Number", unit: "", cell: |row| row.times.count.to_string() },
        Column { name: "Median", unit: "µs", cell: |row| row.times.median_us.to_string() },
        Column { name: "99 %", unit: "µs", cell: |row| row.times.p99_us.to_string() },
        Column { name: "99.9 %", unit: "µs", cell: |row| row.times.p999_us.to_string() },
        Column { name: "Most", unit: "µs", cell: |row| row.times.most_us.to_string() },
    ];
    let told: Vec<String> = summary.real_time.iter().map(counted).collect();
    let caption = format!(
        "How long after its moment a process woke; from the moment of a cycle to the last answer of its regulators; from a tick's \
         measurement to its last frame. {}",
        told.join(" ")
    );
    let times = Table::of("Real time", &columns, &rows).with_caption(caption);
    [Some(times), refused(summary), late(summary)].into_iter().flatten().collect()
}

fn counted(report: &RealTimeReport) -> String {
    let system = &report.system;
    format!(
        "Since the start {} had {} page faults, {} of them from a disk, slept {} times, and lost its processor {} times.",
        report.process,
        system.minor_faults + system.major_faults,
        system.major_faults,
        system.voluntary_switches,
        system.involuntary_switches
    )
}

/// What the computer has refused.
fn refused(summary: &Summary) -> Option<Table> {
    let all = summary.real_time.iter().flat_map(|report| {
        let refused = report.set_up.iter().filter(|item| !item.done);
        refused.map(|item| [report.process.clone(), item.what.clone(), item.text.clone()])
    });
    let rows: Vec<[String; 3]> = all.collect();
    let columns = [
        Column { name: "Process", unit: "", cell: |row: &[String; 3]| row[0].clone() },
        Column { name: "What", unit: "", cell: |row| row[1].clone() },
        Column { name: "Why, and what helps", unit: "", cell: |row| row[2].clone() },
    ];
    let table = Table::of("What the computer refused", &columns, &rows).at(Place::Page);
    (!rows.is_empty()).then(|| table.with_caption("The run did without it."))
}

/// Late cycles with those before them.
fn late(summary: &Summary) -> Option<Table> {
    let all = summary.real_time.iter().flat_map(|report| &report.late);
    let rows: Vec<&LateCycle> = all.collect();
    let in_all: u64 = summary.real_time.iter().map(|report| report.late_in_all).sum();
    let before = |late: &&LateCycle| {
        let pairs = late.before_us.iter().map(|(woke, worked)| format!("{woke}/{worked}"));
        pairs.collect::<Vec<_>>().join(" ")
    };
    let columns = [
        Column { name: "Cycle", unit: "", cell: |late: &&LateCycle| late.cycle.to_string() },
        Column { name: "Missed", unit: "cycles", cell: |late| late.missed.to_string() },
        Column { name: "Before", unit: "woke late/worked, µs", cell: before },
    ];
    let caption = format!(
        "{} of {in_all} times that this process was late, each with the cycles before it, the newest last: how late each woke, \
         and how long after its moment its answers were there.",
        rows.len()
    );
    let table = Table::of("Late cycles", &columns, &rows).at(Place::Details);
    (!rows.is_empty()).then(|| table.with_caption(caption))
}

#[cfg(test)]
mod tests {
    use rig::observe::{LateCycle, RealTimeReport, SetUpItem, Summary, Times};

    use super::tables;

    #[test]
    fn what_was_timed_refused_and_late_is_shown() {
        assert!(tables(&Summary::default()).is_empty());
        let times = |p99_us| {
            Some(Times { count: 9, median_us: 5, p99_us, p999_us: 70, most_us: 81, ..Times::default() })
        };
        let refused = SetUpItem { what: "memory".into(), done: false, text: "ulimit -l".into() };
        let granted = SetUpItem { what: "priority".into(), done: true, text: "SCHED_FIFO 80".into() };
        let late = LateCycle { cycle: 77, missed: 3, before_us: vec![(1, 20), (2000, 2100)] };
        let report = RealTimeReport {
            process: "real-time".into(),
            set_up: vec![refused, granted],
            wake_up: times(42),
            answer: times(60),
            late: vec![late],
            late_in_all: 5,
            ..RealTimeReport::default()
        };
        let all = tables(&Summary { real_time: vec![report], ..Summary::default() });
        let rows: Vec<String> =
            all.iter().flat_map(|table| table.rows.iter().map(|row| row.join("|"))).collect();
        let expected = [
            "real-time|wake-up|9|5|42|70|81",
            "real-time|answer|9|5|60|70|81",
            "real-time|memory|ulimit -l",
            "77|3|1/20 2000/2100",
        ];
        assert_eq!(rows, expected);
        assert!(all[2].caption.starts_with("1 of 5 times"), "{}", all[2].caption);
    }
}
