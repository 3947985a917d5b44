//! By how much a looser tolerance or a finer contour may be slower, which it should not be: what `check`
//! foretells of random contours of lines with three decimals, through the compressor and the planning.

use crate::shop::{Place, project};
use testing::{Seed, count};

/// A closed random contour: radius by angle, a sum of waves, with so many corners.
struct Contour {
    waves: Vec<(f64, f64, f64)>,
    corners: usize,
}

impl Contour {
    fn random(random: &mut Seed) -> Contour {
        let wave = |random: &mut Seed| {
            let often = f64::from(2 + (random.next() % 9) as u32);
            (often, random.between(0.2, 3.0) / often, random.between(0.0, 6.0))
        };
        Contour { waves: (0..3).map(|_| wave(random)).collect(), corners: (random.next() % 4) as usize }
    }

    fn at(&self, turn: f64) -> [f64; 2] {
        let radius: f64 =
            12.0 + self.waves.iter().map(|(n, size, lag)| size * libm::sin(n * turn + lag)).sum::<f64>();
        // A flat cut off the side of the contour has two corners.
        let cut = |x: f64, k: usize| if self.corners > k { x.min(8.0) } else { x };
        let (sin, cos) = libm::sincos(turn);
        [cut(radius * cos, 0), cut(radius * sin, 2)]
    }

    /// Lines of nearly so many mm.
    fn program(&self, chord_mm: f64, mode: &str) -> String {
        let lines = (80.0 / chord_mm) as u32;
        let mut text = format!("G21 G90 G94 G17 {mode} F6000\n");
        for i in 0..=lines {
            let [x, y] = self.at(std::f64::consts::TAU * f64::from(i) / f64::from(lines));
            text += &format!("G{} X{x:.3} Y{y:.3}\n", i.min(1));
        }
        text + "M2\n"
    }
}

