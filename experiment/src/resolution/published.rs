//! The figures of the published method, computed by `adviser::resolution`, and what a machine and its wire
//! need and have. In: the published cases, a machine. Out: tables. mm, mm/min, m/s², m/s³, Hz.

use adviser::resolution::{
    Counts, Demand, FeedError, Required, Steps, counts_per_mm, double_mm, order, position_mm, single_mm,
};
use machine::Machine;
use motion::Ramp;
use protocol::{Axis, Position};

use report::table::{Column, Table, six, three};

/// g, by which the method measures accelerations, m/s².
pub(super) const G_M_S2: f64 = 9.81;

/// Feed in mm/min, cycle in Hz, counts per mm.
pub(super) const FEEDS: [(f64, f64, f64); 13] = [
    (1.0, 1000.0, 1000.0),
    (5.0, 1000.0, 1000.0),
    (10.0, 1000.0, 1000.0),
    (10.0, 2500.0, 1000.0),
    (10.0, 1000.0, 10_000.0),
    (50.0, 1000.0, 1000.0),
    (100.0, 1000.0, 1000.0),
    (500.0, 1000.0, 1000.0),
    (1000.0, 1000.0, 1000.0),
    (2000.0, 1000.0, 1000.0),
    (5000.0, 1000.0, 1000.0),
    (10_000.0, 1000.0, 1000.0),
    (20_000.0, 1000.0, 1000.0),
];

/// Tolerances, µm.
pub(super) const TOLERANCES_UM: [f64; 7] = [6.0, 8.0, 11.0, 18.0, 27.0, 43.0, 70.0];

/// Feed in mm/min, acceleration in g, jerk in m/s³, cycle in Hz, with 1000 counts per mm.
pub(super) const MOTIONS: [(f64, f64, f64, f64); 4] = [
    (20_000.0, 2.0, 5.0, 1000.0),
    (20_000.0, 2.0, 5.0, 2500.0),
    (5000.0, 0.21, 50.0, 1000.0),
    (600.0, 0.09, 1.0, 2500.0),
];

/// A published machine, with 1000 counts per mm; its K_a is 1000.
pub(super) struct Published {
    pub(super) feed_mm_min: f64,
    pub(super) cycle_hz: f64,
    pub(super) k_f: f64,
    pub(super) overload_g: f64,
    pub(super) jerk_m_s3: f64,
    pub(super) k_j: f64,
}

const fn published([feed_mm_min, cycle_hz, k_f, overload_g, jerk_m_s3, k_j]: [f64; 6]) -> Published {
    Published { feed_mm_min, cycle_hz, k_f, overload_g, jerk_m_s3, k_j }
}

pub(super) const MACHINES: [Published; 6] = [
    published([5000.0, 1000.0, 1e4, 0.2, 1.0, 100.0]),
    published([5000.0, 1000.0, 3e4, 0.2, 1.0, 1000.0]),
    published([30_000.0, 2500.0, 3e4, 0.2, 1.0, 100.0]),
    published([25_000.0, 2500.0, 3e4, 2.0, 10.0, 100.0]),
    published([2000.0, 1000.0, 1e4, 0.1, 5.0, 100.0]),
    published([6000.0, 1000.0, 1e4, 0.05, 50.0, 100.0]),
];

/// Counts per mm of the method.
const PER_MM: f64 = 1000.0;

/// Cycles of the start of a motion that are shown.
const STARTING: [u32; 8] = [30, 33, 34, 35, 36, 40, 50, 60];

pub(super) fn demand(machine: &Published) -> (Demand, Steps) {
    let &Published { feed_mm_min, cycle_hz, k_f, overload_g, jerk_m_s3, k_j } = machine;
    let [tolerance_um, ..] = TOLERANCES_UM;
    let acceleration_m_s2 = overload_g * G_M_S2;
    (
        Demand { tolerance_um, feed_mm_min, acceleration_m_s2, jerk_m_s3, cycle_hz },
        Steps { feed: k_f, jerk: k_j, ..Steps::PUBLISHED },
    )
}

/// The step of a quantity that is needed, and its order.
fn step(value: f64) -> String {
    format!("{} (1e{})", three(value), order(value))
}

