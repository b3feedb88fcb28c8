//! What some tests compare with or open pages in: Python packages, a browser, and the driver of the browser.

use std::path::Path;

use xtask::{browser, playwright, python};

/// Paths as the tests take them from the environment; those that are missing leave tests out, with a message.
#[derive(Debug)]
pub struct References {
    found: [(&'static str, Option<String>); 3],
}

impl References {
    /// Installs what is missing; offline, only searches and says what is left out.
    ///
    /// # Errors
    /// What cannot be installed, and how to do it by hand.
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

    /// The variables to set.
    pub fn environment(&self) -> impl Iterator<Item = (&str, &str)> {
        self.found.iter().filter_map(|(name, path)| Some((*name, path.as_deref()?)))
    }
}