/// Time that `check` foretells, s.
fn foretold(place: &Place, text: &str) -> f64 {
    let program = place.write("contour.ngc", text);
    let mill = project().join("examples/machines/small-mill.toml");
    let [program, mill] = [&program, &mill].map(|path| path.to_str().expect("a path in UTF-8"));
    let answer = place.ask(&["check", program, "--machine", mill, "--json"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stdout);
    let document: serde_json::Value = serde_json::from_str(&answer.stdout).expect("a document");
    document["time_s"].as_f64().expect("a time")
}

/// The most that a larger P, a larger Q and shorter lines may take longer.
const MOST: [f64; 3] = [1.15, 1.15, 1.4];

/// `PITCHLOCK_CONTOURS` contours instead of four.
#[test]
fn a_larger_p_or_q_and_shorter_lines_are_hardly_slower() {
    let place = Place::new();
    let mut worst: [(f64, String); 3] = Default::default();
    for case in 0..count("PITCHLOCK_CONTOURS", 4) {
        let contour = Contour::random(&mut Seed::of_case(4700 + case));
        let mut compare = |kind: usize, programs: Vec<(String, String)>| {
            let mut least = (f64::INFINITY, String::new());
            for (name, text) in programs {
                let time = foretold(&place, &text);
                if time / least.0 > worst[kind].0 {
                    worst[kind] = (time / least.0, format!("contour {case}: {name} beside {}", least.1));
                }
                if time < least.0 {
                    least = (time, name);
                }
            }
        };
        let modes = |modes: &[String]| modes.iter().map(|m| (m.clone(), contour.program(0.2, m))).collect();
        let of_p = [0.002, 0.004, 0.01, 0.02, 0.05, 0.1].map(|p| format!("G64 P{p}"));
        let of_q = [0.0, 0.001, 0.002, 0.005, 0.01, 0.02].map(|q| format!("G64 P0.02 Q{q}"));
        compare(0, modes(&of_p));
        compare(1, modes(&of_q));
        let finer = [0.8, 0.4, 0.2, 0.1].map(|mm| (format!("{mm} mm"), contour.program(mm, "G64 P0.01")));
        compare(2, finer.into());
    }
    println!("{worst:?}");
    // Where P, Q and fineness move the ends of curves beside corners: what docs/motion.md says of it.
    for ((slower, which), most) in worst.into_iter().zip(MOST) {
        assert!(slower <= most, "{slower} times as long: {which}");
    }
}

/// Lines of a length, one behind the other, that turn by these angles, each in so many parts.
fn sides(turns: &[f64], length: f64, [parts, decimals]: [usize; 2], mode: &str) -> String {
    let (mut at, mut heading) = ([0.0; 2], 0.3);
    let mut text = format!("G21 G90 G94 G17 {mode} F6000\n");
    for turn in turns {
        heading += turn.to_radians();
        let way = [length * libm::cos(heading), length * libm::sin(heading)];
        for part in 1..=parts {
            let share = part as f64 / parts as f64;
            let [x, y] = [0, 1].map(|i| at[i] + share * way[i]);
            text += &format!("G1 X{x:.decimals$} Y{y:.decimals$}\n");
        }
        at = [0, 1].map(|i| at[i] + way[i]);
    }
    text + "M2\n"
}

/// Sides in one line or in several are alike in time, whether they are those of a polygon, which is nearly a
/// curve, or of sharp corners to either side. In parts they take no more than 10 % longer than whole, rounded
/// to a thousandth or not.
#[test]
fn sides_are_as_fast_in_parts() {
    let place = Place::new();
    let round = |sides: u16| (vec![360.0 / f64::from(sides); sides.into()], 125.0 / f64::from(sides));
    let to_and_fro = |turn: f64, length: f64| (vec![turn, -turn, turn, -turn, turn], length);
    let cases = [round(24), round(36), round(60), round(90), (vec![25.0; 10], 3.0)];
    let cases = cases.into_iter().chain([to_and_fro(20.0, 3.0), to_and_fro(8.0, 3.0), to_and_fro(28.0, 8.0)]);
    for ((turns, length), mode) in
        cases.flat_map(|case| ["G64 P0.01", "G64 P0.002"].map(|m| (case.clone(), m)))
    {
        let time =
            |parts: usize, decimals: usize| foretold(&place, &sides(&turns, length, [parts, decimals], mode));
        let whole = time(1, 6);
        for (parts, decimals) in [(2, 3), (2, 6), (3, 6), (8, 3), (16, 6)] {
            let parted = time(parts, decimals);
            let told =
                format!("{mode}, {} sides of {length} mm, {parts} parts: {parted} s, {whole}", turns.len());
            assert!(parted < 1.1 * whole, "{told}");
        }
    }
}

/// A staircase is as fast, within a tenth, with points so near to its corners, before them, behind or both.
#[test]
fn points_beside_corners_cost_little() {
    let place = Place::new();
    let stairs = |beside: &[f64], mode: &str| {
        let (mut at, mut text) = ([0.0_f64; 2], format!("G21 G90 G94 G17 {mode} F6000\nG0 X0 Y0\n"));
        for side in 0..16 {
            let (sin, cos) =
                libm::sincos(0.3 + if side % 2 == 0 { 0.0 } else { std::f64::consts::FRAC_PI_2 });
            let ways = beside.iter().map(|mm| if *mm < 0.0 { 10.0 + mm } else { *mm }).chain([10.0]);
            for way in ways {
                text += &format!("G1 X{:.3} Y{:.3}\n", at[0] + way * cos, at[1] + way * sin);
            }
            at = [at[0] + 10.0 * cos, at[1] + 10.0 * sin];
        }
        text + "M2\n"
    };
    for mode in ["G64 P0.01", "G64 P0.05", "G64 P0.05 Q0.01"] {
        let without = foretold(&place, &stairs(&[], mode));
        for mm in [0.002, 0.01, 0.05, 0.15] {
            for beside in [vec![-mm], vec![mm], vec![mm, -mm]] {
                let time = foretold(&place, &stairs(&beside, mode));
                assert!(time < 1.1 * without, "{mode}, {beside:?} mm: {time} s, {without} s without");
            }
        }
    }
}
