//! The planner: keeps what it knows of a table from one question to the next.

use elbowroom_cspace::{Cell, Changes, Grid, Table};

use crate::graph::{Graph, Node};
use crate::labels::Labels;
use crate::local::Local;
use crate::nearest::nearest;
use crate::path::{End, Path, PlanError};
use crate::polish::{Ground, Polish};
use crate::search::{Outcome, Search, Task};
use crate::sight::is_clear;
use crate::space::{Point, Scale, Space};

/// After cells changed, so many nodes are searched before it is found out which are joined at all.
const BEFORE_LABELS: usize = 1500;

/// What a path shall be like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanOptions {
    /// How much a radian of each joint counts in lengths; finite, above 0.
    pub weights: [f64; 3],
    /// How far (weighted radians) an end in a blocked cell may be moved to a free one; 0: not at all.
    pub nearest_rad: f64,
}

impl Default for PlanOptions {
    /// All joints alike; ends stay where they are.
    fn default() -> Self {
        Self { weights: [1.0; 3], nearest_rad: 0.0 }
    }
}

/// Finds paths through the free cells of a table; one per thread, its memory is used again.
///
/// ```
/// use elbowroom_cspace::{Axis, Grid, JointMap, Obstacle, PlanarArm};
/// use elbowroom_planner::{PlanOptions, Planner};
/// use elbowroom_spatial::Vec3;
/// let axis = |name: &str, min, max| Axis::from_degrees(name, min, max, 2.0);
/// let grid = Grid::new([axis("base", -170.0, 170.0)?, axis("shoulder", -90.0, 90.0)?, axis("elbow", -120.0, 150.0)?])?;
/// let mut map = JointMap::new(PlanarArm::KR125_SIZED, &grid)?;
/// map.set("head", &Obstacle::sphere(Vec3::new(1.5, 0.0, 1.0), 0.3)?);
/// let mut planner = Planner::new(&grid, map.table())?;
/// let path = planner.plan([-1.0, 0.4, 0.3], [1.0, 0.4, 0.3], &PlanOptions::default())?;
/// assert!(path.length_rad > 2.0 && path.waypoints.len() > 2); // not straight through
/// assert!(path.waypoints.iter().all(|&q| !map.is_blocked(q)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Planner {
    pub(crate) space: Space,
    pub(crate) table: Table,
    pub(crate) graph: Graph,
    labels: Labels,
    search: Search,
    local: Local,
    pub(crate) polish: Polish,
    chain: Vec<(Node, bool)>,
    cells: Vec<Cell>,
}

impl Planner {
    /// A planner for a table of a grid.
    ///
    /// # Errors
    /// The table is not of the grid's shape.
    pub fn new(grid: &Grid, table: &Table) -> Result<Self, PlanError> {
        check_shape(grid, table)?;
        Ok(Self {
            space: Space::new(grid),
            graph: Graph::new(table),
            table: table.clone(),
            labels: Labels::default(),
            search: Search::default(),
            local: Local::default(),
            polish: Polish::default(),
            chain: Vec::new(),
            cells: Vec::new(),
        })
    }

    /// Takes over a newer table; tells which cells changed. Costs what changed, but for a look at planes that the two
    /// tables do not share.
    ///
    /// # Errors
    /// The table is not of the grid's shape.
    pub fn update(&mut self, table: &Table) -> Result<Changes, PlanError> {
        check_shape(self.space.grid(), table)?;
        let changes = Changes::between(&self.table, table);
        self.apply(table, &changes)?;
        Ok(changes)
    }

    /// The same where the changes are known, as [`elbowroom_cspace::JointMap::set`] tells them: costs what changed, no plane
    /// is compared. `changes` must be all that differs between the planner's table and the newer one; changes of several
    /// updates are handed over one by one, in order.
    ///
    /// ```
    /// # use elbowroom_cspace::{Axis, Grid, JointMap, Obstacle, PlanarArm};
    /// # use elbowroom_planner::Planner;
    /// # use elbowroom_spatial::Vec3;
    /// # let axis = |name: &str| Axis::from_degrees(name, -90.0, 90.0, 5.0);
    /// # let grid = Grid::new([axis("base")?, axis("shoulder")?, axis("elbow")?])?;
    /// let mut map = JointMap::new(PlanarArm::KR125_SIZED, &grid)?;
    /// let mut planner = Planner::new(&grid, map.table())?;
    /// let changes = map.set("head", &Obstacle::sphere(Vec3::new(1.5, 0.0, 1.0), 0.3)?).clone();
    /// planner.apply(map.table(), &changes)?;
    /// assert_eq!(planner.table().blocked(), map.table().blocked());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The table is not of the grid's shape.
    pub fn apply(&mut self, table: &Table, changes: &Changes) -> Result<(), PlanError> {
        check_shape(self.space.grid(), table)?;
        self.table = table.clone();
        if !changes.is_empty() {
            self.graph.update(table, changes);
            self.labels.forget();
        }
        Ok(())
    }

