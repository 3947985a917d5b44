//! Whether a tool in the material is in its groove. In: where it touches, what the servo does undisturbed,
//! what the events excuse. Out: by how much it is too deep, or in a flank, if that is too much.

use machine::Machine;
use protocol::{Axis, ThreadPass};

use super::{
    Broken, Known, bounds, excuse,
    stock::{Contact, PassStock},
};
use crate::event::Event;

/// Beside what the servo does undisturbed, mm.
pub(super) const TOLERANCE_MM: f64 = 0.005;
/// What the servo does undisturbed it may do a little worse.
const SCATTER: f64 = 1.2;
/// What the servo may do undisturbed at most, mm; beyond it a machine is not fit to be a reference.
const WORST_SERVO_MM: f64 = 0.2;
/// A spindle swings through rest when it has stopped, slower than this, 1/min.
const SWINGS_RPM: f64 = 20.0;

/// What is seen of a tool that touches in a cycle: the changes of the spindle's speed so far, 1/min in a
/// cycle; whether X and Z have torque; the speed of the spindle, 1/min; turns that nobody can have seen;
/// how fast X was when Z had torque last, mm/s; how deep the tool was when X began to leave, mm.
pub(super) struct Seen {
    pub(super) contact: Contact,
    pub(super) now: u64,
    pub(super) turn: u64,
    pub(super) uneven: f64,
    pub(super) led: [bool; 2],
    pub(super) rpm: f64,
    pub(super) unseen: f64,
    pub(super) x_mm_s: f64,
    pub(super) left_mm: Option<f64>,
}

/// How far X, by an estimate, and Z lag behind a spindle that is uneven, mm.
fn lags_mm(machine: &Machine, pass: &ThreadPass, lead: f64, uneven: f64) -> (f64, f64) {
    let steepest = excuse::steepest_mm(pass.axis(Axis::X));
    let x_mm =
        excuse::lag_mm(machine, Axis::X, steepest, uneven) + excuse::late_mm(machine, steepest, uneven);
    (excuse::SLACK * x_mm, excuse::lag_mm(machine, Axis::Z, lead, uneven))
}

/// The tool is beside its groove. Without torque X gives no depth any more, but Z goes on along the helix up
/// to where the pass brakes, unless its encoder has failed too; without Z, X may not go deeper.
pub(super) fn beside(known: &Known, pass: &ThreadPass, stock: &PassStock, seen: &Seen) -> Option<Broken> {
    let Seen { contact, now, turn, uneven, led: [x_led, z_led], rpm, unseen, x_mm_s, left_mm } = seen;
    let (tan, now, turn, uneven) = (known.tan_flank, *now, *turn, *uneven);
    let servo = match known.reference {
        Some(reference) => reference.servo.get(&pass.pass).copied().unwrap_or((0.0, 0.0)),
        None => (WORST_SERVO_MM, WORST_SERVO_MM),
    };
    let (lead, mut deepest) = (stock.lead, false);
    let counted = |event: &Event| now >= event.at && excuse::miscounts(&event.what);
    let (mut bottom, mut flank) = (SCATTER * servo.0 + TOLERANCE_MM, SCATTER * servo.1 + TOLERANCE_MM);
    // Excuses only add: what is within without any needs none.
    let depth_mm = contact.bottom_mm.max(contact.depth_mm - stock.deepest);
    if depth_mm <= bottom && contact.flank_mm <= flank {
        return None;
    }
    if known.reference.is_some() {
        let (x_lag_mm, lag_mm) = lags_mm(known.machine, pass, lead, uneven);
        flank += excuse::SLACK * lag_mm + x_lag_mm * tan;
        bottom += x_lag_mm + lag_mm * pass.axis(Axis::X).lead_mm.abs() / lead;
    }
    let out = bounds::way_out(known.machine, pass);
    for event in known.events {
        let excuse = excuse::excuse(known.machine, event, now, pass, out, turn);
        // A tool that is pushed in has less room between the flanks; on a cone one that is pushed along is
        // deeper.
        let (radial, axial) = (excuse.radial_mm, excuse.axial_mm + excuse.turns * lead);
        deepest |= excuse.deepest;
        bottom += excuse::SLACK * (radial + axial * stock.slope.abs());
        flank += excuse::SLACK * (axial + radial * tan);
    }
    // How far a steep approach or retract is beside its place with Z.
    let bottom_mm = match deepest {
        true => contact.depth_mm - stock.deepest,
        false => stock.bottom_mm(contact, flank),
    };
    // A way out by time begins more gently than a retract by the angle that is under way: it is behind it at
    // first, and no deeper along the cone than where it began.
    let bottom_mm = left_mm.map_or(bottom_mm, |left_mm| bottom_mm.min(contact.depth_mm - left_mm));
    // Behind a spindle that runs away X is still in the part where Z ends: that is as far as Z may go.
    let ends = deepest && stock.brakes(contact);
    if ends {
        flank += excuse::overshoot_mm(known.machine, Axis::Z, lead * rpm.abs() / 60.0);
    }
    let flank_mm = if ends { stock.beyond_mm(contact) } else { contact.flank_mm };
    flank += unseen * lead;
    if rpm.abs() < SWINGS_RPM {
        // A spindle that swings through rest turns Z round: its slide is anywhere in its backlash.
        flank += excuse::backlash_mm(known.machine, Axis::Z);
    }
    if !z_led {
        // X went in with a Z that stands now: it has to turn round first.
        bottom += turning_mm(known, x_mm_s.max(stock.steep(contact) * stock.lead * rpm.abs() / 60.0));
    }
    let told = |what: &str, by: f64, most: f64| {
        format!(
            "pass {}: {:.1} µm {what}, {:.1} allowed, {:.4} mm deep",
            pass.pass,
            1e3 * by,
            1e3 * most,
            contact.depth_mm
        )
    };
    if *x_led && bottom_mm > bottom {
        return Some(Broken::new("bottom", now, told("too deep", bottom_mm, bottom)));
    }
    let follows = !(stock.brakes(contact) || known.events.iter().any(counted));
    let on_helix = *z_led && (*x_led || follows);
    let beside = on_helix && flank_mm > flank;
    beside.then(|| Broken::new("flank", now, told("into the flank", flank_mm, flank)))
}

/// How far X still goes that was led inwards so fast, mm/s, once Z has no torque: three cycles until every
/// regulator knows, then as hard as it can, and the same again for the ramps of its acceleration.
fn turning_mm(known: &Known, v: f64) -> f64 {
    let Some(x) = known.machine.axis.get(&Axis::X) else { return 0.0 };
    let limits = x.limits();
    v * (3.0 * known.machine.general.cycle_s + limits.a / limits.j) + v * v / (2.0 * limits.a)
}
