//! A person draws targets of virtual fixtures in Chromium, and writes them into the cell file.

use crate::browser::{screenshots, settings, tools, visit};
use crate::common::drawn::{Drawn, fixture};
use elbowroom_cell::ShieldSource;
use elbowroom_cell::shared_control::ShieldTarget;
use elbowroom_proximity::project_point;
use elbowroom_spatial::{Pose, Vec3};
use serde_json::{Value, json};

/// What a person has drawn.
fn drawing(state: &Value) -> &Value {
    &state["drawing"]
}

#[test]
fn a_person_draws_a_line_of_five_points_on_a_skull_and_writes_it() {
    if tools().is_none() {
        return;
    }
    let drawn_cell = Drawn::new(settings());
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
        assert!(skull.in_world.transform_point(*p).distance(Vec3::from(*q)) < 1e-9);
    }
}

#[test]
fn holes_areas_and_radii_are_drawn_too_and_what_cannot_be_is_explained() {
    if tools().is_none() {
        return;
    }
    let drawn_cell = Drawn::new(settings());
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
