//! A screw is ground once: behind a reference run the slide is where it is wanted, wherever the axis was
//! switched on. Judged at the slide, which no controller sees.

use std::f64::consts::TAU;

use machine::{Machine, Method};
use protocol::Axis;
use rig::observe::Outcome;

use crate::{
    references::PLAIN,
    stand::{Stand, compiled},
};

/// A turn of the motor, and where the switch or the index lies beyond home, mm.
const LEAD_MM: f64 = 5.0;
const MARK_MM: f64 = 20.0;
/// Friction of the guide from rest over the stiffness of the drive train, 160 N over 110 kg at 100 Hz: so far
/// the slide may stand beside its nut.
const FRICTION_MM: f64 = 0.0037;
/// From the same side it stands there every time, but for where it came to rest.
const AGAIN_MM: f64 = 0.0005;
/// A steep error of the screw by the way from home, mm and µm; at home there is none.
const ROWS: [[f64; 2]; 6] =
    [[-500.0, -120.0], [-100.0, 0.0], [-40.0, 30.0], [0.0, 0.0], [20.0, 40.0], [100.0, 90.0]];

/// The plain lathe with an axis C besides, that is another Z; and with these keys of one of both.
fn lathe(axis: Axis, method: Method, off_mm: f64, believed: &str, truth: &str) -> Machine {
    let method = match method {
        Method::Switch => "switch",
        Method::SwitchAndIndex => "switch-and-index",
        Method::Index => "index",
    };
    let (_, z) = PLAIN.split_once("[axis.z]").expect("it has a Z");
    let (z, _) = z.split_once("[spindle]").expect("it has a spindle");
    let c = z.replace("mm", "deg").replace("home_deg = 100.0", "home_deg = 0.0");
    let (_, guide) = PLAIN.split_once("[plant.axis.z]").expect("of which something is true");
    let (guide, _) = guide.split_once("[plant.spindle]").expect("and of its spindle");
    let unit = if axis.is_rotary() { "deg" } else { "mm" };
    let run = format!(
        "[axis.{}.reference]\nmethod = \"{method}\"\nposition_{unit} = {}\nsearch_{unit}_s = 40\nlatch_{unit}_s = 2\n\n",
        axis.name(),
        home_mm(axis) + MARK_MM
    );
    let scatter = if method == "index" { "" } else { "switch_scatter_mm = 0\n" };
    let truth = format!("home_off_mm = {off_mm}\n{scatter}{truth}\n");
    let keys = |of: Axis, keys: &str| if of == axis { keys.to_owned() } else { String::new() };
    let own = PLAIN
        .replacen(
            "[axis.z]",
            &format!("[axis.c]{c}{}\n{}[axis.z]", keys(Axis::C, believed), keys(Axis::C, &run)),
            1,
        )
        .replacen("[spindle]", &format!("{}\n{}[spindle]", keys(Axis::Z, believed), keys(Axis::Z, &run)), 1)
        .replacen("[plant.axis.z]", &format!("[plant.axis.z]\n{}", keys(Axis::Z, &truth)), 1)
        .replacen(
            "[plant.spindle]",
            &format!("[plant.axis.c]{guide}\n{}[plant.spindle]", keys(Axis::C, &truth)),
            1,
        );
    Machine::from_toml(&own).expect("a sound machine")
}

fn home_mm(axis: Axis) -> f64 {
    if axis == Axis::C { 0.0 } else { 100.0 }
}

/// The table of an axis with this home.
fn table(axis: Axis) -> String {
    let row = |[mm, um]: [f64; 2]| format!("[{}, {um}]", home_mm(axis) + mm);
    format!("screw_error = [{}]", ROWS.map(row).join(", "))
}

/// How far beyond where it is wanted the slide stands at these places, mm from home and falling, in the
/// program that begins with the run.
fn beside_mm(machine: &Machine, axis: Axis, places_mm: &[f64]) -> Vec<f64> {
    let (name, home_mm) = (axis.name().to_ascii_uppercase(), home_mm(axis));
    let go = |mm: &f64| format!("G0 {name}{}\nG4 P0.3\n", home_mm + mm);
    let way: String = [places_mm[0] + 3.0].iter().chain(places_mm).map(go).collect();
    let items = compiled(machine, &format!("G18 G21 G90 G94 G8\n{way}M2\n"));
    let mut stood = vec![f64::NAN; places_mm.len()];
    let seen = Stand { machine, items: &items, scenario: "", seed: 6 }.run(|record| {
        let (_, status) = record.axes.iter().find(|(own, _)| *own == axis).expect("it is there");
        for (at_mm, stood) in places_mm.iter().map(|mm| home_mm + mm).zip(&mut stood) {
            let there = status.velocity_mm_s == 0.0 && (status.commanded_mm - at_mm).abs() < 1e-6;
            if there && !record.machine.is_unreferenced(axis) {
                *stood = record.truth.axes[axis.index()].slide_mm - at_mm;
            }
        }
        None
    });
    assert_eq!(seen.outcome, Outcome::Completed, "{:?}", seen.faults);
    stood
}

