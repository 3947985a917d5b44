//! Points and axes, one function each way; an axis that a machine does not have is named.
#![allow(clippy::unwrap_used)]

use machine::{
    Kinematics, Machine, SMALL_MILL,
    kinematics::{MissingAxis, Point},
};
use proptest::prelude::*;
use protocol::Axis;

proptest! {
    #[test]
    fn the_axes_stand_at_the_point_they_were_sent_to(point in any::<Point>(), which in 0..3_usize) {
        let kinematics = [Kinematics::Mill, Kinematics::Lathe, Kinematics::Positioner][which];
        let back = kinematics.point(&kinematics.axes(&point));
        prop_assert!(back.iter().zip(&point).all(|(back, to)| back.to_bits() == to.to_bits()));
    }
}

#[test]
fn every_coordinate_reaches_its_axis() {
    let axes = Kinematics::Mill.axes(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let of = |axis: Axis| axes[axis.index()];
    assert_eq!(
        [Axis::X, Axis::Y, Axis::Z, Axis::A, Axis::B, Axis::C].map(of),
        [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    );
}

#[test]
fn an_axis_that_does_not_exist_is_named() {
    let (lathe, mill) = (Machine::plain(), Machine::from_toml(SMALL_MILL).unwrap());
    let point = [10.0, -2.5, -30.0, 0.0, 0.0, 0.0];
    let error = lathe.axes_at(&point).unwrap_err();
    assert_eq!(error, MissingAxis { axis: Axis::Y, at: -2.5 });
    assert!(error.to_string().starts_with("the point has Y -2.5 mm"), "{error}");
    assert_eq!(mill.axes_at(&point).unwrap()[..3], [10.0, -2.5, -30.0]);
    let error = mill.axes_at(&[0.0, 0.0, 0.0, 0.0, 0.0, 90.0]).unwrap_err().to_string();
    assert!(error.contains("C 90 deg") && error.contains("[axis.c]"), "{error}");
    assert!(lathe.axes_at(&[10.0, 0.0, -30.0, 0.0, 0.0, 0.0]).is_ok());
}
