//! Leads along a thread as the program says them, in a comment: `(lead_table, Z0 K3, Z-40 K5, Z-60 K5)`,
//! `(lead_table, off)`. It stays until it is said otherwise. In: the text of a comment; a thread, mm. Out:
//! the legs of the thread, or a problem that says what would do.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | z, K | mm, mm/rev | a place of the thread, and the lead along Z there |
//!
//! ```text
//! between two rows  K² is a line of z: the lead grows by the same in every turn                    (M206)
//! before the first row and behind the last one  K is that of the row
//! ```
//! So a leg from row to row is one of (M219), without an approximation, and the lead is continuous.

use gcode::Problem;
use gcode::problem::{Blame, short};

use super::chain::{Broken, Leg};
use super::cut::Point;
use crate::frame::Frame;

/// What is said of leads, and what is not known.
const WORD: &str = "lead_table";
const SPLINE: &str = "lead_spline";
/// Rows of a table.
const MOST_ROWS: usize = 64;
/// A lead in the program is that of the table if it differs by less, mm/rev.
const SAME_LEAD: f64 = 1e-6;
/// A path that moves Z by less does not move it, mm.
const SAME: f64 = 1e-9;

/// Leads along Z, in the units and from the zero of the program: Z and K of each row, in the order of Z; none
/// without a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Table(Vec<[f64; 2]>);

impl Table {
    /// Takes a comment; most of them say nothing of leads.
    ///
    /// # Errors
    /// It begins with the word, and what follows is no table.
    pub(crate) fn comment(&mut self, text: &str) -> Result<(), Box<Problem>> {
        let text = text.trim();
        let ends = |c: char| !(c.is_alphanumeric() || matches!(c, '_' | '-'));
        let (word, rest) = text.split_at(text.find(ends).unwrap_or(text.len()));
        if word.eq_ignore_ascii_case(SPLINE) {
            let message = "a lead is not told by a spline: between two rows of a table it grows by the same in every turn";
            let help = "write (lead_table, Z0 K3, Z-40 K5) with as many rows as the lead needs";
            return Err(Problem::error("not-available", Blame::Block, message, help));
        }
        if !word.eq_ignore_ascii_case(WORD) {
            let says = rest.trim_start().starts_with(',') && word.to_ascii_lowercase().starts_with("lead");
            return if says { wrong(format!("{word:?} is no word that says leads")) } else { Ok(()) };
        }
        let Some(told) = rest.trim().strip_prefix(',') else {
            return wrong(format!("a comma is missing behind {WORD}"));
        };
        self.0 = if told.trim().eq_ignore_ascii_case("off") { Vec::new() } else { read(told)? };
        Ok(())
    }

    /// Whether threads have their leads by it.
    pub(crate) fn is_in_force(&self) -> bool {
        !self.0.is_empty()
    }

    /// Why something that has a lead of its own is not cut while it is in force.
    pub(crate) fn refuses(&self, what: &str) -> Box<Problem> {
        let message = format!("{what} while ({WORD}, ...) is in force: it has a lead of its own");
        let help = format!("write ({WORD}, off) before it, or cut it by G33 (G32)");
        Problem::error("not-available", Blame::Block, message, help)
    }

