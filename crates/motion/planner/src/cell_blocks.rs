//! Blocks of 4 × 4 × 4 cells, one 64-bit word each: bit `(x·4 + y)·4 + z` represents one cell.

use elbowroom_cspace::{CellIndex, OccupancyBitmap};

/// Number of cells along the edge of a block.
pub(crate) const EDGE: usize = 4;
/// The cells of a block in which every cell is free.
pub(crate) const ALL_FREE: u64 = !0;
/// Largest number of components in a block: every second cell is free.
pub(crate) const MAX_COMPONENTS: usize = 32;

const Z0: u64 = 0x1111_1111_1111_1111;
const Z3: u64 = Z0 << 3;
const Y0: u64 = 0x000f_000f_000f_000f;
const Y3: u64 = Y0 << 12;

/// A face of a block.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Face {
    /// The axis normal to the face.
    pub axis: usize,
    /// Whether the face is at the upper end of the axis.
    pub is_upper: bool,
}

/// The three faces at the upper ends of the axes.
pub(crate) const UPPER_FACES: [Face; 3] =
    [Face { axis: 0, is_upper: true }, Face { axis: 1, is_upper: true }, Face { axis: 2, is_upper: true }];

/// All six faces of a block.
pub(crate) const FACES: [Face; 6] = [
    Face { axis: 0, is_upper: false },
    UPPER_FACES[0],
    Face { axis: 1, is_upper: false },
    UPPER_FACES[1],
    Face { axis: 2, is_upper: false },
    UPPER_FACES[2],
];

/// Returns the cells of the neighbour beyond `face` that share this face with some of `cells`.
pub(crate) fn facing_cells(cells: u64, face: Face) -> u64 {
    match (face.axis, face.is_upper) {
        (0, true) => cells >> 48,
        (0, false) => cells << 48,
        (1, true) => (cells & Y3) >> 12,
        (1, false) => (cells & Y0) << 12,
        (_, true) => (cells & Z3) >> 3,
        (_, false) => (cells & Z0) << 3,
    }
}

/// Flood fill: returns the cells of `free` that are connected to `seed` through faces.
fn flood(seed: u64, free: u64) -> u64 {
    let mut now = seed;
    loop {
        let z = (now & !Z3) << 1 | (now & !Z0) >> 1;
        let y = (now & !Y3) << 4 | (now & !Y0) >> 4;
        let next = (now | z | y | now << 16 | now >> 16) & free;
        if next == now {
            return now;
        }
        now = next;
    }
}

/// Returns the connected components of a block's free cells and their number.
pub(crate) fn components(free: u64) -> ([u64; MAX_COMPONENTS], usize) {
    let (mut found, mut count, mut rest) = ([0; MAX_COMPONENTS], 0, free);
    if free == ALL_FREE {
        found[0] = ALL_FREE;
        return (found, 1);
    }
    while rest != 0 {
        let component = flood(rest & rest.wrapping_neg(), rest);
        found[count] = component;
        count += 1;
        rest &= !component;
    }
    (found, count)
}

/// Returns the bit of a cell in its block.
pub(crate) fn bit_of(cell: CellIndex) -> u32 {
    let [x, y, z] = cell.map(|c| u32::from(c) % EDGE as u32);
    (x * 4 + y) * 4 + z
}

/// Returns the free cells of a block; cells outside the grid count as blocked.
pub(crate) fn free_cells(occupancy: &OccupancyBitmap, block: [usize; 3]) -> u64 {
    let [_, rows, count] = occupancy.shape();
    let width = occupancy.words_per_row();
    let first = block[2] * EDGE;
    let inside = 0xf >> (first + EDGE).saturating_sub(count).min(EDGE);
    let (word, shift) = (first / 64, first % 64);
    let mut free = 0;
    for x in 0..EDGE {
        let plane = occupancy.plane(block[0] * EDGE + x);
        for y in 0..EDGE.min(rows - block[1] * EDGE) {
            let blocked = plane.get((block[1] * EDGE + y) * width + word).map_or(!0, |w| w >> shift);
            free |= (!blocked & inside) << ((x * 4 + y) * 4);
        }
    }
    free
}

/// Returns the cell of a component nearest to its centroid, which sees most of the component in a straight line.
pub(crate) fn central_bit(component: u64) -> u32 {
    if component == ALL_FREE {
        return 0b01_01_01;
    }
    let mut sum = [0_i32; 3];
    let mut rest = component;
    let count = component.count_ones().max(1).cast_signed();
    while rest != 0 {
        let at = coordinates(rest.trailing_zeros());
        (0..3).for_each(|i| sum[i] += at[i]);
        rest &= rest - 1;
    }
    let (mut best, mut least, mut rest) = (0, i32::MAX, component);
    while rest != 0 {
        let bit = rest.trailing_zeros();
        let at = coordinates(bit);
        let far: i32 = (0..3).map(|i| (at[i] * count - sum[i]).pow(2)).sum();
        if far < least {
            (best, least) = (bit, far);
        }
        rest &= rest - 1;
    }
    best
}

fn coordinates(bit: u32) -> [i32; 3] {
    [bit >> 4, bit >> 2 & 3, bit & 3].map(u32::cast_signed)
}

/// Returns the cell that a bit of a block represents.
pub(crate) fn cell_of(block: [usize; 3], bit: u32) -> CellIndex {
    let at = coordinates(bit);
    [0, 1, 2].map(|i| (block[i] * EDGE) as u16 + at[i] as u16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn touch(a: u32, b: u32) -> bool {
        let (a, b) = (coordinates(a), coordinates(b));
        (0..3).map(|i| (a[i] - b[i]).abs()).sum::<i32>() == 1
    }

    /// The component of a cell, computed cell by cell.
    fn naive(seed: u32, free: u64) -> u64 {
        let mut component = 1_u64 << seed;
        loop {
            let next =
                (0..64).filter(|&b| free >> b & 1 == 1 && (0..64).any(|a| component >> a & 1 == 1 && touch(a, b)));
            let grown = next.fold(component, |p, b| p | 1 << b);
            if grown == component {
                return component;
            }
            component = grown;
        }
    }

    proptest! {
        #[test]
        fn components_agree_with_a_search_cell_by_cell(a in any::<u64>(), b in any::<u64>(), dense in any::<bool>()) {
            let free = if dense { a | b } else { a & b };
            let (components, count) = components(free);
            prop_assert_eq!(components.iter().fold(0, |all, p| all | p), free);
            for component in &components[..count] {
                prop_assert_eq!(*component, naive(component.trailing_zeros(), free));
                prop_assert!(component >> central_bit(*component) & 1 == 1);
            }
        }
    }

    #[test]
    fn a_chess_board_has_the_most_components() {
        let board = (0..64).filter(|&b| coordinates(b).iter().sum::<i32>() % 2 == 0).fold(0, |all, b| all | 1_u64 << b);
        assert_eq!(components(board).1, MAX_COMPONENTS);
    }

    #[test]
    fn across_a_face_lie_the_cells_one_further() {
        for face in FACES {
            for bit in 0..64 {
                let mut there = coordinates(bit);
                there[face.axis] += if face.is_upper { 1 } else { -1 };
                let beyond = !(0..4).contains(&there[face.axis]);
                there[face.axis] = there[face.axis].rem_euclid(4);
                let expected = if beyond { 1_u64 << ((there[0] * 4 + there[1]) * 4 + there[2]) } else { 0 };
                assert_eq!(facing_cells(1 << bit, face), expected);
            }
        }
    }
}
