//! What the tool does in the material in one pass: judged where the part is made, at the slide and at the
//! true angle of the spindle. In: every control cycle the true places of the slides, mm, and the true angle
//! since the index, degrees. Out: a [`ToolReport`], µm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | C | deg | true spindle angle since the index of the pass |
//! | a, b | mm | true place of the slide along the thread (Z; X of a face thread), and of the one across it |
//! | z, z_f, z_b | mm | place along the spindle, less what the edge reaches; where the stock begins and ends there |
//! | d | mm | how deep the point is: below the crest of the pass; of a pass that does not say its depth (G33), below where its way out says that the tool is out of the groove, less its margin |
//! | h(C), x(C) | mm | helix that the program means; law of the axis across |
//! | x_full(a) | mm | the axis across at full depth; on a cone it grows with a |
//! | s | – | direction of the axis across out of the material, ±1 |
//! | α | deg | half angle of the flank that the way out may not touch |
//! | e, ē | µm | error along the thread, its mean over the angle |
//!
//! ```text
//! (M120) contact: d > 0 and z_b ≤ z ≤ z_f, or within the part if it is known; of a tap until it is free
//! (M121) e = a − h(C)  as long as that law asks for the helix;   phase = ē,   helix = max |e − ē|
//! (M122) behind that: |e − ē| − max(0, s (b − x_full(a))) tan α, if positive: what is taken from the flank
//! (M123) s (b − x(C)): positive where the groove is too shallow
//! ```
//! While the axis across lifts the tool and the other one brakes, the tool may leave its helix: what counts
//! is how far it reaches beyond the groove that it leaves behind. The same holds for a tool that leaves a
//! thread early. Where a program lets the tool stay in the groove to its end, nothing but the helix is asked.

use machine::Machine;
use motion::PassLaw;
use protocol::{Axis, Groove, Position, Truth, WayOut};
use serde::{Deserialize, Serialize};

use super::full::Full;
use super::helix::Helix;
use super::planned::{Planned, Stock};
use super::span::Span;

/// How much farther than the groove is deep a way out goes until the tool counts as free, a share of the
/// depth.
const WAY_OUT_MARGIN: f64 = 0.05;

/// Half angle of a tool that nobody described, degrees.
const METRIC_DEG: f64 = 30.0;

/// What the tool did in one pass, over all contact with the material: tapers and run-out included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ToolReport {
    /// Largest distance of the slide from the helix, less its mean; or what it took from the flank on its way
    /// out, if that is more.
    pub helix_max_abs_um: f64,
    /// Mean of that distance over the angle: where the tool cut.
    pub phase_um: f64,
    /// Least error of depth at full depth; negative where the groove is too deep.
    pub x_min_um: f64,
    /// Largest error of depth at full depth; positive where the groove is too shallow.
    pub x_max_um: f64,
    /// Largest error of depth on the way in and out, in either direction.
    pub stroke_max_abs_um: f64,
    /// What was taken from the flank while the tool left, or before it was on the helix.
    pub flank_um: f64,
    /// What of it was taken before it was on the helix.
    pub flank_in_um: f64,
    /// Angle over which the tool was in the material and had to be on the helix; 0 if it touched nothing.
    pub contact_deg: f64,
}

/// A thread that passes go deeper into, and how deep this one goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Finish {
    /// Where the crest lies, or, if that is not known, where the tool is clear, mm.
    pub(super) surface_mm: f64,
    /// How far the pass goes in, mm.
    pub(super) reach_mm: f64,
}

