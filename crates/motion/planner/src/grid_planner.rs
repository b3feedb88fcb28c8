//! Path planning on the grid: lazy Theta* on a coarse graph, then shortcutting.

use elbowroom_cspace::{CellChanges, CellIndex, Grid, OccupancyBitmap};

use crate::cell_group_graph::{CellGroupGraph, Node};
use crate::cell_path::CellPathSearch;
use crate::graph_components::GraphComponents;
use crate::grid_path::{GridPath, GridPlannerError, GridPlannerSetting, PathEnd};
use crate::grid_shortcutting::{GridShortcutting, PathContext};
use crate::grid_space::{CellPoint, CellScale, GridPoint, GridSpace};
use crate::line_of_sight::line_of_sight;
use crate::nearest_free_cell::nearest_cell;
use crate::theta_star::{PathLink, SearchOutcome, Terminal, ThetaStarQuery, ThetaStarSearch};

/// Number of nodes that a search expands after a change of cells before the connected components are computed.
const NODES_BEFORE_COMPONENTS: usize = 1500;

/// Settings of a [`GridPlanner`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridPlannerSettings {
    /// Factor of each joint in lengths; finite, above 0.
    pub weights: [f64; 3],
    /// Largest distance, in weighted radians, by which an end in a blocked cell is moved to a free cell; 0: ends are
    /// not moved.
    pub max_end_shift_rad: f64,
}

impl GridPlannerSettings {
    /// Unit weights, so that weighted lengths are lengths in joint space; ends are not moved.
    pub const DEFAULT: Self = Self { weights: [1.0; 3], max_end_shift_rad: 0.0 };
}

impl Default for GridPlannerSettings {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Finds paths through the free cells of a map. Use one planner per thread, because it reuses its workspace.
///
/// ```
/// use elbowroom_cspace::{ConvexObstacle, Grid, GridAxis, JointMap, PlanarArm};
/// use elbowroom_planner::{GridPlanner, GridPlannerSettings};
/// use elbowroom_spatial::Vec3;
/// let axis = |name: &str, min, max| GridAxis::from_degrees(name, min, max, 2.0);
/// let grid = Grid::new([axis("base", -170.0, 170.0)?, axis("shoulder", -90.0, 90.0)?, axis("elbow", -120.0, 150.0)?])?;
/// let mut map = JointMap::new(PlanarArm::KR125_SIZED, &grid)?;
/// map.set_obstacle("head", &ConvexObstacle::sphere(Vec3::new(1.5, 0.0, 1.0), 0.3)?);
/// let mut planner = GridPlanner::new(&grid, map.occupancy())?;
/// let path = planner.plan([-1.0, 0.4, 0.3], [1.0, 0.4, 0.3], &GridPlannerSettings::default())?;
/// assert!(path.length_rad > 2.0 && path.waypoints.len() > 2); // not straight
/// assert!(path.waypoints.iter().all(|&q| !map.is_blocked(q)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct GridPlanner {
    pub(crate) space: GridSpace,
    pub(crate) occupancy: OccupancyBitmap,
    graph: CellGroupGraph,
    components: GraphComponents,
    search: ThetaStarSearch,
    cell_path: CellPathSearch,
    shortcutting: GridShortcutting,
    links: Vec<PathLink>,
    cells: Vec<CellIndex>,
}

impl GridPlanner {
    /// Creates a planner for the occupancy of a grid.
    ///
    /// # Errors
    /// The shapes of occupancy and grid differ.
    pub fn new(grid: &Grid, occupancy: &OccupancyBitmap) -> Result<Self, GridPlannerError> {
        check_shape(grid, occupancy)?;
        Ok(Self {
            space: GridSpace::new(grid),
            graph: CellGroupGraph::new(occupancy),
            occupancy: occupancy.clone(),
            components: GraphComponents::default(),
            search: ThetaStarSearch::default(),
            cell_path: CellPathSearch::default(),
            shortcutting: GridShortcutting::default(),
            links: Vec::new(),
            cells: Vec::new(),
        })
    }

