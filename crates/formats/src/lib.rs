//! room: formats
