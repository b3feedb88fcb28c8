//! Report of a run: one HTML file that opens offline, and a text summary for the terminal; images of maps and models.
//!
//! [`HtmlReport`] writes one file with
//!
//! - the result of each robot, and the regions;
//! - an animated 3-D scene in which the joints can be moved, with the distances of the guarded volumes to every region
//!   and object;
//! - plots of the distances over time, of the override with the governing region, after figure 12 of Romanelli 2011,
//!   and timing;
//! - the events.
//!
//! Nothing is loaded from a network: plotly.js and three.js are embedded. [`summary`] is the text summary.
//!
//! **Size.** Scripts and data are deflated; the scripts are 0.95 MB. Plots have at most 2,000 points per trace and the 3-D
//! scene at most 1,700 frames of joint values, so a run adds at most about 20 kB per trace and 8 kB per joint, however long
//! it is; meshes add about 8 bytes per triangle, equal ones once. The page needs a browser with `DecompressionStream`
//! (all since 2023); result and tables need no script.
//!
//! [`map_pictures`] writes images of slices of a joint-space map, [`map_page`] one page with a slider over them,
//! [`model_picture`] an image of a robot model with its joint axes. [`cell_data`], [`mesh_data`] and [`shared_assets`] are for other
//! pages with the 3-D scene of a cell.
//!
//! ```
//! use elbowroom_cell::Cell;
//! use elbowroom_report::{ReportScene, summary, write_html};
//! use elbowroom_sim::{RunOptions, simulate};
//! let cell = Cell::parse("rail.toml", r#"
//! version = 1
//! units = { length = "mm", angle = "deg" }
//! [robot.rail]
//! dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
//! links = [{ sphere = { radius = 50 } }]
//! [program.rail]
//! steps = [{ move = "joint", to = [1500] }]
//! "#)?;
//! let run = simulate(&cell, &RunOptions::default())?.recording;
//! let mut page = Vec::new();
//! write_html(&mut page, &ReportScene::of_cell(&cell), &[("run", &run)])?;
//! assert!(page.starts_with(b"<!DOCTYPE html>"));
//! assert!(summary(&run, 80, false).contains("rail"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Invariant.** For any cell and recording, a page never loads anything from a network, and a name in it is always
//! text, never markup.

mod carried_motion;
mod downsample;
mod explanation;
mod html;
mod last_motion;
pub mod levels_page;
pub mod map_page;
pub mod map_pictures;
mod mesh_data;
pub mod model_picture;
mod packing;
mod page_meshes;
mod page_template;
mod palette;
mod plots;
mod png;
mod region_distances;
mod region_surface;
mod results;
mod run_data;
mod scene;
mod scene_data;
mod sensor_data;
pub mod shared_assets;
mod spans;
mod sparkline;
mod summary;
mod tables;

pub use html::{HtmlReport, write_html};
pub use mesh_data::mesh_data;
pub use scene::{ReportMesh, ReportObject, ReportRobot, ReportScene};
pub use scene_data::{PageData, cell_data};
pub use summary::{TextSummary, summary};
