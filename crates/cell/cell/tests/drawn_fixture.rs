//! Drawn fixtures in a cell file: what is written, and that the rest of the file stays as it is.

use std::path::{Path, PathBuf};

use crate::sealed_cell::sealed;
use elbowroom_cell::shared_control::ShieldTarget;
use elbowroom_cell::{Cell, DrawnFixture, DrawnTarget, FixtureEditor, MOST_DRAWN_POINTS, ShieldSource};
use elbowroom_spatial::Vec3;

const CELL: &str = r#"# A block that is cut.
version = 1
units = { length = "mm", angle = "deg" }   # not inches

[fixture.old]          # the first cut
protects = "block"
target = { line = [[0, 0, 100], [20, 0, 100]] }   # was measured
depth   = 3
width = 9 # mm
tolerance = 3

[fixture.rail]
guide = "line"
tool = "arm"
points = [[0, 0, 200], [100, 0, 200]]

# The arm comes after its fixtures.
[robot.arm]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
base = { at = [0, 0, 600] }
[robot.arm.tool]
tcp = { at = [0, 0, 60] }
box = { at = [0, 0, 30], size = [4, 4, 60] }

[object.block]
shape = "box"
size = [80, 80, 40]
at = [0, 0, 80]
[object.ball]
shape = "sphere"
radius = 30
at = [400, 0, 70]
[object.floor]
shape = "plane"
at = [0, 0, -10]
# The end.
"#;

struct Folder(tempfile::TempDir);

impl Folder {
    fn with(text: &str) -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        std::fs::write(folder.file(), text).unwrap();
        folder
    }

    fn file(&self) -> PathBuf {
        self.0.path().join("cell.toml")
    }

    fn text(&self) -> String {
        std::fs::read_to_string(self.file()).unwrap()
    }

    fn editor(&self) -> FixtureEditor {
        FixtureEditor::read(&self.file()).unwrap()
    }
}

/// A line of three points on the block that no short decimal describes.
fn line() -> DrawnTarget {
    DrawnTarget::Line(vec![[1.0 / 30.0, -0.02, 0.1], [0.012_345_678_901_2, 0.0, 0.1], [-0.03, 2.0 / 70.0, 0.1]])
}

fn cut(name: &str) -> DrawnFixture {
    DrawnFixture { tool: Some("arm".into()), ..DrawnFixture::new(name, "block", line(), 0.012) }
}

fn write(folder: &Folder, drawn: &DrawnFixture) -> Result<String, String> {
    let mut editor = folder.editor();
    let draft = editor.draft(drawn).map_err(|e| e.to_string())?;
    editor.write(&draft).map_err(|e| e.to_string())?;
    Ok(draft.table().to_owned())
}

/// The target of a fixture of the file, in the world.
fn target(file: &Path, name: &str) -> (ShieldTarget, Cell) {
    let cell = Cell::load(file).unwrap_or_else(|e| panic!("{e}"));
    let fixture = cell.guidance.fixtures.iter().find(|f| f.name == name).unwrap();
    let ShieldSource::Generated { target, .. } = &fixture.shield else { panic!("no target") };
    (target.clone(), cell)
}

#[test]
fn a_new_fixture_is_appended_and_the_rest_stays_as_it_is() {
    let folder = Folder::with(CELL);
    let table = write(&folder, &DrawnFixture { flare_rad: Some(15_f64.to_radians()), ..cut("drawn") }).unwrap();
    assert_eq!(folder.text(), format!("{CELL}\n{table}"));
    assert!(
        table.contains("flare = 15\n") && table.contains("width = 12\n") && table.contains("tool = \"arm\"\n"),
        "{table}"
    );
    assert!(!table.contains("offset") && !table.contains("depth"), "what was not given is the default: {table}");
    let (ShieldTarget::Line(points), cell) = target(&folder.file(), "drawn") else { panic!() };
    let DrawnTarget::Line(drawn) = line() else { panic!() };
    let in_world = cell.objects[0].in_world;
    for (p, q) in points.iter().zip(drawn) {
        assert!((in_world.transform_point(*p) - Vec3::from(q)).length() < 2e-10, "{p:?} {q:?}");
    }
    // A second one goes after it, whatever the line ends of the file.
    let windows = Folder::with(&CELL.replace('\n', "\r\n"));
    let table = write(&windows, &cut("drawn")).unwrap();
    assert_eq!(windows.text(), format!("{CELL}\n{table}").replace('\n', "\r\n"));
}