pub(super) fn required() -> Table {
    let columns: [Column<Published>; 9] = [
        Column { name: "feed", unit: "mm/min", cell: |m| six(m.feed_mm_min) },
        Column { name: "cycle", unit: "Hz", cell: |m| six(m.cycle_hz) },
        Column { name: "a", unit: "g", cell: |m| six(m.overload_g) },
        Column { name: "jerk", unit: "m/s³", cell: |m| six(m.jerk_m_s3) },
        Column { name: "K_F", unit: "", cell: |m| six(m.k_f) },
        Column { name: "K_J", unit: "", cell: |m| six(m.k_j) },
        Column { name: "step of speed", unit: "mm/cycle: D", cell: |m| needed(m, 1) },
        Column { name: "of acceleration", unit: "mm/cycle²: D", cell: |m| needed(m, 2) },
        Column { name: "of jerk", unit: "mm/cycle³: D", cell: |m| needed(m, 3) },
    ];
    Table::of("Steps that a motion needs (M31–M35)", &columns, &MACHINES).with_caption(
        "The published machines. In brackets the order: the decimal power that is not coarser. D, the degree of \
         discrepancy: how many times a count of 1 µm is coarser than the step.",
    )
}

/// A step that a published machine needs, and how many times a count of 1 µm is coarser.
fn needed(machine: &Published, n: usize) -> String {
    let (demand, steps) = demand(machine);
    let counts = Counts { per_mm: PER_MM, cycle_hz: demand.cycle_hz };
    let value = Required::of(&demand, &steps).steps().get(n).copied().unwrap_or_default();
    format!("{}: {}", step(value), three(counts.discrepancy(value)))
}

/// A quantity of a machine: its name, its unit, the step it needs, what the wire has, 1e-9 mm and 1 µm over
/// the need.
type Need = (&'static str, &'static str, f64, f64);

pub(super) fn wire(machine: &Machine) -> Table {
    let needs = machine.axis.get(&Axis::X).map(|x| {
        let f = 1.0 / machine.general.cycle_s;
        let [tolerance_um, ..] = TOLERANCES_UM;
        let demand = Demand {
            tolerance_um,
            feed_mm_min: 60.0 * x.velocity_mm_s,
            acceleration_m_s2: 1e-3 * x.acceleration_mm_s2,
            jerk_m_s3: 1e-3 * x.jerk_mm_s3,
            cycle_hz: f,
        };
        let needed = Required::of(&demand, &Steps { feed: 3e4, ..Steps::PUBLISHED });
        [
            ("position", "mm", needed.position_mm, 1.0 / Position::PER_MM),
            ("speed", "mm/cycle", needed.speed_mm, double_mm(x.velocity_mm_s) / f),
            ("acceleration", "mm/cycle²", needed.acceleration_mm, double_mm(x.acceleration_mm_s2) / (f * f)),
            ("jerk", "mm/cycle³", needed.jerk_mm, double_mm(x.jerk_mm_s3) / (f * f * f)),
        ]
    });
    let columns: [Column<Need>; 6] = [
        Column { name: "quantity of X", unit: "", cell: |need| need.0.into() },
        Column { name: "unit", unit: "", cell: |need| need.1.into() },
        Column { name: "needed", unit: "(order)", cell: |need| step(need.2) },
        Column { name: "wire", unit: "", cell: |need| three(need.3) },
        Column { name: "by differences of 1e-9 mm", unit: "D", cell: |need| three(1e-9 / need.2) },
        Column { name: "by differences of 1 µm", unit: "D", cell: |need| three(1e-3 / need.2) },
    ];
    Table::of("What this machine needs, and what the wire provides", &columns, &needs.unwrap_or_default())
        .with_caption(format!(
            "Limits of X of the machine file, a tolerance of {} µm, K_F 3e4, in its control cycle. On the wire a \
             position is a whole count of 1e-9 mm; speed, acceleration and jerk are numbers in double precision made \
             by the law, whose step at their highest value is given. A double resolves {} mm at one metre, a single {} \
             mm.",
            TOLERANCES_UM[0],
            three(double_mm(1000.0)),
            three(single_mm(1000.0))
        ))
}

