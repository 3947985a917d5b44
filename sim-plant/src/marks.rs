//! What an axis is referenced by: a switch at the slide, an index on the motor. In: where slide and motor
//! truly are, cycle by cycle, mm. Out: whether the switch is on, how many indexes have gone by, and where in
//! the cycle each of them came, a share of it: the drive takes the position of that moment.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | y, s, d | mm, mm, ±1 | slide, where the switch goes on this time, the direction in which it does |
//! | h, r | mm | its hysteresis, its repeatability |
//! | n, i, N | counts | count of the motor, that of an index, counts of a turn |
//!
//! ```text
//! off → on  (y − s) d ≥ 0,     on → off  (y − s) d < −h,     s anew in switch_mm ± r          (M272)
//! index     floor((n − i)/N) changes                                                          (M273)
//! ```
//! The index lies on the edge of a count, the one next to `index_mm`.

use machine::{AxisConfig, Method};

use crate::config::{AxisTrain, Facts, ReferenceFault, SwitchWay};
use crate::drive_train::DriveTrain;
use crate::seed::Seed;

/// The switch and the index of an axis that has a reference.
#[derive(Clone, Debug)]
pub(crate) struct Marks {
    switch: Switch,
    index: Index,
}

/// What came of a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Passed {
    /// The switch is on.
    pub(crate) on: bool,
    /// It went on at this share of the cycle.
    pub(crate) switched: Option<f64>,
    /// The motor passed its index at this share of the cycle; the edge of the count.
    pub(crate) indexed: Option<(f64, f64)>,
}

#[derive(Clone, Debug)]
struct Switch {
    at_mm: f64,
    way: f64,
    hysteresis_mm: f64,
    scatter_mm: f64,
    seed: Seed,
    this_time_mm: f64,
    on: bool,
    slide_mm: f64,
    fault: Option<ReferenceFault>,
}

#[derive(Clone, Debug)]
struct Index {
    at: f64,
    counts: f64,
    turn: Option<f64>,
    count: f64,
    dead: bool,
}

impl Marks {
    /// Those of an axis, if it has a reference. `phase` is where home lies within its count.
    pub(crate) fn of(
        belief: &AxisConfig,
        train: &AxisTrain,
        facts: &Facts,
        drives: &DriveTrain,
        phase: f64,
        own: &Seed,
    ) -> Option<Marks> {
        let reference = belief.reference.as_ref()?;
        let before = if reference.method == Method::SwitchAndIndex { 0.5 * facts.screw_lead_mm } else { 0.0 };
        let way = match train.switch_way {
            Some(SwitchWay::Positive) => 1.0,
            Some(SwitchWay::Negative) => -1.0,
            None => reference.way(),
        };
        let at_mm = train.switch_mm.unwrap_or(reference.position_mm - before * way);
        // What is believed is the position of the motor; with a scale it is that of the slide.
        let as_believed_mm = match facts.scale_step_mm {
            Some(_) => drives.motor_mm(reference.position_mm),
            None => reference.position_mm,
        };
        let index_mm = train.index_mm.unwrap_or(as_believed_mm);
        let counts = f64::from(facts.encoder_counts);
        let count_mm = facts.screw_lead_mm / counts;
        let mut switch = Switch {
            at_mm,
            way,
            hysteresis_mm: train.switch_hysteresis_mm,
            scatter_mm: train.switch_scatter_mm,
            seed: own.branch(0),
            this_time_mm: at_mm,
            on: false,
            slide_mm: facts.home_mm,
            fault: train.reference_fault,
        };
        switch.goes_on_anew();
        switch.on = switch.is_beyond(facts.home_mm);
        let index = Index {
            at: ((index_mm - drives.motor_mm(facts.home_mm)) / count_mm + phase).round(),
            counts,
            turn: None,
            count: 0.0,
            dead: train.reference_fault == Some(ReferenceFault::NoIndex),
        };
        Some(Marks { switch, index })
    }

