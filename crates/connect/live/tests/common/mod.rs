//! Cells for several tests, and the start of their parts.

pub mod control_setup;

use std::sync::Arc;

use elbowroom_cell::{Cell, configure};
use elbowroom_interlock::Boot;
use elbowroom_live::network::Network;
use elbowroom_live::node::NodeParts;
use elbowroom_live::{Clock, Node};
use elbowroom_robot::RobotId;

/// Makes a cell of two carriages named `left` and `right`, 0.9 m apart, that move up from 0 to 2 m. `more` is added to
/// the file.
pub fn two_rails(more: &str) -> Cell {
    let text = format!(
        r#"
version = 1
name = "rails"
units = {{ length = "mm", angle = "deg" }}
tick_ms = 4
[robot.left]
dh = [{{ kind = "prismatic", min = 0, max = 2000, speed = 1000, acceleration = 4000 }}]
links = [{{ sphere = {{ radius = 50 }} }}]
stop_time = 0.25
[robot.right]
dh = [{{ kind = "prismatic", min = 0, max = 2000, speed = 1000, acceleration = 4000 }}]
links = [{{ sphere = {{ radius = 50 }} }}]
stop_time = 0.25
base = {{ at = [900, 0, 0] }}
{more}"#
    );
    Cell::parse("rails.toml", &text).unwrap_or_else(|e| panic!("{e}"))
}

/// Makes a cell of a carriage named `rail`, which moves up from 0 to 2 m, and the forbidden region `end` at 2.3 m with
/// a warning zone below it. `more` is added to the file.
pub fn rail(warning_mm: u32, more: &str) -> Cell {
    let text = format!(
        r#"
version = 1
name = "rail"
units = {{ length = "mm", angle = "deg" }}
[robot.rail]
dh = [{{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }}]
links = [{{ sphere = {{ radius = 50 }} }}]
[region.end]
shape = "sphere"
centre = [0, 0, 2500]
radius = 200
kind = "forbidden"
life = "permanent"
warning = {warning_mm}
{more}"#
    );
    Cell::parse("rail.toml", &text).expect("a cell")
}

/// Starts the node of the only robot of a cell.
pub fn start_node(cell: &Cell, clock: Clock, network: Arc<dyn Network>) -> Node {
    let setup = configure::setups(cell).expect("setups").remove(0);
    let networks = [network.clone(), network];
    let parts =
        NodeParts::new(&Arc::new(cell.clone()), (RobotId(0), setup), Boot(1), clock, networks).expect("a monitor");
    Node::start(parts).expect("a node")
}
