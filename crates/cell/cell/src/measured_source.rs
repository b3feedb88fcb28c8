//! Encoders and objects whose place arrives over the network while a cell is live.

use elbowroom_robot::ObjectId;

/// An encoder or an object with `measured = true`: `run` moves it as the cell file says, a live cell as the messages say;
/// `check` assumes the limits of what follows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeasuredSource {
    /// Index of an encoder: its travel is measured.
    Encoder(usize),
    /// An object: its pose is measured.
    Object(ObjectId),
}
