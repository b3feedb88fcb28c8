//! Images of the run: every 25th frame is saved as sent, every 10th with its overlay; some are included in the report,
//! with images of the map and the paths.

use std::path::PathBuf;

use elbowroom::perception::picture::{MapOverlay, fullest_slice, half, map_along_elbow, overlay};
use elbowroom::perception::{ObstacleUpdate, ReplanResult, ReportImage};
use elbowroom::planner::{Path, ReplanKind};
use elbowroom::vision::encode_png;

use crate::station::{Failure, Station};

/// Smallest interval between images in the report without a change of path, seconds.
const MIN_INTERVAL_S: f64 = 4.8;
/// Largest number of changes of path that the report shows.
const MAX_PATHS: usize = 4;

/// Saves images and collects those of the report.
pub struct ReportImages {
    folder: PathBuf,
    count: usize,
    last_s: f64,
    last_path_s: f64,
    paths: usize,
    /// The path from the last start at rest.
    start_path: Option<Path>,
    pub images: Vec<ReportImage>,
}

impl ReportImages {
    pub fn new(folder: PathBuf) -> Result<Self, Failure> {
        std::fs::create_dir_all(&folder)?;
        Ok(Self { folder, count: 0, last_s: 3.0, last_path_s: 0.0, paths: 0, start_path: None, images: Vec::new() })
    }

    /// Saves images of a frame; `sent` are its bytes.
    pub fn save(
        &mut self,
        station: &Station,
        sent: &[u8],
        update: &ObstacleUpdate,
        result: &ReplanResult,
    ) -> Result<(), Failure> {
        self.count += 1;
        if result.kind == Some(ReplanKind::Replanned) && !result.in_motion {
            self.start_path = station.executor.path().cloned();
        }
        if self.count.is_multiple_of(25) {
            std::fs::write(self.folder.join(format!("sent_{:06.2}.png", update.stamp_s)), sent)?;
        }
        let t = update.stamp_s;
        let path_changed = result.in_motion && self.paths < MAX_PATHS && t > self.last_path_s + 1.5;
        let is_due = !update.prisms.is_empty() && t > self.last_s + MIN_INTERVAL_S;
        if self.count % 10 == 1 || path_changed || is_due {
            let png = encode_png(&half(&overlay(&station.pipeline, &update.prisms)?)?)?;
            std::fs::write(self.folder.join(format!("seen_{t:06.2}.png")), &png)?;
            if path_changed || is_due {
                self.last_s = t;
                let kinds = update.prisms.iter().map(|p| {
                    let kind = p.kind.as_deref().unwrap_or("unknown, unbounded");
                    format!("{} ({kind})", p.id)
                });
                let kinds: Vec<String> = kinds.collect();
                let title = format!("Frame at {t:.2} s: {}", kinds.join(", "));
                let note = "As rendered, with noise. Blue: the arm's silhouette, masked. Red: foreground. Green: the \
                           reported footprint. Yellow: with its prediction for half a second.";
                self.images.push(ReportImage { title, note: note.into(), png });
            }
        }
        if path_changed {
            (self.last_path_s, self.paths) = (t, self.paths + 1);
            self.save_map(station, result, t)?;
        }
        Ok(())
    }

    /// Saves images of the map with the path before and after.
    fn save_map(&mut self, station: &Station, result: &ReplanResult, t: f64) -> Result<(), Failure> {
        let (occupancy, grid, here) =
            (station.executor.planner().occupancy(), station.pipeline.map().grid(), station.executor.planar());
        let overlay = MapOverlay { old_path: self.start_path.as_ref(), new_path: station.executor.path(), q: here };
        let how = if result.kind == Some(ReplanKind::Repaired) { "repaired" } else { "replanned" };
        let whole = encode_png(&map_along_elbow(occupancy, grid, &overlay)?)?;
        let slice = encode_png(&fullest_slice(occupancy, grid, &overlay)?)?;
        for (png, name, what) in [
            (whole, "map", "θ1 to the right, θ2 up; the redder, the more of θ3 is blocked"),
            (slice, "slice", "the slice of one θ1 in which most is blocked: θ3 to the right, θ2 up"),
        ] {
            std::fs::write(self.folder.join(format!("{name}_{t:06.2}.png")), &png)?;
            let title = format!("Joint map at {t:.2} s ({name}), path {how} in motion");
            let note = format!("{what}. Grey: the path from the last start. Green: the current path. Blue: the arm.");
            self.images.push(ReportImage { title, note, png });
        }
        Ok(())
    }
}
