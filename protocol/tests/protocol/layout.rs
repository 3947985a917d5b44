//! The layout of every message of one size. A channel compares name and size of what it carries, but not the
//! order of the fields: whoever changes a layout has to change the version in the type's name, and this file.

use std::mem::offset_of;

use protocol::*;

/// Checks size and offsets, and, by taking the type apart, that no field is left out.
macro_rules! layout {
    ($test:ident: $type:ident, $bytes:literal, $($name:literal,)? { $($field:ident: $offset:literal),* $(,)? }) => {
        #[test]
        fn $test() {
            let $type { $($field: _),* } = $type::default();
            assert_eq!((size_of::<$type>(), align_of::<$type>()), ($bytes, 8));
            $(assert_eq!(offset_of!($type, $field), $offset, stringify!($field));)*
            $(assert_eq!(<$type as Message>::NAME, $name);)?
        }
    };
}

layout!(credit: Credit, 8, "pitchlock/credit/1", {
    taken: 0,
});
layout!(axis_law: AxisLaw, 144, {
    start: 0, end: 8, stroke_mm: 16, stroke_c0_deg: 24, stroke_dc_deg: 32, unload_mm: 40,
    unload_dc_deg: 48, lead_mm: 56, steepest_mm: 64, run_in_c0_deg: 72, run_in_dc_deg: 80,
    run_in_lambda: 88, brake_c_deg: 96, brake_dc_deg: 104, brake_lambda: 112, retract_mm: 120,
    retract_c_deg: 128, retract_dc_deg: 136,
});
layout!(lead_change: LeadChange, 32, {
    c_deg: 0, dc_deg: 8, lead_mm: 16, growth_mm: 24,
});
layout!(axis_frame: AxisFrame, 640, "pitchlock/axis-frame/7", {
    cycle: 0, command: 8, line: 12, setpoint: 16, stop_s: 48, pass: 56, check: 60, s_rpm: 64,
    direction: 72, not_before: 80, out: 88, law: 112, changes: 256,
});
layout!(way_out: WayOut, 24, {
    axis: 0, leaves: 4, clear: 8, free: 16,
});
layout!(setpoint: Setpoint, 32, {
    cycle: 0, position: 8, velocity_mm_s: 16, acceleration_mm_s2: 24,
});
layout!(measurement: Measurement, 536, "pitchlock/measurement/7", {
    cycle: 0, spindle_count: 8, index_count: 16, index_number: 24, index_cycle: 32, last: 40,
    check: 44, axes: 48, panel: 304, inputs: 336, references: 344,
});
layout!(axis_measurement: AxisMeasurement, 32, {
    position: 0, scale: 8, torque_nm: 16, status_word: 24, signals: 28,
});
layout!(axis_reference: AxisReference, 24, {
    home_offset: 0, switched_at: 8, indexed_at: 16,
});
layout!(panel: Panel, 32, {
    spindle_override_pct: 0, feed_override_pct: 8, rapid_override_pct: 16, buttons: 24, cycle_starts: 28,
});
layout!(drive_command: DriveCommand, 48, "pitchlock/drive-command/3", {
    cycle: 0, control_word: 8, check: 12, target_velocity_mm_s: 16, velocity_offset_mm_s: 24,
    torque_offset_nm: 32, home_offset: 40,
});
layout!(axis_status: AxisStatus, 120, "pitchlock/axis-status/2", {
    cycle: 0, state: 8, fault: 12, pass: 16, line: 20, in_position: 24, refused: 28, commanded_mm: 32,
    velocity_mm_s: 40, acceleration_mm_s2: 48, jerk_mm_s3: 56, servo_error_mm: 64, angle_deg: 72,
    spindle_rpm: 80, control_word: 88, encoder_counts: 92, target_velocity_mm_s: 96,
    velocity_offset_mm_s: 104, torque_offset_nm: 112,
});
layout!(machine_status: MachineStatus, 136, "pitchlock/machine-status/9", {
    cycle: 0, state: 8, fault: 12, line: 16, pass: 20, moves: 24, taken: 32, overrides_clamped: 40,
    stopped: 44, fault_axis: 45, coolant: 46, unreferenced: 47, spindle_rpm: 48, spindle_override_pct: 56, feed_override_pct: 64, depth_mm: 72,
    starved: 80, work: 84, tool: 88, motion: 92, outputs: 96, analog: 104,
});
layout!(spindle_command: SpindleCommand, 88, "pitchlock/spindle-command/3", {
    cycle: 0, rpm: 8, finished: 16, line: 20, pass: 24, paused: 28, index_not_before: 32,
    direction: 40, groove: 48,
});
layout!(groove: Groove, 40, {
    start: 0, reserved: 4, lead_mm: 8, crest_mm: 16, slope: 24, into: 32,
});
layout!(truth: Truth, 952, "pitchlock/truth/9", {
    cycle: 0, spindle_deg: 8, spindle_rpm: 16, spindle_torque_nm: 24, late_answers: 32, cut: 40, axes: 80,
    measurement: 400, doomed: 936, doom: 940, pending: 944,
});
layout!(axis_truth: AxisTruth, 40, {
    motor_mm: 0, slide_mm: 8, velocity_mm_s: 16, torque_nm: 24, force_n: 32,
});
layout!(cut_truth: CutTruth, 40, {
    area_mm2: 0, force_n: 8, radial_n: 16, axial_n: 24, torque_nm: 32,
});
layout!(operator_request: OperatorRequest, 24, "pitchlock/operator-request/2", {
    sequence: 0, kind: 8, reserved: 12, value: 16,
});
