//! `elbowroom view`.

use super::ViewArgs;
use crate::output::{ExitStatus, Failure};

pub(crate) fn view(_: &ViewArgs) -> Result<ExitStatus, Failure> {
    Err(Failure::Wrong("not built yet".into()))
}
