//! What a journal keeps of a run, and what is left of it after a loss of power at any moment.

use std::io::Result;

use machine::Machine;
use protocol::{MachineState, Panel, operator::Request};
use rig::journal::{Act, Book, File, Keeper, Kept, MOST, Medium, Origin, SECTOR, State, latest};
use testing::Seed;

use crate::stand::{Stand, compiled, pressed};

/// A medium that loses its power. What was synced is there for good; of the rest any sector may be there, or
/// not, or torn, or damaged.
#[derive(Default)]
struct Disk {
    kept: Vec<u8>,
    cached: Vec<u8>,
}

impl Medium for Disk {
    fn append(&mut self, bytes: &[u8]) -> Result<()> {
        self.cached.extend(bytes);
        Ok(())
    }

    fn sync(&mut self) -> Result<()> {
        self.kept.append(&mut self.cached);
        Ok(())
    }

    fn replace(&mut self, bytes: &[u8]) -> Result<()> {
        self.cached.clear();
        self.kept = bytes.into();
        Ok(())
    }
}

impl Disk {
    /// What is found when the power comes back.
    fn cut(&self, random: &mut Seed) -> Vec<u8> {
        let mut left = self.cached.clone();
        for sector in left.chunks_mut(SECTOR) {
            let within = random.below(sector.len());
            match random.below(5) {
                0 => sector.fill(0),
                1 => sector[within..].fill(0),
                2 => sector[within] ^= 1 << random.below(8),
                _ => {}
            }
        }
        left.truncate(random.below(left.len() + 1));
        let mut found = self.kept.clone();
        found.extend(left);
        // A bit that turns over, or a whole sector that goes bad, also where all was well.
        if !found.is_empty() && random.below(2) == 0 {
            let at = random.below(found.len());
            match random.below(2) {
                0 => found[at] ^= 1 << random.below(8),
                _ => found[at / SECTOR * SECTOR..].iter_mut().take(SECTOR).for_each(|byte| *byte = 0xFF),
            }
        }
        found
    }
}

fn state(number: u64) -> State {
    State { step: number, ..State::nothing() }
}

#[test]
fn nothing_that_was_confirmed_is_lost_with_the_power() {
    let cuts = 1000;
    let mut random = Seed::new(18);
    let mut torn = 0;
    for _ in 0..cuts {
        let mut book = Book::new(Disk::default());
        // Sometimes beyond the length at which the file begins anew.
        let most = if random.below(20) == 0 { 2 * MOST as usize / SECTOR } else { 40 };
        for number in 1..=random.below(most) as u64 {
            assert_eq!(book.write(&state(number)).expect("a disk"), number);
            if random.below(4) == 0 {
                assert_eq!(book.sync().expect("a disk"), number);
            }
        }
        let found = book.medium().cut(&mut random);
        match latest::<State>(&found) {
            None => assert_eq!(book.confirmed(), 0),
            Some((number, kept)) => {
                assert!(number >= book.confirmed(), "{number} of {}", book.confirmed());
                assert_eq!(kept, state(number), "what is found is what was written");
            }
        }
        torn += u32::from(!found.len().is_multiple_of(SECTOR));
    }
    assert!(torn > cuts / 4, "the cuts tear records: {torn}");
}

#[test]
fn what_is_no_journal_is_read_as_none() {
    let mut random = Seed::new(3);
    let noise: Vec<u8> = (0..10_000).map(|_| random.below(256) as u8).collect();
    assert_eq!(latest::<State>(&noise), None);
    assert_eq!(latest::<State>(&[]), None);
    // A journal of another kind or version is not taken for this one.
    let mut book = Book::new(Disk::default());
    book.write(&state(1)).expect("a disk");
    let mut other = book.medium().cached.clone();
    assert_eq!(latest::<State>(&other), Some((1, state(1))));
    other.chunks_mut(SECTOR).for_each(|sector| sector[State::MAGIC.len() - 1] += 1);
    assert_eq!(latest::<State>(&other), None);
}

/// A disk that takes no more, but for what takes the place of all there is.
#[derive(Default)]
struct Full(Vec<u8>);

impl Medium for Full {
    fn append(&mut self, bytes: &[u8]) -> Result<()> {
        if self.0.len() + bytes.len() > 8 * SECTOR {
            return Err(std::io::ErrorKind::StorageFull.into());
        }
        self.0.extend(bytes);
        Ok(())
    }

    fn sync(&mut self) -> Result<()> {
        Ok(())
    }

    fn replace(&mut self, bytes: &[u8]) -> Result<()> {
        self.0 = bytes.into();
        Ok(())
    }
}

