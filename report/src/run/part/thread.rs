//! One thread of a run: its passes, pitch and crest. In: reports of passes, places of the tip, the tools.
//! Out: a [`Thread`]; mm.

use gauge::Edge;
use rig::observe::{PassReport, Summary};

use super::Part;
use super::limits::tangents;
use super::outline::{Outline, Tip};

/// How far a turn may advance from the lead, a share of it, to be along Z.
const ALONG: f64 = 0.2;

/// What is known of a thread.
#[derive(Clone, Debug)]
pub(super) struct Thread {
    /// Number of a pass of it.
    pub(super) pass: u32,
    /// 1 of a screw, −1 of a nut.
    pub(super) sign: f64,
    /// Distance of grooves along Z, and of turns of one groove.
    pub(super) pitch_mm: f64,
    pub(super) lead_mm: f64,
    /// Where the part is drawn, lower and higher Z.
    pub(super) ends_mm: [f64; 2],
    /// The middle of a groove in the middle of the thread.
    pub(super) middle_mm: f64,
    /// y of the deepest place in that groove.
    pub(super) root_mm: f64,
    /// Edges at their places, of each pass of the run.
    pub(super) passes: Vec<Vec<Tip>>,
    /// Places on the crest by Z, two at least: it goes straight from one to the next, and on beyond them.
    crest: Vec<[f64; 2]>,
    /// Nobody said where the crest is: it is drawn by the pitch line of the gauge.
    pub(super) crest_is_guessed: bool,
}

impl Thread {
    /// The thread that the pass with this index belongs to, at spindle angle 0 or so many half turns on.
    pub(super) fn of(summary: &Summary, part: &Part, index: usize, half: usize) -> Option<Thread> {
        let pass = summary.passes.get(index).filter(|pass| pass.tap.is_none())?;
        let sign = sign_of(summary, pass, part.passes[index].full?[0][1]);
        let passes: Vec<Vec<Tip>> = summary
            .passes
            .iter()
            .zip(&part.passes)
            .map(|(pass, cuts)| {
                let edge = edge_of(summary, pass);
                let tip = |[z, x]: &[f64; 2]| Some(Tip { edge: edge?, at: [*z, sign * x.abs()] });
                cuts.tips[half].iter().filter_map(tip).collect()
            })
            .collect();
        let [first, last] = part.passes[index].full?;
        let [low, high] = [first[0].min(last[0]), first[0].max(last[0])];
        let full: Vec<[f64; 2]> =
            passes[index].iter().map(|tip| tip.at).filter(|[z, _]| (low..=high).contains(z)).collect();
        let lead_mm = pass.lead_mm.abs();
        let is_along = |two: &[[f64; 2]]| ((two[1][0] - two[0][0]).abs() - lead_mm).abs() < ALONG * lead_mm;
        let is_chain = !pass.lead_changes.is_empty();
        let goes_along = is_chain || full.windows(2).all(is_along);
        if full.is_empty() || !goes_along || high - low < ALONG * lead_mm {
            return None;
        }
        let pitch_mm = pitch_mm(summary, pass.pass, lead_mm);
        let deepest = full[full.len() / 2];
        let ((place, slope), crest_is_guessed) = crest(summary, pass, [first, last], sign)?;
        let crest = match is_chain {
            true => beside(&full, place),
            false => vec![place, [place[0] + 1.0, place[1] + slope]],
        };
        let (middle_mm, root_mm) = groove(&passes, deepest, pitch_mm, pass.depth_mm);
        Some(Thread {
            pass: pass.pass,
            sign,
            pitch_mm,
            lead_mm,
            ends_mm: ends(summary, [low - pitch_mm, high + pitch_mm]),
            middle_mm,
            root_mm,
            passes,
            crest,
            crest_is_guessed,
        })
    }

    /// y of the crest.
    pub(super) fn crest_at(&self, z: f64) -> f64 {
        let behind = self.crest.partition_point(|place| place[0] < z).clamp(1, self.crest.len() - 1);
        let ([z0, y0], [z1, y1]) = (self.crest[behind - 1], self.crest[behind]);
        y0 + (y1 - y0) * (z - z0) / (z1 - z0)
    }

    /// What one pass leaves, or all of them.
    pub(super) fn outline(&self, passes: &[Vec<Tip>]) -> Outline {
        Outline::new(passes.iter().flatten().copied(), self.highest_mm())
    }

    /// What all passes leave of stock that may be higher than the crest: a shoulder behind a screw.
    pub(super) fn outline_in(&self, stock_mm: f64) -> Outline {
        let top_mm = if self.sign > 0.0 { self.highest_mm().max(stock_mm) } else { self.highest_mm() };
        Outline::new(self.passes.iter().flatten().copied(), top_mm)
    }

    /// The highest place of the crest.
    fn highest_mm(&self) -> f64 {
        let [low, high] = self.ends_mm.map(|z| self.crest_at(z));
        low.max(high)
    }
}

