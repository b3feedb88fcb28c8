//! A cell whose fixtures are drawn: points on surfaces, previews, and the cell file.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};

use elbowroom_cell::shared_control::{ShieldSettings, ShieldTarget};
use elbowroom_cell::{
    Cell, CellFixture, DrawnFixture, FixtureDraft, FixtureEditor, FixtureTool, MOST_DRAWN_POINTS, ShieldReport,
    ShieldSource,
};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_proximity::{RayHit, Shape, ray_cast};
use elbowroom_report::{PageData, mesh_data};
use elbowroom_robot::ObjectId;
use elbowroom_spatial::Vec3;
use serde_json::{Value, json};

use super::request::{LineRequest, PickRequest};

/// Why a request of a page that draws is refused.
#[derive(Debug, thiserror::Error)]
pub(crate) enum DrawingRefusal {
    /// The cell, its file or the drawn target is wrong.
    #[error(transparent)]
    Wrong(#[from] Diagnostic),
    /// Another request makes a shield.
    #[error("a shield is being made")]
    Busy,
}

/// A cell whose fixtures are drawn. Pages share nothing but the file: each sends all that it has drawn.
#[derive(Debug)]
pub(crate) struct TargetDrawing {
    file: PathBuf,
    /// The cell as the file describes it, drawn fixtures included.
    cell: Mutex<Arc<Cell>>,
    editor: Mutex<EditedFile>,
}

#[derive(Debug)]
struct EditedFile {
    editor: FixtureEditor,
    /// The last preview, whose shield is not made again when it is written.
    last: Option<FixtureDraft>,
}

type Result<T> = std::result::Result<T, DrawingRefusal>;

impl TargetDrawing {
    /// Reads the file of the cell.
    pub(crate) fn new(cell: &Arc<Cell>) -> std::result::Result<Self, Diagnostic> {
        let editor = FixtureEditor::read(&cell.file)?;
        let editor = Mutex::new(EditedFile { editor, last: None });
        Ok(Self { file: cell.file.clone(), cell: Mutex::new(cell.clone()), editor })
    }

    /// What can be drawn: objects, tools, the fixtures of the file, and the defaults of their dimensions.
    pub(crate) fn description(&self) -> Value {
        let cell = self.cell();
        let default = ShieldSettings::with_width(0.0);
        let objects = cell.objects.iter().filter(|o| !matches!(o.shape, Shape::HalfSpace(_)));
        let guides: Vec<&str> = cell.guidance.guides.iter().map(|g| g.name.as_str()).collect();
        json!({
            "file": self.file.file_name().map(|name| name.to_string_lossy()),
            "objects": objects.map(|o| json!({ "name": o.name, "kind": o.shape.kind().name() })).collect::<Vec<_>>(),
            "tools": tools(&cell),
            "fixtures": cell.guidance.fixtures.iter().map(|f| described(f, &cell)).collect::<Vec<_>>(),
            "guides": guides,
            "default": dimensions(&default),
            "most_points": MOST_DRAWN_POINTS,
        })
    }

    /// The first point of an object on a ray; `None` if the ray misses it.
    pub(crate) fn pick(&self, request: &PickRequest) -> Result<Option<RayHit>> {
        let cell = self.cell();
        let object = &cell.objects[self.object(&cell, &request.object)?.0];
        let (origin, direction) = request.ray();
        Ok(ray_cast(&object.shape, &object.in_world, origin, direction))
    }

    /// The line along the surface through drawn points.
    pub(crate) fn line(&self, request: &LineRequest) -> Result<Vec<[f64; 3]>> {
        let cell = self.cell();
        let object = self.object(&cell, &request.object)?;
        let points = request.points();
        if points.len() > MOST_DRAWN_POINTS {
            let what = format!("the target has {} points, at most {MOST_DRAWN_POINTS} are drawn", points.len());
            return Err(self.wrong(what, "fewer points").into());
        }
        let settings = ShieldSettings::with_width(request.width_m);
        let tolerance_m = request.tolerance_m.unwrap_or(settings.tolerance_m);
        let settings = ShieldSettings { tolerance_m, ..settings };
        let line = cell.line_on_object(object, &points, request.closed, &settings)?;
        Ok(line.into_iter().map(Vec3::to_array).collect())
    }

