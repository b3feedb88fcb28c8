//! References of some tests: Python packages to compare with, a browser to open pages in, and its driver.

use std::path::Path;

use xtask::{browser, playwright, python};

/// Paths that the tests read from the environment; without a path its tests are left out, with a message.
#[derive(Debug)]
pub struct References {
    found: [(&'static str, Option<String>); 3],
}

impl References {
    /// Installs missing references; offline, only searches and reports what is left out.
    ///
    /// # Errors
    /// If a reference cannot be installed; the message says how to do it by hand.
    pub fn find(root: &Path, offline: bool) -> Result<Self, String> {
        if !offline {
            python::install(root)?;
            browser::install(root)?;
            playwright::install(root)?;
        }
        let text = |path: Option<std::path::PathBuf>| path.map(|path| path.to_string_lossy().into_owned());
        let found = [
            ("ELBOWROOM_PYTHON", text(python::ready(root))),
            ("ELBOWROOM_CHROMIUM", text(browser::find(root))),
            ("ELBOWROOM_PLAYWRIGHT", text(playwright::ready(root))),
        ];
        for (name, _) in found.iter().filter(|(_, path)| path.is_none()) {
            println!("nothing is installed for {name}: the tests that need it are left out");
        }
        Ok(Self { found })
    }

    /// Environment variables to set.
    pub fn environment(&self) -> impl Iterator<Item = (&str, &str)> {
        self.found.iter().filter_map(|(name, path)| Some((*name, path.as_deref()?)))
    }
}
