//! The title of a cell.

use std::path::PathBuf;

use elbowroom_robot::GeometryId;

use crate::Cell;

impl Cell {
    /// Name of a part: an object, or `robot/link`.
    pub fn part_name(&self, id: GeometryId) -> String {
        match id {
            GeometryId::Object(object) => self.objects[object.0].name.clone(),
            GeometryId::Link { robot, link } => {
                let r = &self.robots[robot.0];
                format!("{}/{}", r.name, r.robot.chain.links()[link.0])
            }
        }
    }

    /// The title of the cell: its name, or the name of the folder if the file is called `cell.toml` and states no other
    /// name.
    ///
    /// ```
    /// use elbowroom_cell::Cell;
    /// let robot = "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\n[robot.a]\n\
    ///     dh = [{ kind = \"prismatic\", min = 0, max = 900, speed = 100 }]\nlinks = [{ sphere = { radius = 50 } }]\n";
    /// assert_eq!(Cell::parse("line3/cell.toml", robot)?.title(), "line3");
    /// assert_eq!(Cell::parse("line3/left.toml", robot)?.title(), "left");
    /// # Ok::<(), elbowroom_formats::Diagnostic>(())
    /// ```
    pub fn title(&self) -> String {
        let says_nothing = self.name == "cell" && self.file.file_stem().is_some_and(|stem| stem == "cell");
        let folder = says_nothing.then(|| self.folder()).flatten();
        let title = folder.and_then(|folder| Some(folder.file_name()?.to_string_lossy().into_owned()));
        title.unwrap_or_else(|| self.name.clone())
    }

    /// The folder of the file, without `.` and `..` if the file exists.
    fn folder(&self) -> Option<PathBuf> {
        let file = std::fs::canonicalize(&self.file).or_else(|_| std::path::absolute(&self.file)).ok()?;
        file.parent().map(PathBuf::from)
    }
}
