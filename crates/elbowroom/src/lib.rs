//! room: elbowroom
