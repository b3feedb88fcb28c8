//! Scripts that the report and other pages with the 3-D scene share.
//!
//! Each is a part of one function body, after the scripts that it uses: [`DOM`], [`PACKING`], a script of the page that
//! defines `Data`, [`KINEMATICS`], [`STAGE`]; [`THREE`] before all of them.

/// three.js as a classic script, which defines the global `THREE`.
pub const THREE: &str = include_str!("../assets/three/three.bundle.min.js");
/// `byId`, `css` and `element`.
pub const DOM: &str = include_str!("../assets/shared/dom.js");
/// `Inflate`: texts and bytes that the page holds deflated.
pub const INFLATE: &str = include_str!("../assets/shared/inflate.js");
/// `Packing.read`: arrays of numbers from bytes.
pub const PACKING: &str = include_str!("../assets/shared/packing.js");
/// `Kinematics`: poses, and forward kinematics of the robots in `Data`.
pub const KINEMATICS: &str = include_str!("../assets/shared/kinematics.js");
/// The style of pages with cards, a 3-D scene and tables.
pub const STYLE: &str = include_str!("../assets/report/report.css");
/// `Surfaces` and `createStage`: the 3-D scene of the robots, objects and regions in `Data`.
pub const STAGE: &str =
    concat!(include_str!("../assets/shared/surfaces.js"), include_str!("../assets/shared/stage.js"));
