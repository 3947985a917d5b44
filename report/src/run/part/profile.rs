//! The part as a body of revolution. In: the stock, what feeds and a thread have left, mm. Out: radii over Z.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | r_s, b | mm | radius of the stock over Z, and of its bore; unknown where nobody said it |
//! | r_o, r_i | mm | what feeds leave outside and inside (M169) |
//! | y(z) | mm | what the edge of a thread leaves (M161), of a nut with its sign |
//!
//! ```text
//! | y(z) | mm | what the edge of a thread leaves (M161); of a nut with its sign |
//! ```
//!
//! The axis is met across where the part is faced or cut off; what is left of it is the longest piece.

use rig::observe::StockReport;

use super::outline::Outline;
use super::plain::Plain;
use super::swept::Swept;
use super::thread::Thread;

/// Places in a turn of the thread, and of all of it at most.
const IN_A_TURN: f64 = 400.0;
const MOST_PLACES: f64 = 40_000.0;

/// What says where the front of the part is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Front {
    /// A tool went across it to the axis, or the stock ends there.
    Known,
    /// Z 0 of the program, as nobody said it.
    Zero,
    /// Tools have cut no farther.
    Cut,
}

/// The part at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slice {
    pub(super) z: f64,
    /// Unknown without stock where no tool has cut outside.
    pub(super) outer: Option<f64>,
    /// 0 where it is solid.
    pub(super) inner: f64,
}

/// The whole part.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    /// By Z.
    pub(super) slices: Vec<Slice>,
    pub(super) front: Front,
    /// Whether it is known to end where the slices begin.
    pub(super) ends_at_back: bool,
}

/// What a part is made of.
struct Made<'a> {
    stock: Option<&'a StockReport>,
    swept: &'a Swept,
    thread: Option<(&'a Thread, Outline)>,
    plain: &'a [Plain],
}

impl Profile {
    /// Of a part of which anything is known.
    pub(super) fn of(
        stock: Option<&StockReport>,
        swept: &Swept,
        thread: Option<&Thread>,
        plain: &[Plain],
    ) -> Option<Profile> {
        let stock = stock.filter(|stock| stock.rows_mm.len() > 1);
        let rows = stock.map(|stock| stock.rows_mm.as_slice()).unwrap_or_default();
        let widest_mm = rows.iter().map(|row| row[1]).fold(0.0, f64::max);
        let thread = thread.map(|thread| (thread, thread.outline_in(widest_mm)));
        let made = Made { stock, swept, thread, plain };
        let cut = swept.places_mm();
        let mut places = cut.clone();
        if let Some((thread, outline)) = &made.thread {
            // In a shoulder a flank is as wide as the shoulder is high.
            let beyond = if widest_mm > 0.0 { outline.reach_mm() } else { 0.0 };
            let [low, high] = [thread.ends_mm[0] - beyond, thread.ends_mm[1] + beyond];
            let n = (IN_A_TURN * (high - low) / thread.pitch_mm).clamp(2.0, MOST_PLACES) as usize;
            places.extend((0..=n).map(|i| low + (high - low) * i as f64 / n as f64));
        }
        places.extend(plain.iter().flat_map(|thread| thread.root_mm.iter().map(|place| place[0])));
        places.extend(rows.iter().flat_map(|row| [row[0] - STEP_SIDE_MM, row[0], row[0] + STEP_SIDE_MM]));
        places.sort_by(f64::total_cmp);
        let (low, high) = (*places.first()?, *places.last()?);
        let [low, high] = rows.first().zip(rows.last()).map_or([low, high], |(a, b)| [a[0], b[0]]);
        let ([back, mut high], is_faced) = piece([low, high], &swept.faces_mm, &places);
        let ends_at_back = stock.is_some() || back > low;
        let low = back;
        let front = match stock {
            _ if is_faced => Front::Known,
            Some(_) => Front::Known,
            None if low < 0.0 && high > 0.0 => {
                high = 0.0;
                Front::Zero
            }
            None => Front::Cut,
        };
        places.extend(swept.ends_mm());
        places.extend([low, high]);
        places.retain(|z| (low..=high).contains(z));
        places.sort_by(f64::total_cmp);
        places.dedup();
        let slices: Vec<Slice> = places.into_iter().map(|z| made.at(z)).collect();
        (slices.len() > 1).then_some(Profile { slices, front, ends_at_back })
    }
}

/// Beside a step of the stock, mm.
const STEP_SIDE_MM: f64 = 1e-6;

/// Between the places where the axis is met, the piece in which most was cut; and whether its front was.
fn piece([low, high]: [f64; 2], faces: &[f64], cut: &[f64]) -> ([f64; 2], bool) {
    let mut bounds: Vec<f64> = faces.iter().copied().filter(|z| (low..high).contains(z)).collect();
    bounds.extend([low, high]);
    bounds.sort_by(f64::total_cmp);
    let pieces = bounds.windows(2).map(|two| [two[0], two[1]]);
    let places = |[low, high]: &[f64; 2]| cut.iter().filter(|z| (low..=high).contains(z)).count();
    let longest = pieces.max_by_key(places).unwrap_or([low, high]);
    (longest, longest[1] < high)
}