/// Watches the tool of one pass.
#[derive(Clone)]
pub(super) struct Tool {
    along: Axis,
    across: Axis,
    helix: Helix,
    law: PassLaw,
    start_mm: f64,
    /// Where it is at full depth.
    full: Full,
    groove: Groove,
    /// How a tap comes out; it is in the material until it is free.
    taps: Option<WayOut>,
    /// Depth of a groove that the pass does not tell, mm.
    deepest_mm: f64,
    outwards: f64,
    /// Where the tool rests when it has left.
    clear_mm: f64,
    stock: Stock,
    /// How far the edge reaches to either side of the point along Z, mm.
    edge_mm: f64,
    tan_flank: f64,
    /// Of the flanks of the tool itself.
    tan_tool: f64,
    /// Angles between which the law along the thread asks for the helix, and the one across is at full depth.
    helix_deg: [f64; 2],
    full_deg: [f64; 2],
    /// The tool lifts off before the axis along the thread brakes.
    lifts: bool,
    c_deg: Option<f64>,
    error: Mean,
    depth: Span,
    stroke_max_um: f64,
    flank_um: f64,
    flank_in_um: f64,
}

/// Mean of an error over the angle, and its span.
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    deg: f64,
    sum: f64,
    span: Span,
}

impl Mean {
    fn add(&mut self, turned_deg: f64, e: f64) {
        self.deg += turned_deg;
        self.sum += turned_deg * e;
        self.span.add(e);
    }

    /// The middle of the span if the spindle did not turn.
    fn mean(&self) -> f64 {
        let (low, high) = self.span.ends();
        if self.deg > 0.0 { self.sum / self.deg } else { 0.5 * (low + high) }
    }
}

impl Tool {
    /// The tool of a pass along an axis.
    pub(super) fn new(machine: &Machine, planned: &Planned, along: Axis) -> Tool {
        let pass = &planned.pass;
        let tool = machine.tool(planned.tool);
        let own_deg = tool.and_then(|tool| Some(0.5 * tool.angle_deg?));
        let half_angle_deg = own_deg.unwrap_or(machine.threading.flank_half_angle_deg);
        let across = if along == Axis::Z { Axis::X } else { Axis::Z };
        let (lead, depth) = (pass.axis(along), pass.axis(across));
        let groove = if along == Axis::Z { Groove::of(pass) } else { Groove::default() };
        let lifts_up = if pass.out.clear >= pass.out.free { 1.0 } else { -1.0 };
        let outwards = if groove.into == 0.0 { lifts_up } else { -groove.into };
        let full = Full::of(pass, [along, across]);
        let bottom_mm = full.bottom_mm();
        let grows_mm = full.grows_mm(outwards, lead.end.mm());
        Tool {
            along,
            across,
            helix: Helix::of(pass, along),
            law: pass.law(across),
            start_mm: depth.start.mm(),
            full,
            groove,
            taps: pass.returns().then_some(pass.out),
            deepest_mm: (outwards * (pass.out.free.mm() - bottom_mm) - grows_mm) / (1.0 + WAY_OUT_MARGIN),
            outwards,
            clear_mm: pass.out.clear.mm(),
            stock: planned.stock.clone(),
            edge_mm: tool.map_or(0.0, machine::Tool::edge_mm),
            tan_flank: libm::tan(half_angle_deg.to_radians()),
            tan_tool: libm::tan(own_deg.unwrap_or(METRIC_DEG).to_radians()),
            helix_deg: [lead.run_in_c0_deg + lead.run_in_dc_deg, lead.brake_c_deg],
            full_deg: [depth.locked_deg(), depth.leaves_deg()],
            lifts: depth.retract_mm != 0.0,
            c_deg: None,
            error: Mean::default(),
            depth: Span::default(),
            stroke_max_um: 0.0,
            flank_um: 0.0,
            flank_in_um: 0.0,
        }
    }

