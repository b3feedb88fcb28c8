//! The distance of two placed triangles without any rounding.
//!
//! Every f64 is a whole number times a power of two, and so are sums and products of such numbers.
#![allow(dead_code)]

use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

use elbowroom_spatial::{Pose, Vec3};
use num_bigint::{BigInt, Sign};

/// `mantissa * 2^exponent`, exactly.
#[derive(Debug, Clone)]
pub struct Dyadic {
    mantissa: BigInt,
    exponent: i64,
}

impl Dyadic {
    pub fn of(x: f64) -> Self {
        assert!(x.is_finite());
        let bits = x.to_bits();
        let stored = ((bits >> 52) & 0x7ff).cast_signed();
        let fraction = (bits & ((1 << 52) - 1)).cast_signed();
        let (mantissa, exponent) = if stored == 0 { (fraction, -1074) } else { (fraction | 1 << 52, stored - 1075) };
        Self { mantissa: BigInt::from(if x < 0.0 { -mantissa } else { mantissa }), exponent }
    }

    fn at(&self, exponent: i64) -> BigInt {
        &self.mantissa << (self.exponent - exponent).cast_unsigned()
    }

    pub fn sign(&self) -> i32 {
        match self.mantissa.sign() {
            Sign::Minus => -1,
            Sign::NoSign => 0,
            Sign::Plus => 1,
        }
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;
    fn add(self, o: Self) -> Dyadic {
        let exponent = self.exponent.min(o.exponent);
        Dyadic { mantissa: self.at(exponent) + o.at(exponent), exponent }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;
    fn sub(self, o: Self) -> Dyadic {
        let exponent = self.exponent.min(o.exponent);
        Dyadic { mantissa: self.at(exponent) - o.at(exponent), exponent }
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;
    fn mul(self, o: Self) -> Dyadic {
        Dyadic { mantissa: &self.mantissa * &o.mantissa, exponent: self.exponent + o.exponent }
    }
}

/// A point or a vector.
pub type Point = [Dyadic; 3];
pub type Triangle = [Point; 3];

/// A local point at its place in the pose, by the matrix as it is stored.
pub fn placed(p: Vec3, pose: &Pose) -> Point {
    let (rows, local, t) = (pose.rotation.rows(), p.to_array().map(Dyadic::of), pose.translation.to_array());
    std::array::from_fn(|i| {
        let along = |k: usize| &Dyadic::of(rows[i][k]) * &local[k];
        &(&(&along(0) + &along(1)) + &along(2)) + &Dyadic::of(t[i])
    })
}

pub fn placed_triangle(t: [Vec3; 3], pose: &Pose) -> Triangle {
    t.map(|p| placed(p, pose))
}

fn minus(a: &Point, b: &Point) -> Point {
    std::array::from_fn(|k| &a[k] - &b[k])
}

fn dot(a: &Point, b: &Point) -> Dyadic {
    &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])) + &(&a[2] * &b[2])
}

fn cross(a: &Point, b: &Point) -> Point {
    let two = |i: usize, j: usize| &(&a[i] * &b[j]) - &(&a[j] * &b[i]);
    [two(1, 2), two(2, 0), two(0, 1)]
}

/// A squared distance as a fraction with a positive denominator.
#[derive(Debug, Clone)]
pub struct Square {
    numerator: Dyadic,
    denominator: Dyadic,
}

impl Square {
    fn whole(numerator: Dyadic) -> Self {
        Self { numerator, denominator: Dyadic::of(1.0) }
    }

    fn less(self, o: Self) -> Self {
        let left = &self.numerator * &o.denominator;
        if (&left - &(&o.numerator * &self.denominator)).sign() <= 0 { self } else { o }
    }

    /// Compares the square root with a length that is not negative, metres.
    pub fn root_cmp(&self, length: f64) -> Ordering {
        let length = Dyadic::of(length);
        (&self.numerator - &(&(&length * &length) * &self.denominator)).sign().cmp(&0)
    }

