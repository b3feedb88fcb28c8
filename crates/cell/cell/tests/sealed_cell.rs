//! Cells under a seal, for the tests of several modules.

use std::path::Path;

use elbowroom_cell::access::PrivateKey;
use elbowroom_cell::seal::{Signer, seal};
use elbowroom_monitor::AccessClass;

/// Writes a cell file, `cell.toml`, that is sealed by an integrator.
pub fn sealed(dir: &Path, text: &str) {
    let key = PrivateKey::generate(AccessClass::Integrator, "I").unwrap();
    let public = key.public().to_hex();
    let trusted = format!("[[key]]\nclass = \"integrator\"\nname = \"I\"\npublic = \"{public}\"\n");
    std::fs::write(dir.join("trusted-keys.toml"), trusted).unwrap();
    std::fs::write(dir.join("cell.toml"), text).unwrap();
    let signer = Signer { class: AccessClass::Integrator, key: &key, note: None };
    seal(&dir.join("cell.toml"), &signer).unwrap_or_else(|e| panic!("{e}"));
}
