//! The answer: a tree of boxes of cells.

use crate::{Axis, Grid, Layer, Span};

use super::joints::MOST_JOINTS;

/// A box of cells, all blocked; `first..=last` on each axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Block<'a> {
    /// First cell on each axis.
    pub first: &'a [u16],
    /// Last cell on each axis.
    pub last: &'a [u16],
}

/// What is blocked, as boxes cut in two again and again: any number of axes, and memory that grows with the surface of
/// what is blocked, 8 bytes a cut or box.
///
/// ```
/// use elbowroom_cspace::{Axis, Others, RobotFiller};
/// use elbowroom_proximity::{Shape, Sphere};
/// use elbowroom_scene::example;
/// use elbowroom_spatial::{Pose, Vec3};
/// let scene = example::two_arms();
/// let robot = &scene.robots()[0];
/// let axes = ["a", "b", "c"].map(|name| Axis::from_degrees(name, -90.0, 90.0, 3.0).unwrap());
/// let filler = RobotFiller::new(&robot.robot, Pose::IDENTITY, &axes, &[0, 1, 2], Others::Any)?;
/// let ball = (Shape::Sphere(Sphere { radius: 0.2 }), Pose::from_translation(Vec3::new(0.7, 0.0, 0.7)));
/// let blocks = filler.fill(&[ball])?;
/// assert!(blocks.blocked() > 0 && blocks.blocked() < 60 * 60 * 60);
/// assert!(blocks.bytes() < 500_000);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Blocks {
    pub(super) axes: Vec<Axis>,
    /// Slabs along the first axis, in order: first cell, and the tree.
    pub(super) slabs: Vec<(u16, Vec<Node>)>,
}

/// A box: its left part is the next node, its right part has a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Node {
    Free,
    Blocked,
    /// Cells from `at` on are to the right.
    Cut {
        axis: u8,
        at: u16,
        right: u32,
    },
}

/// Cells `first..end` on each axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cells {
    pub first: [u16; MOST_JOINTS],
    pub end: [u16; MOST_JOINTS],
}

impl Cells {
    pub fn all(axes: &[Axis]) -> Self {
        let mut all = Self { first: [0; MOST_JOINTS], end: [1; MOST_JOINTS] };
        for (end, axis) in all.end.iter_mut().zip(axes) {
            *end = axis.count() as u16;
        }
        all
    }

    pub fn count(&self, axis: usize) -> u16 {
        self.end[axis] - self.first[axis]
    }

    pub fn cut(&self, axis: usize, at: u16) -> [Self; 2] {
        let (mut left, mut right) = (*self, *self);
        left.end[axis] = at;
        right.first[axis] = at;
        [left, right]
    }
}

impl Blocks {
    /// The axes.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// True where a configuration (rad or m, one value per axis) lies in a blocked cell, where it lies outside the limits,
    /// and where it has the wrong number of values.
    pub fn is_blocked(&self, q: &[f64]) -> bool {
        if q.len() != self.axes.len() {
            return true;
        }
        let mut cell = [0u16; MOST_JOINTS];
        for ((cell, axis), &value) in cell.iter_mut().zip(&self.axes).zip(q) {
            match axis.cell(value) {
                Some(c) => *cell = c as u16,
                None => return true,
            }
        }
        self.is_blocked_cell(&cell[..q.len()])
    }

    /// The same for a cell, by its number on each axis.
    pub fn is_blocked_cell(&self, cell: &[u16]) -> bool {
        let outside = |(c, axis): (&u16, &Axis)| usize::from(*c) >= axis.count();
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
                Node::Cut { axis, at: border, right } => {
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
        self.each(|b| {
            let cells = b.first.iter().zip(b.last).map(|(f, l)| u64::from(l - f) + 1).fold(1, u64::saturating_mul);
            sum = sum.saturating_add(cells);
        });
        sum
    }

    /// All blocked boxes, no two overlapping.
    pub fn each(&self, mut found: impl FnMut(Block<'_>)) {
        let mut slabs = self.slabs.iter().peekable();
        let mut open = Vec::new();
        while let Some((first, nodes)) = slabs.next() {
            let mut cells = Cells::all(&self.axes);
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
                        found(Block { first: &cells.first[..count], last: &last[..count] });
                    }
                    Node::Cut { axis, at: border, right } => {
                        let [l, r] = cells.cut(usize::from(axis), border);
                        open.extend([(right as usize, r), (at + 1, l)]);
                    }
                }
            }
        }
    }

    /// The same as a layer of a dense table, `None` unless the axes are the grid's three.
    pub fn layer(&self, grid: &Grid) -> Option<Layer> {
        if self.axes != grid.axes() {
            return None;
        }
        let rows = grid.shape()[1] as u32;
        let mut spans = Vec::new();
        self.each(|b| {
            for plane in b.first[0]..=b.last[0] {
                let from = u32::from(plane) * rows;
                let row = |j: u16| Span { row: from + u32::from(j), first: b.first[2], last: b.last[2] };
                spans.extend((b.first[1]..=b.last[1]).map(row));
            }
        });
        spans.sort_unstable();
        Some(Layer { spans: joined(spans) })
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        self.slabs.iter().map(|(_, nodes)| nodes.len() * size_of::<Node>()).sum()
    }
}

/// Spans of one row that follow each other become one.
fn joined(spans: Vec<Span>) -> Vec<Span> {
    let mut out: Vec<Span> = Vec::with_capacity(spans.len());
    for span in spans {
        match out.last_mut() {
            Some(last) if last.row == span.row && last.last + 1 >= span.first => last.last = last.last.max(span.last),
            _ => out.push(span),
        }
    }
    out
}
