//! Plane geometry that knows no blocks, no state and no calls: contours of turned parts with the passes that
//! rough and finish them, and the way of a tool's centre beside a contour.

pub(crate) mod contour;
pub(crate) mod corner;
pub(crate) mod frame;
pub(crate) mod offset;
pub(crate) mod passes;
pub(crate) mod track;
pub(crate) mod walk;

#[cfg(test)]
mod tests;
