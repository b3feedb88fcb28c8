//! Arguments of shapes that taught points determine.

use clap::{Args, ValueEnum};

/// A shape that taught points determine.
#[derive(Debug, Args)]
pub(crate) struct TaughtShapeArgs {
    /// The shape that the points determine
    #[arg(long, value_enum)]
    pub(crate) shape: TaughtShape,
    /// Teach with the flange instead of the TCP
    #[arg(long)]
    pub(crate) flange: bool,
    /// Height of box3 or of the walls of a fence, in the cell file's unit of length; of box3 positive is upwards from the
    /// taught corners, negative downwards
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) height: Option<f64>,
    /// Keep robots inside of the shape instead of out of it
    #[arg(long)]
    pub(crate) inside: bool,
    /// Thickness of the warning zone, in the cell file's unit of length
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pub(crate) warning: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum TaughtShape {
    Sphere,
    Sphere4,
    Cylinder,
    Plane,
    Box,
    Box3,
    Fence,
}
