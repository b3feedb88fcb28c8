//! Server: connections, requests, and the WebSocket of each page.

mod assets;
mod draw_routes;
mod responses;
mod routes;
mod session;
mod shared;
mod start;
mod token;

pub use start::Server;
