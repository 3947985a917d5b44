//! A pass as it is sent and kept in files. In: a [`ThreadPass`]. Out: the same, bit for bit, in a fifth of
//! the bytes.
//!
//! What an axis does not do is left out, the windows that all axes on a helix have in common stand once, an
//! end is told by its way from the start, and numbers that people choose are short ([`Short`]).

use core::fmt::{Formatter, Result as Written};

use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeSeq;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{AxisLaw, Changes, Corner, Corners, ThreadPass, WayOut};
use crate::units::{AXES, Axis, PerAxis, Position};

/// A pass.
#[derive(Serialize, Deserialize)]
pub(super) struct Stored {
    pass: u32,
    start: u32,
    s_rpm: Short,
    direction: Short,
    start_angle_deg: Short,
    /// `None`: that of Z.
    lead_mm: Option<Short>,
    /// `None`: where the first axis leaves the thread.
    thread_end_deg: Option<Bits>,
    max_ratio: f64,
    depth_mm: f64,
    /// Axis, what leaves; where it is clear, seen from the end of its law, and how much before that it is
    /// free.
    out: (u8, u8, i64, i64),
    /// Of a pass that returns: speed of the way out, dwell.
    back: Option<[Short; 2]>,
    helix: Option<Helix>,
    laws: Laws,
    turns: Turns,
}

/// Run-in and brake: angle, window, λ.
#[derive(Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Helix {
    run_in: [Bits; 3],
    brake_c: Bits,
    /// `None`: those of the run-in.
    brake_shape: Option<[Bits; 2]>,
}

/// What one axis does.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Law {
    start: Position,
    way: i64,
    approach: Option<Approach>,
    lead: Option<Lead>,
    retract: Option<Retract>,
}

/// Stroke, angle, window; way and angle of its unloading.
#[derive(Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Approach {
    stroke: [Bits; 3],
    unload: Option<[Bits; 2]>,
}

/// Signed advance per revolution, mm, and where it is reached and left.
#[derive(Clone, Copy, Serialize, Deserialize)]
enum Lead {
    /// With the other axes.
    OnHelix(Short),
    /// Alone.
    Own(Short, Helix),
}

#[derive(Clone, Copy, Serialize, Deserialize)]
enum Retract {
    /// No stroke: the axis belongs to the pass until its brake is over.
    WithBrake,
    /// Stroke, angle, window.
    Stroke([Bits; 3]),
}

/// A number by its bits: 0 and −0 differ, and what is not a number is one and the same.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Bits(u64);

impl Serialize for Bits {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        f64::from_bits(self.0).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Bits {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Bits, D::Error> {
        f64::deserialize(deserializer).map(|value| Bits(value.to_bits()))
    }
}

/// A number whose last bits are 0, as in 400 or 1.5, takes few bytes: an integer with those bits in front.
#[derive(Clone, Copy, PartialEq)]
struct Short(f64);

impl Serialize for Short {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.to_bits().swap_bytes().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Short {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Short, D::Error> {
        u64::deserialize(deserializer).map(|bits| Short(f64::from_bits(bits.swap_bytes())))
    }
}

/// The laws of the axes that have one, each behind its axis.
struct Laws(PerAxis<Option<Law>>);

impl Serialize for Laws {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut laws = serializer.serialize_seq(Some(self.0.iter().flatten().count()))?;
        for (axis, law) in Axis::ALL.iter().zip(&self.0) {
            if let Some(law) = law {
                laws.serialize_element(&(axis, law))?;
            }
        }
        laws.end()
    }
}

impl<'de> Deserialize<'de> for Laws {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Laws, D::Error> {
        struct Each;

        impl<'de> Visitor<'de> for Each {
            type Value = Laws;

            fn expecting(&self, text: &mut Formatter<'_>) -> Written {
                text.write_str("the laws of axes, each axis once")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut laws: A) -> Result<Laws, A::Error> {
                let mut all: PerAxis<Option<Law>> = [None; AXES];
                let mut next = 0;
                while let Some((axis, law)) = laws.next_element::<(Axis, Law)>()? {
                    if axis.index() < next {
                        return Err(A::Error::custom("the axes of a pass are not in their order"));
                    }
                    next = axis.index() + 1;
                    all[axis.index()] = Some(law);
                }
                Ok(Laws(all))
            }
        }

        deserializer.deserialize_seq(Each)
    }
}

/// The corners that there are: angle, window, leads and growths of X and Z.
struct Turns(Corners);

impl Serialize for Turns {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // What stands behind the last one that is something: nothing is lost, whatever a pass holds.
        let is_something = |corner: &Corner| {
            let Corner { c_deg, dc_deg, x_mm: [x, x_grows], z_mm: [z, z_grows] } = *corner;
            [c_deg, dc_deg, x, x_grows, z, z_grows].iter().any(|value| value.to_bits() != 0)
        };
        let count = self.0.iter().rposition(is_something).map_or(0, |last| last + 1);
        let mut corners = serializer.serialize_seq(Some(count))?;
        for Corner { c_deg, dc_deg, x_mm, z_mm } in &self.0[..count] {
            let leads = [x_mm[0], x_mm[1], z_mm[0], z_mm[1]].map(Short);
            corners.serialize_element(&(c_deg, dc_deg, leads))?;
        }
        corners.end()
    }
}

