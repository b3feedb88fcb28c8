//! Arguments of programs that `cargo bench` starts.

use std::path::Path;

/// The arguments after the program's name, without the `--bench` that cargo adds.
///
/// Changes the working directory to the root of the workspace, so that relative paths in the arguments start there:
/// cargo starts a bench in the folder of its package.
///
/// # Panics
/// Panics if the workspace in which the program was compiled does not exist any more.
pub fn arguments() -> impl Iterator<Item = String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..");
    std::env::set_current_dir(root).expect("the program was compiled in this workspace");
    std::env::args().skip(1).filter(|argument| argument != "--bench")
}
