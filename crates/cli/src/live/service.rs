//! `elbowroom live`.

use super::LiveArgs;
use crate::output::{ExitStatus, Failure};

pub(crate) fn live(_: &LiveArgs) -> Result<ExitStatus, Failure> {
    Err(Failure::Wrong("not built yet".into()))
}
