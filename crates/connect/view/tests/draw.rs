//! Targets of virtual fixtures that are drawn: requests of the page, and hostile ones.

use crate::common::drawn::{Drawn, fixture, split};
use crate::common::{answer, cell, get, settings, status, token};
use elbowroom_cell::ShieldSource;
use elbowroom_cell::shared_control::ShieldTarget;
use elbowroom_proximity::{project_point, ray_cast};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::certificate::write_certificate;
use elbowroom_view::http::{Endpoint, TlsIdentity};
use elbowroom_view::{Server, ServerSettings, ViewError};
use serde_json::{Value, json};

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
        assert!(status == expected || (expected == 413 && status == 0), "{status} for {body:.60}");
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