impl<'de> Deserialize<'de> for Turns {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Turns, D::Error> {
        struct Each;

        impl<'de> Visitor<'de> for Each {
            type Value = Turns;

            fn expecting(&self, text: &mut Formatter<'_>) -> Written {
                text.write_str("the corners of a pass, not too many")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut corners: A) -> Result<Turns, A::Error> {
                let mut all = Corners::default();
                let mut next = all.iter_mut();
                while let Some((c_deg, dc_deg, leads)) = corners.next_element::<(f64, f64, [Short; 4])>()? {
                    let [x, x_grows, z, z_grows] = leads.map(|Short(lead)| lead);
                    let corner =
                        next.next().ok_or_else(|| A::Error::custom("a pass has too many corners"))?;
                    *corner = Corner { c_deg, dc_deg, x_mm: [x, x_grows], z_mm: [z, z_grows] };
                }
                Ok(Turns(all))
            }
        }

        deserializer.deserialize_seq(Each)
    }
}

fn bits(values: [f64; 3]) -> [Bits; 3] {
    values.map(|value| Bits(value.to_bits()))
}

fn values(bits: [Bits; 3]) -> [f64; 3] {
    bits.map(|Bits(bits)| f64::from_bits(bits))
}

fn is_something(values: [Bits; 3]) -> bool {
    values != [Bits(0); 3]
}

/// The windows of an axis that has a lead.
fn helix(law: &AxisLaw) -> Option<Helix> {
    let run_in = bits([law.run_in_c0_deg, law.run_in_dc_deg, law.run_in_lambda]);
    let brake = bits([law.brake_c_deg, law.brake_dc_deg, law.brake_lambda]);
    let leads = law.lead_mm.to_bits() != 0 || is_something(run_in) || is_something(brake);
    let ([_, dc, lambda], [brake_c, brake_dc, brake_lambda]) = (run_in, brake);
    let (shape, brake_shape) = ([dc, lambda], [brake_dc, brake_lambda]);
    let brake_shape = (brake_shape != shape).then_some(brake_shape);
    leads.then_some(Helix { run_in, brake_c, brake_shape })
}

impl Helix {
    fn brake(self) -> [Bits; 3] {
        let [_, dc, lambda] = self.run_in;
        let [dc, lambda] = self.brake_shape.unwrap_or([dc, lambda]);
        [self.brake_c, dc, lambda]
    }
}

/// Where the first axis leaves the thread, of those that are in it.
fn first_leaves(laws: &PerAxis<AxisLaw>) -> f64 {
    let in_thread = laws.iter().filter(|law| law.is_led() || law.retract_dc_deg != 0.0);
    in_thread.map(AxisLaw::leaves_deg).fold(f64::INFINITY, f64::min)
}

impl Law {
    fn new(law: &AxisLaw, common: Option<Helix>) -> Option<Law> {
        let stroke = bits([law.stroke_mm, law.stroke_c0_deg, law.stroke_dc_deg]);
        let [mm, dc_deg, _] = bits([law.unload_mm, law.unload_dc_deg, 0.0]);
        let unload = ([mm, dc_deg] != [Bits(0); 2]).then_some([mm, dc_deg]);
        let approach = (is_something(stroke) || unload.is_some()).then_some(Approach { stroke, unload });
        let retract = bits([law.retract_mm, law.retract_c_deg, law.retract_dc_deg]);
        let with_brake = bits([0.0, law.brake_c_deg, law.brake_dc_deg]);
        let lead_mm = Short(law.lead_mm);
        let lead = helix(law).map(|own| match common {
            Some(common) if common == own => Lead::OnHelix(lead_mm),
            _ => Lead::Own(lead_mm, own),
        });
        let stored = Law {
            start: law.start,
            way: law.end.0.wrapping_sub(law.start.0),
            approach,
            lead,
            retract: is_something(retract).then_some(match retract == with_brake {
                true => Retract::WithBrake,
                false => Retract::Stroke(retract),
            }),
        };
        (*law != AxisLaw::default() || stored.does_something()).then_some(stored)
    }

    fn does_something(&self) -> bool {
        self.approach.is_some() || self.lead.is_some() || self.retract.is_some()
    }

