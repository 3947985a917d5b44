//! Mutation check: with the reaction to any one row of the table of faults switched off, the soak finds a
//! broken invariant within 2,000 seeds. Wires hide from the controllers what they would react to; the product
//! is as it is. A seed counts only if it breaks nothing over straight wires.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use protocol::{Axis, AxisFrame, AxisStatus, Cycle, Measurement, Panel, StatusWord, units::AXES};
use rig::wires::Wires;
use soak::driver;

/// Seeds that it may take.
const MOST: u64 = 2000;
/// 0x6041 of a drive in operation.
const ENABLED: u32 = 0x0027;
/// Its bit of a fault.
const FAULTY: u32 = 0x0008;
/// Codes of frames: nothing new, and leave.
const HOLD: u32 = 4;
const LEAVE: u32 = 5;

/// What is hidden.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Row {
    /// The drives of the other axes, and the order to leave that follows.
    OtherDrives,
    /// Emergency stop.
    EmergencyStop,
    /// That the interpolator wants the pass to be left.
    LeaveFrames,
    /// Counts that are lost or gained: they come little by little, and the index shows what it should.
    LostCounts,
    /// That a regulator says nothing new, and what its drive says of that.
    SilentRegulators,
}

/// Wires that hide it.
pub(crate) struct Blind {
    row: Row,
    measurement: Measurement,
    frame: AxisFrame,
    statuses: [AxisStatus; AXES],
    /// Count of the first index.
    index: Option<i64>,
    turn: i64,
    /// What is hidden of the counts of each reader: the count and the change of the cycle before, and what is
    /// still held back.
    counts: [Option<(i64, i64, i64)>; AXES + 1],
}

/// Counts by which a change of the spindle's count differs from the one before where it is a jump.
const JUMP: i64 = 4;
/// Counts of it that come each cycle.
const SLEW: i64 = 2;

impl Blind {
    pub(crate) fn new(row: Row, turn: f64) -> Blind {
        Blind {
            row,
            measurement: Measurement::default(),
            frame: AxisFrame::default(),
            statuses: [AxisStatus::default(); AXES],
            index: None,
            turn: turn as i64,
            counts: [None; AXES + 1],
        }
    }

    /// What the case has damaged stays so.
    fn hide(&mut self, own: Option<Axis>) {
        if self.measurement.is_whole() {
            self.change(own);
            self.measurement = self.measurement.sealed();
        }
    }

    fn change(&mut self, own: Option<Axis>) {
        let reader = own.map_or(AXES, Axis::index);
        if self.row == Row::LostCounts {
            let sent = self.measurement.spindle_count;
            let (before, change, held) = self.counts[reader].unwrap_or((sent, 0, 0));
            let jump = (sent - before) - change;
            let (change, held) = match jump.abs() > JUMP {
                true => (change, held + jump),
                false => (sent - before, held - held.clamp(-SLEW, SLEW)),
            };
            self.counts[reader] = Some((sent, change, held));
            self.measurement.spindle_count = sent - held;
        }
        let measurement = &mut self.measurement;
        match self.row {
            Row::OtherDrives => {
                for (index, axis) in measurement.axes.iter_mut().enumerate() {
                    if own.is_some_and(|own| own.index() != index) {
                        axis.status_word = ENABLED;
                    }
                }
            }
            // Drives that are not in operation yet stay so: nothing has been switched on.
            Row::SilentRegulators => {
                let tells = FAULTY | u32::from(StatusWord::LATE);
                for axis in measurement.axes.iter_mut().filter(|axis| axis.status_word & tells != 0) {
                    axis.status_word = ENABLED;
                }
            }
            Row::EmergencyStop => measurement.panel.press(Panel::EMERGENCY_STOP, false),
            Row::LostCounts if measurement.index_number > 0 => {
                let first = *self.index.get_or_insert(measurement.index_count);
                let turns = (measurement.index_count - first) as f64 / self.turn as f64;
                measurement.index_count = first + turns.round() as i64 * self.turn;
            }
            _ => {}
        }
    }
}

impl Wires for Blind {
    fn tick_measurement<'a>(
        &'a mut self,
        _: Cycle,
        sent: Option<&'a Measurement>,
    ) -> Option<&'a Measurement> {
        self.measurement = *sent?;
        self.hide(None);
        Some(&self.measurement)
    }

    fn measurement<'a>(
        &'a mut self,
        _: Cycle,
        axis: Axis,
        sent: Option<&'a Measurement>,
    ) -> Option<&'a Measurement> {
        self.measurement = *sent?;
        self.hide(Some(axis));
        Some(&self.measurement)
    }

    fn frame<'a>(&'a mut self, _: Cycle, _: Axis, sent: Option<&'a AxisFrame>) -> Option<&'a AxisFrame> {
        self.frame = *sent?;
        if matches!(self.row, Row::LeaveFrames | Row::OtherDrives) && self.frame.command == LEAVE {
            self.frame.command = HOLD;
        }
        Some(&self.frame)
    }

    fn status<'a>(
        &'a mut self,
        now: Cycle,
        axis: Axis,
        sent: Option<&'a AxisStatus>,
    ) -> Option<&'a AxisStatus> {
        let last = &mut self.statuses[axis.index()];
        match sent {
            Some(status) => *last = *status,
            None if self.row == Row::SilentRegulators => last.cycle = now,
            None => return None,
        }
        Some(last)
    }
}

/// The first seed from one on that finds it, and what it breaks.
fn found(row: Row, from: u64) -> Option<(u64, String)> {
    let (next, stop) = (AtomicU64::new(from), AtomicBool::new(false));
    let jobs = std::thread::available_parallelism().map_or(1, usize::from);
    let work = || {
        while !stop.load(Ordering::Relaxed) {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= from + MOST {
                return None;
            }
            let (_, _, ran) = driver::over(seed, |machine| Blind::new(row, machine.spindle_counts()));
            if let Some(broken) = ran.broken
                && driver::one(seed).1.broken.is_none()
            {
                stop.store(true, Ordering::Relaxed);
                return Some((seed, format!("{} {}", broken.invariant, broken.text)));
            }
        }
        None
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..jobs).map(|_| scope.spawn(work)).collect();
        threads.into_iter().filter_map(|thread| thread.join().expect("no thread of it panics")).min()
    })
}

/// The search begins shortly before the first seed that finds it, if that one is far: from 0 on it only takes
/// longer.
fn is_found(row: Row, from: u64) {
    let found = found(row, from);
    assert!(found.is_some(), "{row:?} is switched off, and {MOST} seeds from {from} on do not find it");
}

#[test]
fn a_drive_in_operation_is_what_the_mutant_shows() {
    let word = StatusWord(ENABLED as u16);
    assert_eq!(word.state(), Some(protocol::DriveState::OperationEnabled));
}

#[test]
fn axes_that_do_not_see_the_drives_of_the_others_are_found() {
    is_found(Row::OtherDrives, 860);
}

#[test]
fn a_machine_without_emergency_stop_is_found() {
    is_found(Row::EmergencyStop, 0);
}

#[test]
fn axes_that_do_not_leave_when_they_are_told_to_are_found() {
    is_found(Row::LeaveFrames, 4200);
}

#[test]
fn axes_that_do_not_see_lost_counts_are_found() {
    is_found(Row::LostCounts, 0);
}

#[test]
fn an_interpolator_that_does_not_miss_a_regulator_is_found() {
    is_found(Row::SilentRegulators, 120);
}
