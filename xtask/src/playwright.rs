//! Playwright, which drives the browser in the tests of the view. It includes no browser, and downloads none.

use std::path::{Path, PathBuf};

use crate::{python, shell};

/// Pinned, so that tests are driven in the same way everywhere.
const PACKAGE: &str = "playwright==1.65.2";
/// Checks that the pinned version is installed, and starts.
const PROBE: &str = "import importlib.metadata as m, playwright.sync_api; assert m.version('playwright') == '1.65.2'";
const FOLDER: &str = "target/playwright";

/// Finds the Python with Playwright, if installed.
pub fn ready(root: &Path) -> Option<PathBuf> {
    let python = root.join(FOLDER).join("bin/python");
    shell::succeeds(root, &python.to_string_lossy(), &["-c", PROBE]).then_some(python)
}

/// Finds the Python with Playwright, or installs it from PyPI.
///
/// # Errors
/// If it cannot be installed; the message says what to do.
pub fn install(root: &Path) -> Result<PathBuf, String> {
    if let Some(python) = ready(root) {
        println!("{FOLDER} has {PACKAGE}");
        return Ok(python);
    }
    let env = [("PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD", "1")];
    python::environment(root, &root.join(FOLDER), &[PACKAGE], &env).map_err(|e| explain(&e))?;
    ready(root).ok_or_else(|| explain("it is installed, but does not start"))
}

fn explain(reason: &str) -> String {
    format!(
        "{reason}\n  The view is operated by {PACKAGE} in {FOLDER}. Install python3 (3.11 or later) with venv and give pip a \
         registry, or run `cargo xtask test --offline`, which leaves these tests out and says so."
    )
}