    /// The legs of a thread from one point to another, X a radius, mm, whose program says this lead along its
    /// path.
    ///
    /// # Errors
    /// It does not run along Z, or the program says another lead than the table where it begins.
    pub(crate) fn legs(
        &self,
        line: u32,
        [from, to]: [Point; 2],
        lead_mm: f64,
        frame: &Frame,
    ) -> Result<Result<Vec<Leg>, Broken>, Box<Problem>> {
        let length = (to.z - from.z).abs();
        if length < SAME {
            return Err(self.refuses("a thread on a face"));
        }
        let unit = frame.unit();
        let rows: Vec<[f64; 2]> = self.0.iter().map(|[z, k]| [frame.z_on_machine(*z), k * unit]).collect();
        let along = libm::hypot(to.x - from.x, length) / length;
        let starts = along * lead_at(&rows, from.z);
        if (starts - lead_mm).abs() > SAME_LEAD * starts.max(1.0) {
            let [table, told] = [starts, lead_mm].map(|mm| frame.units.length(mm));
            let message = format!(
                "the lead of the table is {table} a turn where this thread begins, and the block says {told}"
            );
            let help = format!(
                "write that of the table, so that a control without tables begins alike; or ({WORD}, off)"
            );
            return Err(Problem::error("bad-value", Blame::Block, message, help));
        }
        let inside = |z: f64| (z - from.z) * (to.z - from.z) > SAME && (to.z - z) * (to.z - from.z) > SAME;
        let mut knots: Vec<f64> = rows.iter().map(|[z, _]| *z).filter(|z| inside(*z)).collect();
        if to.z < from.z {
            knots.reverse();
        }
        let mut at = from;
        let mut legs = Vec::with_capacity(knots.len() + 1);
        for z in knots.into_iter().chain([to.z]) {
            let share = (z - from.z) / (to.z - from.z);
            let next = if z == to.z { to } else { Point { x: from.x + share * (to.x - from.x), z } };
            let [k, ends] = [at.z, z].map(|z| along * lead_at(&rows, z));
            let growth = (ends * ends - k * k) / (2.0 * along * (z - at.z).abs());
            match Leg::straight(line, [at, next], k, growth) {
                Ok(leg) => legs.push(Leg { within: !legs.is_empty(), ..leg }),
                Err(why) => return Ok(Err(why)),
            }
            at = next;
        }
        Ok(Ok(legs))
    }
}

/// The lead along Z at a place (M206); rows in the order of Z.
fn lead_at(rows: &[[f64; 2]], z: f64) -> f64 {
    let behind = rows.partition_point(|row| row[0] <= z);
    match (behind.checked_sub(1).map(|before| rows[before]), rows.get(behind)) {
        (Some([a, k]), Some([b, l])) => (k * k + (l * l - k * k) * (z - a) / (b - a)).sqrt(),
        (Some([_, k]), None) => k,
        (None, Some([_, l])) => *l,
        (None, None) => 0.0,
    }
}

fn wrong<T>(message: String) -> Result<T, Box<Problem>> {
    let help = "write (lead_table, Z0 K3, Z-40 K5): places along Z, one after the other, each with the lead that the \
                thread has there; or (lead_table, off)";
    Err(Problem::error("bad-value", Blame::Block, message, help))
}

/// The rows, in the order of Z.
fn read(told: &str) -> Result<Vec<[f64; 2]>, Box<Problem>> {
    let mut rows = told.split(',').map(row).collect::<Result<Vec<_>, _>>()?;
    if !(2..=MOST_ROWS).contains(&rows.len()) {
        return wrong(format!("{WORD} has {} rows: 2 to {MOST_ROWS}", rows.len()));
    }
    if rows[0][0] > rows[1][0] {
        rows.reverse();
    }
    match rows.windows(2).find(|pair| pair[0][0] >= pair[1][0]) {
        Some(pair) => {
            wrong(format!("Z{} of {WORD} is not on its way: rows go one way along Z", short(pair[1][0])))
        }
        None => Ok(rows),
    }
}

/// `Z-40 K5`, or F for K.
fn row(text: &str) -> Result<[f64; 2], Box<Problem>> {
    let told = text.trim().strip_prefix(['Z', 'z']).and_then(|told| told.split_once(['K', 'k', 'F', 'f']));
    let numbers =
        told.and_then(|(z, k)| Some([z.trim().parse::<f64>().ok()?, k.trim().parse::<f64>().ok()?]));
    match numbers {
        Some([z, k]) if z.is_finite() && z.abs() < 1e6 && k > 0.0 && k < 1e4 => Ok([z, k]),
        _ => wrong(format!("{:?} is no row of {WORD}", text.trim())),
    }
}
