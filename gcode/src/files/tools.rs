//! The tool table.

use crate::canon::Position;

/// A tool: lengths in units of the machine, X a radius, angles in degrees.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tool {
    /// T: number of the tool, -1 for none.
    pub number: i32,
    /// P: its pocket.
    pub pocket: i32,
    /// Offset in every axis.
    pub offset: Position,
    /// D: diameter; of a turning tool twice the radius of its nose.
    pub diameter: f64,
    /// I: angle of the front edge.
    pub front_angle: f64,
    /// J: angle of the back edge.
    pub back_angle: f64,
    /// Q: orientation of a turning tool, 0 to 9.
    pub orientation: u8,
    /// What stands behind the semicolon.
    pub comment: String,
}

/// Tools by number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolTable {
    /// What is in the spindle: a copy of a tool (LinuxCNC's entry 0).
    pub in_spindle: Tool,
    tools: Vec<Tool>,
}
