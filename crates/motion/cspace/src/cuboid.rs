//! Boxes given by half edge lengths: corners and bisection.

use elbowroom_spatial::Vec3;

/// Corners of a box around the origin; corner `i` is at the upper end of axis `b` if bit `b` of `i` is set.
pub(crate) fn corners(half: Vec3) -> [Vec3; 8] {
    let side = |i: usize, bit: u8| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
    std::array::from_fn(|i| Vec3::new(side(i, 0) * half.x, side(i, 1) * half.y, side(i, 2) * half.z))
}

/// A box bisected across its longest edge.
pub(crate) struct Bisection {
    /// Centre of the upper half; the centre of the lower half is opposite.
    pub offset: Vec3,
    /// Half edge lengths of the two halves.
    pub half: Vec3,
}

impl Bisection {
    pub fn new(half: Vec3) -> Self {
        let h = half.to_array();
        let longest = (0..3).max_by(|&i, &j| h[i].total_cmp(&h[j])).unwrap_or(0);
        let (mut half, mut offset) = (h, [0.0; 3]);
        half[longest] *= 0.5;
        offset[longest] = half[longest];
        Self { offset: Vec3::from(offset), half: Vec3::from(half) }
    }
}
