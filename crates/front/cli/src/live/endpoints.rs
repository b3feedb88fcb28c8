//! Endpoints of the page and of the control interface.

use elbowroom::view::ViewError;
use elbowroom::view::http::{Endpoint, TlsIdentity};

use super::args::PageArgs;
use crate::output::Failure;

/// Parses the endpoint in the value of an option.
pub(super) fn endpoint(option: &str, text: &str, page: &PageArgs) -> Result<Endpoint, Failure> {
    let identity = match (&page.certificate, &page.certificate_key) {
        (Some(certificate), Some(key)) => {
            Some(TlsIdentity::read(certificate, key).map_err(|e| wrong("--certificate", &e))?)
        }
        _ => None,
    };
    Endpoint::new(text, identity).map_err(|e| wrong(option, &e))
}

pub(super) fn wrong(option: &str, error: &ViewError) -> Failure {
    match error {
        ViewError::Cell(e) => Failure::Wrong(e.to_string()),
        e => Failure::Wrong(format!("{option}: {e}")),
    }
}
