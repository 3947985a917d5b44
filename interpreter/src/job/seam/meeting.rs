//! Two surfaces of which a seam is the intersection. In: their keys. Out: [`Meeting`], axes as unit vectors;
//! or what is wrong with a key.

use std::fmt;

use serde::Deserialize;
use shape::{Meeting, Quadric, Ruled};

use super::super::row::Row;
use super::super::{Fault, within};

/// A vector.
type Vector = [f64; 3];

/// Keys of a surface.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SurfaceKeys {
    kind: SurfaceKind,
    /// A point of its axis, its centre, or a point of the plane, mm.
    at_mm: Row<f64, 3>,
    /// Along its axis; of a plane, out of the material.
    axis: Option<Row<f64, 3>>,
    /// Diameter, of a cone at `at_mm`.
    diameter_mm: Option<f64>,
    /// Of a cone, which grows along its axis.
    half_angle_deg: Option<f64>,
    /// The part is around it: its normals point inwards.
    #[serde(default)]
    hollow: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum SurfaceKind {
    Plane,
    Sphere,
    Cylinder,
    Cone,
}

/// Which of the places where the first surface, along its axis, pierces the second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Crossing {
    /// Where it comes out of the second.
    #[default]
    Leaves,
    /// Where it goes into it.
    Enters,
}

impl fmt::Display for SurfaceKeys {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hollow = if self.hollow { "hollow " } else { "" };
        let kind = match self.kind {
            SurfaceKind::Plane => "plane",
            SurfaceKind::Sphere => "sphere",
            SurfaceKind::Cylinder => "cylinder",
            SurfaceKind::Cone => "cone",
        };
        write!(f, "{hollow}{kind}")?;
        self.diameter_mm.map_or(Ok(()), |diameter| write!(f, " Ø{diameter}"))
    }
}

/// Where two surfaces meet.
///
/// # Errors
/// A key that is missing, that the kind of surface does not have, or that no surface can have.
pub(super) fn of(
    first: &SurfaceKeys,
    second: &SurfaceKeys,
    zero: Option<Vector>,
    crossing: Crossing,
    share: f64,
) -> Result<Meeting, Fault> {
    let leaving = (crossing == Crossing::Leaves) != second.hollow;
    Ok(Meeting { first: first.ruled(zero)?, second: second.quadric()?, leaving, share })
}

impl SurfaceKeys {
    /// As the first surface.
    fn ruled(&self, zero: Option<Vector>) -> Result<Ruled, Fault> {
        if !matches!(self.kind, SurfaceKind::Cylinder | SurfaceKind::Cone) {
            let help = "give the cylinder or cone first; \
                where a plane and a sphere or two spheres meet is a circle: give x, y, z";
            return Err(Fault::new("first.kind", "the first surface is a cylinder or a cone", help));
        }
        let axis = self.axis("first")?;
        let (radius_mm, slope) = self.size("first")?;
        let zero = match zero {
            Some(zero) => across(zero, axis).ok_or_else(|| {
                let message = "zero points along the axis of the first surface, or nowhere";
                Fault::new("zero", message, "give a direction across that axis")
            })?,
            None => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
                .into_iter()
                .find_map(|try_| across(try_, axis))
                .unwrap_or(axis),
        };
        // The same points, seen from the other side of the axis: what was inside is outside.
        let sign = if self.hollow { -1.0 } else { 1.0 };
        let zero = zero.map(|c| sign * c);
        Ok(Ruled { at: self.at("first")?, axis, zero, radius_mm: sign * radius_mm, slope: sign * slope })
    }

    /// As the second surface.
    fn quadric(&self) -> Result<Quadric, Fault> {
        let name = "second";
        let (r, k) = self.size(name)?;
        let axis = if self.kind == SurfaceKind::Sphere { [0.0, 0.0, 1.0] } else { self.axis(name)? };
        let c = match self.kind {
            SurfaceKind::Plane => [0.0, 1.0, 0.0, 0.0],
            SurfaceKind::Sphere => [-r * r, 0.0, 1.0, 1.0],
            SurfaceKind::Cylinder | SurfaceKind::Cone => [-r * r, -2.0 * r * k, -k * k, 1.0],
        };
        let sign = if self.hollow { -1.0 } else { 1.0 };
        Ok(Quadric { at: self.at(name)?, axis, c: c.map(|c| sign * c) })
    }

    fn at(&self, name: &str) -> Result<Vector, Fault> {
        for mm in self.at_mm.0 {
            within(&format!("{name}.at_mm"), mm, [-1e4, 1e4], "mm")?;
        }
        Ok(self.at_mm.0)
    }

    fn axis(&self, name: &str) -> Result<Vector, Fault> {
        let key = format!("{name}.axis");
        let Some(Row(axis)) = self.axis else {
            return Err(Fault::new(
                name,
                format!("{key} is missing"),
                "give its direction, as in axis = [0, 0, 1]",
            ));
        };
        unit(axis)
            .ok_or_else(|| Fault::new(&key, "a direction of length 0", "give a direction, as in [0, 0, 1]"))
    }

    /// Radius, mm, and its growth along the axis.
    fn size(&self, name: &str) -> Result<(f64, f64), Fault> {
        let key = |key: &str| format!("{name}.{key}");
        let is_cone = self.kind == SurfaceKind::Cone;
        let (is_plane, is_sphere) = (self.kind == SurfaceKind::Plane, self.kind == SurfaceKind::Sphere);
        for (given, wanted, name) in [
            (self.diameter_mm.is_some(), !is_plane, "diameter_mm"),
            (self.half_angle_deg.is_some(), is_cone, "half_angle_deg"),
        ] {
            match (given, wanted) {
                (true, false) => {
                    return Err(Fault::new(&key(name), format!("{self} has no {name}"), "leave it out"));
                }
                (false, true) => {
                    return Err(Fault::new(
                        key("").trim_end_matches('.'),
                        format!("{} is missing", key(name)),
                        "add it",
                    ));
                }
                _ => {}
            }
        }
        if is_sphere && self.axis.is_some() {
            return Err(Fault::new(&key("axis"), "a sphere has no axis", "leave it out"));
        }
        let least = if is_cone { 0.0 } else { 1e-3 };
        let diameter =
            self.diameter_mm.map_or(Ok(0.0), |mm| within(&key("diameter_mm"), mm, [least, 1e4], "mm"))?;
        let half = self
            .half_angle_deg
            .map_or(Ok(0.0), |deg| within(&key("half_angle_deg"), deg, [-80.0, 80.0], "deg"))?;
        Ok((diameter / 2.0, libm::tan(half.to_radians())))
    }
}

/// The vector at length 1, if it has a length.
fn unit(v: Vector) -> Option<Vector> {
    let length = dot(v, v).sqrt();
    (length > 1e-9 && length < 1e9).then(|| v.map(|c| c / length))
}

fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The part of a vector across an axis, at length 1, unless it is along the axis.
fn across(v: Vector, axis: Vector) -> Option<Vector> {
    let v = unit(v)?;
    let along = dot(v, axis);
    let part: Vector = std::array::from_fn(|i| v[i] - along * axis[i]);
    if dot(part, part) < 1e-2 * 1e-2 { None } else { unit(part) }
}
