//! What is told of a pass before it is cut, and a warning of a spindle encoder that is too coarse for it. In:
//! passes, leads in mm. Out: notes.

use gcode::Problem;
use gcode::problem::{Blame, short};
use machine::{Machine, Varied};
use protocol::{Axis, Code, CodePacket, Item, ThreadPass, Variation};

use crate::tapping::TapNote;
use crate::thread::{BluntNote, CornerNote};

/// So many counts of the spindle encoder at least have to lie within the servo error that Z may have on the
/// helix. On the small lathe a lead of 5 mm faults with one of them at most speeds, with two at some.
const COUNTS_IN_THREAD_ERROR: f64 = 4.0;
/// And so many within what a thread may be off at the tool: where counts come one in a cycle or the speed
/// changes, the observed angle is off by about so many of them.
const COUNTS_IN_PART_ERROR: f64 = 2.5;
/// Of a lead that is just allowed.
const ROUNDING: f64 = 1e-8;

/// What a user wants to know about a pass before it is cut.
#[derive(Clone, Debug, PartialEq)]
pub struct PassNote {
    /// Running number, from 1.
    pub pass: u32,
    /// Line of the program.
    pub line: u32,
    /// The axis along which it runs: Z, or X of a thread on a face.
    pub along: Axis,
    /// Depth below the crest, mm, where the program says it: G33 does not, nor G92 of FANUC.
    pub depth_mm: Option<f64>,
    /// The other axis of the machine at full depth, where the run-in ends, mm.
    pub across_mm: f64,
    /// Where along its axis the pass starts, mm.
    pub start_mm: f64,
    /// Where full depth begins and ends, mm.
    pub full_depth_mm: [f64; 2],
    /// ΔZ of the run-in and of the run-out (of a face ΔX), mm.
    pub delta_mm: [f64; 2],
    /// Highest spindle speed that every axis can follow, per cent of the programmed one.
    pub max_override_pct: f64,
    /// Size of the pass on its way to the interpolator, bytes.
    pub packet_bytes: usize,
    /// X and Z of the machine at which X 0 and Z 0 of the program lie in it, tool and offsets included, mm.
    pub origin_mm: [f64; 2],
    /// How much deeper, and how far along the thread, it goes than the last pass of its start, mm; of the
    /// first all of its depth. `None` where nobody knows: a first pass of unknown depth, a tap.
    pub infeed_mm: Option<[f64; 2]>,
    /// The tool that cuts it, if one was called for.
    pub tool: Option<u32>,
    /// Of a tap: where it brakes and how it comes out.
    pub tap: Option<TapNote>,
    /// How the speed of the spindle is varied in it, and what comes of that.
    pub varied: Option<(Variation, Varied)>,
    /// What it leaves of the ridge, if it is one of a blunt start.
    pub blunt: Option<BluntNote>,
    /// How the corners of a chain are rounded.
    pub corners: Vec<CornerNote>,
    /// Lead along the thread where it ends, mm, of one that changes.
    pub end_lead_mm: Option<f64>,
}

/// What a pass takes on its way to the interpolator, bytes.
pub(crate) fn bytes_of(line: u32, pass: ThreadPass) -> usize {
    CodePacket::pack(0, &Item { line, code: Code::Pass(pass) }).as_bytes().len()
}

/// Warns of a spindle encoder that is too coarse for a lead.
pub(crate) fn coarse_encoder(line: u32, lead_mm: f64, machine: &Machine) -> Option<Box<Problem>> {
    let axis = machine.axis.get(&Axis::Z)?;
    let count_mm = lead_mm / machine.spindle_counts();
    let (fault_mm, scrap_mm) = (axis.thread_error_mm, 1e-3 * machine.threading.part_error_um);
    let (fault, scrap) = (fault_mm / COUNTS_IN_THREAD_ERROR, scrap_mm / COUNTS_IN_PART_ERROR);
    let allowed_mm = fault.min(scrap);
    if count_mm <= allowed_mm * (1.0 + ROUNDING) {
        return None;
    }
    let lines = (lead_mm / (4.0 * allowed_mm) * (1.0 - ROUNDING)).ceil();
    let (limit, becomes) = match scrap < fault {
        true => (format!("threading.part_error_um is {}", short(1e3 * scrap_mm)), "be off by more"),
        false => (format!("axis.z.thread_error_mm is {}", short(fault_mm)), "end in thread-error"),
    };
    let message =
        format!("one count of the spindle encoder is {} mm of this lead, and {limit}", short(count_mm));
    let help = format!("the thread may {becomes}: take an encoder of {lines} lines or more");
    Some(Problem::warning("coarse-encoder", Blame::Line(line), message, help))
}