    /// Makes the shield of a drawn fixture: its report, its table in the file, and its mesh in the world.
    pub(crate) fn preview(&self, drawn: &DrawnFixture) -> Result<PageData> {
        let mut edited = self.edit()?;
        let (draft, report) = edited.drafted(drawn)?;
        let (fixture, cell) = (draft.fixture(), draft.cell());
        let object = &cell.objects[fixture.protects.0];
        let shield = fixture.shield(cell)?;
        let mut data = mesh_data(&shield.mesh, &object.in_world);
        data.json["report"] = json!(report);
        data.json["table"] = draft.table().into();
        data.json["replaces"] = draft.replaces().into();
        edited.last = Some(draft);
        Ok(data)
    }

    /// Writes a drawn fixture into the cell file.
    pub(crate) fn write(&self, drawn: &DrawnFixture) -> Result<Value> {
        let mut edited = self.edit()?;
        edited.editor.refusal()?;
        let (draft, report) = edited.drafted(drawn)?;
        edited.editor.write(&draft)?;
        *self.cell.lock().unwrap_or_else(PoisonError::into_inner) = Arc::new(draft.cell().clone());
        Ok(json!({ "report": report, "table": draft.table(), "replaces": draft.replaces(), "file": self.file }))
    }

    fn cell(&self) -> Arc<Cell> {
        self.cell.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The file, for one request at a time: a shield takes a core for seconds.
    fn edit(&self) -> Result<MutexGuard<'_, EditedFile>> {
        match self.editor.try_lock() {
            Ok(edited) => Ok(edited),
            Err(TryLockError::Poisoned(edited)) => Ok(edited.into_inner()),
            Err(TryLockError::WouldBlock) => Err(DrawingRefusal::Busy),
        }
    }

    fn object(&self, cell: &Cell, name: &str) -> Result<ObjectId> {
        let found = cell.objects.iter().position(|o| o.name == name).map(ObjectId);
        let known = || cell.objects.iter().map(|o| o.name.as_str()).collect::<Vec<_>>().join(", ");
        found.ok_or_else(|| self.wrong(format!("object {name:?} is not in this cell"), &known()).into())
    }

    fn wrong(&self, what: String, hint: &str) -> Diagnostic {
        Diagnostic::new(&self.file, None, what).hint(hint)
    }
}

impl EditedFile {
    /// The draft of a fixture with its report; the last one, if it still fits.
    fn drafted(&mut self, drawn: &DrawnFixture) -> std::result::Result<(FixtureDraft, ShieldReport), Diagnostic> {
        let last = self.last.take().filter(|last| last.drawn() == drawn && last.fits(&self.editor));
        let draft = last.map_or_else(|| self.editor.draft(drawn), Ok)?;
        let report = draft.report()?;
        Ok((draft, report))
    }
}

/// Tools with a solid, as `tool` of a fixture names them.
fn tools(cell: &Cell) -> Vec<String> {
    let of_robot = |(index, robot): (usize, &elbowroom_cell::CellRobot)| {
        let tool = |named: Option<usize>| FixtureTool { robot: elbowroom_robot::RobotId(index), named };
        let name = |named: Option<usize>| named.map_or("tool", |i| robot.payload.tools[i].name.as_str());
        let all: Vec<Option<usize>> = if robot.payload.tools.is_empty() {
            vec![None]
        } else {
            (0..robot.payload.tools.len()).map(Some).collect()
        };
        let usable = all.into_iter().filter(|named| tool(*named).solid(cell).is_some());
        usable.map(|named| format!("{}/{}", robot.name, name(named))).collect::<Vec<_>>()
    };
    cell.robots.iter().enumerate().flat_map(of_robot).collect()
}

/// A fixture of the file, for the form of the page.
fn described(fixture: &CellFixture, cell: &Cell) -> Value {
    let kind = match &fixture.shield {
        ShieldSource::Mesh(_) => "mesh",
        ShieldSource::Generated { target, .. } => match target {
            ShieldTarget::Line(_) => "line",
            ShieldTarget::Area(_) => "area",
            ShieldTarget::Drill { .. } => "drill",
            ShieldTarget::FacesWithin { .. } => "faces_within",
        },
    };
    json!({
        "name": fixture.name,
        "protects": cell.objects[fixture.protects.0].name,
        "kind": kind,
        "settings": fixture.settings().map(dimensions),
    })
}

fn dimensions(s: &ShieldSettings) -> Value {
    json!({
        "width_m": s.width_m,
        "offset_m": s.offset_m,
        "depth_m": s.depth_m,
        "flare_rad": s.flare_rad,
        "tolerance_m": s.tolerance_m,
    })
}
