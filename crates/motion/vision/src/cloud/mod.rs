//! Point clouds as a second source of obstacles: PCD and PLY files, depth images.

mod arm_filter;
mod cloud_tracker;
mod clusters;
mod depth;
mod point_cloud;
mod settings;
mod voxel_grid;

pub use cloud_tracker::{CloudReport, CloudStatus, CloudTimings, CloudTracker};
pub use point_cloud::PointCloud;
pub use settings::CloudTrackerSettings;
