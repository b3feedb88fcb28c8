//! What all requests share.

use std::sync::Arc;

use axum::body::Bytes;
use tokio::sync::{Semaphore, watch};

use super::guard::Hosts;
use super::places::Places;
use super::token::Token;
use crate::engine::SentFrame;
use crate::history::History;
use crate::inbox::Inbox;
use crate::settings::Limits;

/// What requests share.
#[derive(Debug)]
pub(crate) struct Shared {
    pub(crate) token: Token,
    pub(crate) hosts: Hosts,
    pub(crate) limits: Limits,
    pub(crate) geometry: Bytes,
    pub(crate) inbox: Arc<Inbox>,
    pub(crate) history: Arc<History>,
    pub(crate) frames: watch::Receiver<SentFrame>,
    /// Connections without a token.
    pub(crate) places: Places,
    pub(crate) browsers: Arc<Semaphore>,
    pub(crate) mode: &'static str,
}
