//! room: monitor
