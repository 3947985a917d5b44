//! What a machine has and how far it goes. In: a machine, what a program asks of it. Out: refusals by name.

use gcode::canon::Plane;
use gcode::problem::{Blame, short};
use gcode::{Call, Problem};
use machine::{Kinematics, Machine};
use protocol::{Axis, Position, units::AXES};

/// Longest dwell, and longest wait for an input, s.
pub(crate) const LONGEST_DWELL: f64 = 86_400.0;

/// What a call comes to.
pub(crate) type Done = Result<(), Box<Problem>>;

/// The plane at the start.
pub(crate) fn plane_of(machine: &Machine) -> Plane {
    match machine.general.kinematics {
        Kinematics::Lathe => Plane::Xz,
        Kinematics::Mill | Kinematics::Positioner => Plane::Xy,
    }
}

/// The point at which the axes are at home.
pub(crate) fn home(machine: &Machine) -> gcode::Pose {
    let mut axes = [0.0; AXES];
    machine.axes().for_each(|(axis, config)| axes[axis.index()] = config.home_mm);
    machine.general.kinematics.point(&axes)
}

/// What this machine does not have, in words.
pub(crate) fn missing(what: &str, help: &str) -> Box<Problem> {
    let message = format!("{what}: not available on this machine yet");
    Problem::error("not-available", Blame::Block, message, help)
}

/// Refuses what no machine has yet: orientation, probes.
pub(crate) fn refuse_absent(call: &Call<'_>) -> Done {
    match *call {
        Call::OrientSpindle(..) | Call::WaitSpindleOrient(_) => {
            Err(missing("spindle orientation (M19)", "leave it out: threads find their angle"))
        }
        Call::EnableFeedOverride(false)
        | Call::EnableSpeedOverride(false)
        | Call::EnableFeedHold(false)
        | Call::EnableAdaptiveFeed(true) => {
            let help = "tap rigidly with G33.1 Z K instead; leave M49 to M53 out: the operator's overrides always \
                        count here";
            Err(missing("taps (G74, G84), and overrides or hold switched off (M49 to M53)", help))
        }
        Call::SetPlannerMode(_) => {
            let help =
                "leave R out: every move here keeps the jerk of its axes; P and Q are those of LinuxCNC";
            Err(missing("another planner (G64 R)", help))
        }
        Call::MoveByHand => Err(missing("moving the tool out by hand (G88)", "bore with G85, G86 or G89")),
        Call::StraightProbe(..) => Err(missing("probing (G38)", "measure by other means")),
        _ => Ok(()),
    }
}

/// Refuses a word that needs a spindle where there is none.
pub(crate) fn needs_spindle(machine: &Machine, word: &str, blame: Blame) -> Done {
    if !machine.spindle.is_none() {
        return Ok(());
    }
    let message = format!("{word}: {} has no spindle", machine.general.name);
    Err(Problem::error("no-spindle", blame, message, "leave out S, M3, M4, G95 and G96"))
}

/// The letter of the words that move an axis.
pub(crate) fn letter(axis: Axis) -> char {
    axis.name().chars().next().unwrap_or(' ').to_ascii_uppercase()
}

/// Refuses a position outside the travel of its axis, and one of an axis that there is not; `at` in mm or
/// degrees.
pub(crate) fn within_travel(machine: &Machine, axis: Axis, at: f64, blame: Blame) -> Done {
    let Some(config) = machine.axis.get(&axis) else {
        let is_origin = Position::from_mm(at) == Position(0);
        return if is_origin { Ok(()) } else { Err(no_axis(machine, axis)) };
    };
    let [low, high] = config.travel_mm;
    if (low..=high).contains(&at) {
        return Ok(());
    }
    let is_radius = axis == Axis::X && machine.general.kinematics == Kinematics::Lathe;
    let message = format!(
        "{axis} at {} {unit}{note} is outside axis.{name}.travel_{unit} = [{}, {}]",
        short(at),
        short(low),
        short(high),
        note = if is_radius { " (radius)" } else { "" },
        name = axis.name(),
        unit = axis.unit(),
    );
    let help = "keep the target within the travel; check units (G20, G21), G7, G91 and offsets";
    Err(Problem::error("travel-limit", blame, message, help))
}

/// The machine is asked for an axis that it does not have.
pub(crate) fn no_axis(machine: &Machine, axis: Axis) -> Box<Problem> {
    let kind = match machine.general.kinematics {
        Kinematics::Lathe => "lathe",
        Kinematics::Mill => "mill",
        Kinematics::Positioner => "positioner",
    };
    let axes: Vec<String> = machine.axes().map(|(axis, _)| axis.to_string()).collect();
    let message = format!("this {kind} has no axis {axis}, which would leave its zero here");
    let help = format!("its axes are {}: leave the word out", axes.join(", "));
    Problem::error("no-such-axis", Blame::Word(letter(axis)), message, help)
}
