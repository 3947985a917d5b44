//! What a process with a deadline writes down of a run in real time. In: how late each cycle woke, how long
//! it took. Out, once it is over: histograms, the first late cycles with what came before them, and what the
//! system counted. All room is taken before the machine begins.

use std::{fs, time::Duration};

use serde::Serialize;

use super::Missed;

/// Cycles that are kept before a late one.
pub(crate) const BEFORE: usize = 64;
/// Late cycles that are kept with what came before them; of all others their number is.
pub(crate) const KEPT: usize = 8;
/// Buckets of a power of two.
const SHARE: u64 = 16;
/// Buckets: whole microseconds up to [`SHARE`], then sixteenths of each power of two up to 2^24 µs.
const BUCKETS: usize = 21 * SHARE as usize;

/// How often something took how long.
#[derive(Clone, Debug)]
pub(crate) struct Histogram {
    buckets: Vec<u64>,
    most: Duration,
}

/// A histogram as it is told, µs.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Told {
    /// How many there were.
    pub(crate) count: u64,
    /// So much half of them took at most, 99 % and 99.9 % of them.
    pub(crate) median_us: u64,
    pub(crate) p99_us: u64,
    pub(crate) p999_us: u64,
    /// The longest.
    pub(crate) most_us: u64,
    /// Least of each bucket that is not empty, and how many are in it.
    pub(crate) buckets: Vec<(u64, u64)>,
}

impl Default for Histogram {
    fn default() -> Histogram {
        Histogram { buckets: vec![0; BUCKETS], most: Duration::ZERO }
    }
}

/// The bucket of a time, µs.
fn bucket(us: u64) -> usize {
    if us < SHARE {
        return us as usize;
    }
    let power = u64::from(us.ilog2() - SHARE.ilog2());
    ((power * SHARE + (us >> power)) as usize).min(BUCKETS - 1)
}

/// The least time of a bucket, µs.
fn least_us(bucket: usize) -> u64 {
    let bucket = bucket as u64;
    if bucket < SHARE { bucket } else { (SHARE + bucket % SHARE) << (bucket / SHARE - 1) }
}

impl Histogram {
    /// One more.
    pub(crate) fn note(&mut self, time: Duration) {
        self.buckets[bucket(micros(time))] += 1;
        self.most = self.most.max(time);
    }

    /// As it is told. A share is told by the end of its bucket, which is a sixteenth of its value wide at
    /// most.
    pub(crate) fn told(&self) -> Told {
        let count: u64 = self.buckets.iter().sum();
        let most_us = micros(self.most);
        let share = |per_mille: u64| {
            let rank = (count * per_mille).div_ceil(1000);
            let mut below = 0;
            let found = self.buckets.iter().position(|here| {
                below += here;
                below >= rank
            });
            found.map_or(0, |bucket| least_us(bucket + 1) - 1).min(most_us)
        };
        let all = self.buckets.iter().enumerate().filter(|(_, count)| **count > 0);
        Told {
            count,
            median_us: share(500),
            p99_us: share(990),
            p999_us: share(999),
            most_us,
            buckets: all.map(|(bucket, count)| (least_us(bucket), *count)).collect(),
        }
    }
}

fn micros(time: Duration) -> u64 {
    u64::try_from(time.as_micros()).unwrap_or(u64::MAX)
}

/// A late cycle, and those before it, the newest last: how late each woke and how long its answer took, µs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Late {
    /// The cycle in which it was seen.
    pub(crate) cycle: u64,
    /// So many cycles were missed.
    pub(crate) missed: u64,
    pub(crate) before_us: Vec<(u32, u32)>,
}

/// What the system has counted of a process.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Counted {
    /// Pages that were made, and pages that were read from a disk.
    pub(crate) minor_faults: u64,
    pub(crate) major_faults: u64,
    /// How often it went to sleep by itself, and how often its processor was taken from it.
    pub(crate) voluntary_switches: u64,
    pub(crate) involuntary_switches: u64,
}

