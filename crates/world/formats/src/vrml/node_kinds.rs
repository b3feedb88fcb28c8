//! The nodes of VRML 2 and what is done with them.

use super::document::{Document, Node};

/// What a node is to the reader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NodeKind {
    /// A group with a frame of its own.
    Transform,
    /// A group whose children are all read: `Group`, `Anchor`, `Billboard`, `Collision`.
    Group,
    /// A group of which one child is read.
    Switch,
    /// A group whose first child is the finest.
    Lod,
    /// Another file.
    Inline,
    /// A surface with its appearance.
    Shape,
    /// Program text, which is not run.
    Script,
    /// A node of the standard without a surface.
    WithoutSurface,
    /// Any other node.
    Unknown,
}

/// Geometry with a surface, for [`may_have_surface`].
const SURFACES: [&str; 7] = ["Box", "Cone", "Cylinder", "ElevationGrid", "Extrusion", "IndexedFaceSet", "Sphere"];

/// Nodes of the standard that never have a surface.
const WITHOUT_SURFACE: [&str; 34] = [
    "Appearance",
    "AudioClip",
    "Background",
    "Color",
    "ColorInterpolator",
    "Coordinate",
    "CoordinateInterpolator",
    "CylinderSensor",
    "DirectionalLight",
    "Fog",
    "FontStyle",
    "ImageTexture",
    "Material",
    "MovieTexture",
    "NavigationInfo",
    "Normal",
    "NormalInterpolator",
    "OrientationInterpolator",
    "PixelTexture",
    "PlaneSensor",
    "PointLight",
    "PositionInterpolator",
    "ProximitySensor",
    "ScalarInterpolator",
    "Sound",
    "SphereSensor",
    "SpotLight",
    "TextureCoordinate",
    "TextureTransform",
    "TimeSensor",
    "TouchSensor",
    "Viewpoint",
    "VisibilitySensor",
    "WorldInfo",
];

/// The fields of each node that is read: those with an effect, and those that change no surface.
const FIELDS: [(&str, &[&str]); 16] = [
    ("Transform", &["children", "center", "rotation", "scale", "scaleOrientation", "translation"]),
    ("Group", &["children"]),
    ("Anchor", &["children", "description", "parameter", "url"]),
    ("Billboard", &["children", "axisOfRotation"]),
    ("Collision", &["children", "collide", "proxy"]),
    ("Switch", &["choice", "children", "whichChoice"]),
    ("LOD", &["level", "children", "center", "range"]),
    ("Inline", &["url"]),
    ("Shape", &["appearance", "geometry"]),
    (
        "IndexedFaceSet",
        &[
            "coord",
            "coordIndex",
            "ccw",
            "convex",
            "color",
            "normal",
            "texCoord",
            "colorIndex",
            "colorPerVertex",
            "creaseAngle",
            "normalIndex",
            "normalPerVertex",
            "texCoordIndex",
        ],
    ),
    (
        "ElevationGrid",
        &[
            "height",
            "xDimension",
            "xSpacing",
            "zDimension",
            "zSpacing",
            "ccw",
            "color",
            "normal",
            "texCoord",
            "colorPerVertex",
            "creaseAngle",
            "normalPerVertex",
        ],
    ),
    ("Box", &["size"]),
    ("Sphere", &["radius"]),
    ("Cylinder", &["radius", "height", "bottom", "side", "top"]),
    ("Cone", &["bottomRadius", "height", "bottom", "side"]),
    ("Coordinate", &["point"]),
];

/// Fields that any node may have and that change no surface.
const ANYWHERE: [&str; 4] = ["bboxCenter", "bboxSize", "metadata", "solid"];

pub(super) fn kind(name: &[u8]) -> NodeKind {
    match name {
        b"Transform" => NodeKind::Transform,
        b"Group" | b"Anchor" | b"Billboard" | b"Collision" => NodeKind::Group,
        b"Switch" => NodeKind::Switch,
        b"LOD" => NodeKind::Lod,
        b"Inline" => NodeKind::Inline,
        b"Shape" => NodeKind::Shape,
        b"Script" => NodeKind::Script,
        _ if contains(&WITHOUT_SURFACE, name) => NodeKind::WithoutSurface,
        _ => NodeKind::Unknown,
    }
}

/// Whether the standard has a node of this name that a prototype must not replace.
pub(super) fn is_standard(name: &[u8]) -> bool {
    kind(name) != NodeKind::Unknown || contains(&SURFACES, name)
}

/// Whether a node by itself may have a surface.
pub(super) fn may_have_surface(name: &[u8], document: &Document<'_>) -> bool {
    matches!(kind(name), NodeKind::Shape | NodeKind::Inline)
        || contains(&SURFACES, name)
        || document.prototypes.contains_key(name)
}

/// Names of the fields of a node that is read; `None` for other nodes.
pub(super) fn field_names(node: &Node<'_>) -> Option<&'static [&'static str]> {
    FIELDS.iter().find(|(name, _)| name.as_bytes() == node.kind).map(|(_, fields)| *fields)
}

/// Whether a field needs no attention in any node.
pub(super) fn is_known_anywhere(field: &[u8]) -> bool {
    contains(&ANYWHERE, field)
}

fn contains(list: &[&str], name: &[u8]) -> bool {
    list.iter().any(|n| n.as_bytes() == name)
}
