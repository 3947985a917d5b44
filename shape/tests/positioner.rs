//! The four-axis positioner in cases that are in no reference file: ten million random poses, paths near the pole, bounds.

#![allow(clippy::disallowed_methods)] // what is checked against may be platform maths

use shape::{Branch, DriveErrors, Drives, NoPose, Positioner, Travel};
use std::f64::consts::{PI, TAU};

/// Numbers that look random, the same in every run (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// −1 to 1.
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn positioner(&mut self) -> Positioner {
        let mut mm = || 150.0 * self.unit();
        Positioner { x1: mm(), y1: mm(), z1: mm(), x2: mm(), y2: mm(), z2: mm() }
    }
}

/// M47 multiplied out: what the matrices must give.
fn m47(positioner: &Positioner, [x, y, z]: [f64; 3], drives: &Drives) -> [f64; 3] {
    let ((sa, ca), (sb, cb)) = (drives.alpha.sin_cos(), drives.beta.sin_cos());
    let (w, q) = (positioner.y2 - x * sb + y * cb, x * cb + y * sb);
    let height = positioner.z2 + z;
    [
        drives.x + positioner.x1 + positioner.x2 + q,
        drives.y + positioner.y1 + ca * w + sa * height,
        positioner.z1 - sa * w + ca * height,
    ]
}

#[test]
fn the_matrices_give_m47() {
    let mut random = Random(1);
    for _ in 0..100_000 {
        let positioner = random.positioner();
        let point = [200.0; 3].map(|mm| mm * random.unit());
        let drives = Drives {
            x: 300.0 * random.unit(),
            y: 300.0 * random.unit(),
            alpha: 2.0 * PI * random.unit(),
            beta: 4.0 * PI * random.unit(),
        };
        let (got, want) = (positioner.forward(point, &drives), m47(&positioner, point, &drives));
        assert!((0..3).all(|i| (got[i] - want[i]).abs() < 5e-13), "{got:?} {want:?}");
    }
}

/// Ten million poses, a third of them with a direction near ±Z: h down to 1e-15, and exactly 0. The part goes back
/// under the beam within 1e-10 mm, its direction looks along it within 1e-10 rad, and the pose itself is found again
/// among both branches.
#[test]
fn ten_million_poses_there_and_back() {
    let mut random = Random(2);
    let mut positioner = random.positioner();
    for round in 0..10_000_000_u32 {
        if round % 64 == 0 {
            positioner = random.positioner();
        }
        let point = [200.0; 3].map(|mm| mm * random.unit());
        let turned = match round % 6 {
            0 => libm::exp10(-7.5 + 7.5 * random.unit()), // 1 … 1e-15
            1 if round % 5 == 0 => 0.0,
            _ => PI * random.unit(),
        };
        let alpha = if round % 12 < 6 { turned } else { PI - turned };
        let drives =
            Drives { x: 300.0 * random.unit(), y: 300.0 * random.unit(), alpha, beta: PI * random.unit() };
        let [xa, ya, _] = positioner.forward(point, &drives);
        // The direction that this pose turns onto +Z: third row of R_X R_Z.
        let ((sa, ca), (sb, cb)) = (libm::sincos(alpha), libm::sincos(drives.beta));
        let direction = if turned == 0.0 { [0.0, 0.0, ca] } else { [sa * sb, -sa * cb, ca] };
        let mut found = 0;
        for branch in Branch::BOTH {
            let pose = positioner.inverse(point, direction, [xa, ya], branch, drives.beta);
            let [x, y, _] = positioner.forward(point, &pose);
            assert!((x - xa).abs() <= 1e-10 && (y - ya).abs() <= 1e-10, "{round}: {drives:?} {pose:?}");
            let l = Positioner::turned(direction, &pose);
            assert!(l[0].abs() <= 1e-10 && l[1].abs() <= 1e-10 && l[2] > 0.0, "{round}: {l:?}");
            assert!(pose.alpha * branch.sign() >= 0.0 && (pose.beta - drives.beta).abs() <= PI + 1e-9);
            let tilt = (pose.alpha - alpha + 3.0 * PI).rem_euclid(TAU) - PI;
            let same = tilt.abs() < 1e-12 && (pose.beta - drives.beta).abs() < 1e-12;
            let way = (pose.x - drives.x).abs().max((pose.y - drives.y).abs());
            assert!(!same || way <= 1e-10, "{round}: {way:e}");
            found += u32::from(same);
        }
        assert!(found == if turned == 0.0 { 2 } else { 1 }, "{round}: {drives:?} was found {found} times");
    }
}

