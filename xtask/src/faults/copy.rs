//! Copy of the committed sources, in which faults are planted.

use std::path::{Path, PathBuf};

use xtask::shell;

use super::list::Fault;

/// A worktree of the commit `HEAD`. It is removed when it is dropped.
#[derive(Debug)]
pub struct SourceCopy {
    root: PathBuf,
    folder: PathBuf,
}

impl SourceCopy {
    /// Makes the copy in `folder`; a copy that an earlier run has left there is removed.
    ///
    /// # Errors
    /// If git cannot make it.
    pub fn new(root: &Path, folder: &Path) -> Result<Self, String> {
        remove(root, folder)?;
        let path = folder.to_string_lossy();
        shell::output(root, "git", &["worktree", "add", "--quiet", "--force", "--detach", &path, "HEAD"])?;
        Ok(Self { root: root.to_path_buf(), folder: folder.to_path_buf() })
    }

    /// The root of the copy.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Plants a fault, until the returned value is dropped.
    ///
    /// # Errors
    /// If its text does not occur exactly once, or the file cannot be written.
    pub fn plant(&self, fault: &Fault) -> Result<Planted, String> {
        let path = self.folder.join(&fault.file);
        let source = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let faulty = fault.planted(&source)?;
        let planted = Planted { path, source };
        std::fs::write(&planted.path, faulty).map_err(|e| format!("{}: {e}", planted.path.display()))?;
        Ok(planted)
    }
}

impl Drop for SourceCopy {
    fn drop(&mut self) {
        if let Err(e) = remove(&self.root, &self.folder) {
            eprintln!("{e}");
        }
    }
}

fn remove(root: &Path, folder: &Path) -> Result<(), String> {
    if !folder.exists() || shell::succeeds(root, "git", &["worktree", "remove", "--force", &folder.to_string_lossy()]) {
        return Ok(());
    }
    std::fs::remove_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))
}

/// A fault in the copy; dropping it restores the file.
#[derive(Debug)]
pub struct Planted {
    path: PathBuf,
    source: String,
}

impl Drop for Planted {
    fn drop(&mut self) {
        if let Err(e) = std::fs::write(&self.path, &self.source) {
            eprintln!("{}: {e}; every later fault runs with this one", self.path.display());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planted_fault_is_taken_out_again() {
        let folder = std::env::temp_dir().join(format!("elbowroom-faults-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("crates")).unwrap();
        std::fs::write(folder.join("crates/a.rs"), "a < b").unwrap();
        let text = |words: &str| words.to_owned();
        let fault = Fault {
            name: text("limit"),
            crate_name: text("a"),
            file: text("crates/a.rs"),
            find: text("<"),
            replace: text("<="),
            why: text("one too many"),
        };
        // Not a worktree: dropping the copy removes the folder nevertheless.
        let copy = SourceCopy { root: folder.clone(), folder: folder.clone() };
        let read = || std::fs::read_to_string(folder.join("crates/a.rs")).unwrap();
        let planted = copy.plant(&fault).unwrap();
        assert_eq!(read(), "a <= b");
        drop(planted);
        assert_eq!(read(), "a < b");
        drop(copy);
        assert!(!folder.exists());
    }
}
