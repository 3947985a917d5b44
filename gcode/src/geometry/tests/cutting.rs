//! Passes on random contours, cut out of a stock that remembers what is left.

use proptest::prelude::*;
use proptest::test_runner::TestCaseError;
use std::convert::Infallible;

use super::random::contours;
use crate::geometry::contour::{Point, Segment};
use crate::geometry::offset::left_on;
use crate::geometry::passes::{Move, Pockets, Roughing, finish, repeat, rough, turn, walled};

/// Width of a slice of the stock.
const SLICE: f64 = 0.05;

type Cut = Result<(), TestCaseError>;

/// A stock in slices, with the contour that must not be cut.
struct Stock {
    tool: Point,
    left: Vec<f64>,
    contour: Vec<Segment>,
    infeed: f64,
    /// Each pass takes at most the infeed.
    thin: bool,
}

impl Stock {
    fn new(contour: &[Segment], start: Point, infeed: f64) -> Stock {
        let length = contour.last().map_or(0.0, |last| -last.end.z);
        let left = vec![start.x; (length / SLICE) as usize];
        Stock { tool: Point::new(f64::NAN, f64::NAN), left, contour: contour.to_vec(), infeed, thin: true }
    }

    /// X of the contour at a Z, and whether it is steep there.
    fn height(&self, z: f64) -> Option<(f64, bool)> {
        let at = |z: f64| {
            let mut over = self.contour.iter().filter(|s| !s.is_wall() && s.start.z >= z && s.end.z <= z);
            over.next().map(|segment| segment.x_at(z))
        };
        let (before, here, behind) = (at(z + SLICE)?, at(z)?, at(z - SLICE)?);
        Some((here, (before - here).abs().max((behind - here).abs()) > 0.15))
    }

    fn go(&mut self, next: Move) -> Cut {
        let (path, cuts) = match next {
            Move::Rapid(end) => (Segment::line(self.tool, end), false),
            Move::Feed(end) => (Segment::line(self.tool, end), true),
            Move::Arc { end, center, ccw } => (Segment::arc(self.tool, end, center, ccw), true),
        };
        prop_assert!(path.end.z.is_finite() && path.end.x.is_finite());
        self.tool = path.end;
        if !path.start.z.is_finite() {
            return Ok(());
        }
        if path.bend.is_some() {
            let at_end = Segment { start: path.end, ..path };
            prop_assert!((path.radius() - at_end.radius()).abs() < 1e-4);
        }
        let path = if path.start.z < path.end.z { Segment::line(path.end, path.start) } else { path };
        for n in 0..self.left.len() {
            let z = -(n as f64 + 0.5) * SLICE;
            if path.is_wall() || z > path.start.z || z < path.end.z {
                continue;
            }
            let Some((height, steep)) = self.height(z) else { continue };
            let (x, left) = (path.x_at(z), self.left[n]);
            if !steep {
                prop_assert!(x > height - 1e-3, "{next:?} is {} deep in the part at Z{z}", height - x);
                prop_assert!(cuts || x > left - 1e-3, "{next:?} goes through stock up to X{left} at Z{z}");
                let deepest = self.infeed + 1e-3;
                prop_assert!(!self.thin || left - x < deepest, "{next:?} cuts {} at Z{z}", left - x);
            }
            self.left[n] = left.min(x);
        }
        Ok(())
    }

    /// Everything outside of the contour is gone.
    fn is_finished(&self) -> Cut {
        for (n, left) in self.left.iter().enumerate() {
            let z = -(n as f64 + 0.5) * SLICE;
            if let Some((height, false)) = self.height(z) {
                prop_assert!((left - height).abs() < 1e-3, "X{left} is left of X{height} at Z{z}");
            }
        }
        Ok(())
    }
}

/// Start above and in front of a contour, and the contour with its wall and allowance.
fn prepared(contour: &[Segment], allowance: f64) -> Option<(Point, Vec<Segment>)> {
    let top = contour.iter().map(|segment| segment.start.x.max(segment.end.x)).fold(0.0, f64::max);
    let top = contour.iter().filter_map(|s| s.halves().1).map(|half| half.start.x).fold(top, f64::max);
    let start = Point::new(3.0, top + 1.0 + allowance);
    Some((start, walled(start, &left_on(contour, allowance)?)))
}

