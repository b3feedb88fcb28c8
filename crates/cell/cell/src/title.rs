//! What people call a cell.

use crate::Cell;

impl Cell {
    /// What people call the cell: its name, or the folder's where the file has no `name` and is called `cell.toml`.
    ///
    /// ```
    /// use elbowroom_cell::Cell;
    /// let cell = |file: &str| Cell::parse(file, "version = 1\n[robot.a]\ndh = [{ a = 0.4 }]\nlinks = [{ sphere = { radius = 0.1 } }]");
    /// assert_eq!(cell("line3/cell.toml")?.title(), "line3");
    /// assert_eq!(cell("line3/left.toml")?.title(), "left");
    /// # Ok::<(), elbowroom_formats::FormatError>(())
    /// ```
    pub fn title(&self) -> String {
        if self.name != "cell" {
            return self.name.clone();
        }
        let folder = self.file.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.map_or_else(std::env::current_dir, |folder| Ok(folder.to_path_buf()));
        let title = folder.ok().and_then(|folder| Some(folder.file_name()?.to_string_lossy().into_owned()));
        title.unwrap_or_else(|| self.name.clone())
    }
}