    /// Replaces the occupancy by a newer one; returns the cells that changed. The cost is proportional to the changes
    /// and to the number of planes that the two bitmaps do not share, which are compared.
    ///
    /// # Errors
    /// The shapes of occupancy and grid differ.
    pub fn update(&mut self, occupancy: &OccupancyBitmap) -> Result<CellChanges, GridPlannerError> {
        check_shape(self.space.grid(), occupancy)?;
        let changes = CellChanges::between(&self.occupancy, occupancy);
        self.apply(occupancy, &changes)?;
        Ok(changes)
    }

    /// Like [`update`](Self::update) with known changes, as [`elbowroom_cspace::JointMap::set_obstacle`] reports them:
    /// compares no planes. `changes` must be all differences between the planner's occupancy and the newer one. Changes
    /// of several updates must be applied one by one, in order.
    ///
    /// ```
    /// # use elbowroom_cspace::{ConvexObstacle, Grid, GridAxis, JointMap, PlanarArm};
    /// # use elbowroom_planner::GridPlanner;
    /// # use elbowroom_spatial::Vec3;
    /// # let axis = |name: &str| GridAxis::from_degrees(name, -90.0, 90.0, 5.0);
    /// # let grid = Grid::new([axis("base")?, axis("shoulder")?, axis("elbow")?])?;
    /// let mut map = JointMap::new(PlanarArm::KR125_SIZED, &grid)?;
    /// let mut planner = GridPlanner::new(&grid, map.occupancy())?;
    /// let changes = map.set_obstacle("head", &ConvexObstacle::sphere(Vec3::new(1.5, 0.0, 1.0), 0.3)?).clone();
    /// planner.apply(map.occupancy(), &changes)?;
    /// assert_eq!(planner.occupancy().blocked(), map.occupancy().blocked());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The shapes of occupancy and grid differ.
    pub fn apply(&mut self, occupancy: &OccupancyBitmap, changes: &CellChanges) -> Result<(), GridPlannerError> {
        check_shape(self.space.grid(), occupancy)?;
        self.occupancy = occupancy.clone();
        if !changes.is_empty() {
            self.graph.update(occupancy, changes);
            self.components.invalidate();
        }
        Ok(())
    }

    /// Returns the occupancy on which paths are planned.
    pub fn occupancy(&self) -> &OccupancyBitmap {
        &self.occupancy
    }

    /// Computes a short path from `start` to `goal` (values of the map's joints, radians) through free cells.
    ///
    /// A path exists if and only if the cells of start and goal are connected through free cells with common faces.
    ///
    /// # Errors
    /// An end is outside the grid (or NaN), or its cell is blocked without a free cell near enough; start and goal are
    /// not connected; a setting is invalid.
    pub fn plan(
        &mut self,
        start: [f64; 3],
        goal: [f64; 3],
        settings: &GridPlannerSettings,
    ) -> Result<GridPath, GridPlannerError> {
        let scale = self.scale(settings)?;
        let ends = self.ends([start, goal], scale, settings.max_end_shift_rad)?;
        let mut points = Vec::new();
        if !self.connect(scale, ends.map(|end| end.at), &mut points) {
            return Err(GridPlannerError::NoPath);
        }
        let context = PathContext { occupancy: &self.occupancy, space: &self.space, scale };
        self.shortcutting.run(context, &mut points);
        Ok(self.path(&points, scale, &ends))
    }

    /// Memory of the planner in bytes, without the occupancy, which it shares with the map.
    pub fn bytes(&self) -> usize {
        self.graph.bytes()
            + self.components.bytes()
            + self.search.bytes()
            + self.shortcutting.bytes()
            + self.links.capacity() * size_of::<PathLink>()
            + self.cells.capacity() * size_of::<CellIndex>()
    }

    /// Number of nodes that the last search expanded; 0 if the goal was in line of sight.
    pub fn expanded_nodes(&self) -> usize {
        self.search.expanded_nodes
    }