#[test]
fn a_disk_that_is_full_has_the_newest() {
    let mut book = Book::new(Full::default());
    for cycle in 1..=30 {
        let number =
            book.write(&State { cycle, ..State::nothing() }).expect("it takes the place of those before");
        let (found, state) = latest::<State>(&book.medium().0).expect("a whole record");
        assert_eq!((found, state.cycle, number), (cycle, cycle, cycle));
    }
}

#[test]
fn a_file_is_bounded_and_begins_anew_with_what_is_known() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("journal");
    let mut book = Book::new(File::create(&path).expect("room"));
    assert!(File::create(&path).is_err(), "what is there is not written over");
    let records = 3 * MOST / (2 * SECTOR as u64);
    for number in 1..=records {
        book.write(&state(number)).expect("room");
        if number % 500 == 0 || number == records {
            let bytes = std::fs::read(&path).expect("it is there");
            assert!(bytes.len() as u64 <= MOST, "{} bytes", bytes.len());
            assert_eq!(latest::<State>(&bytes), Some((number, state(number))));
        }
    }
    assert_eq!(book.sync().expect("a disk"), records);
}

/// What is written of a run, in its order.
fn kept(program: &str, scenario: &str, requests: &[(u64, Request)]) -> Vec<State> {
    let machine = Machine::plain();
    let items = compiled(&machine, &format!("G18 G21 G90 G8\n{program}"));
    let run = Origin { seed: 3, ..Origin::default() };
    let (mut keeper, mut written) = (Keeper::new(&machine, run, &items), Vec::new());
    Stand { machine: &machine, items: &items, scenario, seed: 3 }.run(|record| {
        written.extend(keeper.cycle(record));
        pressed(requests, record)
    });
    written.extend(keeper.last());
    written
}

/// Two passes.
const THREAD: &str = "T1 M6\nM3 S900\nG0 X12 Z5\nG76 P1.5 Z-8 I-1 J0.4 R1 K0.6\nG0 X14\nM5\nM2\n";

#[test]
fn passes_are_known_while_they_are_cut_and_the_end_is_known() {
    let written = kept(THREAD, "", &[]);
    let mut open: Vec<(u32, u32)> = written.iter().map(|state| (state.open, state.passes)).collect();
    open.dedup();
    assert_eq!(open, [(0, 0), (1, 0), (0, 1), (2, 1), (0, 2)]);
    let last = written.last().expect("some were written");
    assert!(last.is_complete() && last.tool == 1 && last.pass == 2 && last.index_number > 0, "{last:?}");
    assert!(written.iter().rev().skip(2).all(|state| !state.is_complete()));
    assert!(written.windows(2).all(|pair| pair[0].step <= pair[1].step), "it does not go back");
    // Events, and four a second besides.
    assert!((written.len() as u64) < 60 + last.cycle / 500, "{} records", written.len());
}

#[test]
fn a_pass_that_was_left_stays_open_and_who_stopped_it_is_known() {
    let stop = "[[event]]\nat = { pass = 2, angle_deg = 1500 }\nstop = true\n";
    let written = kept(THREAD, stop, &[(400, Request::SpindleOverride(90.0))]);
    let last = written.last().expect("some were written");
    assert_eq!((last.open, last.passes, last.stopped), (2, 1, 1), "{last:?}");
    assert!(!last.is_complete() && last.machine == MachineState::Ended as u32);
    let within = written.iter().find(|state| state.open == 2).expect("it was begun");
    assert_eq!(last.step, within.step, "what was thrown away does not count as done");
    let acts: Vec<(u32, f64)> = last.actions.iter().map(|action| (action.act, action.value)).collect();
    let turned = (Act::SpindleOverride as u32, 90.0);
    let stopped = (Act::Buttons as u32, f64::from(Panel::STOP));
    assert_eq!((last.acted, &acts[acts.len() - 2..]), (2, &[turned, stopped][..]));
}

#[test]
fn a_pass_that_a_hold_interrupts_is_open_until_it_is_cut() {
    let hold = "(on_hold, leave)\n";
    let events = "[[event]]\nat = { pass = 1, angle_deg = 1200 }\nfeed_hold = true\n\
                  [[event]]\nat = { time_s = 4 }\ncycle_start = true\n";
    let written = kept(&format!("{hold}{THREAD}"), events, &[]);
    let mut open: Vec<(u32, u32)> = written.iter().map(|state| (state.open, state.passes)).collect();
    open.dedup();
    assert_eq!(open, [(0, 0), (1, 0), (0, 1), (2, 1), (0, 2)]);
    assert!(written.last().is_some_and(State::is_complete));
}