impl Made<'_> {
    /// M170.
    fn at(&self, z: f64) -> Slice {
        let stock = self.stock.and_then(|stock| radius_at(&stock.rows_mm, z));
        let [outside, inside] = self.swept.at(z);
        let mut outer = least(stock, outside);
        let mut inner = self.stock.map_or(0.0, |stock| stock.inner_mm).max(inside.unwrap_or(0.0));
        if let Some((thread, outline)) = &self.thread {
            let is_within = (thread.ends_mm[0]..=thread.ends_mm[1]).contains(&z);
            let crest = is_within.then(|| thread.crest_at(z));
            if thread.sign > 0.0 {
                outer = outer.or(crest).map(|top| outline.at(z, top));
            } else if let Some(crest) = crest {
                let bore = if inner > 0.0 { -inner } else { crest };
                inner = -outline.at(z, bore);
            }
        }
        for thread in self.plain.iter().filter(|thread| thread.is_at(z)) {
            let crest = thread.crest_at(z);
            if thread.sign > 0.0 {
                outer = outer.or(crest);
            } else if inner == 0.0 {
                inner = crest.unwrap_or(0.0);
            }
        }
        Slice { z, outer, inner }
    }
}

fn least(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    a.into_iter().chain(b).reduce(f64::min)
}

/// The radius of stock at a place; the lower one at a step.
fn radius_at(rows: &[[f64; 2]], z: f64) -> Option<f64> {
    let around = rows.windows(2).filter(|two| (two[0][0]..=two[1][0]).contains(&z));
    let radius = |two: &[[f64; 2]]| {
        let [[z0, r0], [z1, r1]] = [two[0], two[1]];
        if z1 > z0 { r0 + (r1 - r0) * (z - z0) / (z1 - z0) } else { r0.min(r1) }
    };
    around.map(radius).reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BAR: [[f64; 2]; 2] = [[-60.0, 20.0], [1.0, 20.0]];

    fn at(profile: &Profile, z: f64) -> Slice {
        let near = profile.slices.iter().min_by(|a, b| (a.z - z).abs().total_cmp(&(b.z - z).abs()));
        *near.expect("a slice")
    }

    #[test]
    fn a_bar_that_nothing_cuts_is_a_bar() {
        let stock = StockReport { rows_mm: BAR.to_vec(), inner_mm: 3.0, ..StockReport::default() };
        let profile = Profile::of(Some(&stock), &Swept::default(), None, &[]).expect("a part");
        let (first, last) = (profile.slices[0], profile.slices[profile.slices.len() - 1]);
        assert_eq!((first.z, last.z, profile.front), (-60.0, 1.0, Front::Known));
        assert!(profile.slices.iter().all(|at| at.outer == Some(20.0) && at.inner == 3.0));
    }

    #[test]
    fn nothing_known_is_no_part() {
        assert!(Profile::of(None, &Swept::default(), None, &[]).is_none());
    }

    /// Turned to 10 mm from before the face as far as Z −26, with and without stock.
    #[test]
    fn stock_is_left_where_no_tool_was() {
        let stock = StockReport { rows_mm: BAR.to_vec(), ..StockReport::default() };
        let mut turned = Swept::turned([2.0, -26.0], 10.0);
        let profile = Profile::of(Some(&stock), &turned, None, &[]).expect("a part");
        let outer = |z: f64| at(&profile, z).outer;
        assert_eq!((outer(-20.0), outer(-26.5), outer(-60.0)), (Some(10.0), Some(20.0), Some(20.0)));
        let bare = Profile::of(None, &turned, None, &[]).expect("a part");
        assert_eq!((bare.front, bare.slices[bare.slices.len() - 1].z), (Front::Zero, 0.0));
        assert!(!bare.ends_at_back && (bare.slices[0].z + 26.0).abs() < 0.03);
        turned.faces_mm.push(-0.5);
        let faced = Profile::of(None, &turned, None, &[]).expect("a part");
        assert_eq!((faced.front, faced.slices[faced.slices.len() - 1].z), (Front::Known, -0.5));
        turned.faces_mm.push(-24.0);
        let cut_off = Profile::of(Some(&stock), &turned, None, &[]).expect("a part");
        assert_eq!(
            (cut_off.slices[0].z, cut_off.ends_at_back),
            (-24.0, true),
            "the longest piece that was cut"
        );
    }

    #[test]
    fn a_step_of_the_stock_has_both_radii() {
        let rows = [[-30.0, 20.0], [-10.0, 20.0], [-10.0, 8.0], [0.0, 8.0]];
        let radii = [-10.1, -10.0, -9.9, 0.1].map(|z| radius_at(&rows, z));
        assert_eq!(radii, [Some(20.0), Some(8.0), Some(8.0), None]);
    }
}