    fn scale(&self, settings: &GridPlannerSettings) -> Result<CellScale, GridPlannerError> {
        let bad = settings.weights.into_iter().find(|w| !(w.is_finite() && *w > 0.0));
        if let Some(value) = bad {
            return Err(GridPlannerError::InvalidSetting { setting: GridPlannerSetting::Weight, value });
        }
        if !(settings.max_end_shift_rad >= 0.0) {
            let (setting, value) = (GridPlannerSetting::MaxEndShift, settings.max_end_shift_rad);
            return Err(GridPlannerError::InvalidSetting { setting, value });
        }
        Ok(self.space.scale(settings.weights))
    }

    /// Returns the two ends of a path, each in a free cell.
    fn ends(
        &mut self,
        [start, goal]: [[f64; 3]; 2],
        scale: CellScale,
        radius: f64,
    ) -> Result<[FreeEnd; 2], GridPlannerError> {
        let cells = [self.cell(PathEnd::Start, start)?, self.cell(PathEnd::Goal, goal)?];
        let nodes = cells.map(|cell| self.graph.node(cell));
        let (from, to) = match nodes {
            [Some(_), Some(_)] => (self.exact_end(start, cells[0]), self.exact_end(goal, cells[1])),
            [Some(node), None] => {
                (self.exact_end(start, cells[0]), self.nearest_end(PathEnd::Goal, goal, scale, radius, Some(node))?)
            }
            [None, Some(node)] => {
                (self.nearest_end(PathEnd::Start, start, scale, radius, Some(node))?, self.exact_end(goal, cells[1]))
            }
            [None, None] => {
                let from = self.nearest_end(PathEnd::Start, start, scale, radius, None)?;
                let node = self.graph.node(from.at.cell);
                (from, self.nearest_end(PathEnd::Goal, goal, scale, radius, node)?)
            }
        };
        Ok([from, to])
    }

    fn cell(&self, end: PathEnd, q: [f64; 3]) -> Result<CellIndex, GridPlannerError> {
        self.space.grid().cell(q).ok_or_else(|| {
            let axes = self.space.grid().axes();
            let joint = (0..3).find(|&i| axes[i].cell(q[i]).is_none()).unwrap_or(0);
            GridPlannerError::Outside { end, joint, value: q[joint], min: axes[joint].min(), max: axes[joint].max() }
        })
    }

    fn exact_end(&self, q: [f64; 3], cell: CellIndex) -> FreeEnd {
        FreeEnd { at: CellPoint { cell, point: self.space.point_within(q, cell) }, q, moved: 0.0 }
    }

    /// Returns the nearest free cell: the nearest one connected to the node `other`, or any if none within the radius
    /// is connected.
    fn nearest_end(
        &mut self,
        end: PathEnd,
        q: [f64; 3],
        scale: CellScale,
        radius: f64,
        other: Option<Node>,
    ) -> Result<FreeEnd, GridPlannerError> {
        let Self { space, graph, components, .. } = self;
        let wanted = other.map(|node| components.component_of(graph, node));
        let point = space.point(q);
        let connected =
            |cell: CellIndex| graph.node(cell).is_some_and(|node| Some(components.component_of(graph, node)) == wanted);
        let found = wanted.and_then(|_| nearest_cell(space, scale, point, radius, connected));
        let found = found.or_else(|| nearest_cell(space, scale, point, radius, |cell| graph.node(cell).is_some()));
        let (cell, moved) = found.ok_or(GridPlannerError::Blocked { end, radius_rad: radius })?;
        let point = space.center(cell);
        Ok(FreeEnd { at: CellPoint { cell, point }, q: space.q(point), moved })
    }

