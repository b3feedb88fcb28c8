//! Breadth-first search cell by cell, within one or two components of blocks.

use std::collections::VecDeque;

use elbowroom_cspace::CellIndex;

use crate::cell_blocks::bit_of;
use crate::cell_group_graph::{CellGroupGraph, Node};

const NOT_VISITED: u8 = u8::MAX;

/// Workspace of the search, for at most 128 cells.
#[derive(Debug)]
pub(crate) struct CellPathSearch {
    queue: VecDeque<CellIndex>,
    /// Per cell of the two components: the step that reached it.
    step: [u8; 128],
}

impl Default for CellPathSearch {
    fn default() -> Self {
        Self { queue: VecDeque::with_capacity(128), step: [NOT_VISITED; 128] }
    }
}

impl CellPathSearch {
    /// Computes the shortest sequence of cells with common faces from `from` in one component to `to` in another or the
    /// same component, both ends included. Empty if no such sequence exists.
    pub fn shortest_path(
        &mut self,
        graph: &CellGroupGraph,
        nodes: [Node; 2],
        [from, to]: [CellIndex; 2],
        cells: &mut Vec<CellIndex>,
    ) {
        cells.clear();
        let index = |cell: CellIndex| {
            let node = nodes.iter().position(|&node| graph.has(node, cell))?;
            Some(node * 64 + bit_of(cell) as usize)
        };
        let (Some(first), Some(last)) = (index(from), index(to)) else { return };
        self.step = [NOT_VISITED; 128];
        self.step[first] = 6;
        self.queue.clear();
        self.queue.push_back(from);
        while let Some(cell) = self.queue.pop_front() {
            if cell == to {
                break;
            }
            for step in 0..6 {
                let Some(next) = neighbour(cell, step) else { continue };
                let Some(i) = index(next).filter(|&i| self.step[i] == NOT_VISITED) else { continue };
                self.step[i] = step;
                self.queue.push_back(next);
            }
        }
        if self.step[last] == NOT_VISITED {
            return;
        }
        let mut cell = to;
        cells.push(cell);
        while let Some(step) = index(cell).map(|i| self.step[i]).filter(|&step| step < 6) {
            let Some(before) = neighbour(cell, step ^ 1) else { break };
            cell = before;
            cells.push(cell);
        }
        cells.reverse();
    }
}

/// Returns the neighbour of a cell: steps 0 to 5 are down and up along each axis.
fn neighbour(mut cell: CellIndex, step: u8) -> Option<CellIndex> {
    let along = &mut cell[usize::from(step / 2)];
    *along = if step % 2 == 1 { along.checked_add(1)? } else { along.checked_sub(1)? };
    Some(cell)
}
