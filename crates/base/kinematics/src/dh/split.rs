//! Splitting of a transform into rows.

use std::f64::consts::{FRAC_PI_2, PI};

use elbowroom_spatial::{Pose, Vec3};

use super::generalized::GeneralizedRow;

/// Sine of the angle below which axes count as parallel. The deviation is dropped; it is below every tolerance.
const PARALLEL: f64 = 1e-11;
/// Sine of the angle below which b is used, because the common normal would be very far away.
const NEARLY_PARALLEL: f64 = 1e-3;
/// Lengths (m) and angles (rad) below this are rounding.
const ROUNDING: f64 = 1e-12;

/// Splits `T = row · Rz(θ₂)·Tz(d₂)`; returns the second factor as a pose. The row's `joint` and `kind` are empty.
pub fn row_and_rest(t: &Pose) -> (GeneralizedRow, Pose) {
    let z = t.rotation.z_axis();
    let sine = z.x.hypot(z.y);
    let mut row = if sine < PARALLEL { parallel(t) } else { skew(t, z, sine) };
    tidy(&mut row);
    let rest = row.transform(0.0).inverse() * *t;
    // Only the rotation about z and the translation along z are left; the rest of the pose is rounding.
    let x = rest.rotation.x_axis();
    let about_z = elbowroom_spatial::Rotation::from_axis_angle(Vec3::Z, clean_angle(x.y.atan2(x.x)));
    (row, Pose::new(about_z, Vec3::new(0.0, 0.0, clean(rest.translation.z))))
}

/// The row for parallel axes. Their common normal is not unique; the one through the first origin is used, so d = 0.
fn parallel(t: &Pose) -> GeneralizedRow {
    let p = t.translation;
    let a = p.x.hypot(p.y);
    let theta = if a > ROUNDING { p.y.atan2(p.x) } else { 0.0 };
    let alpha = if t.rotation.z_axis().z > 0.0 { 0.0 } else { PI };
    GeneralizedRow { theta, a, alpha, ..GeneralizedRow::IDENTITY }
}

/// The row for skew axes: `z = (sθ·sα, −cθ·sα, cα)` gives θ and α; the foot of the common normal gives a, b and d.
fn skew(t: &Pose, z: Vec3, sine: f64) -> GeneralizedRow {
    let theta = z.x.atan2(-z.y);
    let (s, c) = theta.sin_cos();
    let (x_new, y_new) = (Vec3::new(c, s, 0.0), Vec3::new(-s, c, 0.0));
    // Along the second axis to the common normal, or to the plane of the first origin if the common normal is too far
    // away.
    let along = if sine >= NEARLY_PARALLEL { t.translation.dot(y_new) / sine } else { -t.translation.z / z.z };
    let foot = t.translation + z * along;
    let b = if sine >= NEARLY_PARALLEL { 0.0 } else { foot.dot(y_new) };
    GeneralizedRow { theta, a: foot.dot(x_new), b, d: foot.z, alpha: sine.atan2(z.z), ..GeneralizedRow::IDENTITY }
}

/// The row of a transform whose entry (3,1) is zero; `None` if the entry is not zero.
pub fn exact_row(t: &Pose) -> Option<GeneralizedRow> {
    let [r1, r2, r3] = t.rotation.rows();
    if r3[0].abs() > ROUNDING {
        return None;
    }
    let theta = r2[0].atan2(r1[0]);
    let (s, c) = theta.sin_cos();
    let p = t.translation;
    let (a, b) = (c * p.x + s * p.y, c * p.y - s * p.x);
    let mut row = GeneralizedRow { theta, a, b, d: p.z, alpha: r3[1].atan2(r3[2]), ..GeneralizedRow::IDENTITY };
    row.theta = clean_angle(row.theta);
    row.alpha = clean_angle(row.alpha);
    (row.a, row.b, row.d) = (clean(row.a), clean(row.b), clean(row.d));
    Some(row)
}

/// Normalizes a row without changing the transform except for the remainder: a ≥ 0, or |θ| ≤ π/2 if the axes
/// intersect. Also removes rounding.
fn tidy(row: &mut GeneralizedRow) {
    row.a = clean(row.a);
    let flip = row.a < 0.0 || (row.a == 0.0 && row.theta.abs() > FRAC_PI_2 + ROUNDING);
    if flip {
        row.theta += if row.theta > 0.0 { -PI } else { PI };
        (row.a, row.b, row.alpha) = (-row.a, -row.b, -row.alpha);
    }
    row.theta = clean_angle(row.theta);
    row.alpha = clean_angle(row.alpha);
    (row.a, row.b, row.d) = (clean(row.a), clean(row.b), clean(row.d));
}

/// The row of a pose that is a rotation about z and a translation along z.
pub fn along_z(rest: &Pose) -> GeneralizedRow {
    let x = rest.rotation.x_axis();
    GeneralizedRow { theta: clean_angle(x.y.atan2(x.x)), d: clean(rest.translation.z), ..GeneralizedRow::IDENTITY }
}

/// True if the row is only a rotation about z and a translation along z.
pub fn is_along_z(row: &GeneralizedRow) -> bool {
    row.a == 0.0 && row.b == 0.0 && row.alpha == 0.0
}

fn clean(v: f64) -> f64 {
    if v.abs() < ROUNDING { 0.0 } else { v }
}

/// Makes near quarter turns exact, and half turns +π.
fn clean_angle(v: f64) -> f64 {
    let quarters = (v / FRAC_PI_2).round();
    let v = if (v - quarters * FRAC_PI_2).abs() < ROUNDING { quarters * FRAC_PI_2 } else { v };
    if v == -PI { PI } else { v + 0.0 }
}
