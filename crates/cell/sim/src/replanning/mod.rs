//! Robots avoid what sensors see: the path ahead is checked against the obstacles of each picture, replanned if it is a planned
//! move, and the robot stops before the obstacle if there is no other path.
//!
//! A run does this on its own clock, a live cell on a thread of its own. Both have a [`PathGuard`] per robot: it reads an
//! [`ExecutedMotion`], says where the path is blocked, and finds new paths. A [`ProgramHold`] belongs to whoever executes the
//! motion: in each tick it decides whether the robot must brake now.

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
pub use path_replanner::NewPath;
pub use path_search::ClosedRegions;
pub use perceived_obstacles::{LastSight, PerceivedObstacle, PerceivedObstacles, PerceivedSolid};
pub use program_hold::{BlockedPath, ProgramHold};
pub use surroundings::Surroundings;
