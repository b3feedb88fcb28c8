//! A virtual robot at the start of a cell.

use elbowroom_cooperation::{CooperationError, Grasp, Member, VirtualRobot};
use elbowroom_formats::Diagnostic;
use elbowroom_robot::RobotId;
use elbowroom_scene::{Scene, SceneState};
use elbowroom_spatial::Pose;

use crate::{Cell, CellVirtualRobot};

impl CellVirtualRobot {
    /// The virtual robot at its start in the scene of the cell.
    ///
    /// # Errors
    /// [`Diagnostic`] at the line of the table if the tool of the holder is not at one of its grasps.
    pub fn start<'s>(&self, cell: &Cell, scene: &'s Scene) -> Result<VirtualRobot<'s>, Diagnostic> {
        let refused = |what: String| Diagnostic::new(&cell.file, self.line, what);
        let mut state = SceneState::new(scene);
        for (index, robot) in cell.robots.iter().enumerate() {
            state.set_q(scene, RobotId(index), &robot.start).map_err(|e| refused(e.to_string()))?;
        }
        let members = self.members.iter().map(|member| {
            let robot = &cell.robots[member.robot.0];
            Member {
                robot: member.robot,
                tip: robot.flange,
                tool_in_tip: robot.tcp_in_flange,
                limits: robot.limits.clone(),
                hand: robot.hand_links(),
                grasps: member.grasps.clone(),
            }
        });
        let tool_in_part = self.tool_in_part(cell);
        let distance = |grasp: &Grasp| {
            let turned = (grasp.tool_in_part.rotation.inverse() * tool_in_part.rotation).angle();
            grasp.tool_in_part.translation.distance(tool_in_part.translation) + 0.1 * turned
        };
        let grasps = self.members[self.holder].grasps.iter().map(distance).enumerate();
        let nearest = grasps.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(index, _)| index);
        let holder = (self.holder, nearest);
        let mut robot = VirtualRobot::new(scene, state, self.work_piece, members.collect(), holder, self.settings)
            .map_err(|e| self.not_started(cell, &e, &tool_in_part))?;
        if let Some(view) = &self.view {
            robot.keep_in_view(&view.visibility);
        }
        Ok(robot)
    }

    /// The tool centre point of the holder in the frame of the work-piece, at the start.
    fn tool_in_part(&self, cell: &Cell) -> Pose {
        let holder = &cell.robots[self.members[self.holder].robot.0];
        let tool_in_world = holder.base_in_world * holder.tcp_in_root(&holder.start);
        cell.objects[self.work_piece.0].in_world.inverse_mul(&tool_in_world)
    }

    fn short_approach(&self, cell: &Cell, member: usize, grasp: usize) -> Diagnostic {
        let (robot, part) = (&cell.robots[self.members[member].robot.0].name, &cell.objects[self.work_piece.0].name);
        let gap = cell.units.show_length(self.settings.gap_m);
        let what = format!(
            "grasp {} of robot \"{robot}\": before its approach the hand is nearer to \"{part}\" than the gap of {gap}, so it cannot get there",
            grasp + 1
        );
        Diagnostic::new(&cell.file, self.line, what)
            .hint("a longer `approach`, away from the work-piece, or a smaller `gap`")
    }

    fn not_started(&self, cell: &Cell, e: &CooperationError, tool_in_part: &Pose) -> Diagnostic {
        let (part, holder) =
            (&cell.objects[self.work_piece.0].name, &cell.robots[self.members[self.holder].robot.0].name);
        if let CooperationError::Touching(a, b) = e {
            let what = format!("{} and {} touch at the start", cell.part_name(*a), cell.part_name(*b));
            return Diagnostic::new(&cell.file, self.line, what).hint("a `start` and objects that leave room");
        }
        if let CooperationError::ShortApproach { member, grasp } = *e {
            return self.short_approach(cell, member, grasp);
        }
        let CooperationError::NotGrasped { distance_m, angle_rad } = *e else {
            return Diagnostic::new(&cell.file, self.line, format!("virtual robot \"{}\": {e}", self.name));
        };
        let what = format!(
            "robot \"{holder}\" at its `start` does not hold \"{part}\": its tool is {} and {:.1}° from the nearest of its grasps",
            cell.units.show_length(distance_m),
            angle_rad.to_degrees()
        );
        let at = [tool_in_part.translation.x, tool_in_part.translation.y, tool_in_part.translation.z];
        let at = at.map(|v| cell.units.in_file_units(v)).join(", ");
        let in_file = |rad: f64| rad / cell.units.angle.to_radians(1.0);
        let rpy = tool_in_part.rotation.to_rpy().map(|v| format!("{:.3}", in_file(v))).join(", ");
        let hint = format!(
            "another `start`, another place of \"{part}\", or the grasp where the tool is: {{ at = [{at}], rpy = [{rpy}] }}"
        );
        Diagnostic::new(&cell.file, self.line, what).hint(hint)
    }
}
