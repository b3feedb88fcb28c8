//! Pictures: some frames go to a folder as they were sent and as they were seen; a few go into the report, with the map before and after.

use std::path::PathBuf;

use elbowroom::cell::watch::picture::{fullest_slice, half, map_along_elbow, overlay};
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
    /// The path with which the arm set out last.
    set_out: Option<Path>,
    pub pictures: Vec<Picture>,
}

impl Album {
    pub fn new(folder: PathBuf) -> Result<Self, Failure> {
        std::fs::create_dir_all(&folder)?;
        Ok(Self { folder, count: 0, last_s: 3.0, last_path_s: 0.0, paths: 0, set_out: None, pictures: Vec::new() })
    }

    /// Looks at what a frame told; `sent` are its bytes.
    pub fn keep(
        &mut self,
        station: &Station,
        sent: &[u8],
        sighting: &Sighting,
        outlook: &Outlook,
    ) -> Result<(), Failure> {
        self.count += 1;
        if outlook.how == Some(How::Anew) && !outlook.in_motion {
            self.set_out = station.guide.path().cloned();
        }
        if self.count.is_multiple_of(25) {
            std::fs::write(self.folder.join(format!("sent_{:06.2}.png", sighting.stamp_s)), sent)?;
        }
        let t = sighting.stamp_s;
        let went_over = outlook.in_motion && self.paths < MOST_PATHS && t > self.last_path_s + 1.5;
        let is_due = !sighting.prisms.is_empty() && t > self.last_s + PAUSE_S;
        if self.count % 10 == 1 || went_over || is_due {
            let png = encode_png(&half(&overlay(&station.watch, &sighting.prisms)?)?)?;
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
            self.map(station, outlook, t)?;
        }
        Ok(())
    }

    /// The map and the path before and after.
    fn map(&mut self, station: &Station, outlook: &Outlook, t: f64) -> Result<(), Failure> {
        let (table, grid, here) = (station.guide.planner().table(), station.watch.map().grid(), station.guide.planar());
        let ways = [self.set_out.as_ref(), station.guide.path()];
        let how = if outlook.how == Some(How::Mended) { "mended" } else { "planned anew" };
        let whole = encode_png(&map_along_elbow(table, grid, ways, here)?)?;
        let slice = encode_png(&fullest_slice(table, grid, ways, here)?)?;
        for (png, name, what) in [
            (whole, "map", "θ1 to the right, θ2 up; the redder, the more of θ3 is blocked"),
            (slice, "slice", "the slice of one θ1 in which most is blocked: θ3 to the right, θ2 up"),
        ] {
            std::fs::write(self.folder.join(format!("{name}_{t:06.2}.png")), &png)?;
            let title = format!("Joint map at {t:.2} s ({name}), path {how} while moving");
            let note =
                format!("{what}. Grey: the path with which the arm set out. Green: the path now. Blue: the arm.");
            self.pictures.push(Picture { title, note, png });
        }
        Ok(())
    }
}
