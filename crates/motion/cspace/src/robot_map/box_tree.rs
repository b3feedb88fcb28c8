//! Blocked cells as a tree of boxes.

use super::settings::MAX_JOINTS;
use crate::{Grid, GridAxis, Layer, RowSpan};

/// A box of blocked cells, `first..=last` on each axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CellBox<'a> {
    /// First cell on each axis.
    pub first: &'a [u16],
    /// Last cell on each axis.
    pub last: &'a [u16],
}

/// Blocked cells as recursively bisected boxes, for any number of axes. The memory grows with the surface of the
/// blocked region: 8 bytes for each split or box.
///
/// ```
/// use elbowroom_cspace::{GridAxis, RemainingJoints, RobotMapBuilder};
/// use elbowroom_proximity::{Shape, Sphere};
/// use elbowroom_robot::example;
/// use elbowroom_spatial::{Pose, Vec3};
/// let robot = example::arm()?;
/// let axes = ["a", "b", "c"].map(|name| GridAxis::from_degrees(name, -90.0, 90.0, 3.0).unwrap());
/// let builder = RobotMapBuilder::new(&robot, Pose::IDENTITY, &axes, &[0, 1, 2], RemainingJoints::Swept)?;
/// let ball = (Shape::Sphere(Sphere { radius: 0.2 }), Pose::from_translation(Vec3::new(0.7, 0.0, 0.7)));
/// let tree = builder.build(&[ball])?;
/// assert!(tree.blocked() > 0 && tree.blocked() < 60 * 60 * 60);
/// assert!(tree.bytes() < 500_000);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct BoxTree {
    pub(super) axes: Vec<GridAxis>,
    /// Slabs along the first axis, in order: first cell and nodes.
    pub(super) slabs: Vec<(u16, Vec<Node>)>,
}

/// A box. The left half of a split is the next node; the right half is the node with the given index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Node {
    Free,
    Blocked,
    /// A split: cells from `at` on are in the right half.
    Split {
        axis: u8,
        at: u16,
        right: u32,
    },
}

/// Cells `first..end` on each axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct CellRange {
    pub first: [u16; MAX_JOINTS],
    pub end: [u16; MAX_JOINTS],
}

impl CellRange {
    pub fn all(axes: &[GridAxis]) -> Self {
        let mut all = Self { first: [0; MAX_JOINTS], end: [1; MAX_JOINTS] };
        for (end, axis) in all.end.iter_mut().zip(axes) {
            *end = axis.count() as u16;
        }
        all
    }

    pub fn count(&self, axis: usize) -> u16 {
        self.end[axis] - self.first[axis]
    }

    pub fn split(&self, axis: usize, at: u16) -> [Self; 2] {
        let (mut left, mut right) = (*self, *self);
        left.end[axis] = at;
        right.first[axis] = at;
        [left, right]
    }
}

impl BoxTree {
    /// The axes.
    pub fn axes(&self) -> &[GridAxis] {
        &self.axes
    }

    /// Whether a configuration (rad or m, one value per axis) is in a blocked cell. Also true if it is outside the
    /// limits or has the wrong number of values.
    pub fn is_blocked(&self, q: &[f64]) -> bool {
        if q.len() != self.axes.len() {
            return true;
        }
        let mut cell = [0u16; MAX_JOINTS];
        for ((cell, axis), &value) in cell.iter_mut().zip(&self.axes).zip(q) {
            match axis.cell(value) {
                Some(c) => *cell = c as u16,
                None => return true,
            }
        }
        self.is_blocked_cell(&cell[..q.len()])
    }

    /// Whether a cell is blocked, given by its index on each axis.
    pub fn is_blocked_cell(&self, cell: &[u16]) -> bool {
        let outside = |(c, axis): (&u16, &GridAxis)| usize::from(*c) >= axis.count();
        if cell.len() != self.axes.len() || cell.iter().zip(&self.axes).any(outside) {
            return true;
        }
        let slab = self.slabs.partition_point(|(first, _)| *first <= cell[0]);
        let Some((_, nodes)) = slab.checked_sub(1).and_then(|i| self.slabs.get(i)) else { return true };
        let mut at = 0;
        loop {
            match nodes[at] {
                Node::Free => return false,
                Node::Blocked => return true,
                Node::Split { axis, at: border, right } => {
                    at = if cell[usize::from(axis)] < border { at + 1 } else { right as usize };
                }
            }
        }
    }

    /// Number of cells.
    pub fn cells(&self) -> u64 {
        self.axes.iter().map(|a| a.count() as u64).fold(1, u64::saturating_mul)
    }

    /// Number of blocked cells.
    pub fn blocked(&self) -> u64 {
        let mut sum = 0u64;
        self.for_each_box(|b| {
            let cells = b.first.iter().zip(b.last).map(|(f, l)| u64::from(l - f) + 1).fold(1, u64::saturating_mul);
            sum = sum.saturating_add(cells);
        });
        sum
    }

    /// Calls `found` for every blocked box; boxes do not overlap.
    pub fn for_each_box(&self, mut found: impl FnMut(CellBox<'_>)) {
        let mut slabs = self.slabs.iter().peekable();
        let mut open = Vec::new();
        while let Some((first, nodes)) = slabs.next() {
            let mut cells = CellRange::all(&self.axes);
            cells.first[0] = *first;
            if let Some((next, _)) = slabs.peek() {
                cells.end[0] = *next;
            }
            open.push((0, cells));
            while let Some((at, cells)) = open.pop() {
                match nodes[at] {
                    Node::Free => {}
                    Node::Blocked => {
                        let count = self.axes.len();
                        let last = cells.end.map(|e| e - 1);
                        found(CellBox { first: &cells.first[..count], last: &last[..count] });
                    }
                    Node::Split { axis, at: border, right } => {
                        let [l, r] = cells.split(usize::from(axis), border);
                        open.extend([(right as usize, r), (at + 1, l)]);
                    }
                }
            }
        }
    }

    /// Converts the blocked cells to a layer; `None` unless the axes are the grid's three axes.
    pub fn to_layer(&self, grid: &Grid) -> Option<Layer> {
        if self.axes != grid.axes() {
            return None;
        }
        let rows = grid.shape()[1] as u32;
        let mut spans = Vec::new();
        self.for_each_box(|b| {
            for plane in b.first[0]..=b.last[0] {
                let from = u32::from(plane) * rows;
                let row = |j: u16| RowSpan { row: from + u32::from(j), first: b.first[2], last: b.last[2] };
                spans.extend((b.first[1]..=b.last[1]).map(row));
            }
        });
        spans.sort_unstable();
        Some(Layer { spans: merge_adjacent(spans) })
    }

    /// Memory on the heap, bytes.
    pub fn bytes(&self) -> usize {
        self.slabs.iter().map(|(_, nodes)| nodes.len() * size_of::<Node>()).sum()
    }
}

/// Merges spans of one row that touch or overlap.
fn merge_adjacent(spans: Vec<RowSpan>) -> Vec<RowSpan> {
    let mut out: Vec<RowSpan> = Vec::with_capacity(spans.len());
    for span in spans {
        match out.last_mut() {
            Some(last) if last.row == span.row && last.last + 1 >= span.first => last.last = last.last.max(span.last),
            _ => out.push(span),
        }
    }
    out
}
