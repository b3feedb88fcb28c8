//! Targets of virtual fixtures drawn in the page: requests of a program, hostile ones, and a person in Chromium.

use std::io::Read as _;
use std::net::SocketAddr;
use std::path::PathBuf;

use crate::browser::{AGREED_M, screenshots, settings as browser_settings, tools, visit};
use crate::common::{answer, cell, get, settings, status, token};
use elbowroom_cell::shared_control::ShieldTarget;
use elbowroom_cell::{Cell, CellFixture, ShieldSource};
use elbowroom_proximity::{project_point, ray_cast};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::certificate::write_certificate;
use elbowroom_view::http::{Endpoint, TlsIdentity};
use elbowroom_view::{Server, ServerSettings, ViewError};
use flate2::read::GzDecoder;
use serde_json::{Value, json};

/// A skull, a mill beside it, a ball, and a fixture that exists.
const CELL: &str = r#"# A skull is opened.
version = 1
name = "drawn"
units = { length = "mm", angle = "deg" }
[robot.arm]
model = "MODELS/rx60b/rx60b.urdf"
srdf = "MODELS/rx60b/rx60b.srdf"
base = { at = [-400, 0, 0] }
[robot.arm.tool]
tcp = { at = [0, 0, 140] }
mesh = "MODELS/tools/mill.stl"
[object.skull]
shape = "mesh"
mesh = "MODELS/work_pieces/skull.stl"
at = [430, 0, 240]
[object.ball]
shape = "sphere"
radius = 30
at = [430, 300, 240]
[object.floor]
shape = "plane"
[fixture.first]
protects = "ball"       # stays
target = { faces_within = { at = [430, 300, 270], radius = 8 } }
width = 5
tolerance = 4
"#;

struct Drawn {
    folder: tempfile::TempDir,
    server: Server,
}

impl Drawn {
    fn new(settings: ServerSettings) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let models = elbowroom_testkit::folder::examples().join("models");
        let file = folder.path().join("cell.toml");
        std::fs::write(&file, CELL.replace("MODELS", &models.display().to_string())).unwrap();
        let cell = Cell::load(&file).unwrap_or_else(|e| panic!("{e}"));
        Self { server: Server::draw(&cell, settings).unwrap(), folder }
    }

    fn file(&self) -> PathBuf {
        self.folder.path().join("cell.toml")
    }

    fn text(&self) -> String {
        std::fs::read_to_string(self.file()).unwrap()
    }

    fn load(&self) -> Cell {
        Cell::load(self.file()).unwrap_or_else(|e| panic!("{e}"))
    }

    /// Sends a document as the page does; status and answer.
    fn post(&self, path: &str, body: &str) -> (u16, Vec<u8>) {
        let (address, token) = (self.server.address(), token(&self.server));
        self.send(
            path,
            &format!("Origin: http://{address}\r\nAuthorization: Bearer {token}\r\nContent-Type: application/json\r\n"),
            body,
        )
    }

    fn send(&self, path: &str, headers: &str, body: &str) -> (u16, Vec<u8>) {
        let address = self.server.address();
        let head =
            format!("POST {path} HTTP/1.1\r\nHost: {address}\r\n{headers}Content-Length: {}\r\n\r\n", body.len());
        split(&exchange(address, (head + body).as_bytes()))
    }

    fn ask(&self, path: &str, body: &Value) -> (u16, Value) {
        let (status, body) = self.post(path, &body.to_string());
        (status, serde_json::from_slice(&body).unwrap_or_else(|_| String::from_utf8_lossy(&body).into_owned().into()))
    }

    /// The document of a preview.
    fn preview(&self, drawn: &Value) -> Value {
        let (status, body) = self.post("/draw/preview", &drawn.to_string());
        assert_eq!(status, 200, "{}", String::from_utf8_lossy(&body));
        let mut data = Vec::new();
        GzDecoder::new(&body[..]).read_to_end(&mut data).unwrap();
        let length = u32::from_le_bytes(data[..4].try_into().unwrap()) as usize;
        serde_json::from_slice(&data[4..4 + length]).unwrap()
    }

    /// The point of an object below a place, as a click from above finds it.
    fn below(&self, object: &str, x: f64, y: f64) -> [f64; 3] {
        let (status, hit) =
            self.ask("/draw/pick", &json!({ "object": object, "origin_m": [x, y, 3.0], "direction": [0, 0, -2] }));
        assert_eq!(status, 200, "{hit}");
        serde_json::from_value(hit["point_m"].clone()).unwrap()
    }
}

