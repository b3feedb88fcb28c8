//! Robots avoid what sensors see: the path ahead is checked against the obstacles of each picture, replanned if it is a planned
//! move, and the robot stops before the obstacle if there is no other path.
//!
//! A run does this on its own clock, a live cell on threads beside its controllers. Each robot has three parts. A [`PathGuard`]
//! reads an [`ExecutedMotion`], returns where the path is blocked, and decides when to search. A [`PathReplanner`] searches for a
//! [`NewPath`]. A [`ProgramHold`], beside the executed program, decides in each tick whether the robot must brake now.

mod executed_motion;
mod object_places;
mod path_ahead;
mod path_guard;
mod path_replanner;
mod path_search;
mod perceived_obstacles;
mod program_hold;
mod surroundings;

pub use executed_motion::{ExecutedMotion, PlannedGoal};
pub use object_places::ObjectPlaces;
pub use path_ahead::PathAhead;
pub(crate) use path_ahead::SAMPLE_S;
pub use path_guard::{PathGuard, SearchTiming};
pub use path_replanner::{NewPath, PathReplanner, SearchResult};
pub use path_search::{ClosedRegions, SearchRequest};
pub use perceived_obstacles::{LastSight, PerceivedObstacle, PerceivedObstacles, PerceivedSolid};
pub use program_hold::{BlockedPath, ProgramHold};
pub use surroundings::Surroundings;
