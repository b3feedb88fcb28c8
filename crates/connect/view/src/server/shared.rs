//! State that all requests share.

use std::sync::Arc;

use axum::body::Bytes;
use tokio::sync::{Semaphore, watch};

use super::token::Token;
use crate::engine::SentFrame;
use crate::history::History;
use crate::http::Hosts;
use crate::inbox::Inbox;
use crate::settings::ClientLimits;

/// State that all requests share.
#[derive(Debug)]
pub(crate) struct Shared {
    pub(crate) token: Token,
    pub(crate) hosts: Hosts,
    pub(crate) limits: ClientLimits,
    pub(crate) geometry: Bytes,
    pub(crate) inbox: Arc<Inbox>,
    pub(crate) history: Arc<History>,
    pub(crate) frames: watch::Receiver<SentFrame>,
    pub(crate) browsers: Arc<Semaphore>,
    pub(crate) mode: &'static str,
}