    /// The table that paths are planned on.
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// A short path from `start` to `goal` (values of the map's joints, radians) through free cells.
    ///
    /// It exists if and only if the two cells are joined through free cells that share faces.
    ///
    /// # Errors
    /// An end outside the map (NaN too) or in a blocked cell with no free one within the radius; ends that are not
    /// joined; options that cannot be used.
    pub fn plan(&mut self, start: [f64; 3], goal: [f64; 3], options: &PlanOptions) -> Result<Path, PlanError> {
        let scale = self.scale(options)?;
        let ends = self.ends([start, goal], scale, options.nearest_rad)?;
        let [from, to] = ends.each_ref().map(|end| end.point);
        let mut points = Vec::new();
        if !self.between(scale, (from, ends[0].cell), (to, ends[1].cell), usize::MAX, &mut points) {
            return Err(PlanError::NoPath);
        }
        let ground = Ground { table: &self.table, space: &self.space, scale };
        self.polish.run(ground, &mut points);
        Ok(self.path(&points, scale, &ends))
    }

    /// Memory held for the search, bytes; the table itself, shared with the map, not counted.
    pub fn bytes(&self) -> usize {
        self.graph.bytes()
            + self.labels.bytes()
            + self.search.bytes()
            + self.polish.bytes()
            + self.chain.capacity() * size_of::<(Node, bool)>()
            + self.cells.capacity() * size_of::<Cell>()
    }

    /// How many nodes the last search took up; 0 where the straight way was clear.
    pub fn taken(&self) -> usize {
        self.search.taken
    }

    pub(crate) fn scale(&self, options: &PlanOptions) -> Result<Scale, PlanError> {
        let bad = options.weights.into_iter().find(|w| !(w.is_finite() && *w > 0.0));
        if let Some(value) = bad {
            return Err(PlanError::Option { what: "a weight", value });
        }
        if !(options.nearest_rad >= 0.0) {
            return Err(PlanError::Option { what: "the radius", value: options.nearest_rad });
        }
        Ok(self.space.scale(options.weights))
    }

    /// Where a path can begin and end.
    fn ends(&mut self, [start, goal]: [[f64; 3]; 2], scale: Scale, radius: f64) -> Result<[Place; 2], PlanError> {
        let cells = [self.cell(End::Start, start)?, self.cell(End::Goal, goal)?];
        let nodes = cells.map(|cell| self.graph.node(cell));
        let (from, to) = match nodes {
            [Some(_), Some(_)] => (self.stay(start, cells[0]), self.stay(goal, cells[1])),
            [Some(node), None] => {
                (self.stay(start, cells[0]), self.move_in(End::Goal, goal, scale, radius, Some(node))?)
            }
            [None, Some(node)] => {
                (self.move_in(End::Start, start, scale, radius, Some(node))?, self.stay(goal, cells[1]))
            }
            [None, None] => {
                let from = self.move_in(End::Start, start, scale, radius, None)?;
                let node = self.graph.node(from.cell);
                (from, self.move_in(End::Goal, goal, scale, radius, node)?)
            }
        };
        Ok([from, to])
    }

    pub(crate) fn cell(&self, end: End, q: [f64; 3]) -> Result<Cell, PlanError> {
        self.space.grid().cell(q).ok_or_else(|| {
            let axes = self.space.grid().axes();
            let joint = (0..3).find(|&i| axes[i].cell(q[i]).is_none()).unwrap_or(0);
            PlanError::Outside { end, joint, value: q[joint], min: axes[joint].min(), max: axes[joint].max() }
        })
    }

    fn stay(&self, q: [f64; 3], cell: Cell) -> Place {
        Place { cell, point: self.space.point_within(q, cell), q, moved: 0.0 }
    }