    /// Takes a control cycle at a true angle since the index; `led` as long as no axis has left its law.
    pub(super) fn cycle(&mut self, c_deg: f64, truth: &Truth, led: bool) {
        let turned_deg = (c_deg - self.c_deg.replace(c_deg).unwrap_or(c_deg)).abs();
        let [a, b] = [self.along, self.across].map(|axis| truth.axes[axis.index()].slide_mm);
        let runs_in = c_deg < self.helix_deg[0];
        if runs_in && !matches!(self.stock, Stock::Part(..)) || !self.is_in_material(a, b) {
            return;
        }
        let e = self.helix.error_um(c_deg, a);
        let on_helix = led && !runs_in && c_deg < self.helix_deg[1];
        if on_helix {
            self.error.add(turned_deg, e);
        } else if self.lifts || runs_in || !led {
            let room_mm = self.way_out_mm(a, b).max(0.0) * self.tan_flank;
            let taken_um = (e - self.error.mean()).abs() - 1e3 * room_mm;
            self.flank_um = self.flank_um.max(taken_um);
            if runs_in {
                self.flank_in_um = self.flank_in_um.max(taken_um);
            }
        }
        let shallow_um = 1e3 * self.outwards * (b - self.start_mm - self.law.at(c_deg).s);
        match (self.full_deg[0]..self.full_deg[1]).contains(&c_deg) {
            true if on_helix => self.depth.add(shallow_um),
            false if led && !runs_in => self.stroke_max_um = self.stroke_max_um.max(shallow_um.abs()),
            _ => {}
        }
    }

    /// How deep the tool is below the crest of stock that its flanks reach, mm, and how far off the helix at
    /// an angle, µm (M122). Of a tap nothing: it turns with its hole.
    pub(super) fn off_helix(&self, c_deg: f64, truth: &Truth) -> Option<[f64; 2]> {
        let [a, b] = [self.along, self.across].map(|axis| truth.axes[axis.index()].slide_mm);
        let depth_mm = match self.groove.into {
            0.0 => self.deepest_mm - self.way_out_mm(a, b),
            _ => self.groove.depth_mm(b, a),
        };
        let room_mm = self.way_out_mm(a, b).max(0.0) * self.tan_flank;
        let mean = if self.error.deg > 0.0 { self.error.mean() } else { 0.0 };
        let off_um = (self.helix.error_um(c_deg, a) - mean).abs() - 1e3 * room_mm;
        // Its flanks reach as far as they are deep.
        let reach_mm = self.edge_mm + depth_mm.max(0.0) * self.tan_tool;
        let (x, z) = if self.along == Axis::Z { (b, a) } else { (a, b) };
        let cuts = self.taps.is_none() && depth_mm > 0.0 && self.stock.holds(x, z, reach_mm);
        cuts.then_some([depth_mm, off_um])
    }

    /// How far the tool is out of the groove, mm.
    fn way_out_mm(&self, a: f64, b: f64) -> f64 {
        self.outwards * (b - self.full_mm(a))
    }

    /// Where the axis across is at full depth, mm.
    fn full_mm(&self, along_mm: f64) -> f64 {
        self.full.at_mm(along_mm)
    }

    /// Whether the point of the tool is in the material (M120).
    fn is_in_material(&self, a: f64, b: f64) -> bool {
        if let Some(out) = &self.taps {
            return !out.is_free(Position::from_mm(a));
        }
        let (x, z) = if self.along == Axis::Z { (b, a) } else { (a, b) };
        let deep = match self.groove.into {
            0.0 => self.way_out_mm(a, b) < self.deepest_mm,
            _ => self.groove.depth_mm(b, a) > 0.0,
        };
        deep && self.stock.holds(x, z, self.edge_mm)
    }

    /// How deep the pass goes, if the tool was in the material.
    pub(super) fn finish(&self) -> Option<Finish> {
        let surface_mm = if self.groove.into == 0.0 { self.clear_mm } else { self.groove.crest_mm };
        let reach_mm = -self.outwards * self.full.first_mm(0.0);
        (self.error.deg > 0.0).then_some(Finish { surface_mm, reach_mm })
    }

    /// The measures of the pass.
    pub(super) fn report(&self) -> ToolReport {
        let mean = self.error.mean();
        let (low, high) = self.error.span.ends();
        let (x_min_um, x_max_um) = self.depth.ends();
        ToolReport {
            helix_max_abs_um: (high - mean).max(mean - low).max(self.flank_um),
            phase_um: mean,
            x_min_um,
            x_max_um,
            stroke_max_abs_um: self.stroke_max_um,
            flank_um: self.flank_um,
            flank_in_um: self.flank_in_um,
            contact_deg: self.error.deg,
        }
    }
}