    /// Computes points from one free cell to another, without shortcutting; returns false if the cells are not
    /// connected.
    fn connect(&mut self, scale: CellScale, [from, to]: [CellPoint; 2], points: &mut Vec<GridPoint>) -> bool {
        points.clear();
        points.push(from.point);
        self.search.expanded_nodes = 0;
        if line_of_sight(&self.occupancy, from.point, to.point) {
            points.push(to.point);
            return true;
        }
        let (Some(start), Some(goal)) = (self.graph.node(from.cell), self.graph.node(to.cell)) else { return false };
        if start == goal {
            self.append_cell_path([start, goal], [from.cell, to.cell], points);
            points.push(to.point);
            return true;
        }
        let terminals = [(start, from), (goal, to)].map(|(node, at)| Terminal { node, point: at.point });
        if !self.find_links(scale, terminals) {
            return false;
        }
        self.append_links([(start, from.cell), (goal, to.cell)], points);
        points.push(to.point);
        true
    }

    /// Finds the links from one node to another; returns false if the nodes are not connected.
    fn find_links(&mut self, scale: CellScale, [start, goal]: [Terminal; 2]) -> bool {
        let Self { occupancy, graph, space, search, links, components, .. } = self;
        let mut query = ThetaStarQuery { occupancy, graph, space, scale, start, goal, max_nodes: usize::MAX };
        if components.are_valid() {
            let is_connected = components.connected(graph, start.node, goal.node);
            return is_connected && search.run(&query, links) == SearchOutcome::Found;
        }
        // Most searches take less time than computing the components.
        query.max_nodes = NODES_BEFORE_COMPONENTS;
        match search.run(&query, links) {
            SearchOutcome::Found => true,
            SearchOutcome::NotConnected => false,
            SearchOutcome::LimitReached => {
                query.max_nodes = usize::MAX;
                let is_connected = components.connected(graph, start.node, goal.node);
                is_connected && search.resume(&query, links) == SearchOutcome::Found
            }
        }
    }

    /// Appends the points of the links between two ends; a link without line of sight is appended cell by cell.
    fn append_links(&mut self, [start, goal]: [(Node, CellIndex); 2], points: &mut Vec<GridPoint>) {
        let cell = |graph: &CellGroupGraph, node| match node {
            _ if node == start.0 => start.1,
            _ if node == goal.0 => goal.1,
            _ => graph.representative(node),
        };
        for n in (0..self.links.len().saturating_sub(1)).rev() {
            let (PathLink { node, by_cells }, before) = (self.links[n], self.links[n + 1].node);
            let cells = [cell(&self.graph, before), cell(&self.graph, node)];
            if by_cells {
                self.append_cell_path([before, node], cells, points);
            } else if node != goal.0 {
                points.push(self.space.center(cells[1]));
            }
        }
    }

    /// Appends the centres of the cells from one cell to another in one or two components, both included.
    fn append_cell_path(&mut self, nodes: [Node; 2], cells: [CellIndex; 2], points: &mut Vec<GridPoint>) {
        self.cell_path.shortest_path(&self.graph, nodes, cells, &mut self.cells);
        points.extend(self.cells.iter().map(|&cell| self.space.center(cell)));
    }

    fn path(&self, points: &[GridPoint], scale: CellScale, ends: &[FreeEnd; 2]) -> GridPath {
        let mut waypoints: Vec<[f64; 3]> = points.iter().map(|&p| self.space.q(p)).collect();
        // The points at the ends are within a billionth of a cell of the requested ends.
        if let Some(first) = waypoints.first_mut() {
            *first = ends[0].q;
        }
        if let Some(last) = waypoints.last_mut() {
            *last = ends[1].q;
        }
        waypoints.dedup();
        GridPath {
            waypoints,
            length_rad: scale.length(points),
            start_moved_rad: ends[0].moved,
            goal_moved_rad: ends[1].moved,
        }
    }
}

/// An end of a path, in a free cell.
#[derive(Debug, Clone, Copy)]
struct FreeEnd {
    pub at: CellPoint,
    pub q: [f64; 3],
    /// Weighted distance from the requested end, radians.
    pub moved: f64,
}

fn check_shape(grid: &Grid, occupancy: &OccupancyBitmap) -> Result<(), GridPlannerError> {
    let (occupancy, grid) = (occupancy.shape(), grid.shape());
    if occupancy == grid { Ok(()) } else { Err(GridPlannerError::Shape { occupancy, grid }) }
}
