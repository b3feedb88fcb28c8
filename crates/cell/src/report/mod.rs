//! What a run looked like: one HTML file that opens offline, and a screenful of text for the terminal.
//!
//! [`write_html`] puts everything into one file: plots after figure 12 of the interference-region paper (S1.13), the
//! override with the region that governs, a timing chart, the events, and a 3-D scene that plays. Nothing is fetched:
//! plotly.js and three.js lie in the file. [`summary`] is what a person reads first.
//!
//! **Size.** 5.3 MB are scripts. Plots have at most 2,000 points per trace and the 3-D scene at most 1,500 frames, so a
//! run adds at most about 60 kB per trace and 56 kB per moving link, however long it is; meshes add 16 bytes per
//! vertex and triangle.

mod downsample;
mod html;
mod outline;
pub(crate) mod palette;
mod plots;
mod scene;
mod spans;
mod spark;
mod summary;
mod tables;
mod view;
mod watched;
mod why;

pub use html::write_html;
pub use scene::{ReportMesh, ReportObject, ReportRobot, ReportScene};
pub use summary::{Summary, summary};
pub use watched::{stage_table, write_watch_html};
