//! Exploration of all reachable states, and properties of their graph.

use std::collections::HashMap;

use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::{Dfs, EdgeRef, Reversed, Visitable};

use super::model::{ModelState, ProtocolModel, Step, Violation};

/// The graph of the reachable states.
pub(super) struct StateGraph(DiGraph<ModelState, Step>);

/// Explores the states breadth first.
///
/// # Errors
/// The first property that does not hold.
pub(super) fn explore(model: &ProtocolModel) -> Result<StateGraph, Violation> {
    let mut graph = DiGraph::new();
    let mut known = HashMap::from([(model.start(), graph.add_node(model.start()))]);
    let mut explored = 0;
    while explored < graph.node_count() {
        let from = NodeIndex::new(explored);
        let state = graph[from].clone();
        for step in model.steps(&state) {
            let next = model.next(&state, step)?;
            let to = *known.entry(next).or_insert_with_key(|next| graph.add_node(next.clone()));
            graph.add_edge(from, to, step);
        }
        explored += 1;
    }
    Ok(StateGraph(graph))
}

impl StateGraph {
    pub(super) fn states(&self) -> usize {
        self.0.node_count()
    }

    pub(super) fn steps(&self) -> usize {
        self.0.edge_count()
    }

    /// The states from which not all robots can finish.
    fn unfinished(&self, model: &ProtocolModel) -> Vec<NodeIndex> {
        let finished = self.0.node_indices().filter(|i| model.finished(&self.0[*i])).collect();
        let mut search = Dfs::from_parts(finished, self.0.visit_map());
        let mut can_finish = vec![false; self.0.node_count()];
        while let Some(state) = search.next(Reversed(&self.0)) {
            can_finish[state.index()] = true;
        }
        self.0.node_indices().filter(|i| !can_finish[i.index()]).collect()
    }

    /// Number of states from which not all robots can finish, and a description of the first.
    pub(super) fn stuck_states(&self, model: &ProtocolModel) -> (usize, String) {
        let stuck = self.unfinished(model);
        (stuck.len(), stuck.first().map(|i| model.describe(&self.0[*i])).unwrap_or_default())
    }

    /// Number of states in which not all robots can finish and none can move, and the number of those in which the arbiter
    /// reports no cycle although all robots have requested their slots.
    pub(super) fn deadlocks(&self, model: &ProtocolModel) -> (usize, usize) {
        // No step changes the state: all robots have requested their slots.
        let is_settled = |state: &NodeIndex| self.0.neighbors(*state).all(|next| next == *state);
        let unfinished = self.unfinished(model);
        let dead: Vec<_> = unfinished.iter().copied().filter(is_settled).collect();
        let silent = dead.iter().filter(|i| !model.reports_cycle(&self.0[**i])).count();
        // Every part of the graph from which not all robots can finish must contain a deadlock.
        assert!(unfinished.is_empty() || !dead.is_empty(), "robots move for ever without finishing");
        (dead.len(), silent)
    }

    /// A robot that can stay at its place for ever although every robot ticks again and again, with a state in which it
    /// does.
    pub(super) fn starving(&self, model: &ProtocolModel) -> Option<(NodeIndex, usize)> {
        let robots = model.robots();
        kosaraju_scc(&self.0).iter().find_map(|component| {
            let ticks = self.ticks_within(component, robots);
            let place = |state: NodeIndex, r: usize| self.0[state].robots[r].at;
            let stays = |r: &usize| component.iter().all(|state| place(*state, *r) == place(component[0], *r));
            let is_fair = ticks.iter().all(|ticks| *ticks);
            (0..robots).filter(|_| is_fair).find(stays).map(|r| (component[0], r))
        })
    }

    /// Whether, for each robot, one of its ticks leads from a state of the component to a state of the component.
    fn ticks_within(&self, component: &[NodeIndex], robots: usize) -> Vec<bool> {
        let inside: std::collections::HashSet<_> = component.iter().copied().collect();
        let mut ticks = vec![false; robots];
        for edge in component.iter().flat_map(|state| self.0.edges(*state)) {
            if let (Step::Tick(r), true) = (edge.weight(), inside.contains(&edge.target())) {
                ticks[r.0] = true;
            }
        }
        ticks
    }
}
