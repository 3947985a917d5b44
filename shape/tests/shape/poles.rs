//! Seams whose direction goes through that of the turn axis, ±Z, begins or ends there, or passes by: no axis
//! jumps.

#![allow(clippy::disallowed_methods)] // what is checked against may be platform maths

use shape::{
    Branch, Curve, Drives, Meeting, Piece, PieceError, Positioner, Quadric, Ruled, Seam, SeamCurve, SeamPath,
    Walker,
};
use std::f64::consts::PI;

const BEAM: [f64; 2] = [130.0, -20.0];

fn positioner() -> Positioner {
    Positioner { x1: 120.0, y1: -35.0, z1: 250.0, x2: 15.0, y2: 8.0, z2: -50.0 }
}

/// A seam along x, mm, whose direction leans by 0.02 t in a vertical plane, and by `beside` out of it, seen
/// from ±Z.
fn leaning(azimuth: f64, beside: f64, up: f64, t: [f64; 2], branch: Branch) -> Seam {
    let mut c = [[0.0; 8]; 6];
    let (sin, cos) = azimuth.sin_cos();
    (c[0][1], c[1][2], c[2][0]) = (1.0, 0.02, 20.0);
    (c[3][0], c[3][1]) = (-beside * sin, 0.02 * cos);
    (c[4][0], c[4][1], c[5][0]) = (beside * cos, 0.02 * sin, up);
    Seam { curve: SeamCurve::Polynomials(c), t, branch, idle_beta_deg: 0.0, moved: None }
}

/// What a walk found: the axes at its ends, and how far α and β went up and down in all.
struct Walk {
    start: [f64; 4],
    end: [f64; 4],
    turned: [f64; 2],
    pieces: Vec<Piece<4>>,
}

fn start(seam: &Seam) -> [f64; 4] {
    seam.on(&[], positioner(), BEAM).at(seam.t[0]).axes.map(|axis| axis.value())
}

/// Walks a seam as the interpolator does, and asks at a thousand places of each piece whether the beam is on
/// the seam and looks along its direction.
fn walked(seam: &Seam) -> Result<Walk, PieceError> {
    let path = seam.on(&[], positioner(), BEAM);
    let from = start(seam);
    let mut walk = Walk { start: from, end: from, turned: [0.0; 2], pieces: Vec::new() };
    let mut walker = Walker::new(seam.t).standing(from);
    let mut here = from;
    while let Some(piece) = walker.next(&path)? {
        assert!(piece.from.iter().zip(walk.end).all(|(a, b)| (a - b).abs() < 1e-9), "{:?}", piece.from);
        for step in 1..=1000 {
            let s = piece.path.length() * f64::from(step) / 1000.0;
            let [ways, ..] = piece.path.at(s);
            let axes: [f64; 4] = std::array::from_fn(|i| piece.from[i] + ways[i]);
            is_under_the_beam(&path, piece.parameter(s), axes, off(seam));
            for i in [0, 1] {
                walk.turned[i] += (axes[i + 2] - here[i + 2]).abs();
            }
            here = axes;
        }
        walk.end = piece.to;
        walk.pieces.push(piece);
    }
    Ok(walk)
}

/// How far the direction of a seam may be off, rad (M239).
fn off(seam: &Seam) -> f64 {
    seam.moved.map_or(0.0, |[x, y]| 2.0 * (x.hypot(y) / 2.0).atan())
}

fn is_under_the_beam(path: &SeamPath, t: f64, [x, y, alpha, beta]: [f64; 4], off: f64) {
    let drives = Drives { x, y, alpha: alpha.to_radians(), beta: beta.to_radians() };
    let [place, l] = path.place(t).map(|vector| vector.map(|c| c.value()));
    let [xa, ya, _] = positioner().forward(place, &drives);
    assert!((xa - BEAM[0]).hypot(ya - BEAM[1]) < 1e-9, "{t}: {xa} {ya}");
    let [lx, ly, lz] = Positioner::turned(l, &drives);
    assert!(lx.hypot(ly).atan2(lz) < off + 1e-10, "{t}: {lx} {ly} {lz}");
}

