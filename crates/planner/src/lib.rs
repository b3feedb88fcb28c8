//! Ways around: paths through the free cells of a joint map, replanned when cells change.
//!
//! Two cells are joined where they share a *face*; a straight stretch is allowed where every cell that it so much as
//! touches is free. So a path exists exactly if start and goal are joined, and it never slips between blocked cells that
//! meet at an edge.
//!
//! Where there is no map, or there are more joints than three, [`Connect`] finds its way by sampling in the exact scene and proves
//! it there.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

mod blocks;
mod check;
mod connect;
pub mod example;
mod graph;
mod labels;
mod local;
mod nearest;
mod path;
mod planner;
mod polish;
mod replan;
mod search;
mod sidestep;
mod sight;
mod space;
mod timing;

pub use check::{CheckError, MappedJoints};
pub use connect::{Connect, Fence, Route, RouteError, RouteOptions};
pub use path::{End, Path, PlanError};
pub use planner::{PlanOptions, Planner};
pub use replan::{How, Progress, Standing};
pub use timing::{MotionError, MotionLimits, State, Trajectory};
