//! Pictures: every fifth frame goes to a folder as it was seen; a few go into the report, with the map before and after.

use std::path::PathBuf;

use elbowroom::cell::watch::picture::{map_along_elbow, overlay, slice_at_base};
use elbowroom::cell::watch::{Outlook, Picture, Sighting};
use elbowroom::planner::{How, Path};
use elbowroom::vision::encode_png;

use crate::station::{Failure, Station};

/// Seconds between pictures of the report, where nothing happens.
const PAUSE_S: f64 = 2.4;
/// Pictures of path and map.
const MOST_PATHS: usize = 4;

pub struct Album {
    folder: PathBuf,
    count: usize,
    last_s: f64,
    last_path_s: f64,
    paths: usize,
    pub pictures: Vec<Picture>,
}

impl Album {
    pub fn new(folder: PathBuf) -> Result<Self, Failure> {
        std::fs::create_dir_all(&folder)?;
        Ok(Self { folder, count: 0, last_s: 3.0, last_path_s: 0.0, paths: 0, pictures: Vec::new() })
    }

    pub fn keep(
        &mut self,
        station: &Station,
        sighting: &Sighting,
        outlook: &Outlook,
        before: Option<&Path>,
    ) -> Result<(), Failure> {
        self.count += 1;
        let t = sighting.stamp_s;
        let went_over = outlook.in_motion && self.paths < MOST_PATHS && t > self.last_path_s + 1.5;
        let is_due = !sighting.prisms.is_empty() && t > self.last_s + PAUSE_S;
        if self.count % 5 == 1 || went_over || is_due {
            let png = encode_png(&overlay(&station.watch, &sighting.prisms)?)?;
            std::fs::write(self.folder.join(format!("seen_{t:06.2}.png")), &png)?;
            if went_over || is_due {
                self.last_s = t;
                let kinds = sighting.prisms.iter().map(|p| {
                    let kind = p.kind.as_deref().unwrap_or("unknown, unbounded");
                    format!("{} ({kind})", p.id)
                });
                let kinds: Vec<String> = kinds.collect();
                let title = format!("Frame at {t:.2} s: {}", kinds.join(", "));
                let note = "As rendered, with noise. Blue: the arm's silhouette, masked. Red: foreground. Green: the \
                            footprint told. Yellow: with where it will be half a second later.";
                self.pictures.push(Picture { title, note: note.into(), png });
            }
        }
        if went_over {
            (self.last_path_s, self.paths) = (t, self.paths + 1);
            self.map(station, outlook, before, t)?;
        }
        Ok(())
    }

    /// The map and the path before and after.
    fn map(&mut self, station: &Station, outlook: &Outlook, before: Option<&Path>, t: f64) -> Result<(), Failure> {
        let (table, grid, here) =
            (station.guide.planner().table(), station.watch.map().grid(), station.guide.planar());
        let ways = [before, station.guide.path()];
        let how = if outlook.how == Some(How::Mended) { "mended" } else { "planned anew" };
        let whole = encode_png(&map_along_elbow(table, grid, ways, here)?)?;
        let slice = encode_png(&slice_at_base(table, grid, ways, here)?)?;
        for (png, name, what) in [
            (whole, "map", "θ1 to the right, θ2 up; the redder, the more of θ3 is blocked"),
            (slice, "slice", "slice at the arm's θ1: θ2 to the right, θ3 up"),
        ] {
            std::fs::write(self.folder.join(format!("{name}_{t:06.2}.png")), &png)?;
            let title = format!("Joint map at {t:.2} s ({name}), path {how} while moving");
            let note = format!("{what}. Grey: the path before. Green: after. Blue: the arm.");
            self.pictures.push(Picture { title, note, png });
        }
        Ok(())
    }
}
