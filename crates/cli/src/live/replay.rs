//! `elbowroom replay`.

use super::ReplayArgs;
use crate::output::{ExitStatus, Failure};

pub(crate) fn replay(_: &ReplayArgs) -> Result<ExitStatus, Failure> {
    Err(Failure::Wrong("not built yet".into()))
}
