//! room: proximity
