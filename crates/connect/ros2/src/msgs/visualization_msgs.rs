//! Markers, as `RViz` and Foxglove draw them.

use super::builtin_interfaces::Duration;
use super::geometry_msgs::{Point, Pose, Vector3};
use super::sensor_msgs::CompressedImage;
use super::std_msgs::{ColorRGBA, Header};
use crate::message::message;

message! {
    /// A point of a texture.
    UVCoordinate = "visualization_msgs/msg/UVCoordinate" {
        /// Across.
        u: f32,
        /// Down.
        v: f32,
    }
}

message! {
    /// A mesh file.
    MeshFile = "visualization_msgs/msg/MeshFile" {
        /// Its name.
        filename: String,
        /// Its bytes.
        data: Vec<u8>,
    }
}

message! {
    /// A marker.
    Marker = "visualization_msgs/msg/Marker" {
        /// Time and frame.
        header: Header,
        /// Namespace; with `id` it names the marker.
        ns: String,
        /// Number in the namespace.
        id: i32,
        /// [`Marker::CUBE`] and the like.
        r#type: i32,
        /// [`Marker::ADD`] or [`Marker::DELETE`].
        action: i32,
        /// Pose in the frame.
        pose: Pose,
        /// Extents, m; width for lines and points.
        scale: Vector3,
        /// Colour.
        color: ColorRGBA,
        /// Time for which it is shown; 0 for no limit.
        lifetime: Duration,
        /// Whether it moves with its frame.
        frame_locked: bool,
        /// Points of lists.
        points: Vec<Point>,
        /// Colours of the points.
        colors: Vec<ColorRGBA>,
        /// Name of a texture.
        texture_resource: String,
        /// A texture.
        texture: CompressedImage,
        /// Points of the texture.
        uv_coordinates: Vec<UVCoordinate>,
        /// A text.
        text: String,
        /// Name of a mesh.
        mesh_resource: String,
        /// A mesh.
        mesh_file: MeshFile,
        /// Whether the mesh has its own colours.
        mesh_use_embedded_materials: bool,
    }
}

message! {
    /// Markers.
    MarkerArray = "visualization_msgs/msg/MarkerArray" {
        /// The markers.
        markers: Vec<Marker>,
    }
}

impl Marker {
    /// A box.
    pub const CUBE: i32 = 1;
    /// A ball.
    pub const SPHERE: i32 = 2;
    /// A cylinder along z.
    pub const CYLINDER: i32 = 3;
    /// Lines, each between two points.
    pub const LINE_LIST: i32 = 5;
    /// A text that faces the camera.
    pub const TEXT_VIEW_FACING: i32 = 9;
    /// Triangles, each of three points.
    pub const TRIANGLE_LIST: i32 = 11;

    /// Adds or changes the marker.
    pub const ADD: i32 = 0;
    /// Removes the marker.
    pub const DELETE: i32 = 2;
}