    /// The nearest free cell, joined to a node if there is such a one.
    fn move_in(
        &mut self,
        end: End,
        q: [f64; 3],
        scale: Scale,
        radius: f64,
        other: Option<Node>,
    ) -> Result<Place, PlanError> {
        let Self { space, graph, labels, .. } = self;
        let wanted = other.map(|node| labels.of(graph, node));
        let point = space.point(q);
        let joined = |cell: Cell| graph.node(cell).is_some_and(|node| Some(labels.of(graph, node)) == wanted);
        let found = wanted.and_then(|_| nearest(space, scale, point, radius, joined));
        let found = found.or_else(|| nearest(space, scale, point, radius, |cell| graph.node(cell).is_some()));
        let (cell, moved) = found.ok_or(PlanError::Blocked { end, radius_rad: radius })?;
        let point = space.middle(cell);
        Ok(Place { cell, point, q: space.q(point), moved })
    }

    /// Points from one free cell to another, not polished; false where they are not joined or the search gave up.
    pub(crate) fn between(
        &mut self,
        scale: Scale,
        (from, from_cell): (Point, Cell),
        (to, to_cell): (Point, Cell),
        most: usize,
        points: &mut Vec<Point>,
    ) -> bool {
        points.clear();
        points.push(from);
        self.search.taken = 0;
        if is_clear(&self.table, from, to) {
            points.push(to);
            return true;
        }
        let (Some(start), Some(goal)) = (self.graph.node(from_cell), self.graph.node(to_cell)) else { return false };
        if start == goal {
            self.wind([start, goal], (from_cell, to_cell), points);
            points.push(to);
            return true;
        }
        if !self.find(scale, (start, from), (goal, to), most) {
            return false;
        }
        self.unroll((start, from_cell), (goal, to_cell), points);
        points.push(to);
        true
    }

    /// The chain from one node to another; false where they are not joined or the search gave up.
    fn find(&mut self, scale: Scale, start: (Node, Point), goal: (Node, Point), most: usize) -> bool {
        let Self { table, graph, space, search, chain, labels, .. } = self;
        let mut task = Task { table, graph, space, scale, start, goal, most };
        if most != usize::MAX {
            return search.run(&task, chain) == Outcome::Found;
        }
        if labels.are_fresh() {
            return labels.joined(graph, start.0, goal.0) && search.run(&task, chain) == Outcome::Found;
        }
        // Most searches are over before it would be known what is joined.
        task.most = BEFORE_LABELS;
        match search.run(&task, chain) {
            Outcome::Found => true,
            Outcome::NotJoined => false,
            Outcome::GaveUp => {
                task.most = most;
                labels.joined(graph, start.0, goal.0) && search.go_on(&task, chain) == Outcome::Found
            }
        }
    }

    /// The points of the chain between start and goal, winding links cell by cell.
    fn unroll(&mut self, (start, from): (Node, Cell), (goal, to): (Node, Cell), points: &mut Vec<Point>) {
        let at = |graph: &Graph, node| match node {
            _ if node == start => from,
            _ if node == goal => to,
            _ => graph.at(node),
        };
        for n in (0..self.chain.len().saturating_sub(1)).rev() {
            let ((node, winding), before) = (self.chain[n], self.chain[n + 1].0);
            let (a, b) = (at(&self.graph, before), at(&self.graph, node));
            if winding {
                self.wind([before, node], (a, b), points);
            } else if node != goal {
                points.push(self.space.middle(b));
            }
        }
    }

    /// The middles of the cells between two in one or two parts, both ends with them.
    fn wind(&mut self, parts: [Node; 2], cells: (Cell, Cell), points: &mut Vec<Point>) {
        self.local.way(&self.graph, parts, cells, &mut self.cells);
        points.extend(self.cells.iter().map(|&cell| self.space.middle(cell)));
    }

    pub(crate) fn path(&self, points: &[Point], scale: Scale, ends: &[Place; 2]) -> Path {
        let mut waypoints: Vec<[f64; 3]> = points.iter().map(|&p| self.space.q(p)).collect();
        // Ends are drawn in from borders by less than a billionth of a cell: what was asked for is what is given.
        if let Some(first) = waypoints.first_mut() {
            *first = ends[0].q;
        }
        if let Some(last) = waypoints.last_mut() {
            *last = ends[1].q;
        }
        waypoints.dedup();
        Path {
            waypoints,
            length_rad: scale.length(points),
            start_moved_rad: ends[0].moved,
            goal_moved_rad: ends[1].moved,
        }
    }
}

/// An end of a path, in a free cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub cell: Cell,
    pub point: Point,
    pub q: [f64; 3],
    pub moved: f64,
}

fn check_shape(grid: &Grid, table: &Table) -> Result<(), PlanError> {
    let (table, grid) = (table.shape(), grid.shape());
    if table == grid { Ok(()) } else { Err(PlanError::Shape { table, grid }) }
}