/// Pieces that meet have one slope, curvature and its change.
fn joins(walk: &Walk) {
    for pair in walk.pieces.windows(2) {
        let (before, behind) = (pair[0].path.at(pair[0].path.length()), pair[1].path.at(0.0));
        for n in 1..4 {
            for i in 0..4 {
                let (a, b) = (before[n][i], behind[n][i]);
                assert!((a - b).abs() < 1e-6 * (1.0 + a.abs()), "derivative {n} of {i}: {a} {b}");
            }
        }
    }
}

const AZIMUTHS: [f64; 6] = [0.0, 0.3, PI / 2.0, 2.0, -1.0, PI];

/// A direction that passes by, moved by as much (M239): α goes through, β stands, the beam stays on the seam.
#[test]
fn a_direction_that_is_moved_goes_through_the_pole() {
    for azimuth in AZIMUTHS {
        for (beside, up) in [(1e-6, 1.0), (-0.01, 1.0), (0.08, -1.0)] {
            let seam = leaning(azimuth, beside, up, [-10.0, 12.0], Branch::Negative);
            let [_, l] = seam.on(&[], positioner(), BEAM).place(0.0).map(|vector| vector.map(|c| c.value()));
            let seam = Seam { moved: Some([l[0] / l[2], l[1] / l[2]]), ..seam };
            let walk = walked(&seam).expect("it can be walked");
            joins(&walk);
            let through = [10.0, 12.0].map(|t: f64| (0.02 * t).atan().to_degrees()).iter().sum::<f64>();
            let [tilted, turned] = walk.turned;
            assert!(
                (tilted - through).abs() < 1e-6 && turned < 1e-6,
                "{azimuth} {beside}: {:?}",
                walk.turned
            );
        }
    }
}

/// Of a direction that stays in a plane only the tilt moves, wherever the pole is: inside, at the start, at
/// the end; in the middle of a piece or where the walker looks.
#[test]
fn a_direction_goes_through_the_pole_in_a_plane() {
    for azimuth in AZIMUTHS {
        for up in [1.0, -1.0] {
            for branch in Branch::BOTH {
                for t in [[-20.0, 20.0], [20.0, -20.0], [-20.0, 7.3], [0.0, 20.0], [-20.0, 0.0], [0.0, -9.0]]
                {
                    let seam = leaning(azimuth, 0.0, up, t, branch);
                    let walk = walked(&seam).unwrap_or_else(|error| panic!("{azimuth} {t:?}: {error}"));
                    joins(&walk);
                    let lean = |t: f64| (0.02 * t).atan().to_degrees();
                    let demanded = (lean(t[1]) - lean(t[0])).abs();
                    let [tilted, turned] = walk.turned;
                    assert!((tilted - demanded).abs() < 1e-8 && turned < 1e-8, "{tilted} {turned}");
                    let [_, _, from, beta] = walk.start;
                    let [_, _, to, _] = walk.end;
                    let upright = if up > 0.0 { 0.0 } else { 180.0 * branch.sign() };
                    assert!(t[0] != 0.0 || (from - upright).abs() < 1e-12, "{from}");
                    // The branch is that of the start, or of what follows it.
                    let at = if t[0] == 0.0 { to } else { from };
                    assert!(at * branch.sign() > 0.0, "{azimuth} {up} {t:?} {branch:?}: {from} to {to}");
                    assert!(beta.abs() <= 180.0 + 1e-9 && walk.pieces.len() < 40, "{}", walk.pieces.len());
                }
            }
        }
    }
}

/// Of a direction that passes by at 0.1°, β turns by just under 180°, and no axis by more.
#[test]
fn a_direction_passes_the_pole_by() {
    let beside = 0.1_f64.to_radians().tan();
    for azimuth in AZIMUTHS {
        for branch in Branch::BOTH {
            let walk = walked(&leaning(azimuth, beside, 1.0, [-20.0, 20.0], branch)).unwrap();
            joins(&walk);
            let demanded = 2.0 * (0.4 / beside).atan().to_degrees();
            let [tilted, turned] = walk.turned;
            assert!((turned - demanded).abs() < 1e-6, "{turned}, demanded {demanded}");
            let lean = 0.4_f64.hypot(beside).atan().to_degrees() - 0.1;
            assert!((tilted - 2.0 * lean).abs() < 1e-6, "{tilted}, demanded {}", 2.0 * lean);
            assert!((walk.end[2] - walk.start[2]).abs() < 1e-9 && walk.end[2] * branch.sign() > 0.0);
        }
    }
    // Too near to be followed, and not through it.
    let near = walked(&leaning(0.3, 1e-8, 1.0, [-20.0, 20.0], Branch::Positive));
    assert!(matches!(near, Err(PieceError::Unresolved { .. })));
}