/// The distance of grooves: the starts as a gauge of that lead has them, or as the passes have.
fn pitch_mm(summary: &Summary, pass: u32, lead_mm: f64) -> f64 {
    let asked = summary.gauge_of(pass).map(|gauge| (f64::from(gauge.limits.starts), gauge.limits.pitch_mm));
    let fits = |(starts, pitch): &(f64, f64)| (starts * pitch - lead_mm).abs() < ALONG * lead_mm;
    let starts = summary.passes.iter().map(|pass| pass.start + 1).max().unwrap_or(1);
    lead_mm / asked.filter(fits).map_or(f64::from(starts), |(starts, _)| starts)
}

/// Whether the tool goes towards the axis (1) or away from it.
pub(super) fn sign_of(summary: &Summary, pass: &PassReport, x: f64) -> f64 {
    match summary.gauge_of(pass.pass) {
        Some(gauge) if gauge.limits.side == "internal" => -1.0,
        Some(_) => 1.0,
        None if pass.delta_x_mm * x > 0.0 => -1.0,
        None => 1.0,
    }
}

/// The edge of the tool of a pass; the flanks as a gauge has them where nobody says what they are.
fn edge_of(summary: &Summary, pass: &PassReport) -> Option<Edge> {
    let tool = summary.tools.get(&pass.tool_number);
    let asked = summary.gauge_of(pass.pass).map(|gauge| gauge.limits.flank_deg);
    let flank_deg = tool.and_then(|tool| tool.angle_deg).map(|deg| [0.5 * deg; 2]).or(asked)?;
    let nose_mm = tool.and_then(|tool| tool.nose_mm).unwrap_or(0.0);
    Some(match tool.and_then(|tool| tool.width_mm) {
        Some(width_mm) => Edge::of_width(flank_deg, width_mm, nose_mm),
        None => Edge { flank_deg, flat_mm: 0.0, nose_mm },
    })
}

/// The crest: as it was turned, else from how deep the pass is below it along the way that the program
/// means, or from the gauge. One that does not limit it, as of NPT, has it three eighths of the height of the
/// flanks over its pitch line; then it is a guess.
fn crest(
    summary: &Summary,
    pass: &PassReport,
    [first, last]: [[f64; 2]; 2],
    sign: f64,
) -> Option<(([f64; 2], f64), bool)> {
    let [from, to] = [first, last].map(|[z, x]| [z, sign * x.abs()]);
    let slope = if (to[0] - from[0]).abs() > 0.0 { (to[1] - from[1]) / (to[0] - from[0]) } else { 0.0 };
    let turned =
        summary.gauge_of(pass.pass).and_then(|gauge| gauge.crest_mm.iter().copied().reduce(f64::max));
    if let Some(diameter) = turned {
        return Some((([from[0], 0.5 * sign * diameter], slope), false));
    }
    if pass.depth_mm > 0.0 {
        return Some((([from[0], from[1] + pass.depth_mm], slope), false));
    }
    let limits = &summary.gauge_of(pass.pass)?.limits;
    let most = if sign > 0.0 { 1 } else { 0 };
    let over = 0.375 * limits.pitch_mm / tangents(limits).iter().sum::<f64>();
    let y = |diameter: f64| 0.5 * sign * diameter;
    let known = limits.crest_mm[most].map(y);
    let crest = known.unwrap_or(y(limits.pitch_diameter_mm[most]) + over);
    Some((([limits.plane_mm, crest], slope), known.is_none()))
}

/// The crest of a chain of threads: beside its grooves, through a place.
fn beside(grooves: &[[f64; 2]], [z, y]: [f64; 2]) -> Vec<[f64; 2]> {
    let mut crest = grooves.to_vec();
    crest.sort_by(|one, other| one[0].total_cmp(&other[0]));
    crest.dedup_by(|one, other| one[0] == other[0]);
    let near = crest.iter().copied().min_by(|one, other| (one[0] - z).abs().total_cmp(&(other[0] - z).abs()));
    let over = near.map_or(0.0, |near| y - near[1]);
    crest.iter_mut().for_each(|place| place[1] += over);
    if let [only] = crest[..] {
        crest.push([only[0] + 1.0, only[1]]);
    }
    crest
}

/// Where the part is drawn, as far as the stock goes.
fn ends(summary: &Summary, [low, high]: [f64; 2]) -> [f64; 2] {
    let rows = summary.stock.as_ref().map(|stock| stock.rows_mm.as_slice()).unwrap_or_default();
    match rows {
        [first, .., last] => [low.max(first[0]), high.min(last[0])],
        _ => [low, high],
    }
}

/// The middle of a groove, between the outermost of its deep places, and its deepest y.
fn groove(passes: &[Vec<Tip>], near: [f64; 2], pitch_mm: f64, depth_mm: f64) -> (f64, f64) {
    let within = || passes.iter().flatten().filter(|tip| (tip.at[0] - near[0]).abs() < 0.5 * pitch_mm);
    let root = within().map(|tip| tip.at[1]).fold(near[1], f64::min);
    let deep = within().filter(|tip| tip.at[1] - root < 0.1 * depth_mm).map(|tip| tip.at[0]);
    let (low, high) = deep.fold((near[0], near[0]), |(low, high), z| (low.min(z), high.max(z)));
    (0.5 * (low + high), root)
}
