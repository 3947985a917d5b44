//! Whether what a machine counts in is fine enough, and what to change where it is not. In: needs of its
//! axes, its encoders, scales, spindle, and the numbers on the wire. Out: one answer each.

use adviser::resolution::{counts_per_mm, double_mm, order};
use machine::{AxisConfig, Feedforward, Kinematics, Machine};
use protocol::Position;

use super::{
    Asked, Source,
    needs::{AxisNeeds, QUANTITIES},
};

/// An answer.
#[derive(Clone, Debug)]
pub(super) struct Verdict {
    /// What is asked: an encoder, a scale, a number on the wire.
    pub(super) what: String,
    /// Its step, in `unit`.
    pub(super) has: f64,
    /// The coarsest step that is fine enough.
    pub(super) needs: f64,
    pub(super) unit: String,
    /// What to change; empty if it is fine enough.
    pub(super) remedy: String,
}

impl Verdict {
    fn of(what: String, [has, needs]: [f64; 2], unit: String, remedy: impl FnOnce() -> String) -> Verdict {
        let remedy = if is_fine(has, needs) { String::new() } else { remedy() };
        Verdict { what, has, needs, unit, remedy }
    }

    pub(super) fn is_fine(&self) -> bool {
        is_fine(self.has, self.needs)
    }
}

/// A step that is needed to the last digit is fine.
fn is_fine(has: f64, needs: f64) -> bool {
    has <= needs * (1.0 + 1e-9)
}

/// Every answer.
pub(super) fn of(asked: &Asked) -> Vec<Verdict> {
    let own = match &asked.source {
        Source::Machine { machine, lead_mm } => {
            let axes = asked.axes.iter().flat_map(axis);
            axes.chain(spindle(machine, *lead_mm, &asked.axes)).collect()
        }
        Source::Given => asked.axes.iter().flat_map(counting).collect::<Vec<_>>(),
    };
    own.into_iter().chain(wire(asked)).collect()
}

/// What an axis takes its position from, and what its feedforward differences.
fn axis(needs: &AxisNeeds) -> Vec<Verdict> {
    let Some((axis, config)) = &needs.axis else { return Vec::new() };
    let (unit, needed) = (needs.unit(), needs.required.position_mm);
    let key = |name: &str| format!("axis.{}.{}", axis.name(), name.replace("mm", unit));
    let what = |of: &str| format!("{axis}: {of}");
    let position = match config.scale_step_mm {
        Some(step) => Verdict::of(what("step of the scale"), [step, needed], unit.into(), || {
            format!("a scale of {} {unit} ({})", power(needed), key("scale_step_mm"))
        }),
        None => {
            let has = needs.encoder.increment_mm();
            Verdict::of(what("count of the encoder"), [has, needed], unit.into(), || {
                let counts = (config.screw_lead_mm / needed).ceil();
                format!(
                    "an encoder of {counts} counts a turn or more ({}), or a scale of {} {unit} ({})",
                    key("encoder_counts"),
                    power(needed),
                    key("scale_step_mm")
                )
            })
        }
    };
    let differences = differenced(config).iter().map(|&n| {
        let cycles = f64::from(config.difference.cycles);
        let needed = needs.required.steps()[n];
        let has = config.difference.quantum_mm / cycles.powi(n as i32);
        Verdict::of(
            what(&format!("{} by differences", QUANTITIES[n])),
            [has, needed],
            unit_of(unit, n),
            || {
                format!(
                    "{} = \"full\" takes it from the law; else {} = {}",
                    key("feedforward"),
                    key("difference.quantum_mm"),
                    power(needed * cycles.powi(n as i32))
                )
            },
        )
    });
    std::iter::once(position).chain(differences).collect()
}

/// Which quantities the feedforward of an axis makes by differences of rounded positions.
fn differenced(config: &AxisConfig) -> &'static [usize] {
    match config.feedforward {
        Feedforward::DifferenceV => &[1],
        Feedforward::DifferenceVa => &[1, 2],
        Feedforward::None | Feedforward::AnalyticV | Feedforward::AnalyticVaNoLead | Feedforward::Full => &[],
    }
}

/// A control that counts, as the published one does: positions, and all else by differences of them.
fn counting(needs: &AxisNeeds) -> Vec<Verdict> {
    let has = needs.encoder.increment_mm();
    let named = |n: usize| {
        let by = if n == 0 { "" } else { ", by differences of counts" };
        format!("{}{by}", QUANTITIES[n])
    };
    let answer = |(n, needed): (usize, f64)| {
        Verdict::of(named(n), [has, needed], unit_of("mm", n), || {
            let per_mm = counts_per_mm(order(needed));
            let counts = format!("counts of {} mm (--counts {per_mm})", power(needed));
            if n == 0 {
                counts
            } else {
                format!("compute it from the law of motion, not from positions; else {counts}")
            }
        })
    };
    needs.required.steps().into_iter().enumerate().map(answer).collect()
}

/// One count of the spindle as way along a thread (M95).
fn spindle(machine: &Machine, lead_mm: f64, axes: &[AxisNeeds]) -> Option<Verdict> {
    let lathe = machine.general.kinematics == Kinematics::Lathe;
    let z = axes.iter().find(|needs| needs.name() == "Z").filter(|_| lathe)?;
    let needed = z.required.position_mm;
    let has = lead_mm / machine.spindle_counts();
    Some(Verdict::of(
        format!("spindle: count of its encoder at a lead of {lead_mm} mm"),
        [has, needed],
        "mm".into(),
        || {
            let lines = (lead_mm / (4.0 * needed)).ceil();
            let lead = (1e3 * needed * machine.spindle_counts()).floor() / 1e3;
            format!("an encoder of {lines} lines (spindle.encoder_lines), or leads up to {lead} mm")
        },
    ))
}

/// Positions are whole counts on the wire; the rest are numbers in double precision, made by the law. Each is
/// asked for the axis that needs it finest.
fn wire(asked: &Asked) -> Vec<Verdict> {
    let answer = |n: usize| {
        let of = |needs: &AxisNeeds| {
            let f = needs.demand.cycle_hz;
            let has = match n.checked_sub(1).and_then(|derivative| needs.limits().get(derivative).copied()) {
                Some(limit) => double_mm(limit) / f.powi(n as i32),
                None => 1.0 / Position::PER_MM,
            };
            let what = if n == 0 { "in whole counts" } else { "of the law, as a double" };
            let whose = needs.axis.as_ref().map_or(String::new(), |(axis, _)| format!(" ({axis})"));
            let what = format!("wire: {} {what}{whose}", QUANTITIES[n]);
            Verdict::of(what, [has, needs.required.steps()[n]], unit_of(needs.unit(), n), || {
                "nothing finer is on the wire: ask for fewer steps, or a wider tolerance".into()
            })
        };
        let ratio = |verdict: &Verdict| verdict.has / verdict.needs;
        asked.axes.iter().map(of).reduce(|worst, one| if ratio(&one) > ratio(&worst) { one } else { worst })
    };
    (0..4).filter_map(answer).collect()
}

/// The decimal step that is not coarser than one that is needed (M35).
fn power(needed: f64) -> String {
    format!("1e{}", order(needed))
}

fn unit_of(unit: &str, n: usize) -> String {
    format!("{unit}{}", ["", "/cycle", "/cycle²", "/cycle³"][n.min(3)])
}