pub(super) fn feed_error() -> Table {
    fn error(case: &(f64, f64, f64)) -> FeedError {
        Counts { per_mm: case.2, cycle_hz: case.1 }.feed_error(case.0)
    }
    let columns: [Column<(f64, f64, f64)>; 7] = [
        Column { name: "feed", unit: "mm/min", cell: |case| six(case.0) },
        Column { name: "cycle", unit: "Hz", cell: |case| six(case.1) },
        Column { name: "counts", unit: "1/mm", cell: |case| six(case.2) },
        Column { name: "V_T", unit: "counts/cycle", cell: |case| six(error(case).internal) },
        Column {
            name: "seen",
            unit: "counts/cycle",
            cell: |case| format!("{} or {}", error(case).low, error(case).high),
        },
        Column {
            name: "error",
            unit: "%",
            cell: |case| format!("{} or {}", six(error(case).low_pct), six(error(case).high_pct)),
        },
        Column { name: "envelope", unit: "%", cell: |case| six(error(case).envelope_pct) },
    ];
    Table::of("A feed as differences of counts show it", &columns, &FEEDS)
        .with_caption(
            "Seen minus true feed, per cent of the true one (equation (2) of the source). The envelope is one count.",
        )
}

pub(super) fn positions() -> Table {
    fn needed(tolerance_um: &f64) -> f64 {
        position_mm(*tolerance_um, Steps::PUBLISHED.tolerance)
    }
    let columns: [Column<f64>; 4] = [
        Column { name: "tolerance", unit: "µm", cell: |um| six(*um) },
        Column { name: "step", unit: "mm", cell: |um| three(needed(um)) },
        Column { name: "order", unit: "", cell: |um| format!("1e{}", order(needed(um))) },
        Column { name: "counts", unit: "1/mm", cell: |um| six(counts_per_mm(order(needed(um)))) },
    ];
    Table::of("Step of position for a tolerance (M30)", &columns, &TOLERANCES_UM).with_caption(
        "A tenth of the tolerance. The order is the power that is not coarser (M35); the source rounds both ways, and \
         with the coarser power 18 µm would be content with 1e-2 mm.",
    )
}

pub(super) fn internal() -> Table {
    fn counts(case: &(f64, f64, f64, f64)) -> Counts {
        Counts { per_mm: PER_MM, cycle_hz: case.3 }
    }
    let columns: [Column<(f64, f64, f64, f64)>; 7] = [
        Column { name: "feed", unit: "mm/min", cell: |case| six(case.0) },
        Column { name: "a", unit: "g", cell: |case| six(case.1) },
        Column { name: "jerk", unit: "m/s³", cell: |case| six(case.2) },
        Column { name: "cycle", unit: "Hz", cell: |case| six(case.3) },
        Column { name: "V_T", unit: "counts/cycle", cell: |case| six(counts(case).speed(case.0)) },
        Column {
            name: "a_T",
            unit: "counts/cycle²",
            cell: |case| six(counts(case).acceleration(case.1 * G_M_S2)),
        },
        Column { name: "J_T", unit: "counts/cycle³", cell: |case| six(counts(case).jerk(case.2)) },
    ];
    Table::of("Motions in counts of 1 µm (M29)", &columns, &MOTIONS).with_caption(
        "A jerk of a few thousandths of a count per cycle³ cannot be seen in whole counts at all.",
    )
}

/// The ramp of the source: jerk of 5 m/s³ for 0.2 s, from rest.
pub(super) fn starting() -> Ramp {
    Ramp::new(100.0, 0.4, 0.5)
}

pub(super) fn start_of_motion() -> Table {
    fn way_mm(cycle: &u32) -> f64 {
        starting().at(f64::from(*cycle) * 1e-3).s
    }
    let counts = Counts { per_mm: PER_MM, cycle_hz: 1000.0 };
    let first = counts.first_seen(1000, |t| starting().at(t).s).map_or("none".into(), |n| n.to_string());
    let columns: [Column<u32>; 3] = [
        Column { name: "cycle", unit: "of 1 ms", cell: u32::to_string },
        Column { name: "position", unit: "µm", cell: |cycle| format!("{:.4}", 1e3 * way_mm(cycle)) },
        Column {
            name: "counted",
            unit: "µm",
            cell: |cycle| Counts { per_mm: PER_MM, cycle_hz: 1000.0 }.cut(way_mm(cycle)).to_string(),
        },
    ];
    Table::of("Start of a motion as counts show it", &columns, &STARTING).with_caption(format!(
        "A ramp with a sin² jerk of 5 m/s³ for 0.2 s, from rest. A count of 1 µm shows nothing of it before cycle \
         {first}."
    ))
}