const WIDE: Travel =
    Travel { x: [-1e3, 1e3], y: [-1e3, 1e3], alpha: [-2.0 * PI, 2.0 * PI], beta: [-20.0, 20.0] };

fn positioner() -> Positioner {
    Positioner { x1: 10.0, y1: -20.0, z1: 300.0, x2: 5.0, y2: 15.0, z2: -60.0 }
}

/// From pose to pose along a path of directions over the pole, the nearest solution turns no axis by more than the
/// path asks of it: of a path that goes exactly through ±Z only the tilt moves.
#[test]
fn no_axis_jumps_where_a_path_crosses_the_pole() {
    for pole in [1.0, -1.0] {
        for (azimuth, steps) in [(0.3, 64), (-2.0, 65), (1.57, 1000), (0.0, 200)] {
            let mut at = Drives { beta: azimuth + PI / 2.0, ..Drives::default() };
            at.alpha = if pole > 0.0 { -0.7 } else { PI + 0.7 };
            for step in 0..=steps {
                let tilt = -0.7 + 1.4 * f64::from(step) / f64::from(steps);
                let (s, c) = tilt.sin_cos();
                let l = [s * libm::cos(azimuth), s * libm::sin(azimuth), c * pole];
                let (_, next) = positioner().nearest([30.0, 20.0, 10.0], l, [0.0; 2], &at, &WIDE).unwrap();
                let (tilted, turned) = ((next.alpha - at.alpha).abs(), (next.beta - at.beta).abs());
                let demanded = if step == 0 { 0.0 } else { 1.4 / f64::from(steps) };
                assert!(turned < 1e-12, "{azimuth} {step}: turned by {turned}");
                assert!((tilted - demanded).abs() < 1e-12, "{azimuth} {step}: tilted by {tilted}");
                at = next;
            }
        }
    }
}

/// Of a path that passes the pole at a distance, β turns as the azimuth does and no step more, over many turns too.
#[test]
fn the_turn_follows_the_azimuth_past_the_pole_and_around_it() {
    for distance in [1e-1, 1e-4, 1e-9] {
        let mut at = Drives { alpha: -0.5, beta: 0.0, ..Drives::default() };
        for step in 0..4000 {
            // Around the pole thrice: near it, then far from it, then near again.
            let azimuth = 3.0 * TAU * f64::from(step) / 4000.0;
            let h = distance + 0.4 * (1.0 - libm::cos(azimuth / 1.5)) / 2.0;
            let l = [h * libm::cos(azimuth), h * libm::sin(azimuth), 1.0];
            let (branch, next) = positioner().nearest([3.0, 2.0, 1.0], l, [9.0, 8.0], &at, &WIDE).unwrap();
            if step == 0 {
                at.beta = next.beta;
            }
            let sign = next.alpha.signum();
            assert_eq!(branch.sign(), sign);
            assert!(
                (next.beta - at.beta).abs() <= 3.0 * TAU / 4000.0 + 1e-9,
                "{distance} {step}: {at:?} {next:?}"
            );
            at = next;
        }
    }
}

#[test]
fn the_branch_within_the_travel_is_taken_and_the_angle_turned_into_it() {
    let (point, l) = ([30.0, 20.0, 10.0], [0.6, 0.0, 0.8]);
    let from = Drives { beta: 3.0 * PI, ..Drives::default() };
    let forward_only = Travel { alpha: [-0.1, 1.0], beta: [-2.0, 2.0], ..WIDE };
    let (branch, pose) = positioner().nearest(point, l, [0.0; 2], &from, &forward_only).unwrap();
    assert_eq!(branch, Branch::Positive);
    assert!(
        (pose.alpha - 0.6_f64.atan2(0.8)).abs() < 1e-15 && (pose.beta - PI / 2.0).abs() < 1e-14,
        "{pose:?}"
    );
    let backward_only = Travel { alpha: [-1.0, 0.1], beta: [3.0 * PI, 5.0 * PI], ..WIDE };
    let (branch, pose) = positioner().nearest(point, l, [0.0; 2], &from, &backward_only).unwrap();
    assert_eq!(branch, Branch::Negative);
    assert!((pose.beta - 3.5 * PI).abs() < 1e-14, "{pose:?}");
    let short = Travel { x: [0.0, 1.0], ..WIDE };
    assert_eq!(positioner().nearest(point, l, [0.0; 2], &from, &short), Err(NoPose::BeyondTravel(0)));
    let flat = Travel { alpha: [-0.1, 0.1], ..WIDE };
    assert_eq!(positioner().nearest(point, l, [0.0; 2], &from, &flat), Err(NoPose::BeyondTravel(2)));
    for none in [[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY; 3]] {
        let pose = positioner().nearest(point, none, [0.0; 2], &from, &WIDE);
        assert_eq!(pose, Err(NoPose::NoDirection), "{none:?}");
    }
}