proptest! {
    #[test]
    fn roughing_leaves_the_allowance_and_nothing_else(
        contour in contours(), allowance in 0.0..1.0f64, infeed in 0.3..4.0f64, escape in 0.0..1.0f64,
    ) {
        let Some((start, contour)) = prepared(&contour, allowance) else { return Ok(()) };
        let mut stock = Stock::new(&contour, start, infeed);
        let how = Roughing { infeed, escape: escape.min(infeed), pockets: Pockets::Cut };
        rough(start, &contour, &how, &mut |next| stock.go(next))?;
        stock.is_finished()?;
    }

    #[test]
    fn pockets_that_were_bridged_are_cut_later(
        contour in contours(), allowance in 0.0..1.0f64, infeed in 0.3..4.0f64, escape in 0.0..1.0f64,
    ) {
        let Some((start, contour)) = prepared(&contour, allowance) else { return Ok(()) };
        let mut stock = Stock::new(&contour, start, infeed);
        for pockets in [Pockets::Bridge, Pockets::Only] {
            let how = Roughing { infeed, escape: escape.min(infeed), pockets };
            rough(start, &contour, &how, &mut |next| stock.go(next))?;
        }
        stock.is_finished()?;
    }

    #[test]
    fn fanuc_roughing_leaves_the_allowance_and_nothing_else(
        contour in contours(), allowance in 0.0..1.0f64, infeed in 0.3..4.0f64, escape in 0.0..1.0f64,
    ) {
        let Some((start, contour)) = prepared(&contour, allowance) else { return Ok(()) };
        let mut stock = Stock::new(&contour, start, infeed);
        turn(start, &contour, infeed, escape.min(infeed), &mut |next| stock.go(next))?;
        prop_assert_eq!(stock.tool, start);
        stock.is_finished()?;
    }

    #[test]
    fn finishing_follows_the_contour(contour in contours(), allowance in 0.0..1.0f64) {
        let Some((start, contour)) = prepared(&contour, allowance) else { return Ok(()) };
        let mut stock = Stock::new(&contour, start, f64::INFINITY);
        finish(start, &contour, &mut |next| stock.go(next))?;
        stock.is_finished()?;
    }
}

fn line(z1: f64, x1: f64, z2: f64, x2: f64) -> Segment {
    Segment::line(Point::new(z1, x1), Point::new(z2, x2))
}

fn moves(
    run: impl FnOnce(&mut dyn FnMut(Move) -> Result<(), Infallible>) -> Result<(), Infallible>,
) -> String {
    let mut text = Vec::new();
    let Ok(()) = run(&mut |next| {
        text.push(match next {
            Move::Rapid(to) => format!("R {} {}", to.z, to.x),
            Move::Feed(to) => format!("F {} {}", to.z, to.x),
            Move::Arc { end, ccw, .. } => format!("A {} {} {ccw}", end.z, end.x),
        });
        Ok(())
    });
    text.join(", ")
}

#[test]
fn fanuc_passes_escape_go_back_and_feed_in() {
    let contour = [line(0.0, 4.0, -8.0, 4.0), line(-8.0, 4.0, -8.0, 10.0)];
    let passes = moves(|send| turn(Point::new(2.0, 10.0), &contour, 3.0, 0.5, send));
    let expected = "R 2 10, R 1 7, F -8 7, R -7.5 7.5, R 1 7.5, R 0 4, F -8 4, F -8 10, R -8 10, R 2 10";
    assert_eq!(passes, expected);
}

#[test]
fn a_short_pass_escapes_by_half_of_it() {
    let contour = [line(0.0, 4.0, -1.0, 4.0), line(-1.0, 4.0, -1.0, 6.0)];
    let how = Roughing { infeed: 1.0, escape: 2.0, pockets: Pockets::Cut };
    let passes = moves(|send| rough(Point::new(0.0, 6.0), &contour, &how, send));
    let expected = "R 0 6, R 0 6, F -1 6, R -0.5 6.5, R -0.5 6.5, R 0 6, R 0 5, F -1 5, R -0.5 5.5, R -0.5 5.5, \
                    R 0 5, R 0 4, F -1 4, F -1 6";
    assert_eq!(passes, expected);
}

#[test]
fn a_valley_without_a_pass_is_one_arc() {
    let valley = Segment::arc(Point::new(0.0, 5.0), Point::new(-8.0, 5.0), Point::new(-4.0, 8.0), false);
    let how = |infeed| Roughing { infeed, escape: 0.0, pockets: Pockets::Only };
    let passes = moves(|send| rough(Point::new(0.0, 6.0), &[valley], &how(9.0), send));
    assert_eq!(passes, "R 0 6, R 0 5, A -8 5 false");
}

#[test]
fn a_pattern_comes_nearer_in_equal_steps() {
    let contour = [line(0.0, 4.0, -8.0, 4.0)];
    let away = (Point::new(1.0, 2.0), Point::new(0.25, 0.5));
    let passes = moves(|send| repeat(Point::new(5.0, 9.0), &contour, away, 3, send));
    let expected = "R 5 9, R 1.25 6.5, F -6.75 6.5, R 5 9, R 0.75 5.5, F -7.25 5.5, R 5 9, R 0.25 4.5, F -7.75 4.5, R 5 9";
    assert_eq!(passes, expected);
    let once = moves(|send| repeat(Point::new(5.0, 9.0), &contour, away, 1, send));
    assert_eq!(once, "R 5 9, R 0.25 4.5, F -7.75 4.5, R 5 9");
}

#[test]
fn an_infeed_that_changes_nothing_ends() {
    let contour = [line(0.0, 1e14, -8.0, 1e14), line(-8.0, 1e14, -9.0, 2e14)];
    let how = Roughing { infeed: 1e-300, escape: 0.0, pockets: Pockets::Cut };
    let passes = moves(|send| rough(Point::new(0.0, 2e14), &contour, &how, send));
    assert!(passes.len() < 1000);
}