/// β bends where the direction goes through the pole on a curve: it has its slope there, not a jump, and
/// derivatives up to the third are those of the places beside.
#[test]
fn a_direction_goes_through_the_pole_on_a_curve() {
    let mut c = [[0.0; 8]; 6];
    (c[0][1], c[2][0], c[5][0], c[5][1]) = (1.0, 20.0, 1.0, 0.002);
    (c[3][1], c[3][2], c[3][4]) = (0.02, 1e-4, 3e-8);
    (c[4][1], c[4][2], c[4][3], c[4][4]) = (0.01, -2e-4, 1e-6, 2e-7);
    for (t, places) in
        [([-15.0, 15.0], true), ([-14.0, 17.5], false), ([0.0, 12.0], false), ([-9.0, 0.0], false)]
    {
        for branch in Branch::BOTH {
            let seam = Seam { curve: SeamCurve::Polynomials(c), t, branch, idle_beta_deg: 0.0, moved: None };
            let walk = walked(&seam).unwrap_or_else(|error| panic!("{t:?}: {error}"));
            joins(&walk);
            assert!(walk.pieces.len() < 60, "{} pieces", walk.pieces.len());
            assert!(walk.pieces.windows(2).all(|pair| (pair[1].from[3] - pair[0].from[3]).abs() < 10.0));
            if !places {
                continue;
            }
            let path = seam.on(&[], positioner(), BEAM);
            let mut here = start(&seam);
            (0..150)
                .for_each(|i| here = path.near(-15.0 + 0.1 * f64::from(i), &here).axes.map(|a| a.value()));
            let at = |t: f64| path.near(t, &here).axes;
            let (eta, pole) = (1e-2, at(0.0));
            let (before, behind) = (at(-eta), at(eta));
            for (i, pole) in pole.iter().enumerate() {
                for n in 1..4 {
                    let step = behind[i].derivative(n - 1) - before[i].derivative(n - 1);
                    let (want, got) = (step / (2.0 * eta), pole.derivative(n));
                    assert!((want - got).abs() < 1e-3 * got.abs() + 1e-5, "{n} of {i}: {got} {want}");
                }
            }
        }
    }
}

/// A ring around a pipe that lies: its normal, across the pipe, goes through the pole at the top. Rounding of
/// sine and cosine is in it.
#[test]
fn a_ring_around_a_pipe_goes_over_the_top() {
    for degrees in [0.0_f64, 17.0, 45.0, 133.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let meeting = Meeting {
            first: Ruled {
                at: [0.0, 0.0, 60.0],
                axis: [cos, sin, 0.0],
                zero: [-sin, cos, 0.0],
                radius_mm: 25.0,
                slope: 0.0,
            },
            second: Quadric { at: [0.0, 0.0, 60.0], axis: [1.0, 0.0, 0.0], c: [-12.0, 1.0, 0.0, 0.0] },
            leaving: cos > 0.0,
            share: 0.0,
        };
        for t in [[0.2, 2.9], [PI / 2.0, 2.5], [0.4, PI / 2.0]] {
            let seam = Seam {
                curve: SeamCurve::Meeting(meeting),
                t,
                branch: Branch::Negative,
                idle_beta_deg: 0.0,
                moved: None,
            };
            let walk = walked(&seam).unwrap_or_else(|error| panic!("{degrees} {t:?}: {error}"));
            let [tilted, turned] = walk.turned;
            let demanded = (t[1] - t[0]).to_degrees();
            assert!((tilted - demanded).abs() < 1e-7 && turned < 1e-7, "{degrees}: {tilted} {turned}");
        }
    }
}
