//! Server: connections, requests, and the WebSocket of each page.

mod assets;
mod routes;
mod session;
mod shared;
mod start;
mod token;

pub use start::Server;
