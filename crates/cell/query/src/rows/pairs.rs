//! The pairs that a query tests.

use elbowroom_cell::{Cell, QueryModel};
use elbowroom_formats::suggest;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_scene::Selection;

/// The pairs that a query tests: all pairs of the scene, or the pairs between named sides.
///
/// ```
/// use elbowroom_query::QueryPairs;
/// use elbowroom_cell::{Cell, QueryModel};
/// let cell = Cell::parse("c.toml", r#"
/// version = 1
/// units = { length = "m", angle = "rad" }
/// [robot.arm]
/// dh = [{ a = 1, min = -3, max = 3, speed = 1 }]
/// links = [{ sphere = { at = [0, 0, 0], radius = 0.1 } }]
/// [region.corner]
/// shape = "sphere"
/// centre = [2, 0, 0]
/// radius = 0.5
/// warning = 0.1
/// "#)?;
/// let mut model = QueryModel::of_cell(&cell);
/// assert_eq!(QueryPairs::between("arm,corner", &mut model, Some(&cell))?.sides().len(), 1);
/// assert_eq!(model.objects[0].name, "corner"); // the region is a solid of the query
/// let error = QueryPairs::between("arm,corn", &mut model, Some(&cell)).unwrap_err();
/// assert!(error.to_string().contains("corner"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QueryPairs {
    sides: Vec<[Selection; 2]>,
}

/// A text that names no pairs.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum QueryPairsError {
    /// Not two names.
    #[error(
        "`{0}` is no pair: write two names with a comma, and pairs with semicolons, as arm,table;arm/link_3,conveyor"
    )]
    NotTwo(String),
    /// A name that the model does not have.
    #[error("\"{name}\" is no robot, link, object or region\n  write: {hint}")]
    Unknown {
        /// The name.
        name: String,
        /// What to write instead.
        hint: String,
    },
    /// A robot with itself, although such pairs are left out.
    #[error("`{0}` is a pair within one robot, and --no-self leaves these out\n  write: one of the two")]
    WithinRobot(String),
}

impl QueryPairs {
    /// All pairs of the scene.
    pub fn all() -> Self {
        Self { sides: vec![[Selection::All; 2]] }
    }

    /// All pairs except pairs within one robot, which includes what it holds.
    pub fn without_self(model: &QueryModel) -> Self {
        let robots = model.robots.len();
        let of_robots =
            (0..robots).flat_map(|a| (a + 1..robots).map(move |b| [a, b].map(|r| Selection::Robot(RobotId(r)))));
        if model.carried.is_empty() {
            return Self { sides: of_robots.chain([[Selection::Robots, Selection::Objects]]).collect() };
        }
        let is_free = |o: &ObjectId| model.carried.iter().all(|(carried, _)| carried != o);
        let free = (0..model.objects.len()).map(ObjectId).filter(is_free);
        Self { sides: of_robots.chain(free.map(|o| [Selection::Robots, Selection::Object(o)])).collect() }
    }

    /// Parses pairs: `A,B;C,D`.
    ///
    /// Each side is a robot (with tool and load), a link (`robot/link`; for a single robot its name alone), an object
    /// or a region of the cell. Regions become objects of the model, at their poses at the start; a region that follows
    /// a robot moves with it.
    ///
    /// # Errors
    /// Unknown names, with what to write instead.
    pub fn between(text: &str, model: &mut QueryModel, cell: Option<&Cell>) -> Result<Self, QueryPairsError> {
        let mut sides = Vec::new();
        for pair in text.split(';').filter(|pair| !pair.trim().is_empty()) {
            let names: Vec<&str> = pair.split(',').map(str::trim).collect();
            let &[a, b] = &names[..] else { return Err(QueryPairsError::NotTwo(pair.trim().to_owned())) };
            sides.push([side(a, model, cell)?, side(b, model, cell)?]);
        }
        if sides.is_empty() {
            return Err(QueryPairsError::NotTwo(text.to_owned()));
        }
        Ok(Self { sides })
    }

    /// Returns these pairs if no pair is within one robot.
    ///
    /// # Errors
    /// A pair with both sides in one robot.
    pub fn expect_without_self(self, model: &QueryModel) -> Result<Self, QueryPairsError> {
        let robot = |side: Selection| match side {
            Selection::Robot(robot) | Selection::Link { robot, .. } => Some(robot),
            _ => None,
        };
        match self.sides.iter().find(|[a, b]| robot(*a).is_some() && robot(*a) == robot(*b)) {
            Some(pair) => Err(QueryPairsError::WithinRobot(pair.map(|side| name_of(side, model)).join(","))),
            None => Ok(self),
        }
    }

    /// Both sides of each pair.
    pub fn sides(&self) -> &[[Selection; 2]] {
        &self.sides
    }
}

impl Default for QueryPairs {
    fn default() -> Self {
        Self::all()
    }
}

fn side(name: &str, model: &mut QueryModel, cell: Option<&Cell>) -> Result<Selection, QueryPairsError> {
    if let Some(known) = model.selection(name) {
        return Ok(known);
    }
    if cell.is_some_and(|cell| model.add_region(cell, name)) {
        return Ok(Selection::Object(ObjectId(model.objects.len() - 1)));
    }
    let regions = cell.into_iter().flat_map(|cell| cell.regions.iter().map(|r| r.region.name.clone()));
    // A region that was named before is already an object of the model.
    let regions = regions.filter(|name| model.selection(name).is_none());
    let known: Vec<String> = regions.chain(model.names()).collect();
    let hint = suggest::hint(name, known.iter().map(String::as_str));
    Err(QueryPairsError::Unknown { name: name.to_owned(), hint })
}

fn name_of(side: Selection, model: &QueryModel) -> String {
    match side {
        Selection::Robot(_) if model.is_single_robot => "robot".into(),
        Selection::Robot(robot) => model.robots[robot.0].name.clone(),
        Selection::Link { robot, link } => model.geometry_name(GeometryId::Link { robot, link }),
        Selection::Object(object) => model.geometry_name(GeometryId::Object(object)),
        Selection::All | Selection::Robots | Selection::Objects => format!("{side:?}"),
    }
}
