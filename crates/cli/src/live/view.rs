//! `elbowroom view`.

use super::ViewArgs;
use crate::output::{ExitStatus, Failure};

pub(crate) fn view(args: &ViewArgs) -> Result<ExitStatus, Failure> {
    Err(Failure::Wrong(format!("{}: cannot be shown in a browser yet", args.cell.display())))
}
