//! room: kinematics
