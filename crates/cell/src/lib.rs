//! room: cell
