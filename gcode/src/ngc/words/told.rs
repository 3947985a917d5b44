//! Parameters that tell the state: #5021.., #5081.., #5400 to #5428, #<_x>, #<_metric>, ...
//!
//! Source: manual of LinuxCNC, chapter Overview, "System Parameters". Lengths are in program units, those of
//! the tool in the spindle (#5401 to #5410) in machine units.

use crate::canon::{FeedMode, Plane, Turn, Units};
use crate::codes::system_code;
use crate::state::State;

/// The value of `#index`, if it tells the state; all others are what was stored last.
pub(crate) fn numbered(index: u32, state: &State) -> Option<f64> {
    let tool = &state.tools.table.in_spindle;
    let axis = |first: u32| (index - first) as usize;
    if matches!(index, 5021..=5026 | 5420..=5425) {
        state.told_place.set(true);
    }
    Some(match index {
        5021..=5026 => state.axes.machine_point()[axis(5021)],
        5081..=5086 => state.axes.tool_offset()[axis(5081)],
        5400 => f64::from(state.tools.number),
        5401..=5406 => tool.offset[axis(5401)],
        5407..=5409 => tool.uvw[axis(5407)],
        5410 => tool.diameter,
        5411 => tool.front_angle,
        5412 => tool.back_angle,
        5413 => f64::from(tool.orientation),
        5420..=5425 => state.axes.position[axis(5420)],
        5027..=5029 | 5087..=5089 | 5426..=5428 => 0.0,
        _ => return None,
    })
}

/// Whether a program may set `#index`.
pub(crate) fn is_read_only(index: u32, state: &State) -> bool {
    numbered(index, state).is_some()
}

/// The value of `#<name>`, if it tells the state.
pub(crate) fn named(name: &str, state: &State) -> Option<f64> {
    let is = |condition: bool| Some(f64::from(condition));
    if let Some(axis) = name.strip_prefix("_abs_").and_then(axis) {
        state.told_place.set(true);
        return state.axes.absolute(&state.center()).get(axis).copied();
    }
    if let Some(axis) = name.strip_prefix('_').and_then(axis) {
        state.told_place.set(true);
        return Some(state.center().get(axis).copied().unwrap_or(0.0));
    }
    match name {
        "_vmajor" => Some(2.10),
        "_vminor" => Some(0.0),
        "_metric_machine" => is(state.units.machine() == Units::Millimetre),
        "_motion_mode" => Some(state.modes.motion.map_or(800.0, |code| f64::from(code.0))),
        "_plane" => Some(match state.modes.plane {
            Plane::Xy => 170.0,
            Plane::Xz => 180.0,
            Plane::Yz => 190.0,
        }),
        "_ccomp" => Some(f64::from(state.compensation.code().0)),
        "_metric" => is(state.units.program() == Units::Millimetre),
        "_imperial" => is(state.units.program() == Units::Inch),
        "_absolute" => is(!state.modes.incremental),
        "_incremental" => is(state.modes.incremental),
        "_inverse_time" => is(state.modes.feed_mode == FeedMode::InverseTime),
        "_units_per_minute" => is(state.modes.feed_mode == FeedMode::PerMinute),
        "_units_per_rev" => is(state.modes.feed_mode == FeedMode::PerRevolution),
        "_coord_system" => Some(f64::from(system_code(state.axes.system()).0)),
        "_tool_offset" => is(state.axes.tool_offset() != [0.0; 6]),
        "_retract_r_plane" => is(!state.modes.retract_to_start),
        "_retract_old_z" => is(state.modes.retract_to_start),
        "_ijk_absolute_mode" => is(state.modes.absolute_centers),
        "_lathe_diameter_mode" => is(state.modes.diameter),
        "_lathe_radius_mode" => is(!state.modes.diameter),
        _ => machine(name, state),
    }
}

/// Spindle, coolant, overrides, tools.
fn machine(name: &str, state: &State) -> Option<f64> {
    let is = |condition: bool| Some(f64::from(condition));
    match name {
        "_spindle_rpm_mode" => is(state.spindle.constant_surface.is_none()),
        "_spindle_css_mode" => is(state.spindle.constant_surface.is_some()),
        "_spindle_on" => is(state.spindle.turning.is_some()),
        "_spindle_cw" => is(state.spindle.turning == Some(Turn::Clockwise)),
        "_mist" => is(state.coolant.mist),
        "_flood" => is(state.coolant.flood),
        "_speed_override" => is(state.overrides.speed),
        "_feed_override" => is(state.overrides.feed),
        "_adaptive_feed" => is(state.overrides.adaptive),
        "_feed_hold" => is(state.overrides.hold),
        "_feed" => Some(state.modes.feed),
        "_rpm" => Some(state.spindle.speed),
        "_current_tool" => Some(f64::from(state.tools.number)),
        "_current_pocket" => Some(f64::from(state.tools.table.in_spindle.pocket)),
        "_selected_tool" => Some(f64::from(state.tools.selected.unwrap_or(0))),
        "_selected_pocket" => {
            Some(match state.tools.selected.and_then(|number| state.tools.table.find(number)) {
                Some(tool) => f64::from(tool.pocket),
                None => -1.0,
            })
        }
        "_line" => Some(f64::from(state.progress.line)),
        "_call_level" => Some(f64::from(state.progress.call_level)),
        "_remap_level" | "_task" => Some(0.0),
        _ => None,
    }
}

fn axis(name: &str) -> Option<usize> {
    ["x", "y", "z", "a", "b", "c", "u", "v", "w"].iter().position(|axis| *axis == name)
}
