//! Voxel grid: points counted in cubes, in a hash table with open addressing that reuses its memory.

use elbowroom_spatial::Vec3;

/// A voxel that contains points.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Voxel {
    key: u64,
    pub(super) points: u32,
    /// Bounding box of the points in the voxel.
    pub(super) min: [f32; 3],
    pub(super) max: [f32; 3],
}

/// All voxels that contain points, in the order of their first points.
#[derive(Debug, Clone, Default)]
pub(super) struct VoxelGrid {
    pub(super) list: Vec<Voxel>,
    /// Index in the list plus 1; 0 if the slot is free. The length is a power of two.
    table: Vec<u32>,
}

/// Number of bits per axis of a key; indices stay away from the ends of the range, so that neighbours do not wrap
/// around.
const BITS: u32 = 21;
const HALF: f64 = (1 << (BITS - 1)) as f64;
/// Initial length of the table, a power of two; the table grows with the cloud.
const FIRST_SLOTS: usize = 1 << 10;

impl VoxelGrid {
    pub(super) fn clear(&mut self) {
        self.list.clear();
        self.table.fill(0);
        if self.table.is_empty() {
            self.table.resize(FIRST_SLOTS, 0);
        }
    }

    /// Counts a point; false if it is outside the range of the indices (30 km at 3 cm).
    pub(super) fn add(&mut self, p: Vec3, voxel_m: f64) -> bool {
        let Some(key) = key(p, voxel_m) else { return false };
        let at = p.to_array().map(|x| x as f32);
        let slot = self.slot(key);
        match self.table[slot] {
            0 => {
                self.list.push(Voxel { key, points: 1, min: at, max: at });
                self.table[slot] = self.list.len() as u32;
                if self.list.len() * 2 > self.table.len() {
                    self.grow();
                }
            }
            index => {
                let voxel = &mut self.list[index as usize - 1];
                voxel.points += 1;
                for axis in 0..3 {
                    voxel.min[axis] = voxel.min[axis].min(at[axis]);
                    voxel.max[axis] = voxel.max[axis].max(at[axis]);
                }
            }
        }
        true
    }

    /// Counts a point in its voxel and in the 26 voxels around it.
    pub(super) fn add_with_neighbours(&mut self, p: Vec3, voxel_m: f64) {
        for step in (0..27).map(|i| Vec3::new(f64::from(i / 9 - 1), f64::from(i / 3 % 3 - 1), f64::from(i % 3 - 1))) {
            self.add(p + step * voxel_m, voxel_m);
        }
    }

    /// Whether the voxel of a point contains points.
    pub(super) fn contains(&self, p: Vec3, voxel_m: f64) -> bool {
        !self.list.is_empty() && key(p, voxel_m).is_some_and(|key| self.table[self.slot(key)] != 0)
    }

    /// Calls `visit` with the indices of those of the 26 neighbours that precede `index` in space, so that each pair is
    /// visited once.
    pub(super) fn neighbours(&self, index: usize, mut visit: impl FnMut(usize)) {
        let key = self.list[index].key;
        for step in (0..13_u64).map(|i| (i / 9, i / 3 % 3, i % 3)) {
            // The key of the neighbour at −1 on all axes; steps of 0, 1, 2 correspond to offsets of −1, 0, 1.
            let low = key - (1 << (2 * BITS)) - (1 << BITS) - 1;
            let other = low + (step.0 << (2 * BITS)) + (step.1 << BITS) + step.2;
            let slot = self.slot(other);
            if self.table[slot] != 0 {
                visit(self.table[slot] as usize - 1);
            }
        }
    }

    /// The slot of a key, or the free slot for it.
    fn slot(&self, key: u64) -> usize {
        let mask = self.table.len() - 1;
        let mut slot = (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & mask;
        while self.table[slot] != 0 && self.list[self.table[slot] as usize - 1].key != key {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn grow(&mut self) {
        let size = self.table.len() * 4;
        self.table.clear();
        self.table.resize(size, 0);
        for index in 0..self.list.len() {
            let slot = self.slot(self.list[index].key);
            self.table[slot] = index as u32 + 1;
        }
    }
}

fn key(p: Vec3, voxel_m: f64) -> Option<u64> {
    let mut key = 0;
    for x in p.to_array() {
        let index = (x / voxel_m).floor();
        if !(index.abs() < HALF - 2.0) {
            return None;
        }
        key = (key << BITS) | (index + HALF) as u64;
    }
    Some(key)
}
