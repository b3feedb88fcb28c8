//! Encoders and objects whose place arrives over the network while a cell is live.

use elbowroom_robot::ObjectId;

/// An encoder or an object with `measured = true`: `run` and `check` move it as the cell file says, a live cell as the
/// messages say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeasuredSource {
    /// Index of an encoder: its travel is measured.
    Encoder(usize),
    /// An object: its pose is measured.
    Object(ObjectId),
}