/// Bytes of an answer, until the server closes.
fn exchange(server: SocketAddr, request: &[u8]) -> Vec<u8> {
    use std::io::Write as _;
    let mut stream = std::net::TcpStream::connect(server).unwrap();
    stream.set_read_timeout(Some(std::time::Duration::from_secs(120))).unwrap();
    // A server that refuses a request closes before everything is written.
    let _ = stream.write_all(request);
    let mut bytes = Vec::new();
    let _ = stream.read_to_end(&mut bytes);
    bytes
}

/// Status and body of an answer; status 0 without one.
fn split(answer: &[u8]) -> (u16, Vec<u8>) {
    let end = answer.windows(4).position(|w| w == b"\r\n\r\n").unwrap_or(answer.len());
    (status(&String::from_utf8_lossy(&answer[..end])), answer.get(end + 4..).unwrap_or_default().to_vec())
}

fn fixture<'c>(cell: &'c Cell, name: &str) -> &'c CellFixture {
    cell.guidance.fixtures.iter().find(|f| f.name == name).unwrap()
}

/// A fixture with a line over the skull, as the page sends it.
fn drawn(points: &[[f64; 3]]) -> Value {
    json!({ "name": "cut_1", "protects": "skull", "target": { "line": points }, "tool": "arm/tool", "width_m": 0.009,
            "offset_m": null, "depth_m": 0.003, "flare_rad": 0.3, "tolerance_m": 0.003 })
}

#[test]
fn a_drawn_line_is_previewed_written_and_gives_the_same_shield() {
    let drawn_cell = Drawn::new(settings());
    let cell = drawn_cell.load();
    let (status, described) = {
        let token = token(&drawn_cell.server);
        let text = get(drawn_cell.server.address(), "/draw", &format!("Authorization: Bearer {token}\r\n"));
        split(text.as_bytes())
    };
    assert_eq!(status, 200);
    let described: Value = serde_json::from_slice(&described).unwrap();
    let names = |key: &str| described[key].as_array().unwrap().iter().map(|o| o["name"].clone()).collect::<Vec<_>>();
    assert_eq!(
        (names("objects"), names("fixtures")),
        (vec![json!("skull"), json!("ball")], vec![json!("first")]),
        "no plane"
    );
    assert_eq!((&described["tools"], &described["default"]["offset_m"]), (&json!(["arm/tool"]), &json!(0.002)));
    // Points are those of the engine, and on the exact surface.
    let points: Vec<[f64; 3]> = [-0.01, 0.0, 0.012].map(|y| drawn_cell.below("skull", 0.43 + y / 2.0, y)).to_vec();
    let skull = &cell.objects[0];
    for p in &points {
        let from = Vec3::new(p[0], p[1], 3.0);
        let hit = ray_cast(&skull.shape, &skull.in_world, from, -Vec3::Z).unwrap();
        assert!((hit.point - Vec3::from(*p)).length() < 1e-12);
        assert!(project_point(&skull.shape, &skull.in_world, Vec3::from(*p)).signed_distance.abs() < 1e-12);
    }
    let (status, miss) =
        drawn_cell.ask("/draw/pick", &json!({ "object": "skull", "origin_m": [9, 9, 3], "direction": [0, 0, -1] }));
    assert_eq!((status, &miss["point_m"]), (200, &Value::Null));
    // The line follows the surface, and passes the points.
    let line = |points: &[[f64; 3]], closed: bool| {
        drawn_cell
            .ask("/draw/line", &json!({ "object": "skull", "points_m": points, "closed": closed, "width_m": 0.009 }))
    };
    let (status, along) = line(&points, false);
    assert_eq!(status, 200, "{along}");
    let along: Vec<[f64; 3]> = serde_json::from_value(along["points_m"].clone()).unwrap();
    for p in &along {
        assert!(project_point(&skull.shape, &skull.in_world, Vec3::from(*p)).signed_distance.abs() < 1e-9);
    }
    for p in &points {
        assert!(along.iter().any(|q| Vec3::from(*p).distance(Vec3::from(*q)) < 1e-9), "{p:?} is not on the line");
    }
    let (_, border) = line(&points, true);
    assert!(border["points_m"].as_array().unwrap().len() > along.len());
    let (before, request) = (drawn_cell.text(), drawn(&points));
    let preview = drawn_cell.preview(&request);
    assert_eq!((drawn_cell.text(), &preview["replaces"]), (before.clone(), &json!(false)), "a preview writes nothing");
    let (status, written) = drawn_cell.ask("/draw/write", &request);
    assert_eq!((status, &written["report"]), (200, &preview["report"]), "{written}");
    assert_eq!(drawn_cell.text(), format!("{before}\n{}", written["table"].as_str().unwrap()));
    // What `elbowroom fixture` reports of the file is what was previewed, and the points are those that were drawn.
    let cell = drawn_cell.load();
    let cut = fixture(&cell, "cut_1");
    assert_eq!(json!(cut.report(&cell).unwrap()), preview["report"]);
    assert_eq!(preview["mesh"]["i"]["n"], json!(3 * cut.shield(&cell).unwrap().mesh.triangles().len()));
    let ShieldSource::Generated { target: ShieldTarget::Line(read), .. } = &cut.shield else { panic!() };
    for (p, q) in read.iter().zip(&points) {
        assert!(skull.in_world.transform_point(*p).distance(Vec3::from(*q)) < 1e-9);
        assert!(project_point(&skull.shape, &Pose::IDENTITY, *p).signed_distance.abs() < 1e-9);
    }
    // The next target of this name replaces it; the other fixture stays.
    let (status, again) = drawn_cell.ask("/draw/write", &drawn(&points[..2]));
    assert_eq!((status, &again["replaces"]), (200, &json!(true)), "{again}");
    assert!(drawn_cell.text().contains("protects = \"ball\"       # stays"));
    assert_eq!(drawn_cell.load().guidance.fixtures.len(), 2);
    // Somebody else changes the file: nothing is written any more.
    std::fs::write(drawn_cell.file(), &before).unwrap();
    let (status, refused) = drawn_cell.ask("/draw/write", &request);
    assert_eq!(status, 422);
    assert!(refused["error"].as_str().unwrap().contains("has changed since it was read"), "{refused}");
    assert_eq!(drawn_cell.text(), before);
}

