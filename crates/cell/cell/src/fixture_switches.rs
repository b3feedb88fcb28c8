//! Fixtures that the stream of an operator switches.

/// A fixture of a cell, by its index in [`Guidance`](crate::Guidance).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FixtureRef {
    /// One that protects.
    Shield(usize),
    /// One that guides.
    Guide(usize),
}

/// When a stream switches which fixtures.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FixtureSwitches {
    /// Per switched fixture, whether it is on from these times (s, increasing).
    columns: Vec<(FixtureRef, Vec<(f64, bool)>)>,
}

impl FixtureSwitches {
    /// Adds a fixture with its states from these times (s, increasing) on.
    pub fn add(&mut self, fixture: FixtureRef, states: Vec<(f64, bool)>) {
        self.columns.push((fixture, states));
    }

    /// Whether the stream switches no fixture.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// Whether a fixture is on at some time, if it is `active` at the start.
    pub fn is_ever_on(&self, fixture: FixtureRef, active: bool) -> bool {
        active || self.states(fixture).is_some_and(|states| states.iter().any(|(_, is_on)| *is_on))
    }

    /// Whether a fixture is off at some time, if it is `active` at the start.
    pub fn is_ever_off(&self, fixture: FixtureRef, active: bool) -> bool {
        !active || self.states(fixture).is_some_and(|states| states.iter().any(|(_, is_on)| !*is_on))
    }

    /// Whether a fixture is to be on at a time (s), if it is `active` at the start.
    pub fn is_on(&self, fixture: FixtureRef, active: bool, t_s: f64) -> bool {
        let Some(states) = self.states(fixture) else { return active };
        let next = states.partition_point(|(from_s, _)| *from_s <= t_s);
        next.checked_sub(1).map_or(active, |last| states[last].1)
    }

    /// The times at which something may change, s.
    pub fn times(&self) -> impl Iterator<Item = f64> + '_ {
        self.columns.iter().flat_map(|(_, states)| states).map(|(t_s, _)| *t_s)
    }

    fn states(&self, fixture: FixtureRef) -> Option<&Vec<(f64, bool)>> {
        self.columns.iter().find(|(of, _)| *of == fixture).map(|(_, states)| states)
    }
}
