//! The check of the token, and answers that several routes give.

use axum::body::Bytes;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};

use super::shared::Shared;

/// Answers with a body that is compressed as gzip.
pub(super) fn compressed(kind: &'static str, gzip: Bytes) -> Response {
    ([(header::CONTENT_TYPE, kind), (header::CONTENT_ENCODING, "gzip")], gzip).into_response()
}

/// Whether a request has the token of the page.
pub(super) fn has_token(shared: &Shared, headers: &HeaderMap) -> bool {
    let given = headers.get(header::AUTHORIZATION).and_then(|value| value.to_str().ok());
    let token = given.and_then(|value| value.strip_prefix("Bearer "));
    token.is_some_and(|token| shared.token.is(token))
}

/// Refuses a request without the token.
pub(super) fn no_token() -> Response {
    (StatusCode::UNAUTHORIZED, "the token is missing or another one\n").into_response()
}
