//! Exploration of all reachable states, and properties of their graph.

use std::collections::HashMap;

use super::model::{ModelState, ProtocolModel, Step};

/// The graph of the reachable states.
pub(super) struct StateGraph {
    pub(super) states: Vec<ModelState>,
    /// Per state the steps from it and the states after them.
    next: Vec<Vec<(Step, u32)>>,
}

/// Explores the states breadth first.
///
/// # Errors
/// Describes the first property that does not hold.
pub(super) fn explore(model: &ProtocolModel) -> Result<StateGraph, String> {
    let start = model.start();
    let mut known = HashMap::from([(start.clone(), 0_u32)]);
    let mut graph = StateGraph { states: vec![start], next: Vec::new() };
    while graph.next.len() < graph.states.len() {
        let state = graph.states[graph.next.len()].clone();
        let mut steps = Vec::new();
        for step in model.steps(&state) {
            let next = model.next(&state, step)?;
            let fresh = graph.states.len() as u32;
            let index = *known.entry(next.clone()).or_insert(fresh);
            if index == fresh {
                graph.states.push(next);
            }
            steps.push((step, index));
        }
        graph.next.push(steps);
    }
    Ok(graph)
}

impl StateGraph {
    pub(super) fn steps(&self) -> usize {
        self.next.iter().map(Vec::len).sum()
    }

    /// Per state whether all robots can still finish.
    fn can_finish(&self, model: &ProtocolModel) -> Vec<bool> {
        let mut before: Vec<Vec<u32>> = vec![Vec::new(); self.states.len()];
        for (from, steps) in self.next.iter().enumerate() {
            for (_, to) in steps {
                before[*to as usize].push(from as u32);
            }
        }
        let mut can: Vec<bool> = self.states.iter().map(|s| model.finished(s)).collect();
        let mut open: Vec<u32> = (0..self.states.len() as u32).filter(|i| can[*i as usize]).collect();
        while let Some(state) = open.pop() {
            for from in &before[state as usize] {
                if !std::mem::replace(&mut can[*from as usize], true) {
                    open.push(*from);
                }
            }
        }
        can
    }

    /// Number of states from which not all robots can finish, and a description of the first.
    pub(super) fn stuck_states(&self, model: &ProtocolModel) -> (usize, String) {
        let can = self.can_finish(model);
        let first = can.iter().position(|can| !can).map(|i| model.describe(&self.states[i]));
        (can.iter().filter(|can| !**can).count(), first.unwrap_or_default())
    }

    /// Number of states in which not all robots can finish and none can move, and the number of those in which the arbiter
    /// reports no cycle although all robots have requested their slots.
    pub(super) fn deadlocks(&self, model: &ProtocolModel) -> (usize, usize) {
        let can = self.can_finish(model);
        let place = |i: usize| self.states[i].robots.iter().map(|b| b.at).collect::<Vec<_>>();
        let is_at_rest = |i: &usize| !can[*i] && self.next[*i].iter().all(|(_, to)| place(*to as usize) == place(*i));
        // No step changes the state: all robots have requested their slots.
        let settled = |i: &usize| self.next[*i].iter().all(|(_, to)| *to as usize == *i);
        let dead: Vec<usize> = (0..self.states.len()).filter(is_at_rest).filter(settled).collect();
        let silent = dead.iter().filter(|i| !model.reports_cycle(&self.states[**i])).count();
        // Every part of the graph that cannot finish must contain a deadlock.
        let unfinished = (0..self.states.len()).filter(|i| !can[*i]).count();
        assert!(unfinished == 0 || !dead.is_empty(), "robots move for ever without finishing");
        (dead.len(), silent)
    }

    /// A robot that can stay at its place for ever although every robot ticks again and again.
    pub(super) fn starving(&self, model: &ProtocolModel) -> Option<(usize, usize)> {
        let component = self.components();
        let count = component.iter().max().map_or(0, |m| *m as usize + 1);
        let robots = model.robots();
        let mut ticks = vec![vec![false; robots]; count];
        let mut first: Vec<Option<usize>> = vec![None; count];
        let mut moves = vec![vec![false; robots]; count];
        for (i, steps) in self.next.iter().enumerate() {
            let c = component[i] as usize;
            let known = *first[c].get_or_insert(i);
            for r in 0..robots {
                moves[c][r] |= self.states[i].robots[r].at != self.states[known].robots[r].at;
            }
            for (step, to) in steps {
                if let (Step::Tick(r), true) = (step, component[*to as usize] as usize == c) {
                    ticks[c][*r] = true;
                }
            }
        }
        let fair = (0..count).filter(|c| ticks[*c].iter().all(|t| *t));
        fair.flat_map(|c| (0..robots).map(move |r| (c, r)))
            .find(|(c, r)| !moves[*c][*r])
            .map(|(c, r)| (first[c].unwrap_or(0), r))
    }

    /// Strongly connected components (R. Tarjan, without recursion).
    fn components(&self) -> Vec<u32> {
        let n = self.states.len();
        let (mut index, mut low, mut component) = (vec![u32::MAX; n], vec![0_u32; n], vec![u32::MAX; n]);
        let (mut path, mut counter, mut found) = (Vec::new(), 0, 0);
        for root in 0..n {
            if index[root] != u32::MAX {
                continue;
            }
            let mut open = vec![(root, 0)];
            while let Some((v, edge)) = open.pop() {
                if edge == 0 {
                    (index[v], low[v]) = (counter, counter);
                    counter += 1;
                    path.push(v);
                }
                if let Some((_, to)) = self.next[v].get(edge) {
                    let w = *to as usize;
                    open.push((v, edge + 1));
                    if index[w] == u32::MAX {
                        open.push((w, 0));
                    } else if component[w] == u32::MAX {
                        low[v] = low[v].min(index[w]);
                    }
                    continue;
                }
                if low[v] == index[v] {
                    while let Some(w) = path.pop() {
                        component[w] = found;
                        if w == v {
                            break;
                        }
                    }
                    found += 1;
                }
                if let Some((parent, _)) = open.last() {
                    low[*parent] = low[*parent].min(low[v]);
                }
            }
        }
        component
    }
}