impl Counted {
    /// Of this thread so far, as far as the system says.
    pub(crate) fn now() -> Counted {
        let read = |name: &str| fs::read_to_string(format!("/proc/thread-self/{name}")).unwrap_or_default();
        let (stat, status) = (read("stat"), read("status"));
        // Behind the name, which may hold anything: the state is field 3, these are 10 and 12.
        let fields = stat.rsplit_once(')').map_or("", |(_, fields)| fields);
        let field = |number: usize| fields.split_whitespace().nth(number - 3)?.parse().ok();
        let line = |key: &str| {
            status.lines().find_map(|line| line.strip_prefix(key)?.trim().parse::<u64>().ok()).unwrap_or(0)
        };
        Counted {
            minor_faults: field(10).unwrap_or(0),
            major_faults: field(12).unwrap_or(0),
            voluntary_switches: line("voluntary_ctxt_switches:"),
            involuntary_switches: line("nonvoluntary_ctxt_switches:"),
        }
    }

    fn since(self, before: Counted) -> Counted {
        Counted {
            minor_faults: self.minor_faults.saturating_sub(before.minor_faults),
            major_faults: self.major_faults.saturating_sub(before.major_faults),
            voluntary_switches: self.voluntary_switches.saturating_sub(before.voluntary_switches),
            involuntary_switches: self.involuntary_switches.saturating_sub(before.involuntary_switches),
        }
    }
}

/// The ledger of a process.
#[derive(Debug)]
pub(crate) struct Ledger {
    wake_up: Histogram,
    /// From the moment of a cycle, or of what has come, to the last word to it.
    work: Histogram,
    ring: [(u32, u32); BEFORE],
    noted: usize,
    late: Vec<Late>,
    late_in_all: u64,
    begun: Counted,
}

impl Default for Ledger {
    fn default() -> Ledger {
        let room = || Late { cycle: 0, missed: 0, before_us: Vec::with_capacity(BEFORE) };
        let mut late: Vec<Late> = (0..KEPT).map(|_| room()).collect();
        late.iter_mut().for_each(|late| late.before_us.extend([(0, 0); BEFORE]));
        let histograms = (Histogram::default(), Histogram::default());
        // The last thing, so that nothing of the above counts.
        let begun = Counted::now();
        let (wake_up, work) = histograms;
        Ledger { wake_up, work, ring: [(0, 0); BEFORE], noted: 0, late, late_in_all: 0, begun }
    }
}

impl Ledger {
    /// A cycle woke so late and worked so long, as far as that is known.
    fn note(&mut self, woke_late: Option<Duration>, worked: Option<Duration>) {
        woke_late.into_iter().for_each(|time| self.wake_up.note(time));
        worked.into_iter().for_each(|time| self.work.note(time));
        let short = |time: Option<Duration>| u32::try_from(time.map_or(0, micros)).unwrap_or(u32::MAX);
        self.ring[self.noted % BEFORE] = (short(woke_late), short(worked));
        self.noted += 1;
    }

    /// The same of a cycle that took what had come: it is late if something has been missed before it.
    pub(crate) fn note_taken(&mut self, cycle: u64, worked: Duration, missed: u64) {
        self.note(None, Some(worked));
        if missed > 0 {
            self.late(cycle, missed);
        }
    }

    /// The same of a cycle that slept to its end: it is late if its answer was, or if cycles were missed
    /// behind it.
    pub(crate) fn note_slept(&mut self, cycle: u64, missed: &Missed) {
        self.note(missed.woke_late, missed.worked);
        if missed.answer || missed.cycles > 0 {
            self.late(cycle, missed.cycles);
        }
    }

    /// The cycle that has just been noted is late, or so many have been missed behind it.
    fn late(&mut self, cycle: u64, missed: u64) {
        if let Some(room) = self.late.get_mut(self.late_in_all as usize) {
            (room.cycle, room.missed) = (cycle, missed);
            let filled = self.noted.min(BEFORE);
            room.before_us.truncate(filled);
            for (at, place) in room.before_us.iter_mut().enumerate() {
                *place = self.ring[(self.noted - filled + at) % BEFORE];
            }
        }
        self.late_in_all += 1;
    }