#[test]
fn what_cannot_be_drawn_is_refused_with_a_reason() {
    let drawn_cell = Drawn::new(settings());
    let before = drawn_cell.text();
    let points = [drawn_cell.below("skull", 0.43, 0.0), drawn_cell.below("skull", 0.44, 0.01)];
    let with = |key: &str, value: Value| {
        let mut request = drawn(&points);
        request[key] = value;
        request
    };
    let (high, low) = ([points[0][0], points[0][1], 1.0], [0.43, 0.0, 0.24]);
    let many = vec![points[0]; 2000];
    let cases = [
        (with("protects", json!("skul")), "skul"),
        (with("protects", json!("floor")), "plane"),
        (with("name", json!("a]\n[robot.b")), "cannot be the name"),
        (with("tool", json!("arm/saw")), "saw"),
        (with("target", json!({ "line": [points[0]] })), "at least 2"),
        (with("target", json!({ "line": [points[0], high] })), "off the surface"),
        (with("target", json!({ "line": [points[0], low] })), "off the surface"),
        (with("target", json!({ "line": many })), "at most 1000"),
        (with("target", json!({ "area": points })), "at least 3"),
        (with("target", json!({ "circle": points })), "circle"),
        (with("width_m", json!(-1)), "width"),
        (with("width_m", json!(null)), "width"),
        (with("tolerance_m", json!(1e-9)), "tolerance"),
        (with("file", json!("/etc/passwd")), "file"),
        (json!([]), "not such a request"),
    ];
    for (request, expected) in cases {
        for path in ["/draw/preview", "/draw/write"] {
            let (status, refused) = drawn_cell.ask(path, &request);
            assert_eq!(status, 422, "{expected}: {refused}");
            assert!(refused["error"].as_str().unwrap().contains(expected), "{expected}: {refused}");
        }
    }
    let pick = |object: &str, direction: Value| {
        drawn_cell.ask("/draw/pick", &json!({ "object": object, "origin_m": [0, 0, 1], "direction": direction }))
    };
    assert_eq!(pick("skull", json!([0, 0, 0])), (200, json!({ "point_m": null, "outward": null, "triangle": null })));
    let (status, refused) = pick("robot", json!([0, 0, 1]));
    assert!(status == 422 && refused["help"] == "skull, ball, floor", "{refused}");
    let (status, refused) = drawn_cell.ask(
        "/draw/line",
        &json!({ "object": "skull", "points_m": [points[0], high], "closed": false, "width_m": 0.01 }),
    );
    assert!(status == 422 && refused["error"].as_str().unwrap().contains("off the surface"), "{refused}");
    assert_eq!(drawn_cell.text(), before);
}

