//! Routes: the page's files, the geometry, the WebSocket.

use std::sync::Arc;

use axum::extract::State;
use axum::extract::ws::WebSocketUpgrade;
use axum::http::{HeaderMap, StatusCode};
use axum::middleware;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Extension, Router};

use super::assets::Asset;
use super::draw_routes::draw_routes;
use super::responses::{compressed, has_token, no_token};
use super::session;
use super::shared::Shared;
use crate::drawing::TargetDrawing;
use crate::http::{Place, read_only};

/// Builds the router. Only these paths exist, so no path leads to other files.
///
/// With a cell whose targets are drawn, the routes for that are added.
pub(crate) fn routes(shared: Arc<Shared>, assets: Vec<Asset>, drawing: Option<Arc<TargetDrawing>>) -> Router {
    let draw = drawing.map(|drawing| draw_routes(&shared, drawing));
    let with_assets = assets.into_iter().fold(Router::new(), |router, Asset { path, kind, gzip }| {
        let answer = move || async move { compressed(kind, gzip) };
        router.route(path, get(answer))
    });
    let pages = with_assets
        .route("/geometry", get(geometry))
        .route("/history", get(history))
        .route("/socket", get(socket))
        .fallback(|| async { (StatusCode::NOT_FOUND, "not here\n") })
        .layer(middleware::from_fn(read_only))
        .with_state(shared);
    match draw {
        Some(draw) => pages.merge(draw),
        None => pages,
    }
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
