//! A blunt start on the built-in lathe: the surface that the true tool leaves, on a grid of its own, against
//! where the ridge has to begin and where it has to be untouched.

use machine::Machine;
use protocol::{Axis, Code, operator::Request};
use rig::observe::Outcome;

use crate::stand::{Stand, compiled};

/// Angles at which the part is looked at, and places along Z, mm.
const STATIONS: usize = 72;
const STEP_MM: f64 = 0.02;
const LOW_MM: f64 = -7.0;
const NODES: usize = 420;
/// The crest, and the height of a sharp V of 60 degrees over its half width.
const CREST_MM: f64 = 9.91;
const RISES: f64 = 1.732_050_807_568_877_2;
/// Lead, depth and start of the last pass of the thread, mm; turns of the groove to the ridge, step.
const LEAD: f64 = 2.0;
const DEPTH: f64 = 1.4845;
const TURNS: f64 = 0.9;
const D: f64 = 0.15;

const PROGRAM: &str = "G18 G21 G90 G7 G94 G97\nS600 M3\nG0 X22 Z8\nG76 P2 Z-12 I-2.18 J2 K2.969 R2 Q29.5\nS100\nG0 Z8\n\
                       (blunt_start, Z0 T0.9 D0.15)\nG76 P2 Z-12 I-2.18 J2 K2.969 R2 Q29.5\nM2\n";

/// The radius of the part at every angle and place.
struct Surface(Vec<[f64; NODES]>);

impl Surface {
    fn cut(&mut self, station: usize, x: f64, z: f64) {
        for (node, radius) in self.0[station].iter_mut().enumerate() {
            let at = LOW_MM + STEP_MM * node as f64;
            *radius = radius.min(x + (at - z).abs() * RISES);
        }
    }

    fn at(&self, station: usize, z: f64) -> f64 {
        self.0[station][((z - LOW_MM) / STEP_MM).round() as usize]
    }
}

/// The surface after the program, and the angle over which the tool leaves its blunt passes.
fn surface(program: &str) -> (Surface, f64) {
    let machine = Machine::default();
    let items = compiled(&machine, program);
    let mut passes =
        items.iter().filter_map(|item| if let Code::Pass(pass) = item.code { Some(pass) } else { None });
    let over_deg = passes.next_back().expect("a blunt pass").axis(Axis::X).retract_dc_deg;
    let mut part = Surface(vec![[CREST_MM; NODES]; STATIONS]);
    let (mut before, mut passes) = (None, 0);
    let stand = Stand { machine: &machine, items: &items, scenario: "", seed: 3 };
    let observation = stand.run(|record| {
        let truth = record.truth;
        let slide = |axis: Axis| truth.axes[axis.index()].slide_mm;
        let now = [truth.spindle_deg, slide(Axis::X), slide(Axis::Z)];
        if let Some(before) = before.replace(now) {
            let [from, to] = [before, now].map(|[deg, ..]: [f64; 3]| deg * STATIONS as f64 / 360.0);
            let mut next = from.ceil();
            while next < to {
                let share = (next - from) / (to - from);
                let [x, z] = [1, 2].map(|i| before[i] + share * (now[i] - before[i]));
                part.cut(next.rem_euclid(STATIONS as f64) as usize, x, z);
                next += 1.0;
            }
        }
        // The override is turned in the middle of a blunt pass.
        let (_, status) = record.axes.iter().find(|(axis, _)| *axis == Axis::Z).expect("a lathe");
        let new = status.pass > 8 && status.pass != passes && slide(Axis::Z) < 3.0 && slide(Axis::X) < 9.0;
        new.then(|| {
            passes = status.pass;
            Request::SpindleOverride(if passes % 2 == 0 { 60.0 } else { 100.0 })
        })
    });
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    (part, over_deg)
}

#[test]
fn the_ridge_begins_at_its_angle_and_is_whole_behind_it() {
    let (part, over_deg) = surface(PROGRAM);
    assert!(over_deg < 120.0, "{over_deg}");
    let start = 8.0 - DEPTH * libm::tan(29.5_f64.to_radians());
    let begins = -TURNS * LEAD;
    let whole = begins - LEAD * over_deg / 360.0;
    let cusp = 0.5 * D * RISES;
    let (mut most, mut gone, mut there) = (0.0_f64, 0, 0);
    for station in 0..STATIONS {
        // The groove that lies between the face and a turn behind it, and one more turn.
        let helix = start - LEAD * station as f64 / STATIONS as f64;
        let groove = -(-helix).rem_euclid(LEAD);
        for behind in [groove, groove - LEAD] {
            let (root, ridge) = (part.at(station, behind), part.at(station, behind + 0.5 * LEAD));
            assert!((root - CREST_MM + DEPTH).abs() < 0.05, "root {root} at {behind}");
            if behind > begins {
                // Nothing is left between the groove and the face but what lies between two passes.
                let left = (0..).map(|node| behind + 0.01 * f64::from(node)).take_while(|z| *z < -0.02);
                let highest = left.map(|z| part.at(station, z)).fold(0.0, f64::max);
                most = most.max(highest - CREST_MM + DEPTH);
                gone += 1;
            } else if behind < whole {
                assert_eq!(ridge, CREST_MM, "the ridge at {behind} is touched");
                there += 1;
            }
        }
        assert_eq!(part.at(station, groove - 1.5 * LEAD), CREST_MM, "a ridge behind it is touched");
    }
    println!("left of the ridge {most:.4} mm over the root, {gone} places without, {there} with it");
    assert!(most < cusp + 0.03 && most > 0.5 * cusp, "{most} mm, cusps of {cusp}");
    assert!(gone == 65 && there > 60, "{gone} {there}");
}

/// Without the comment the same cycle cuts the groove once more, and the thin beginning stays.
#[test]
fn a_control_without_the_word_leaves_the_thin_beginning() {
    let (part, _) = surface(&PROGRAM.replace("blunt_start", "a start"));
    let start = 8.0 - DEPTH * libm::tan(29.5_f64.to_radians());
    let stands = (0..STATIONS).filter(|station| {
        let groove = -(LEAD * *station as f64 / STATIONS as f64 - start).rem_euclid(LEAD);
        groove < -1.0 && groove > -1.8 && part.at(*station, groove + 0.9) > CREST_MM - 0.3
    });
    assert!(stands.count() > 20);
}
