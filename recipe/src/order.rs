//! What is wished of a thread besides its name.

use crate::{Infeed, Law, Material, Tool};

/// In which order the starts of a thread are cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sequence {
    /// Every pass of one start, then the next start.
    #[default]
    ByStart,
    /// Every start at one depth, then the next depth: the tool wears alike in all of them.
    ByDepth,
}

/// What is wished.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// The tool that cuts the thread.
    pub tool: Tool,
    /// Its number.
    pub tool_number: u32,
    /// Limits of the pitch diameter, mm, instead of those of the standard; of a taper at the face.
    pub pitch_diameter_mm: Option<[f64; 2]>,
    /// What is cut.
    pub material: Material,
    /// Length of full thread from the face, mm; none: the major diameter, on a taper what engages.
    pub length_mm: Option<f64>,
    /// How far before the face the tool starts, mm; none: four leads, 5 mm at least.
    pub start_mm: Option<f64>,
    /// Spindle speed, 1/min; none: by the material.
    pub s_rpm: Option<f64>,
    /// Highest spindle speed of the machine, 1/min.
    pub most_rpm: f64,
    /// Where beside the groove passes run; none: along a flank, straight in where the flanks are not alike.
    pub infeed: Option<Infeed>,
    /// How deep they go; none: equal area.
    pub law: Option<Law>,
    /// How many of them, springs not counted; none: by pitch and depth.
    pub passes: Option<u32>,
    /// The highest tangential force of a pass, N, and the highest power, kW: more passes until they are kept.
    pub most_force_n: Option<f64>,
    /// See `most_force_n`.
    pub most_power_kw: Option<f64>,
    /// How often the full depth is cut again.
    pub springs: u32,
    /// Depth of the least cut, mm of radius.
    pub least_mm: f64,
    /// Order of the starts.
    pub sequence: Sequence,
    /// Whether the crest is turned before.
    pub turn: bool,
    /// Every pass is written out, even where a cycle says the same.
    pub written_out: bool,
}

impl Default for Order {
    fn default() -> Order {
        Order {
            tool: Tool::sharp(),
            tool_number: 3,
            pitch_diameter_mm: None,
            material: Material::default(),
            length_mm: None,
            start_mm: None,
            s_rpm: None,
            most_rpm: 3000.0,
            infeed: None,
            law: None,
            passes: None,
            most_force_n: None,
            most_power_kw: None,
            springs: 2,
            least_mm: 0.025,
            sequence: Sequence::default(),
            turn: true,
            written_out: false,
        }
    }
}
