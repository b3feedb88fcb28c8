//! Routes: the page's files, the geometry, the WebSocket.

use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::State;
use axum::extract::ws::WebSocketUpgrade;
use axum::http::{HeaderMap, StatusCode, header};
use axum::middleware;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Extension, Router};

use super::assets::Asset;
use super::session;
use super::shared::Shared;
use crate::http::{Place, read_only};

/// Builds the router. Only these paths exist, so no path leads to other files.
pub(crate) fn routes(shared: Arc<Shared>, assets: Vec<Asset>) -> Router {
    let with_assets = assets.into_iter().fold(Router::new(), |router, Asset { path, kind, gzip }| {
        let answer = move || async move { compressed(kind, gzip) };
        router.route(path, get(answer))
    });
    with_assets
        .route("/geometry", get(geometry))
        .route("/history", get(history))
        .route("/socket", get(socket))
        .fallback(|| async { (StatusCode::NOT_FOUND, "not here\n") })
        .layer(middleware::from_fn(read_only))
        .with_state(shared)
}

fn compressed(kind: &'static str, gzip: Bytes) -> Response {
    ([(header::CONTENT_TYPE, kind), (header::CONTENT_ENCODING, "gzip")], gzip).into_response()
}

/// Serves the geometry, only with the token: it describes the cell.
async fn geometry(State(shared): State<Arc<Shared>>, headers: HeaderMap) -> Response {
    if !has_token(&shared, &headers) {
        return no_token();
    }
    compressed("application/octet-stream", shared.geometry.clone())
}

/// Serves the frames of the last minutes, only with the token.
async fn history(State(shared): State<Arc<Shared>>, headers: HeaderMap) -> Response {
    if !has_token(&shared, &headers) {
        return no_token();
    }
    let packed = tokio::task::spawn_blocking(move || shared.history.packed()).await;
    match packed {
        Ok(Ok(packed)) => compressed("application/json", packed.into()),
        _ => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

fn has_token(shared: &Shared, headers: &HeaderMap) -> bool {
    let given = headers.get(header::AUTHORIZATION).and_then(|value| value.to_str().ok());
    let token = given.and_then(|value| value.strip_prefix("Bearer "));
    token.is_some_and(|token| shared.token.is(token))
}

fn no_token() -> Response {
    (StatusCode::UNAUTHORIZED, "the token is missing or another one\n").into_response()
}

async fn socket(
    State(shared): State<Arc<Shared>>,
    Extension(place): Extension<Place>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    if !shared.hosts.is_own_page(&headers) {
        return (StatusCode::FORBIDDEN, "only the page of this server may connect\n").into_response();
    }
    let bytes = shared.limits.message_bytes;
    let upgrade = upgrade.max_message_size(bytes).max_frame_size(bytes);
    upgrade.on_upgrade(move |socket| session::run(socket, place, shared))
}
