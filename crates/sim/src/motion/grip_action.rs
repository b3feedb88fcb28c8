//! What a program does with an object.

use elbowroom_robot::ObjectId;

/// A program grips or releases an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GripAction {
    /// The object.
    pub object: ObjectId,
    /// True: grips. False: releases.
    pub grips: bool,
    /// Line of the step in the cell file.
    pub line: usize,
}