#[test]
fn hostile_requests_write_nothing_and_the_server_continues() {
    let drawn_cell = Drawn::new(settings());
    let (before, address) = (drawn_cell.text(), drawn_cell.server.address());
    let points = [drawn_cell.below("skull", 0.43, 0.0), drawn_cell.below("skull", 0.44, 0.01)];
    let right = drawn(&points).to_string();
    let token = token(&drawn_cell.server);
    let bearer = format!("Authorization: Bearer {token}\r\n");
    let own = format!("Origin: http://{address}\r\n");
    let json_type = "Content-Type: application/json\r\n";
    let headers = [
        (format!("{own}{json_type}"), 401),
        (format!("{own}{json_type}Authorization: Bearer {}\r\n", &token[..63]), 401),
        (format!("{bearer}{json_type}"), 403),
        (format!("{bearer}{json_type}Origin: http://evil.example\r\n"), 403),
        (format!("{bearer}{json_type}Origin: null\r\n"), 403),
        (format!("{bearer}{own}"), 415),
        (format!("{bearer}{own}Content-Type: text/plain\r\n"), 415),
    ];
    for path in ["/draw/write", "/draw/preview"] {
        for (headers, expected) in &headers {
            assert_eq!(drawn_cell.send(path, headers, &right).0, *expected, "{path} {headers}");
        }
    }
    let far = answer(
        address,
        format!("POST /draw/write HTTP/1.1\r\nHost: evil.example\r\n{bearer}{own}{json_type}Content-Length: 0\r\n\r\n")
            .as_bytes(),
    );
    assert_eq!(status(&far), 421);
    // Bodies that are no request, among them numbers that JSON does not have, and far too many points.
    let point = "[0.43,0,0.3],";
    let bodies = [
        ("", 422),
        ("{", 422),
        ("null", 422),
        ("\u{0}", 422),
        (&right.replace("0.009", "NaN"), 422),
        (&right.replace("0.009", "1e999"), 422),
        (&right.replace("0.009", "\"wide\""), 422),
        (&format!("{}{}", "[".repeat(50_000), "]".repeat(50_000)), 422),
        (&right.replace("[[", &format!("[{}[", point.repeat(100_000))), 413),
    ];
    for (body, expected) in bodies {
        let (status, _) = drawn_cell.post("/draw/write", body);
        // A server that refuses a long body may close before all of it is sent.
        assert!(status == expected || (expected == 413 && status == 0), "{status} for {:.60}", body);
    }
    for path in ["/draw/", "/draw/pick/x", "/drawing", "/draw/../cell.toml"] {
        assert!(matches!(drawn_cell.post(path, &right).0, 404 | 405), "{path}");
    }
    assert_eq!(status(&get(address, "/draw", "")), 401);
    assert_eq!(drawn_cell.text(), before);
    assert_eq!(drawn_cell.ask("/draw/write", &drawn(&points)).0, 200);
    assert!(drawn_cell.load().guidance.fixtures.iter().any(|f| f.name == "cut_1"));
}

#[test]
fn nothing_is_drawn_in_a_view_that_was_not_asked_for_it_or_from_another_computer() {
    let server = Server::jog(&cell(), settings()).unwrap();
    let bearer = format!("Authorization: Bearer {}\r\n", token(&server));
    assert_eq!(status(&get(server.address(), "/draw", &bearer)), 404);
    let own = format!("Origin: http://{}\r\n{bearer}Content-Length: 0\r\n", server.address());
    let post = format!("POST /draw/write HTTP/1.1\r\nHost: {}\r\n{own}\r\n", server.address());
    assert_eq!(status(&answer(server.address(), post.as_bytes())), 405);
    let folder = tempfile::tempdir().unwrap();
    let (certificate, key) = write_certificate(folder.path(), "page", &["localhost"]);
    let identity = TlsIdentity::read(&certificate, &key).unwrap();
    let far = ServerSettings::new(Endpoint::new("0.0.0.0:0", Some(identity)).unwrap());
    let refused = Server::draw(&cell(), far).unwrap_err();
    assert!(
        matches!(refused, ViewError::DrawnFromElsewhere(_)) && refused.to_string().contains("127.0.0.1"),
        "{refused}"
    );
    let other = ServerSettings::at("127.0.0.1:0").unwrap();
    // A cell that is in no file cannot be drawn on.
    assert!(matches!(Server::draw(&cell(), other), Err(ViewError::Cell(_))));
}