    /// A cycle later slide and motor are here.
    pub(crate) fn pass(&mut self, slide_mm: f64, count: f64) -> Passed {
        let switched = self.switch.pass(slide_mm);
        Passed { on: self.switch.shows(), switched, indexed: self.index.pass(count) }
    }
}

impl Switch {
    fn goes_on_anew(&mut self) {
        self.this_time_mm = self.at_mm + self.scatter_mm * (2.0 * self.seed.fraction() - 1.0);
    }

    fn is_beyond(&self, slide_mm: f64) -> bool {
        (slide_mm - self.this_time_mm) * self.way >= 0.0
    }

    fn shows(&self) -> bool {
        match self.fault {
            Some(ReferenceFault::SwitchOpen) => false,
            Some(ReferenceFault::SwitchClosed) => true,
            Some(ReferenceFault::NoIndex) | None => self.on,
        }
    }

    fn pass(&mut self, slide_mm: f64) -> Option<f64> {
        let before_mm = std::mem::replace(&mut self.slide_mm, slide_mm);
        if self.on {
            self.on = (slide_mm - self.this_time_mm) * self.way >= -self.hysteresis_mm;
            if !self.on {
                self.goes_on_anew();
            }
            return None;
        }
        self.on = self.is_beyond(slide_mm);
        let share = (self.this_time_mm - before_mm) / (slide_mm - before_mm);
        self.on.then(|| if share.is_finite() { share.clamp(0.0, 1.0) } else { 1.0 })
    }
}

impl Index {
    fn pass(&mut self, count: f64) -> Option<(f64, f64)> {
        let before = std::mem::replace(&mut self.count, count);
        let turn = ((count - self.at) / self.counts).floor();
        let turned = self.turn.replace(turn).filter(|last| *last != turn && !self.dead)?;
        let edge = self.at + self.counts * turned.max(turn);
        Some(((edge - before) / (count - before), edge))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn switch() -> Switch {
        Switch {
            at_mm: 10.0,
            way: -1.0,
            hysteresis_mm: 0.1,
            scatter_mm: 0.01,
            seed: Seed(3),
            this_time_mm: 10.0,
            on: false,
            slide_mm: 11.0,
            fault: None,
        }
    }

    #[test]
    fn a_switch_goes_on_where_it_is_and_off_by_its_hysteresis_and_on_again_a_little_beside() {
        let mut switch = switch();
        assert_eq!((switch.pass(10.5), switch.on), (None, false));
        let share = switch.pass(9.5).expect("it goes on");
        assert!((share - 0.5).abs() < 1e-12 && switch.on);
        assert_eq!((switch.pass(10.09), switch.on), (None, true));
        assert_eq!((switch.pass(10.11), switch.on), (None, false));
        let mut places = Vec::new();
        for _ in 0..200 {
            places.push(switch.this_time_mm);
            switch.pass(9.0);
            switch.pass(11.0);
        }
        let (least, most) = places.iter().fold((f64::MAX, f64::MIN), |(a, b), mm| (a.min(*mm), b.max(*mm)));
        assert!(least >= 9.99 && most <= 10.01 && most - least > 0.015, "{least} to {most}");
    }

    #[test]
    fn an_index_goes_by_once_a_turn_at_the_same_edge_from_either_side() {
        let mut index = Index { at: 30.0, counts: 100.0, turn: None, count: 0.0, dead: false };
        assert_eq!(index.pass(0.0), None, "the first look finds none");
        assert_eq!((index.pass(20.0), index.pass(40.0)), (None, Some((0.5, 30.0))));
        assert_eq!((index.pass(120.0), index.pass(140.0)), (None, Some((0.5, 130.0))));
        assert_eq!(index.pass(129.0).map(|(_, edge)| edge), Some(130.0));
        assert_eq!(index.pass(-71.0).map(|(_, edge)| edge), Some(30.0));
    }
}
