//! Browser that opens the report in a test.

use std::path::{Path, PathBuf};

use crate::shell;

/// Programs to try, in order.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];

/// Finds the browser: `$ELBOWROOM_CHROMIUM`, or the first of the usual names on the search path.
pub fn find(root: &Path) -> Option<PathBuf> {
    let named = std::env::var("ELBOWROOM_CHROMIUM").ok();
    let mut candidates = named.iter().map(String::as_str).chain(NAMES);
    candidates.find(|name| shell::succeeds(root, name, &["--version"])).map(PathBuf::from)
}

/// Finds the browser, or installs it from Debian.
///
/// # Errors
/// If there is no browser and none can be installed; the message says what to do.
pub fn install(root: &Path) -> Result<PathBuf, String> {
    if let Some(browser) = find(root) {
        println!("the browser is {}", browser.display());
        return Ok(browser);
    }
    let env = [("DEBIAN_FRONTEND", "noninteractive")];
    let updated = shell::run(root, "apt-get", &["update", "-q"], &env);
    let install = ["install", "-y", "-q", "--no-install-recommends", "chromium"];
    updated.and_then(|()| shell::run(root, "apt-get", &install, &env)).map_err(|e| explain(&e))?;
    find(root).ok_or_else(|| explain("chromium is installed, but does not start"))
}

fn explain(reason: &str) -> String {
    format!(
        "{reason}\n  The report is opened in headless Chromium. Install it (as root on Debian: apt-get install chromium), or name \
         one in ELBOWROOM_CHROMIUM, or run `cargo xtask test --offline`, which leaves that test out where there is none and says so."
    )
}
