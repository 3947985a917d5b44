//! What a run worked with, for whoever draws it: the stock and the tools. In: the machine file, machine code,
//! what the program says of the part. Out: a [`StockReport`], and a [`ToolNote`] for each tool of the
//! program; mm, degrees.

use std::collections::BTreeMap;

use machine::{Machine, Part};
use protocol::{Code, Item};
use serde::{Deserialize, Serialize};

/// The material before it is cut, in the coordinates of the program; X and Y of a block are those of the
/// machine.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StockReport {
    /// Z and radius, Z rising; a step has two rows of one Z.
    pub rows_mm: Vec<[f64; 2]>,
    /// Radius of its bore; 0 without one.
    pub inner_mm: f64,
    /// Z at which the jaws of the chuck begin; they lie below.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chuck_mm: Option<f64>,
    /// Of a mill: least and largest X, Y and Z of a block; `rows_mm` is empty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub block_mm: Option<[[f64; 3]; 2]>,
}

impl StockReport {
    pub(super) fn of(part: &Part) -> StockReport {
        let inner_mm = part.radii_mm(part.ends_mm()[0]).map_or(0.0, |[inner, _]| inner);
        let block_mm = part.block().map(|block| [block.low_mm, block.high_mm]);
        StockReport { rows_mm: part.rows_mm().to_vec(), inner_mm, chuck_mm: part.chuck_mm(), block_mm }
    }
}

/// A tool that the program selects, as far as anybody said what it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ToolNote {
    /// What it is, for people; empty if the machine file does not have it.
    pub name: String,
    /// Angle between its flanks, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle_deg: Option<f64>,
    /// Radius of its nose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nose_mm: Option<f64>,
    /// Width of its edge along Z; the diameter of a drill.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width_mm: Option<f64>,
    /// Diameter of a milling tool, or twice the nose of a turning tool: D of the tool table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diameter_mm: Option<f64>,
    /// X and Z of the machine at which X 0 and Z 0 of the program lie where the tool first cuts, its offsets
    /// included.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub origin_mm: Option<[f64; 2]>,
}

impl ToolNote {
    /// The diameter of a drill or of an end mill, mm, if somebody said it: D of the tool table goes before
    /// the machine file.
    pub fn drill_mm(&self) -> Option<f64> {
        self.diameter_mm.or(self.width_mm).filter(|mm| *mm > 0.0)
    }

    fn of(machine: &Machine, number: u32) -> ToolNote {
        let tool = machine.tool(number).cloned().unwrap_or_default();
        let machine::Tool { name, angle_deg, nose_mm, width_mm } = tool;
        ToolNote { name, angle_deg, nose_mm, width_mm, ..ToolNote::default() }
    }
}

/// The tools that machine code selects.
pub(super) fn tools(machine: &Machine, items: &[Item]) -> BTreeMap<u32, ToolNote> {
    let selected = items.iter().filter_map(|item| match item.code {
        Code::Tool { number } => Some(number),
        _ => None,
    });
    selected.map(|number| (number, ToolNote::of(machine, number))).collect()
}
