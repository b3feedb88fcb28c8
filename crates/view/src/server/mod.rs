//! The server: connections, requests, and the WebSocket of each page.

mod assets;
mod connection;
mod guard;
mod places;
mod routes;
mod session;
mod shared;
mod start;
mod token;

pub use start::Server;