#[test]
fn a_drawn_target_replaces_one_and_keeps_comments_order_and_other_keys() {
    for ends in ["\n", "\r\n"] {
        let folder = Folder::with(&CELL.replace('\n', ends));
        write(&folder, &DrawnFixture { width_m: None, tool: None, ..cut("old") }).unwrap();
        let text = folder.text();
        assert_eq!(text.matches('\n').count(), text.matches(ends).count(), "one kind of line ends");
        let text = text.replace("\r\n", "\n");
        let (before, after) = (CELL.lines().collect::<Vec<_>>(), text.lines().collect::<Vec<_>>());
        // Without the lines of the target, all is as before.
        let first = after.iter().position(|l| l.starts_with("target")).unwrap();
        let last = first + after[first..].iter().position(|l| l.starts_with("] }")).unwrap();
        let rest = [&after[..first], &after[last + 1..]].concat();
        let without = before.iter().filter(|l| !l.starts_with("target")).copied().collect::<Vec<_>>();
        assert_eq!(rest, without);
        assert_eq!(after[last], "] }   # was measured");
        let (ShieldTarget::Line(points), cell) = target(&folder.file(), "old") else { panic!() };
        assert_eq!(points.len(), 3);
        let settings = *cell.guidance.fixtures[0].settings().unwrap();
        assert_eq!((settings.width_m, settings.depth_m), (0.009, 0.003));
    }
    // A drill has its own depth, and another object may be protected; then the keys of the other kind go.
    let folder = Folder::with(CELL);
    let drill = DrawnTarget::Drill { at_m: [0.4, 0.0, 0.1], axis: [0.0, 0.0, -1.0], depth_m: 0.01 };
    write(&folder, &DrawnFixture { offset_m: Some(0.001), ..DrawnFixture::new("old", "ball", drill, 0.01) }).unwrap();
    let text = folder.text();
    assert!(
        !text.contains("depth   = 3") && text.contains("width = 10 # mm") && text.contains("offset = 1\n"),
        "{text}"
    );
    let (_, cell) = target(&folder.file(), "old");
    assert_eq!(cell.objects[cell.guidance.fixtures[0].protects.0].name, "ball");
}

#[test]
fn targets_written_with_dotted_keys_or_as_tables_are_replaced() {
    let dotted = CELL.replace(
        "target = { line = [[0, 0, 100], [20, 0, 100]] }   # was measured",
        "target.line = [[0, 0, 100], [20, 0, 100]]",
    );
    let table = dotted
        .replace("target.line = [[0, 0, 100], [20, 0, 100]]\n", "")
        .replace("tolerance = 3\n", "tolerance = 3\n[fixture.old.target]\nline = [[0, 0, 100], [20, 0, 100]]\n");
    for text in [dotted, table] {
        let folder = Folder::with(&text);
        write(&folder, &cut("old")).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let (ShieldTarget::Line(points), _) = target(&folder.file(), "old") else { panic!() };
        assert_eq!(points.len(), 3, "{}", folder.text());
        for comment in ["# the first cut", "# not inches", "# The arm comes after its fixtures.", "# The end."] {
            assert!(folder.text().contains(comment), "{comment} is lost");
        }
    }
}

#[test]
fn what_is_wrong_is_said_and_nothing_is_written() {
    let on_block = |points: &[[f64; 3]]| DrawnTarget::Line(points.to_vec());
    let drawn = |target| DrawnFixture::new("new", "block", target, 0.012);
    let cases = [
        (cut(""), "cannot be the name"),
        (cut("a.b"), "cannot be the name"),
        (cut("ü\"]\n[robot.x"), "cannot be the name"),
        (cut(&"n".repeat(65)), "cannot be the name"),
        (cut("rail"), "without a target"),
        (DrawnFixture { protects: "blok".into(), ..cut("new") }, "\"blok\""),
        (DrawnFixture { protects: "floor".into(), ..cut("new") }, "is a plane"),
        (DrawnFixture { tool: Some("leg".into()), ..cut("new") }, "\"leg\""),
        (DrawnFixture { width_m: None, ..cut("new") }, "width"),
        (DrawnFixture { width_m: Some(-0.01), ..cut("new") }, "width"),
        (DrawnFixture { width_m: Some(f64::NAN), ..cut("new") }, "not finite"),
        (DrawnFixture { flare_rad: Some(1.5), ..cut("new") }, "80°"),
        (DrawnFixture { tolerance_m: Some(1e-7), ..cut("new") }, "tolerance"),
        (drawn(on_block(&[[0.0, 0.0, f64::INFINITY], [0.0; 3]])), "not finite"),
        (drawn(on_block(&[[0.0, 0.0, 0.1]])), "at least 2 points"),
        (drawn(on_block(&vec![[0.0, 0.0, 0.1]; MOST_DRAWN_POINTS + 1])), "at most 1000"),
        (drawn(on_block(&[[0.0, 0.0, 0.15], [0.01, 0.0, 0.1]])), "off the surface"),
        (drawn(on_block(&[[0.0, 0.0, 0.1], [0.0, 0.0, 0.06]])), "leaves the surface"),
        (drawn(DrawnTarget::Drill { at_m: [0.0, 0.0, 0.1], axis: [0.0; 3], depth_m: 0.01 }), "no length"),
        (drawn(DrawnTarget::Drill { at_m: [0.0, 0.0, 0.1], axis: [0.0, 0.0, 1.0], depth_m: 0.01 }), "axis"),
        (
            drawn(DrawnTarget::Area(vec![[0.0, 0.0, 0.1], [0.02, 0.02, 0.1], [0.02, 0.0, 0.1], [0.0, 0.03, 0.1]])),
            "crosses itself: after its points 1 and 3",
        ),
        (drawn(DrawnTarget::FacesWithin { at_m: [0.0, 0.0, 0.1], radius_m: 0.0 }), "radius"),
    ];
    let folder = Folder::with(CELL);
    for (drawn, expected) in cases {
        let error = write(&folder, &drawn).unwrap_err();
        assert!(error.contains(expected), "{drawn:?}: {error}");
        assert_eq!(folder.text(), CELL);
    }
    let inline = CELL.replace("[fixture.old]", "[other.old]").replace("[fixture.rail]", "[other.rail]");
    let inline = inline.replacen("version = 1", "version = 1\nfixture = {}", 1);
    assert!(write(&Folder::with(&inline), &cut("new")).unwrap_err().contains("[fixture.NAME]"));
}

