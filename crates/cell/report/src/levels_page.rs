//! A robot with the boxes of its resolution levels, as one page with a slider over the levels.

use std::fmt::Write as _;
use std::io::{self, Write};

use elbowroom_inspect::BoxLevel;
use elbowroom_kinematics::ChainState;
use elbowroom_robot::Robot;
use elbowroom_scene::Level;
use serde_json::{Value, json};

use crate::packing::{ArrayPacker, deflated, pose_values};
use crate::scene_data::{PageData, robot_data};
use crate::tables::escape;
use crate::{page_template, shared_assets};

const PAGE: &str = include_str!("../assets/levels/page.html");
const SCRIPTS: [&str; 7] = [
    shared_assets::DOM,
    shared_assets::INFLATE,
    shared_assets::PACKING,
    include_str!("../assets/levels/data.js"),
    shared_assets::KINEMATICS,
    shared_assets::STAGE,
    include_str!("../assets/levels/levels.js"),
];
/// Step of the numbers of a box: 0.1 µm.
const STEP: f64 = 1e-7;

/// Writes one page that opens offline: the robot in 3-D with the boxes of one level, chosen by a slider, a table or arrow
/// keys, and sliders for its joints.
///
/// `levels` come from [`box_levels`](elbowroom_inspect::box_levels), so that the boxes are those of queries. The last
/// choice is L3: no boxes.
///
/// # Errors
/// Errors of `out`.
pub fn write(out: impl Write, name: &str, robot: &Robot, levels: &[BoxLevel]) -> io::Result<()> {
    let PageData { json, arrays } = data(robot, levels);
    page_template::fill(out, PAGE, |part, out| {
        match part {
            "title" => out.write_all(escape(name).as_bytes())?,
            "style" => out.write_all(shared_assets::STYLE.as_bytes())?,
            "rows" => out.write_all(rows(levels).as_bytes())?,
            "scene_data" => out.write_all(deflated(json.to_string().as_bytes())?.as_bytes())?,
            "arrays" => out.write_all(deflated(&arrays)?.as_bytes())?,
            "three" => out.write_all(deflated(shared_assets::THREE.as_bytes())?.as_bytes())?,
            "scripts" => SCRIPTS.iter().try_for_each(|s| out.write_all(s.as_bytes()))?,
            _ => return Ok(false),
        }
        Ok(true)
    })
}

/// The robot and its boxes, for the scripts.
fn data(robot: &Robot, levels: &[BoxLevel]) -> PageData {
    let mut packer = ArrayPacker::default();
    let mut json = robot_data(robot, &mut packer);
    let mut entries: Vec<Value> = levels
        .iter()
        .map(|level| {
            json!({
                "name": level.level.to_string(), "count": level.count(), "protrusion_m": level.protrusion_m,
                "boxes": packer.add(&numbers(level), 11, STEP),
            })
        })
        .collect();
    let none = packer.add(&[], 11, STEP);
    entries.push(json!({ "name": Level::L3.to_string(), "count": 0, "protrusion_m": 0.0, "boxes": none }));
    json["levels"] = entries.into();
    json["rest"] = json!(ChainState::at_rest(&robot.chain).q);
    PageData { json, arrays: packer.bytes().to_vec() }
}

/// Per box: link, pose, half extents.
fn numbers(level: &BoxLevel) -> Vec<f64> {
    let all = level.boxes.iter().flat_map(|(link, boxes)| boxes.iter().map(move |b| (link.0 as f64, b)));
    all.flat_map(|(link, b)| {
        [link].into_iter().chain(pose_values(&b.pose)).chain(b.half_extents.to_array()).collect::<Vec<f64>>()
    })
    .collect()
}

/// The rows of the table, HTML.
fn rows(levels: &[BoxLevel]) -> String {
    let mut out = String::new();
    for level in levels {
        let what = match level.level {
            Level::L1 => {
                "one box along the axes of the world, around the whole robot; its figure is at rest".to_owned()
            }
            Level::L2 => "one oriented box per link".to_owned(),
            _ => "the boxes of L2 halved again".to_owned(),
        };
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "<tr><td data-name=\"level\">{}</td><td data-name=\"boxes\" class=\"number\">{}</td>\
             <td data-name=\"protrudes\" class=\"number\">{:.2} mm</td><td data-name=\"what it is\">{what}</td></tr>",
            level.level,
            level.count(),
            1000.0 * level.protrusion_m
        );
    }
    out + "<tr><td data-name=\"level\">L3</td><td data-name=\"boxes\" class=\"number\">–</td>\
           <td data-name=\"protrudes\" class=\"number\">0 mm</td><td data-name=\"what it is\">the exact geometry</td></tr>"
}