    fn axis_law(self, common: Option<Helix>) -> AxisLaw {
        let [stroke_mm, stroke_c0_deg, stroke_dc_deg] =
            self.approach.map_or([0.0; 3], |approach| values(approach.stroke));
        let unload = self.approach.and_then(|approach| approach.unload);
        let [unload_mm, unload_dc_deg] =
            unload.map_or([0.0; 2], |two| two.map(|Bits(bits)| f64::from_bits(bits)));
        let (lead_mm, helix) = match self.lead {
            None => (0.0, None),
            Some(Lead::OnHelix(Short(lead_mm))) => (lead_mm, common),
            Some(Lead::Own(Short(lead_mm), own)) => (lead_mm, Some(own)),
        };
        let [run_in_c0_deg, run_in_dc_deg, run_in_lambda] =
            helix.map_or([0.0; 3], |helix| values(helix.run_in));
        let [brake_c_deg, brake_dc_deg, brake_lambda] = helix.map_or([0.0; 3], |helix| values(helix.brake()));
        let [retract_mm, retract_c_deg, retract_dc_deg] = match self.retract {
            None => [0.0; 3],
            Some(Retract::WithBrake) => [0.0, brake_c_deg, brake_dc_deg],
            Some(Retract::Stroke(stroke)) => values(stroke),
        };
        AxisLaw {
            start: self.start,
            end: Position(self.start.0.wrapping_add(self.way)),
            stroke_mm,
            stroke_c0_deg,
            stroke_dc_deg,
            unload_mm,
            unload_dc_deg,
            lead_mm,
            steepest_mm: 0.0,
            run_in_c0_deg,
            run_in_dc_deg,
            run_in_lambda,
            brake_c_deg,
            brake_dc_deg,
            brake_lambda,
            retract_mm,
            retract_c_deg,
            retract_dc_deg,
        }
    }
}

/// What is beyond a byte is refused where it arrives.
fn out_of(out: &WayOut, laws: &PerAxis<AxisLaw>) -> (u8, u8, i64, i64) {
    let byte = |value: u32| u8::try_from(value).unwrap_or(u8::MAX);
    let (end, clear) = (end_of(laws, out.axis), out.clear.0);
    (byte(out.axis), byte(out.leaves), clear.wrapping_sub(end), clear.wrapping_sub(out.free.0))
}

fn way_out((axis, leaves, beyond, before): (u8, u8, i64, i64), laws: &PerAxis<AxisLaw>) -> WayOut {
    let clear = end_of(laws, axis.into()).wrapping_add(beyond);
    let (clear, free) = (Position(clear), Position(clear.wrapping_sub(before)));
    WayOut { axis: axis.into(), leaves: leaves.into(), clear, free }
}

/// Where the law of the axis that lifts ends; an axis that there is not ends nowhere.
fn end_of(laws: &PerAxis<AxisLaw>, axis: u32) -> i64 {
    laws.get(axis as usize).map_or(0, |law| law.end.0)
}

impl From<ThreadPass> for Stored {
    fn from(pass: ThreadPass) -> Stored {
        let common = pass.axes.iter().find_map(helix);
        let differs = |one: f64, other: f64| one.to_bits() != other.to_bits();
        let (lead_mm, end_deg) = (pass.axis(Axis::Z).lead_mm, pass.thread_end_deg);
        Stored {
            pass: pass.pass,
            start: pass.start,
            s_rpm: Short(pass.s_rpm),
            direction: Short(pass.direction),
            start_angle_deg: Short(pass.start_angle_deg),
            lead_mm: differs(pass.lead_mm, lead_mm).then_some(Short(pass.lead_mm)),
            thread_end_deg: differs(end_deg, first_leaves(&pass.axes)).then_some(Bits(end_deg.to_bits())),
            max_ratio: pass.max_ratio,
            depth_mm: pass.depth_mm,
            out: out_of(&pass.out, &pass.axes),
            back: (pass.return_ratio.to_bits(), pass.dwell_s.to_bits())
                .ne(&(0, 0))
                .then_some([Short(pass.return_ratio), Short(pass.dwell_s)]),
            helix: common,
            laws: Laws(pass.axes.map(|law| Law::new(&law, common))),
            turns: Turns(pass.corners),
        }
    }
}

impl From<Stored> for ThreadPass {
    fn from(stored: Stored) -> ThreadPass {
        let Laws(laws) = stored.laws;
        let axis_law = |law: Law| law.axis_law(stored.helix);
        let mut axes = laws.map(|law| law.map_or_else(AxisLaw::default, axis_law));
        let Turns(corners) = stored.turns;
        for (axis, law) in Axis::ALL.into_iter().zip(&mut axes) {
            let locked_deg = law.run_in_c0_deg + law.run_in_dc_deg;
            law.steepest_mm = Changes::of(&corners, axis).steepest_mm(law.lead_mm, locked_deg);
        }
        let [Short(return_ratio), Short(dwell_s)] = stored.back.unwrap_or([Short(0.0); 2]);
        ThreadPass {
            pass: stored.pass,
            start: stored.start,
            s_rpm: stored.s_rpm.0,
            direction: stored.direction.0,
            start_angle_deg: stored.start_angle_deg.0,
            lead_mm: stored.lead_mm.map_or(axes[Axis::Z.index()].lead_mm, |Short(lead_mm)| lead_mm),
            thread_end_deg: stored
                .thread_end_deg
                .map_or_else(|| first_leaves(&axes), |end| f64::from_bits(end.0)),
            max_ratio: stored.max_ratio,
            depth_mm: stored.depth_mm,
            out: way_out(stored.out, &axes),
            return_ratio,
            dwell_s,
            axes,
            corners,
        }
    }
}
