//! What an edge takes in each pass of a thread. In: what the interpreter tells of the passes, the tools of
//! the machine file, the flanks of the threads that are asked for. Out: chip thickness, mm.
//!
//! ```text
//! (M208) chip on a flank  h = Δd sin φ ± Δz cos φ      the larger of both is that of a pass
//! ```
//! Δd, Δz: how much deeper, and how far along the thread, a pass goes than the last one of its start; φ the
//! angle of that flank of the tool, + on the side of higher Z. Radial infeed has h = Δd sin φ on both flanks,
//! infeed along one of them 2 Δd sin φ on the other.

use std::collections::BTreeMap;

use interpreter::{GaugedThread, PassNote};
use machine::Machine;

/// (M208) of every pass of which somebody told how deep it goes, by its number; flanks are those of its
/// thread, where that has a gauge.
pub(crate) fn chips_mm(
    passes: &[PassNote],
    machine: &Machine,
    gauges: &[GaugedThread],
) -> BTreeMap<u32, f64> {
    let chip = |note: &PassNote| {
        let [deeper, along] = note.infeed_mm?;
        let thread = gauges.iter().find(|thread| thread.from_mm.contains_key(&note.pass));
        let nominal_deg = thread.map(|thread| thread.nominal.flank_deg);
        Some((note.pass, chip_mm(deeper, along, flanks_deg(machine, note.tool, nominal_deg))))
    };
    passes.iter().filter_map(chip).collect()
}

/// (M208), mm, of the flanks towards lower and higher Z; 0 of a spring pass.
fn chip_mm(deeper_mm: f64, along_mm: f64, flanks_deg: [f64; 2]) -> f64 {
    let [low, high] = flanks_deg.map(|flank| libm::sincos(flank.to_radians()));
    let (low, high) = (deeper_mm * low.0 - along_mm * low.1, deeper_mm * high.0 + along_mm * high.1);
    low.max(high).max(0.0)
}

/// The flanks of a tool, degrees: as the machine file has them, else those of the thread that is asked for,
/// else those that passes are laid out for.
fn flanks_deg(machine: &Machine, tool: Option<u32>, nominal: Option<[f64; 2]>) -> [f64; 2] {
    let told = tool.and_then(|tool| machine.tool(tool)).and_then(|tool| tool.angle_deg);
    let told = told.map(|angle| [0.5 * angle; 2]);
    told.or(nominal).unwrap_or([machine.threading.flank_half_angle_deg; 2])
}

#[cfg(test)]
mod tests {
    use super::chip_mm;

    /// The two flanks of a 60° tool by their normals, against the formula.
    #[test]
    fn chips_are_those_of_the_flanks() {
        assert!((chip_mm(0.2, 0.0, [30.0; 2]) - 0.1).abs() < 1e-12, "radial");
        // Along a flank: tan 30° of the depth along the thread; the other flank takes twice as much.
        let along = 0.2 * libm::tan(30f64.to_radians());
        assert!((chip_mm(0.2, along, [30.0; 2]) - 0.2).abs() < 1e-12, "{along}");
        // Of a buttress thread (3° and 30°), straight in.
        assert!((chip_mm(0.2, 0.0, [3.0, 30.0]) - 0.1).abs() < 1e-12);
        assert_eq!(chip_mm(0.0, 0.0, [30.0; 2]), 0.0, "a spring pass");
        assert_eq!(chip_mm(-0.2, 0.0, [30.0; 2]), 0.0, "one that is in the air");
    }
}
