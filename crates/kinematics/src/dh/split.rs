//! One transform into rows.

use std::f64::consts::{FRAC_PI_2, PI};

use elbowroom_spatial::{Pose, Vec3};

use super::Row;
use crate::JointKind;

/// Sine of the angle under which axes are parallel: the turn they are off by is lost, below every tolerance.
const PARALLEL: f64 = 1e-11;
/// Sine of the angle under which a common normal would be absurdly far away, and b is used.
const NEARLY_PARALLEL: f64 = 1e-3;
/// Lengths and angles below are rounding.
const DUST: f64 = 1e-12;

/// `T = row · Rz(θ₂)·Tz(d₂)`, the second factor as a pose. The row's `joint` and `kind` are empty.
pub fn row_and_rest(t: &Pose) -> (Row, Pose) {
    let z = t.rotation.z_axis();
    let sine = z.x.hypot(z.y);
    let mut row = if sine < PARALLEL { parallel(t) } else { skew(t, z, sine) };
    tidy(&mut row);
    let rest = row.transform(0.0).inverse() * *t;
    // Only the turn about z and the slide along it are left; what else the pose holds is rounding.
    let turn = rest.rotation.x_axis();
    let about_z = elbowroom_spatial::Rotation::from_axis_angle(Vec3::Z, clean_angle(turn.y.atan2(turn.x)));
    (row, Pose::new(about_z, Vec3::new(0.0, 0.0, clean(rest.translation.z))))
}

/// The common normal of parallel axes is free along them: the one through the first origin, so d = 0.
fn parallel(t: &Pose) -> Row {
    let p = t.translation;
    let a = p.x.hypot(p.y);
    let theta = if a > DUST { p.y.atan2(p.x) } else { 0.0 };
    let alpha = if t.rotation.z_axis().z > 0.0 { 0.0 } else { PI };
    Row { theta, a, alpha, ..fixed() }
}

/// `z = (sθ·sα, −cθ·sα, cα)` gives θ and α; a, b, d from where the second axis is met.
fn skew(t: &Pose, z: Vec3, sine: f64) -> Row {
    let theta = z.x.atan2(-z.y);
    let (s, c) = theta.sin_cos();
    let (x_new, y_new) = (Vec3::new(c, s, 0.0), Vec3::new(-s, c, 0.0));
    // Slide along the second axis to the common normal, or to the first origin's plane where that is too far.
    let along = if sine >= NEARLY_PARALLEL { t.translation.dot(y_new) / sine } else { -t.translation.z / z.z };
    let foot = t.translation + z * along;
    let b = if sine >= NEARLY_PARALLEL { 0.0 } else { foot.dot(y_new) };
    Row { theta, a: foot.dot(x_new), b, d: foot.z, alpha: sine.atan2(z.z), ..fixed() }
}

/// The row of a transform whose entry (3,1) is zero; `None` where it is not.
pub fn exact_row(t: &Pose) -> Option<Row> {
    let [r1, r2, r3] = t.rotation.rows();
    if r3[0].abs() > DUST {
        return None;
    }
    let theta = r2[0].atan2(r1[0]);
    let (s, c) = theta.sin_cos();
    let p = t.translation;
    let (a, b) = (c * p.x + s * p.y, c * p.y - s * p.x);
    let mut row = Row { theta, a, b, d: p.z, alpha: r3[1].atan2(r3[2]), ..fixed() };
    row.theta = clean_angle(row.theta);
    row.alpha = clean_angle(row.alpha);
    (row.a, row.b, row.d) = (clean(row.a), clean(row.b), clean(row.d));
    Some(row)
}

/// The same transform up to the rest: a ≥ 0, or |θ| ≤ π/2 where the axes meet; rounding removed.
fn tidy(row: &mut Row) {
    row.a = clean(row.a);
    let flip = row.a < 0.0 || (row.a == 0.0 && row.theta.abs() > FRAC_PI_2 + DUST);
    if flip {
        row.theta += if row.theta > 0.0 { -PI } else { PI };
        (row.a, row.b, row.alpha) = (-row.a, -row.b, -row.alpha);
    }
    row.theta = clean_angle(row.theta);
    row.alpha = clean_angle(row.alpha);
    (row.a, row.b, row.d) = (clean(row.a), clean(row.b), clean(row.d));
}

/// A pose that is a turn about z and a slide along it, as a row.
pub fn along_z(rest: &Pose) -> Row {
    let x = rest.rotation.x_axis();
    Row { theta: clean_angle(x.y.atan2(x.x)), d: clean(rest.translation.z), ..fixed() }
}

/// True where the row does nothing but turn about and slide along z.
pub fn is_along_z(row: &Row) -> bool {
    row.a == 0.0 && row.b == 0.0 && row.alpha == 0.0
}

fn fixed() -> Row {
    Row { joint: None, kind: JointKind::Fixed, theta: 0.0, a: 0.0, b: 0.0, d: 0.0, alpha: 0.0 }
}

fn clean(v: f64) -> f64 {
    if v.abs() < DUST { 0.0 } else { v }
}

/// Quarter turns are written as quarter turns, half turns as +π.
fn clean_angle(v: f64) -> f64 {
    let quarters = (v / FRAC_PI_2).round();
    let v = if (v - quarters * FRAC_PI_2).abs() < DUST { quarters * FRAC_PI_2 } else { v };
    if v == -PI { PI } else { v + 0.0 }
}
