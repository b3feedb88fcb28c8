//! Breadth-first exploration in little memory: about 20 bytes per state.
//!
//! Of a state that was explored, only a hash of 64 bits is stored. The first step of the path to it is stored with
//! the index of the state before, so a counterexample is a path. If two of `n` states had the same hash, one would
//! be missed: the probability is less than n² / 2⁶⁵, for 100 million states less than 1 in 3,000.

use std::collections::HashSet;
use std::hash::{BuildHasherDefault, Hasher};
use std::time::{Duration, Instant};

use stateright::Model;

use super::CellModel;
use super::action::Action;
use super::codec::Codec;
use super::mixer::Mixer;
use super::state::CellState;

/// Explorations that take longer report their progress.
const REPORTED: Duration = Duration::from_secs(20);

/// Takes hashes as they are.
#[derive(Debug, Default)]
struct Unhashed(u64);

impl Hasher for Unhashed {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, _: &[u8]) {}

    fn write_u64(&mut self, hash: u64) {
        self.0 = hash;
    }
}

/// The result of an exploration.
#[derive(Debug)]
pub(super) struct Explored {
    pub(super) states: usize,
    /// Number of steps within which every state that can be reached was checked.
    pub(super) depth: usize,
    /// True if all reachable states were explored.
    pub(super) is_complete: bool,
    /// A shortest path to a state that is not allowed.
    pub(super) counterexample: Option<Vec<Action>>,
}

/// Limits of an exploration.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    pub(super) states: usize,
    pub(super) time: Duration,
}

struct Explorer<'a> {
    model: &'a CellModel,
    codec: Codec,
    seen: HashSet<u64, BuildHasherDefault<Unhashed>>,
    /// Per state, the index of the state before it and of the action there.
    parents: Vec<(u32, u8)>,
    /// The states found in this round, each with its length.
    found: Vec<u8>,
    counterexample: Option<usize>,
}

impl Explorer<'_> {
    /// Adds a state unless it is known.
    fn add(&mut self, state: &mut CellState, parent: (u32, u8)) {
        let bytes = self.codec.encode(state);
        let mut hasher = Mixer::default();
        hasher.write(bytes);
        if !self.seen.insert(hasher.finish()) {
            return;
        }
        self.found.extend((bytes.len() as u16).to_le_bytes());
        self.found.extend_from_slice(bytes);
        self.parents.push(parent);
        if self.counterexample.is_none() && !self.model.is_exclusive(state) {
            self.counterexample = Some(self.parents.len() - 1);
        }
    }

    /// Adds all states after one state.
    fn expand(&mut self, index: usize, bytes: &[u8], state: &mut CellState, actions: &mut Vec<Action>) {
        actions.clear();
        self.codec.decode(bytes, state);
        self.model.actions(state, actions);
        for (a, action) in actions.iter().enumerate() {
            if a > 0 {
                self.codec.decode(bytes, state);
            }
            if self.model.act(state, *action).is_some() {
                self.model.simplify(state);
                self.add(state, (index as u32, a as u8));
            }
        }
    }

    /// The actions that lead to a state.
    fn path(&self, index: usize) -> Vec<Action> {
        let parent = |i: &usize| (*i > 0).then(|| self.parents[*i].0 as usize);
        let mut indices: Vec<usize> = std::iter::successors(Some(index), parent).filter(|i| *i > 0).collect();
        indices.reverse();
        let mut state = self.model.init_states().remove(0);
        let step = |i: usize| {
            let mut actions = Vec::new();
            self.model.actions(&state, &mut actions);
            let action = actions[usize::from(self.parents[i].1)];
            state = self.model.next_state(&state, action).expect("it was possible before");
            action
        };
        indices.into_iter().map(step).collect()
    }
}

/// Explores a model up to some limits.
pub(super) fn explore(model: &CellModel, limits: Limits) -> Explored {
    let started = Instant::now();
    let (codec, seen) = (Codec::default(), HashSet::default());
    let mut explorer = Explorer { model, codec, seen, parents: Vec::new(), found: Vec::new(), counterexample: None };
    let mut state = model.init_states().remove(0);
    explorer.add(&mut state, (0, 0));
    let (mut depth, mut index, mut actions, mut is_within) = (0, 0, Vec::new(), true);
    while !explorer.found.is_empty() && is_within {
        let round = std::mem::take(&mut explorer.found);
        let mut rest = &round[..];
        while let Some((length, after)) = rest.split_first_chunk().filter(|_| is_within) {
            let (bytes, after) = after.split_at(usize::from(u16::from_le_bytes(*length)));
            explorer.expand(index, bytes, &mut state, &mut actions);
            (rest, index) = (after, index + 1);
            is_within = explorer.counterexample.is_none() && explorer.parents.len() < limits.states;
            is_within &= index % 1024 != 0 || started.elapsed() < limits.time;
        }
        depth += usize::from(rest.is_empty() && !explorer.found.is_empty());
        if started.elapsed() > REPORTED {
            println!(
                "depth {depth}: {} states, {} of them not explored",
                explorer.parents.len(),
                explorer.parents.len() - index
            );
        }
    }
    let counterexample = explorer.counterexample.map(|index| explorer.path(index));
    Explored { states: explorer.parents.len(), depth, is_complete: is_within, counterexample }
}
