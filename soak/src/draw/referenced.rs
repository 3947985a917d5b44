//! Axes that are to be referenced. In: the number of a case, its machine. Out: in every fifth case the
//! machine with reference runs, switched on elsewhere than it believes. They are drawn apart from all else,
//! so that the other cases are what they were, and these are but for their runs.

use machine::{AxisConfig, Machine, Method, ReferenceConfig};
use protocol::Axis;
use testing::Seed;

use super::machines::axis_truth;

/// Every so many cases one has them.
const EVERY: u64 = 5;
/// An axis of such a machine has one with this probability; the first one in any case.
const HAS: f64 = 0.7;
/// How far from home its switch or index lies, mm.
const AWAY_MM: [f64; 2] = [5.0, 14.0];
/// It is switched on no farther beside where it believes to be: an index alone is found again, mm.
const BESIDE_MM: f64 = 0.7;
/// Of another seed than what else is drawn.
const APART: u64 = 0x7265_6665_7265;

/// Gives a machine of such a case its runs, as far as there is room for them.
pub(super) fn referenced(number: u64, machine: &mut Machine) {
    if !number.is_multiple_of(EVERY) {
        return;
    }
    let mut seed = Seed::of_case(number ^ APART);
    let axes: Vec<Axis> = machine.axes().map(|(axis, _)| axis).filter(|axis| !axis.is_rotary()).collect();
    for (nth, axis) in axes.into_iter().enumerate() {
        let reference = machine.axis.get(&axis).map(|config| drawn(&mut seed, config));
        let (beside_mm, has) = (BESIDE_MM * seed.signed(), seed.chance(HAS) || nth == 0);
        let Some(config) = machine.axis.get_mut(&axis).filter(|_| has) else { continue };
        config.reference = reference;
        // A switch repeats what it repeats: who is referenced again stands elsewhere, and that is no fault of
        // his.
        let scatter = reference.filter(|reference| reference.method == Method::Switch);
        match machine.check() {
            Ok(()) => {
                axis_truth(machine, axis, "home_off_mm", beside_mm);
                scatter.into_iter().for_each(|_| axis_truth(machine, axis, "switch_scatter_mm", 0.0));
            }
            Err(_) => drop(machine.axis.get_mut(&axis).and_then(|config| config.reference.take())),
        }
    }
}

fn drawn(seed: &mut Seed, config: &AxisConfig) -> ReferenceConfig {
    let way = if seed.chance(0.5) { 1.0 } else { -1.0 };
    let [near, far] = AWAY_MM;
    let search = seed.between(0.2, 0.5) * config.velocity_mm_s;
    ReferenceConfig {
        method: [Method::Switch, Method::SwitchAndIndex, Method::Index][seed.below(3)],
        position_mm: config.home_mm + way * seed.between(near, far),
        search_mm_s: way * search,
        latch_mm_s: search * seed.between(0.1, 1.0),
        sequence: seed.below(3) as u32,
    }
}

#[cfg(test)]
mod tests {
    use machine::Method;

    use crate::draw::draw;

    #[test]
    fn every_fifth_case_has_runs_of_every_method_and_no_other_has() {
        let (mut methods, mut with) = (Vec::new(), 0);
        for number in 0..60 {
            let (case, _) = draw(number);
            let runs = case.machine.reference_runs();
            assert!(runs.is_empty() || number % 5 == 0, "case {number}");
            with += usize::from(!runs.is_empty());
            methods.extend(runs.into_iter().map(|(_, run)| run.method));
        }
        assert!(with >= 10, "{with} of 12 have room for runs");
        for method in [Method::Switch, Method::SwitchAndIndex, Method::Index] {
            assert!(methods.contains(&method), "{method:?}: {methods:?}");
        }
    }
}
