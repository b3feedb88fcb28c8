//! Cell by cell through one or two parts of blocks.

use std::collections::VecDeque;

use elbowroom_cspace::Cell;

use crate::blocks::bit_of;
use crate::graph::{Graph, Node};

const NOT_SEEN: u8 = u8::MAX;

/// Memory of the walk, at most 128 cells.
#[derive(Debug)]
pub(crate) struct Local {
    queue: VecDeque<Cell>,
    /// Per cell of either part: the step that led there.
    step: [u8; 128],
}

impl Default for Local {
    fn default() -> Self {
        Self { queue: VecDeque::with_capacity(128), step: [NOT_SEEN; 128] }
    }
}

impl Local {
    /// The fewest cells from `from` in one part to `to` in another, or in the same, sharing faces; both ends are in it.
    /// Empty where there is no way.
    pub fn way(&mut self, graph: &Graph, parts: [Node; 2], (from, to): (Cell, Cell), cells: &mut Vec<Cell>) {
        cells.clear();
        let index = |cell: Cell| {
            let part = parts.iter().position(|&part| graph.has(part, cell))?;
            Some(part * 64 + bit_of(cell) as usize)
        };
        let (Some(first), Some(last)) = (index(from), index(to)) else { return };
        self.step = [NOT_SEEN; 128];
        self.step[first] = 6;
        self.queue.clear();
        self.queue.push_back(from);
        while let Some(cell) = self.queue.pop_front() {
            if cell == to {
                break;
            }
            for step in 0..6 {
                let Some(next) = moved(cell, step) else { continue };
                let Some(i) = index(next).filter(|&i| self.step[i] == NOT_SEEN) else { continue };
                self.step[i] = step;
                self.queue.push_back(next);
            }
        }
        if self.step[last] == NOT_SEEN {
            return;
        }
        let mut cell = to;
        cells.push(cell);
        while let Some(step) = index(cell).map(|i| self.step[i]).filter(|&step| step < 6) {
            let Some(before) = moved(cell, step ^ 1) else { break };
            cell = before;
            cells.push(cell);
        }
        cells.reverse();
    }
}

/// One cell further: down, up along each axis.
fn moved(mut cell: Cell, step: u8) -> Option<Cell> {
    let along = &mut cell[usize::from(step / 2)];
    *along = if step % 2 == 1 { along.checked_add(1)? } else { along.checked_sub(1)? };
    Some(cell)
}