/// The machine switched on so far beside home; each time the slide stands so far beyond its places, and but
/// for a count and what friction leaves, `again_mm`, in the same places.
fn holds_wherever_it_is_switched_on(
    (offs_mm, again_mm): (&[f64], f64),
    lathe: impl Fn(f64) -> (Machine, Axis),
    expected: &[(f64, f64)],
    what: &str,
) {
    let (places_mm, expected_mm): (Vec<f64>, Vec<f64>) = expected.iter().copied().unzip();
    let mut first: Option<Vec<f64>> = None;
    for off_mm in offs_mm {
        let (machine, axis) = lathe(*off_mm);
        let beside = beside_mm(&machine, axis, &places_mm);
        println!("{what}, {off_mm} mm beside home: {beside:.5?} of {expected_mm:.5?}");
        let config = &machine.axis[&axis];
        let count_mm = config.screw_lead_mm / f64::from(config.encoder_counts);
        let first = first.get_or_insert_with(|| beside.clone());
        for (i, mm) in beside.iter().enumerate() {
            assert!((mm - expected_mm[i]).abs() < 2.0 * FRICTION_MM, "{what}, {off_mm}: {beside:?}");
            assert!((mm - first[i]).abs() < count_mm + again_mm, "{what}, {off_mm}: {beside:?}, {first:?}");
        }
    }
}

/// Over a turn of the screw.
const TURN_MM: [f64; 5] = [0.0, 1.25, -1.25, 2.3, -0.737];

#[test]
fn a_wobble_is_where_it_is_in_the_machine() {
    let wobble = |mm: f64| 0.02 * libm::sin(TAU * mm / LEAD_MM);
    let places = [0.0, -58.75, -61.25, -80.4].map(|mm| (mm, wobble(mm)));
    for axis in [Axis::Z, Axis::C] {
        for method in [Method::SwitchAndIndex, Method::Index] {
            let wobbles = |off_mm| (lathe(axis, method, off_mm, "", "screw_wobble_um = 20"), axis);
            holds_wherever_it_is_switched_on(
                (&TURN_MM, AGAIN_MM),
                wobbles,
                &places,
                &format!("{axis:?}, {method:?}"),
            );
        }
    }
}

/// An index is at the motor and a scale at the slide: between them is half of the backlash, whichever way the
/// run goes.
#[test]
fn half_of_the_backlash_is_taken_off_at_an_index_of_an_axis_with_a_scale() {
    let places = [20.0, 0.0, -40.0].map(|mm| (mm, 0.0));
    for way in [1.0, -1.0] {
        let believed = "scale_step_mm = 0.0001\nbacklash_mm = 0.012\n";
        let with_backlash = |off_mm| {
            let truth = "backlash_mm = 0.012";
            let mut machine = lathe(Axis::Z, Method::SwitchAndIndex, off_mm, believed, truth);
            let z = machine.axis.get_mut(&Axis::Z).expect("it is there");
            // A loop over a backlash swings sooner.
            z.position_gain_1_s *= 0.4;
            let run = z.reference.as_mut().expect("its run");
            run.search_mm_s *= way;
            run.position_mm = home_mm(Axis::Z) + way * MARK_MM;
            (machine, Axis::Z)
        };
        let what = format!("way {way}");
        holds_wherever_it_is_switched_on((&[0.0, 1.25], FRICTION_MM), with_backlash, &places, &what);
    }
}

/// What is believed of it is right in its rows; by a scale the slide is there in any case.
#[test]
fn what_is_believed_of_a_screw_holds_wherever_the_axis_is_switched_on() {
    let places = [20.0, 0.0, -40.0, -100.0].map(|mm| (mm, 0.0));
    for axis in [Axis::Z, Axis::C] {
        for scale in ["", "scale_step_mm = 0.0001\n"] {
            // Indexes of a motor are not whole turns apart on a scale: alone it has to be the marked one.
            let count = if scale.is_empty() { 3 } else { 2 };
            for method in [Method::Switch, Method::SwitchAndIndex, Method::Index].into_iter().take(count) {
                let scale = if axis.is_rotary() { scale.replace("mm", "deg") } else { scale.to_owned() };
                let believed = format!("{scale}{}", table(axis));
                let steep = |off_mm| (lathe(axis, method, off_mm, &believed, &table(axis)), axis);
                let far = [0.0, 60.0, -60.0, 1.25];
                let offs = if method == Method::Index { &TURN_MM[..] } else { &far[..] };
                // At an index of the motor the slide is where friction leaves it, and its scale says so.
                let is_beside = !scale.is_empty() && method != Method::Switch;
                let again_mm = if is_beside { FRICTION_MM } else { AGAIN_MM };
                let what = format!("{axis:?}, {method:?}, {}", scale.trim());
                holds_wherever_it_is_switched_on((offs, again_mm), steep, &places, &what);
            }
        }
    }
}
