/// The solid `z <= 0` of its frame: the plane region of Romanelli 2011, whose Z axis is the outward normal.
///
/// ```
/// use elbowroom_proximity::{HalfSpace, Shape};
/// assert!(Shape::HalfSpace(HalfSpace).volume().is_infinite());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct HalfSpace;