#[test]
fn a_file_that_has_changed_is_not_overwritten_also_not_by_the_second_of_two_editors() {
    let folder = Folder::with(CELL);
    let (mut first, mut second) = (folder.editor(), folder.editor());
    let (by_first, by_second) = (first.draft(&cut("one")).unwrap(), second.draft(&cut("two")).unwrap());
    first.write(&by_first).unwrap();
    let error = second.write(&by_second).unwrap_err();
    assert!(error.message.contains("has changed since it was read") && error.hint.is_some(), "{error}");
    assert_eq!(folder.text(), format!("{CELL}\n{}", by_first.table()));
    // The first continues; an old draft of it does not fit any more.
    assert!(!by_first.fits(&first));
    assert!(first.write(&by_first).unwrap_err().message.contains("has changed"));
    let next = first.draft(&cut("two")).unwrap();
    assert!(next.fits(&first));
    first.write(&next).unwrap();
    // An editor of text changes it.
    std::fs::write(folder.file(), CELL).unwrap();
    let last = first.draft(&cut("three")).unwrap();
    assert!(first.write(&last).is_err());
    assert_eq!(folder.text(), CELL);
    std::fs::remove_file(folder.file()).unwrap();
    assert!(first.write(&last).is_err() && !folder.file().exists(), "a removed file does not come back");
    // Of many editors at once, one writes.
    let folder = Folder::with(CELL);
    let written: usize = std::thread::scope(|scope| {
        let editors: Vec<_> = (0..4).map(|k| (folder.editor(), k)).collect();
        let threads: Vec<_> = editors
            .into_iter()
            .map(|(mut editor, k)| {
                scope.spawn(move || {
                    let draft = editor.draft(&cut(&format!("cut_{k}"))).unwrap();
                    usize::from(editor.write(&draft).is_ok())
                })
            })
            .collect();
        threads.into_iter().map(|t| t.join().unwrap()).sum()
    });
    assert_eq!((written, folder.text().matches("[fixture.cut_").count()), (1, 1));
}

#[test]
fn a_sealed_cell_is_refused_with_what_to_do() {
    let folder = Folder::with(CELL);
    sealed(folder.0.path(), CELL);
    let mut editor = folder.editor();
    let draft = editor.draft(&cut("new")).unwrap();
    let error = editor.write(&draft).unwrap_err();
    assert!(error.message.contains("is sealed"), "{error}");
    assert!(error.hint.unwrap().contains("region seal"));
    assert_eq!(folder.text(), CELL);
    assert!(Cell::load(folder.file()).is_ok());
}

/// What is refused where it is drawn is refused where it is typed, too, with its line.
#[test]
fn an_area_that_is_typed_must_not_cross_itself_either() {
    let typed = |points: &str| {
        let table = format!("[fixture.patch]\nprotects = \"block\"\ntarget = {{ area = {points} }}\nwidth = 4\n");
        Cell::parse("cell.toml", &format!("{CELL}{table}"))
    };
    typed("[[0, 0, 100], [20, 0, 100], [20, 20, 100], [0, 30, 100]]").unwrap_or_else(|e| panic!("{e}"));
    let crossed = typed("[[0, 0, 100], [20, 20, 100], [20, 0, 100], [0, 30, 100]]").unwrap_err();
    assert_eq!(crossed.line, Some(CELL.lines().count() + 3), "{crossed}");
    assert!(crossed.to_string().contains("crosses itself: after its points 1 and 3"), "{crossed}");
}
