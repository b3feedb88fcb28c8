//! Report of a run: one HTML file that opens offline, and a text summary for the terminal; images of maps and models.
//!
//! [`write_html`] puts everything into one file: plots after figure 12 of the interference-region paper (S1.13), the
//! override with the governing region, a timing chart, the events, and an animated 3-D scene. Nothing is loaded from a
//! network: plotly.js and three.js are embedded. [`summary`] is the text summary.
//!
//! **Size.** 2.4 MB are scripts. Plots have at most 2,000 points per trace and the 3-D scene at most 1,500 frames, so a
//! run adds at most about 60 kB per trace and 56 kB per moving link, however long it is; meshes add 16 bytes per
//! vertex and triangle.
//!
//! [`write_perception_html`] writes the page of a run with a camera, [`map_pictures`] images of slices of a joint-space
//! map, [`map_page`] one page with a slider over them, [`model_picture`] an image of a robot model with its joint axes.
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

mod downsample;
mod explanation;
mod html;
pub mod map_page;
pub mod map_pictures;
pub mod model_picture;
mod palette;
mod perception_page;
mod plots;
mod png;
mod region_surface;
mod scene;
mod scene_data;
mod spans;
mod sparkline;
mod summary;
mod tables;

pub use html::write_html;
pub use perception_page::{stage_table, write_perception_html};
pub use scene::{ReportMesh, ReportObject, ReportRobot, ReportScene};
pub use summary::{TextSummary, summary};
