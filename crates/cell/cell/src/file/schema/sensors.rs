//! Keys of cameras and of sensors of points.

use super::key::{Key, key};

const MAX_SPEED: Key = key("max_speed", "length per second", "4 m/s", "speed of the fastest obstacle");

/// The lens of a camera, and of pictures of depths.
#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const LENS: &[Key] = &[
    key("size", "`[columns, rows]`", "required", "size of a picture, pixels"),
    key("focal_px", "number or `[fx, fy]`", "required", "focal length, pixels"),
    key("centre_px", "`[cx, cy]`", "the middle", "principal point, pixels"),
    key("center_px", "`[cx, cy]`", "", "the same as `centre_px`"),
    key("distortion", "`[k1, k2, k3]`", "`[0, 0, 0]`", "radial distortion, one to three coefficients"),
];

/// What a camera has besides [`LENS`] and [`SENSOR`].
#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const CAMERA: &[Key] = &[
    key("learning_frames", "2 to 10000", "30", "the first pictures, which show the empty cell"),
    key("templates", "list of tables", "none", "known objects"),
    key("uncertainty", "length", "30 mm", "enlargement of outlines: calibration, a pixel or two, and the motion until the next picture is processed"),
    MAX_SPEED,
    key("shadows", "true, false", "false: shadows are obstacles, the safe one", "dimmed floor is ignored"),
    key("mask_margin", "length", "30 mm", "enlargement of the silhouettes of the robots"),
    key("frames", "path", "`--frames`; without it `run` does not use the camera", "folder of pictures with `times.csv` (`file,t_s`); times before 0 are before the start of a run"),
];

#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const TEMPLATE: &[Key] = &[
    key("name", "text", "required", "name of this kind of object"),
    key("size", "`[length, width]`", "`size` or `diameter` required", "sides of a rectangular object"),
    key("diameter", "length", "`size` or `diameter` required", "diameter of a round object"),
    key("height", "length", "required", "its height"),
    key("tolerance", "length", "50 mm", "tolerance of the sides"),
    key("height_tolerance", "length", "10 mm", "tolerance of the height"),
];

/// Keys of every sensor, except the key of its folder.
#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const SENSOR: &[Key] = &[
    key("pose", "pose", "required", "in the world. Camera: z looks along the view, x to the right and y down in the picture. Cloud: the points are in its frame, in metres"),
    key("area", "list of `[x, y]`", "everything visible", "polygon on the floor; obstacles wholly outside are ignored"),
    key("floor", "length", "0", "height of the floor"),
    key("robot", "name", "the only one", "robot whose [map](map.md) has the obstacles (`[map.NAME]`, three joints)"),
    key("prediction", "seconds", "0.5", "a moving obstacle also blocks its predicted place after this time"),
    key("joints", "path", "`--joints`, else the robots stay at their start", "`t_s` and a column per joint: joint values in the pictures; in a run only at the times that it covers"),
    key("latency_ms", "ms", "100", "in a run: time from the stamp of a picture until its obstacles count"),
    key("search_ms", "ms, up to 60000", "200", "in a run: exact time of a search for a path around its obstacles ([at rest](vision.md#in-a-run) up to 8 times)"),
    key("stale_ms", "ms", "500, at least twice the latency", "in a run: robots are held when the last usable picture is older"),
    key("robots", "names", "all", "robots that avoid its obstacles in a run"),
];

/// What a sensor of points has besides [`SENSOR`].
#[rustfmt::skip] // a row per key, as in the document
pub(in crate::file) const CLOUD: &[Key] = &[
    key("clouds", "path", "`--clouds`; without it `run` does not use the sensor", "folder of `*.pcd`, `*.ply` or, with `depth`, of pictures; with `times.csv`"),
    key("depth", "table", "none: the files are points", "16-bit grey pictures of depths along z"),
    key("floor_thickness", "length", "40 mm", "points up to this height are floor"),
    key("ceiling", "length", "3 m", "points above this height are left out"),
    key("voxel", "length", "30 mm", "side of the cubes in which points are counted; about twice their distance"),
    key("min_points", "number", "2", "fewer points in a cube are noise"),
    key("min_voxels", "number", "4", "fewer cubes in a group are noise"),
    key("mask_margin", "length", "40 mm", "points within this distance of robots and known objects belong to them"),
    key("to_floor", "true, false", "true: a sensor above sees no undersides", "obstacles reach down to the floor"),
    key("uncertainty", "length", "20 mm", "enlargement of outlines"),
    MAX_SPEED,
    key(LEARNING_CLOUDS, "0 to 10000", "0", "the first clouds, without obstacles: points in and beside their cubes are background"),
];
pub(in crate::file) const LEARNING_CLOUDS: &str = "learning_clouds";

/// What `depth` has besides [`LENS`].
pub(in crate::file) const DEPTH: &[Key] = &[key("step", "length", "required", "length of depth 1")];
