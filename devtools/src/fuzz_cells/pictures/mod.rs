//! Folders of pictures and clouds that the sensors of random cells see, made from the boxes of the cell.

mod camera;
mod depths;
mod points;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::spec::{CellSpec, SensorSpec, SensorView};

/// The folders of a cell and the files of joint values, which a run reads; they are removed when this is dropped.
#[derive(Debug)]
pub struct PictureFolders(Vec<PathBuf>);

impl PictureFolders {
    /// Writes the folders of all sensors of a cell, beside its file.
    pub fn write(spec: &CellSpec, beside: &Path) -> Result<Self, String> {
        let mut written = Self(Vec::new());
        for sensor in &spec.extras.sensors {
            let folder = beside.join(sensor.folder());
            written.0.push(folder.clone());
            write_folder(sensor, &folder).map_err(|e| format!("{}: {e}", folder.display()))?;
            if let Some(joints) = &sensor.joints {
                let file = beside.join(&joints.name);
                written.0.push(file.clone());
                std::fs::write(&file, &joints.text).map_err(|e| format!("{}: {e}", file.display()))?;
            }
        }
        Ok(written)
    }

    /// Leaves everything where it is.
    pub fn keep(mut self) {
        self.0.clear();
    }
}

impl Drop for PictureFolders {
    fn drop(&mut self) {
        // What stays costs only room.
        let remove =
            |path: &PathBuf| if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
        self.0.iter().for_each(|path| drop(remove(path)));
    }
}

fn write_folder(sensor: &SensorSpec, folder: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let mut times = String::from("file,t_s\n");
    let mut camera = camera::CameraPictures::new(sensor);
    for (index, t_s) in sensor.pictures.times.iter().enumerate() {
        let is_usable = !sensor.pictures.unusable.contains(&index);
        let (extension, bytes) = match &sensor.view {
            SensorView::Points { spacing, is_ply } => points::cloud(sensor, index, *spacing, is_usable).file(*is_ply),
            SensorView::Depths { lens, step } => ("pgm", depths::picture(sensor, index, (lens, *step), is_usable)),
            SensorView::Camera { .. } => ("png", camera.picture(sensor, index, is_usable)),
        };
        let name = format!("{index:04}.{extension}");
        std::fs::write(folder.join(&name), bytes)?;
        let _ = writeln!(times, "{name},{t_s}");
    }
    std::fs::write(folder.join("times.csv"), times)
}
