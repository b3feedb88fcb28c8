//! `elbowroom replay`.

use super::ReplayArgs;
use crate::output::{ExitStatus, Failure};

pub(crate) fn replay(args: &ReplayArgs) -> Result<ExitStatus, Failure> {
    Err(Failure::Wrong(format!("{}: recordings cannot be read yet", args.recording.display())))
}
