//! The regions that are being taught, with what answers the questions about their distances.

use elbowroom_robot::RobotId;

/// Number of regions that are kept: of a few panels at the same time.
const KEPT: usize = 4;

/// A region that is being taught.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct TaughtRegion {
    /// The robot whose distance is asked for.
    pub(crate) robot: RobotId,
    /// Name of the region.
    pub(crate) region: String,
    /// Its keys.
    pub(crate) toml: String,
}

/// What was built for the regions that were asked for last.
#[derive(Debug)]
pub(crate) struct TaughtRegions<Q> {
    /// The region asked for last is at the end.
    kept: Vec<(TaughtRegion, Q)>,
}

impl<Q> Default for TaughtRegions<Q> {
    fn default() -> Self {
        Self { kept: Vec::new() }
    }
}

impl<Q> TaughtRegions<Q> {
    /// What was built for a region; built now if it was not among the last ones. An error is not kept.
    pub(crate) fn query<E>(&mut self, region: TaughtRegion, build: impl FnOnce() -> Result<Q, E>) -> Result<&mut Q, E> {
        let found = match self.kept.iter().position(|(known, _)| *known == region) {
            Some(at) => self.kept.remove(at),
            None => (region, build()?),
        };
        if self.kept.len() == KEPT {
            self.kept.remove(0);
        }
        self.kept.push(found);
        let last = self.kept.len() - 1;
        Ok(&mut self.kept[last].1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_is_built_at_the_first_question_and_when_others_have_replaced_it() {
        let mut regions = TaughtRegions::default();
        let mut built = Vec::new();
        let mut ask = |robot: usize, toml: &str, is_wrong: bool| {
            let key = TaughtRegion { robot: RobotId(robot), region: "lamp".into(), toml: toml.into() };
            let build = || {
                built.push(format!("{robot}{toml}"));
                if is_wrong { Err(()) } else { Ok(format!("{robot}{toml}")) }
            };
            regions.query(key, build).map(|found| found.clone())
        };
        assert_eq!(ask(0, "a", true), Err(()));
        for _ in 0..3 {
            assert_eq!(ask(0, "a", false), Ok("0a".into()));
            assert_eq!(ask(1, "a", false), Ok("1a".into()));
        }
        for toml in ["b", "c", "d"] {
            ask(0, toml, false).unwrap();
            // The one that is asked for stays.
            assert_eq!(ask(1, "a", false), Ok("1a".into()));
        }
        ask(0, "a", false).unwrap();
        assert_eq!(built, ["0a", "0a", "1a", "0b", "0c", "0d", "0a"]);
    }
}