    pub fn root_less(&self, o: &Self) -> bool {
        (&(&self.numerator * &o.denominator) - &(&o.numerator * &self.denominator)).sign() < 0
    }

    pub fn is_zero(&self) -> bool {
        self.numerator.sign() == 0
    }
}

fn point_segment(p: &Point, a: &Point, b: &Point) -> Square {
    let (e, r) = (minus(b, a), minus(p, a));
    let (along, whole) = (dot(&r, &e), dot(&e, &e));
    if along.sign() <= 0 {
        return Square::whole(dot(&r, &r));
    }
    if (&along - &whole).sign() >= 0 {
        let r = minus(p, b);
        return Square::whole(dot(&r, &r));
    }
    let n = cross(&r, &e);
    Square { numerator: dot(&n, &n), denominator: whole }
}

/// Squared distance of two lines if their inner nearest points lie on both segments.
fn segments(a: &[&Point; 2], b: &[&Point; 2]) -> Option<Square> {
    let (u, v, w) = (minus(a[1], a[0]), minus(b[1], b[0]), minus(b[0], a[0]));
    let n = cross(&u, &v);
    let whole = dot(&n, &n);
    if whole.sign() == 0 {
        return None;
    }
    let inside = |x: &Dyadic| x.sign() >= 0 && (x - &whole).sign() <= 0;
    let (s, t) = (dot(&cross(&w, &v), &n), dot(&cross(&w, &u), &n));
    let height = dot(&w, &n);
    (inside(&s) && inside(&t)).then(|| Square { numerator: &height * &height, denominator: whole })
}

fn over_face(p: &Point, [a, b, c]: &Triangle) -> Option<Square> {
    let n = cross(&minus(b, a), &minus(c, a));
    let whole = dot(&n, &n);
    let side = |x: &Point, y: &Point| dot(&cross(&minus(y, x), &minus(p, x)), &n).sign() >= 0;
    let inside = whole.sign() > 0 && side(a, b) && side(b, c) && side(c, a);
    let height = dot(&n, &minus(p, a));
    inside.then(|| Square { numerator: &height * &height, denominator: whole })
}

fn passes(p: &Point, q: &Point, [a, b, c]: &Triangle) -> bool {
    let n = cross(&minus(b, a), &minus(c, a));
    let sides = dot(&n, &minus(p, a)).sign() * dot(&n, &minus(q, a)).sign();
    let d = minus(q, p);
    let turn = |x: &Point, y: &Point| dot(&cross(&minus(x, p), &minus(y, p)), &d).sign();
    let turns = [turn(a, b), turn(b, c), turn(c, a)];
    sides < 0 && (turns.iter().all(|t| *t >= 0) || turns.iter().all(|t| *t <= 0))
}

/// Squared distance of a point and a triangle.
pub fn point_triangle(p: &Point, t: &Triangle) -> Square {
    let mut best = (0..3).map(|k| point_segment(p, &t[k], &t[(k + 1) % 3])).reduce(Square::less).unwrap();
    if let Some(over) = over_face(p, t) {
        best = best.less(over);
    }
    best
}

/// Squared distance of a segment and a triangle.
pub fn segment_triangle(p: &Point, q: &Point, t: &Triangle) -> Square {
    if passes(p, q, t) {
        return Square::whole(Dyadic::of(0.0));
    }
    let mut best = point_triangle(p, t).less(point_triangle(q, t));
    for k in 0..3 {
        let edge = [&t[k], &t[(k + 1) % 3]];
        best = best.less(point_segment(edge[0], p, q));
        if let Some(inner) = segments(&[p, q], &edge) {
            best = best.less(inner);
        }
    }
    best
}

/// Squared distance of two triangles.
pub fn triangles(s: &Triangle, t: &Triangle) -> Square {
    let edges = |s: &Triangle, t: &Triangle| {
        (0..3).map(|k| segment_triangle(&s[k], &s[(k + 1) % 3], t)).reduce(Square::less).unwrap()
    };
    edges(s, t).less(edges(t, s))
}