/// What a person has drawn.
fn drawing(state: &Value) -> &Value {
    &state["drawing"]
}

#[test]
fn a_person_draws_a_line_of_five_points_on_a_skull_and_writes_it() {
    if tools().is_none() {
        return;
    }
    let drawn_cell = Drawn::new(browser_settings());
    let before = drawn_cell.text();
    let cell = drawn_cell.load();
    let skull = &cell.objects[0];
    let aims: Vec<[f64; 3]> = (0..5)
        .map(|k| drawn_cell.below("skull", 0.40 + 0.015 * f64::from(k), 0.03 - 0.004 * f64::from(k * k)))
        .collect();
    let has = |points: usize| {
        format!("s.drawing.points_m.length === {points} && (s.drawing.line_m.length > 1) === ({points} > 1)")
    };
    let mut steps = vec![
        json!({ "do": "click", "at": "#look-top" }),
        json!({ "do": "choose", "at": "#draw-object", "value": "ball" }),
        json!({ "do": "choose", "at": "#draw-object", "value": "skull" }),
        json!({ "do": "fill", "at": "#draw-width", "value": "9" }),
        json!({ "do": "fill", "at": "#draw-tolerance", "value": "3" }),
        json!({ "do": "click", "at": "#draw-place", "until": "s.drawing.placing" }),
    ];
    for (k, aim) in aims.iter().enumerate() {
        steps.push(json!({ "do": "click", "world": aim, "until": has(k + 1) }));
    }
    // One more, which is taken back by the keyboard; then one by the button.
    steps.push(json!({ "do": "click", "world": aims[0], "until": has(6) }));
    steps.push(json!({ "do": "press", "key": "Control+z", "until": has(5) }));
    steps.push(json!({ "do": "click", "at": "#draw-undo", "until": has(4) }));
    steps.push(json!({ "do": "click", "world": aims[4], "until": has(5) }));
    steps.push(json!({ "do": "click", "at": "#draw-preview", "until": "s.drawing.report" }));
    steps.extend(screenshots("draw"));
    let at = steps.len();
    steps.push(json!({ "do": "click", "at": "#draw-write", "until": "s.drawing.written" }));
    steps.push(json!({ "do": "text", "at": "#draw-message" }));
    steps.push(json!({ "do": "audit" }));
    let seen = visit(&drawn_cell.server.url(), &json!({}), &steps).unwrap();
    let written = drawing(&seen[at]);
    let points: Vec<[f64; 3]> = serde_json::from_value(written["points_m"].clone()).unwrap();
    for (p, aim) in points.iter().zip(&aims) {
        assert!(
            Vec3::from(*p).distance(Vec3::from(*aim)) < 5e-4,
            "within a pixel or two of what was aimed at: {p:?} {aim:?}"
        );
        assert!(project_point(&skull.shape, &skull.in_world, Vec3::from(*p)).signed_distance.abs() < 1e-9);
    }
    assert!(seen[at + 1].as_str().unwrap().contains("is added in cell.toml"), "{}", seen[at + 1]);
    assert_eq!((&seen[at + 2]["unnamed"], &seen[at + 2]["wide"]), (&json!([]), &json!([])));
    assert_eq!(drawn_cell.text(), format!("{before}\n{}", written["table"].as_str().unwrap()));
    let cell = drawn_cell.load();
    let cut = fixture(&cell, "cut_1");
    assert_eq!(json!(cut.report(&cell).unwrap()), written["report"]);
    let ShieldSource::Generated { target: ShieldTarget::Line(read), settings } = &cut.shield else { panic!() };
    assert_eq!((read.len(), settings.width_m, settings.tolerance_m), (5, 0.009, 0.003));
    for (p, q) in read.iter().zip(&points) {
        assert!(skull.in_world.transform_point(*p).distance(Vec3::from(*q)) < AGREED_M.min(1e-9));
    }
}

