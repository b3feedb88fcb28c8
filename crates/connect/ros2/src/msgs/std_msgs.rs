//! A header, a colour, a text.

use super::builtin_interfaces::Time;
use crate::message::message;

message! {
    /// Time and frame of a message.
    Header = "std_msgs/msg/Header" {
        /// The time.
        stamp: Time,
        /// The frame.
        frame_id: String,
    }
}

message! {
    /// A colour, 0..1 each.
    ColorRGBA = "std_msgs/msg/ColorRGBA" {
        /// Red.
        r: f32,
        /// Green.
        g: f32,
        /// Blue.
        b: f32,
        /// Opacity.
        a: f32,
    }
}

message! {
    /// A text, as on `/robot_description`. Named `Text`, as Rust already has a `String`.
    Text = "std_msgs/msg/String" {
        /// The text.
        data: String,
    }
}