/// M50 differs from the exact displacement by no more than M91, and no error of the drives displaces a point by more
/// than M52; drives as M90 wants them keep the accuracy, and are wanted no better than by a few per cent of need.
#[test]
fn bounds_hold_and_are_nearly_reached() {
    let mut random = Random(3);
    for share in [0.0, 0.3, 0.9] {
        let (positioner, largest, accuracy) = (random.positioner(), [120.0, 80.0, 60.0], 0.01);
        let errors = positioner.required(largest, accuracy, share);
        let bound = positioner.error_bound(largest, errors);
        let neglected = positioner.neglected(largest, errors);
        assert!((bound[1] + neglected - accuracy).abs() < 1e-12 * accuracy, "{bound:?}");
        let mut worst = [0.0_f64; 3];
        for _ in 0..200_000 {
            let mut sign = || if random.next() & 1 == 0 { 1.0 } else { -1.0 };
            let point = largest.map(|mm| mm * sign());
            let error = Drives {
                x: errors.linear_mm * sign(),
                y: errors.linear_mm * sign(),
                alpha: errors.angular_rad * sign(),
                beta: errors.angular_rad * sign(),
            };
            let drives = Drives { alpha: PI * random.unit(), beta: PI * random.unit(), ..Drives::default() };
            let linear = positioner.linear_error(point, &drives, &error);
            let exact = positioner.exact_error(point, &drives, &error);
            for i in 0..3 {
                assert!((exact[i] - linear[i]).abs() <= neglected + 1e-12, "{share} {i}");
                worst[i] = worst[i].max(exact[i].abs());
            }
        }
        for i in 0..3 {
            assert!(
                worst[i] <= bound[i] + neglected && worst[i] > 0.97 * bound[i],
                "{i}: {worst:?} {bound:?}"
            );
        }
    }
}

/// What the source prints as its example, (10): 0.0369, 0.0501, 0.0201 mm; M51 shows that less is enough, and it is
/// reached: √5 + √2 at a corner of the part.
#[test]
fn the_published_example() {
    let errors = DriveErrors { linear_mm: 0.03, angular_rad: 0.0014_f64.to_radians() };
    let rounded = |bound: [f64; 3]| bound.map(|mm| (mm * 1e4).round() / 1e4);
    assert_eq!(rounded(errors.published_bound(200.0)), [0.0369, 0.0501, 0.0201]);
    let positioner = Positioner::of_size(200.0);
    assert_eq!(rounded(positioner.error_bound([200.0; 3], errors)), [0.0369, 0.0478, 0.0178]);
    let drives = Drives { alpha: libm::atan2(-1.0, 2.0), beta: -libm::atan2(2.0, -1.0), ..Drives::default() };
    let d = errors.angular_rad;
    let largest = [-200.0, 200.0].into_iter().flat_map(|x| [-200.0, 200.0].map(|y| [x, y, 200.0]));
    let turns = (0..3600).map(|turn| f64::from(turn) * TAU / 3600.0);
    let most = turns
        .flat_map(|beta| largest.clone().map(move |point| (beta, point)))
        .map(|(beta, point)| {
            let error = Drives { y: errors.linear_mm, alpha: d, beta: -d, ..Drives::default() };
            positioner.linear_error(point, &Drives { beta, ..drives }, &error)[1]
        })
        .fold(0.0, f64::max);
    assert!((most - 0.047_838_64).abs() < 2e-8, "{most}");
    assert_eq!(errors.increments(), (0.06, 2.0 * d));
}