#[test]
fn holes_areas_and_radii_are_drawn_too_and_what_cannot_be_is_explained() {
    if tools().is_none() {
        return;
    }
    let drawn_cell = Drawn::new(browser_settings());
    let [top, east, west, north] = [(0.0, 0.0), (0.012, 0.0), (-0.012, 0.002), (0.0, 0.013)]
        .map(|(x, y)| drawn_cell.below("ball", 0.43 + x, 0.3 + y));
    let is_made = "!s.drawing.busy && s.drawing.report";
    let steps = vec![
        json!({ "do": "click", "at": "#look-top" }),
        json!({ "do": "choose", "at": "#draw-object", "value": "ball" }),
        // Letters of a name are no keys of the page: d, f, h and 1 would change the view.
        json!({ "do": "fill", "at": "#draw-name", "value": "" }),
        json!({ "do": "type", "at": "#draw-name", "value": "hole_fd1" }),
        json!({ "do": "choose", "at": "#draw-kind", "value": "drill" }),
        json!({ "do": "fill", "at": "#draw-depth", "value": "6" }),
        json!({ "do": "fill", "at": "#draw-tolerance", "value": "4" }),
        json!({ "do": "click", "at": "#draw-place", "until": "s.drawing.placing" }),
        json!({ "do": "click", "world": east, "until": "s.drawing.points_m.length === 1" }),
        // A second click moves the only point.
        json!({ "do": "click", "world": top, "until": "s.drawing.points_m.length === 1 && s.drawing.outward[0][2] > 0.99" }),
        json!({ "do": "click", "at": "#draw-write", "until": "s.drawing.written" }),
        json!({ "do": "fill", "at": "#draw-name", "value": "cap" }),
        json!({ "do": "choose", "at": "#draw-kind", "value": "faces_within" }),
        json!({ "do": "fill", "at": "#draw-radius", "value": "9" }),
        json!({ "do": "click", "at": "#draw-write", "until": "s.drawing.written" }),
        json!({ "do": "fill", "at": "#draw-name", "value": "flap" }),
        json!({ "do": "fill", "at": "#draw-depth", "value": "" }),
        json!({ "do": "choose", "at": "#draw-kind", "value": "area" }),
        json!({ "do": "click", "at": "#draw-clear", "until": "s.drawing.points_m.length === 0" }),
        json!({ "do": "click", "world": east, "until": "s.drawing.points_m.length === 1" }),
        json!({ "do": "click", "world": north, "until": "s.drawing.points_m.length === 2" }),
        json!({ "do": "click", "world": west, "until": "s.drawing.points_m.length === 3 && s.drawing.line_m.length > 3" }),
        json!({ "do": "click", "at": "#draw-preview", "until": is_made }),
        // A width that cannot be, and a target that exists.
        json!({ "do": "fill", "at": "#draw-width", "value": "-3" }),
        json!({ "do": "click", "at": "#draw-preview", "until": "!s.drawing.busy && s.drawing.message.includes('width')" }),
        json!({ "do": "fill", "at": "#draw-name", "value": "first" }),
        json!({ "do": "text", "at": "#draw-message" }),
        json!({ "do": "click", "at": "#draw-write", "until": "s.drawing.written" }),
        json!({ "do": "state" }),
    ];
    let seen = visit(&drawn_cell.server.url(), &json!({ "expected": ["422 (Unprocessable"] }), &steps).unwrap();
    let cell = drawn_cell.load();
    let kinds: Vec<(&str, &ShieldTarget)> = cell
        .guidance
        .fixtures
        .iter()
        .filter_map(|f| match &f.shield {
            ShieldSource::Generated { target, .. } => Some((f.name.as_str(), target)),
            ShieldSource::Mesh(_) => None,
        })
        .collect();
    let ball = &cell.objects[1];
    let [
        ("first", ShieldTarget::Area(border)),
        ("hole_fd1", ShieldTarget::Drill { at, axis }),
        ("cap", ShieldTarget::FacesWithin { radius_m, .. }),
    ] = kinds[..]
    else {
        panic!("{kinds:?}");
    };
    assert_eq!(border.len(), 3);
    assert!(border.iter().all(|p| project_point(&ball.shape, &Pose::IDENTITY, *p).signed_distance.abs() < 1e-9));
    // The hole leads to the centre of the ball, along the normal, to its depth.
    assert!((at.try_normalize().unwrap() + axis.try_normalize().unwrap()).length() < 1e-6, "{at:?} {axis:?}");
    assert_eq!(fixture(&cell, "hole_fd1").settings().unwrap().depth_m, 0.006);
    assert_eq!(*radius_m, 0.009);
    // The dimensions of the fixture that exists were taken over from it.
    assert_eq!(fixture(&cell, "first").settings().unwrap().width_m, 0.005);
    assert!(seen[26].as_str().unwrap().contains("its target is replaced"), "{}", seen[26]);
    assert!(drawn_cell.text().contains("protects = \"ball\"       # stays"));
}
