//! Tables of the experiment. In: rows, threads. Out: chosen speeds, every speed, the threads.

use report::table::{Column, Place, Table};

use super::{NAMED_RPM, Period, Row, SLOW_RPM, lathe::Thread};

/// Of so many rows one is on the screen.
const SHOWN: usize = 9;

fn mm(value: f64) -> String {
    format!("{value:.2}")
}

fn varied(row: &Row) -> String {
    if row.percent == 0.0 {
        "–".into()
    } else {
        format!("±{:.1} over {:.1}", row.percent, row.revolutions)
    }
}

const LIMITS: [Column<Row>; 9] = [
    Column { name: "S", unit: "1/min", cell: |row| format!("{:.0}", row.rpm) },
    Column { name: "waves", unit: "1/turn", cell: |row| format!("{:.1}", row.waves) },
    Column { name: "lobes", unit: "mm", cell: |row| mm(row.lobes_mm) },
    Column { name: "even", unit: "mm", cell: |row| mm(row.even_mm) },
    Column { name: "varied by", unit: "%, turns", cell: varied },
    Column { name: "sine", unit: "mm", cell: |row| mm(row.sine_mm) },
    Column { name: "triangle", unit: "mm", cell: |row| mm(row.triangle_mm) },
    Column { name: "random", unit: "mm", cell: |row| mm(row.random_mm) },
    Column { name: "sine : even", unit: "", cell: |row| mm(row.gain) },
];

const PERIODS: [Column<Period>; 3] = [
    Column { name: "period", unit: "turns", cell: |period| format!("{}", period.revolutions) },
    Column { name: "sine", unit: "mm", cell: |period| mm(period.sine_mm) },
    Column { name: "sine : even", unit: "", cell: |period| mm(period.gain) },
];

/// A pass of both threads.
struct Pass {
    depth_mm: f64,
    width_mm: f64,
    even_um: f64,
    varied_um: f64,
}

const PASSES: [Column<Pass>; 4] = [
    Column { name: "depth", unit: "mm", cell: |pass| format!("{:.3}", pass.depth_mm) },
    Column { name: "width of the chip", unit: "mm", cell: |pass| mm(pass.width_mm) },
    Column { name: "even speed", unit: "µm", cell: |pass| format!("{:.1}", pass.even_um) },
    Column { name: "varied speed", unit: "µm", cell: |pass| format!("{:.1}", pass.varied_um) },
];

fn passes(threads: &[Thread]) -> Vec<Pass> {
    let of =
        |varied| threads.iter().filter(move |thread| thread.varied == varied).flat_map(|one| &one.passes);
    let both = of(false).zip(of(true));
    both.map(|(even, varied)| Pass {
        depth_mm: even[0],
        width_mm: even[1],
        even_um: even[2],
        varied_um: varied[2],
    })
    .collect()
}

pub(super) fn all(rows: &[Row], periods: &[Period], threads: &[Thread]) -> Vec<Table> {
    let chosen = rows.iter().enumerate().filter(|(n, row)| n % SHOWN == 0 || row.rpm == NAMED_RPM);
    let chosen: Vec<Row> = chosen.map(|(_, row)| row.clone()).collect();
    vec![
        Table::of("The widest stable chip", &LIMITS, &chosen).with_caption(
            "Waves: swings of the mode in a turn. Lobes: calculated, at an even speed. Even: the plant's model at that \
             speed. Varied by: the strongest variation that the machine proves at this speed.",
        ),
        Table::of(&format!("±30 % at S{SLOW_RPM} over other periods"), &PERIODS, periods),
        Table::of("The same thread at both speeds: how far the depth at the tool swings", &PASSES, &passes(threads))
            .with_caption("Over each pass at full depth, from the least to the largest."),
        Table::of("Every speed", &LIMITS, rows).at(Place::Details),
    ]
}