    /// All of it as one line of JSON, the work under a name.
    pub(crate) fn told(&self, work: &str) -> String {
        let kept = &self.late[..self.late.len().min(self.late_in_all as usize)];
        let told = |histogram: &Histogram| Some(histogram.told()).filter(|told| told.count > 0);
        serde_json::json!({
            "wake_up": told(&self.wake_up),
            work: told(&self.work),
            "late": kept,
            "late_in_all": self.late_in_all,
            "system": Counted::now().since(self.begun),
        })
        .to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        ipc::time::{Moment, sleep_until},
        shell::POLL,
    };

    /// Buckets follow each other without a gap and none is wider than a sixteenth of its least time.
    #[test]
    fn every_time_has_a_bucket_that_holds_it() {
        for us in (0..5000).chain((0..24).flat_map(|power| [(1 << power) - 1, 1 << power, (1 << power) + 1]))
        {
            let at = bucket(us);
            assert!(least_us(at) <= us && us < least_us(at + 1), "{us} in {at}");
            assert!(least_us(at + 1) - least_us(at) <= (least_us(at) / SHARE).max(1), "{us} in {at}");
        }
        assert_eq!(bucket(u64::MAX), BUCKETS - 1);
    }

    #[test]
    fn shares_of_a_histogram_are_those_of_the_sorted_times() {
        let mut histogram = Histogram::default();
        let times: Vec<u64> = (1..=2000).map(|n| n * n % 1999 + n / 7).collect();
        times.iter().for_each(|us| histogram.note(Duration::from_micros(*us)));
        let mut sorted = times;
        sorted.sort_unstable();
        let told = histogram.told();
        assert_eq!((told.count, told.most_us), (2000, sorted[1999]));
        for (share, rank) in [(told.median_us, 1000), (told.p99_us, 1980), (told.p999_us, 1998)] {
            let exact = sorted[rank - 1];
            assert!(share >= exact && share <= exact + exact / SHARE, "{share} for {exact}");
        }
        assert_eq!(told.buckets.iter().map(|(_, count)| count).sum::<u64>(), 2000);
        assert_eq!(Histogram::default().told(), Told::default());
    }

    /// Of the first late cycles what came before is kept, oldest first; of the others that they were.
    #[test]
    fn a_late_cycle_is_kept_with_those_before_it() {
        let mut ledger = Ledger::default();
        let us = |us: u64| Some(Duration::from_micros(us));
        ledger.note(us(1), us(2));
        ledger.late(0, 0);
        (1..100).for_each(|n| ledger.note(us(n), us(2 * n)));
        (0..20).for_each(|n| ledger.late(99, n));
        assert_eq!(ledger.late[0], Late { cycle: 0, missed: 0, before_us: vec![(1, 2)] });
        let before: Vec<(u32, u32)> = (36..100).map(|n| (n, 2 * n)).collect();
        assert_eq!(ledger.late[1], Late { cycle: 99, missed: 0, before_us: before });
        assert_eq!((ledger.late.len(), ledger.late_in_all, ledger.late[7].missed), (KEPT, 21, 6));
        let told: serde_json::Value = serde_json::from_str(&ledger.told("answer")).expect("JSON");
        assert_eq!((&told["wake_up"]["count"], &told["answer"]["most_us"]), (&100.into(), &198.into()));
        assert_eq!(told["late"].as_array().map(Vec::len), Some(KEPT));
    }

    #[test]
    fn what_the_system_counts_grows() {
        let before = Counted::now();
        sleep_until(Moment::now().after(POLL));
        let touched = vec![1_u8; 1 << 20];
        std::hint::black_box(&touched);
        let counted = Counted::now().since(before);
        assert!(counted.voluntary_switches > 0 && counted.minor_faults > 0, "{counted:?}");
    }
}
