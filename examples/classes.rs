//! The tutorial's three classes, vector, sphere and plane, in Rust, and the picture of `ombres.py`.
//!
//! `cargo run --release --example classes -- [PICTURE.png]`
//!
//! Chapter VI.2 of the tutorial reads it beside `docs/tutorial/programs/vecteur.py`. It uses
//! nothing of envers, which takes its vectors from the crate glam.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A vector, the point that it leads to from the origin, or a colour.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Vector {
    x: f64,
    y: f64,
    z: f64,
}

const fn vector(x: f64, y: f64, z: f64) -> Vector {
    Vector { x, y, z }
}

impl Add for Vector {
    type Output = Vector;

    fn add(self, v: Vector) -> Vector {
        vector(self.x + v.x, self.y + v.y, self.z + v.z)
    }
}

impl Sub for Vector {
    type Output = Vector;

    fn sub(self, v: Vector) -> Vector {
        vector(self.x - v.x, self.y - v.y, self.z - v.z)
    }
}

impl Neg for Vector {
    type Output = Vector;

    fn neg(self) -> Vector {
        vector(-self.x, -self.y, -self.z)
    }
}

impl Mul<f64> for Vector {
    type Output = Vector;

    fn mul(self, k: f64) -> Vector {
        vector(self.x * k, self.y * k, self.z * k)
    }
}

impl Mul<Vector> for f64 {
    type Output = Vector;

    fn mul(self, v: Vector) -> Vector {
        v * self
    }
}

impl Div<f64> for Vector {
    type Output = Vector;

    fn div(self, k: f64) -> Vector {
        vector(self.x / k, self.y / k, self.z / k)
    }
}

impl Vector {
    fn dot(self, v: Vector) -> f64 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    fn unit(self) -> Vector {
        self / self.dot(self).sqrt()
    }

    /// The bytes of a pixel. A float becomes an integer by `as`, which keeps to the ends of u8.
    fn rgb(self) -> [u8; 3] {
        [self.x, self.y, self.z].map(|c| (c + 0.5).floor() as u8)
    }
}

/// A thing in the picture.
trait Object {
    /// The least t > 0 at which `from + t·u` is on it.
    fn intersection(&self, from: Vector, u: Vector) -> Option<f64>;
    fn normal(&self, at: Vector) -> Vector;
    fn color(&self, at: Vector) -> Vector;
}

struct Sphere {
    center: Vector,
    radius: f64,
    color: Vector,
}

impl Object for Sphere {
    fn intersection(&self, from: Vector, u: Vector) -> Option<f64> {
        let f = from - self.center;
        let a = u.dot(u);
        let middle = -f.dot(u) / a;
        let nearest = f + middle * u;
        let rest = self.radius * self.radius - nearest.dot(nearest);
        if rest < 0.0 {
            return None;
        }
        let half_chord = (rest / a).sqrt();
        [middle - half_chord, middle + half_chord].into_iter().find(|t| *t > 0.0)
    }

    fn normal(&self, at: Vector) -> Vector {
        (at - self.center) / self.radius
    }

    fn color(&self, _: Vector) -> Vector {
        self.color
    }
}

struct Plane {
    point: Vector,
    normal: Vector,
    colors: [Vector; 2],
}

impl Object for Plane {
    fn intersection(&self, from: Vector, u: Vector) -> Option<f64> {
        let slope = u.dot(self.normal);
        let t = (self.point - from).dot(self.normal) / slope;
        (slope != 0.0 && t > 0.0).then_some(t)
    }

    fn normal(&self, _: Vector) -> Vector {
        self.normal
    }

    fn color(&self, at: Vector) -> Vector {
        let square = (at.x - self.point.x).floor() + (at.z - self.point.z).floor();
        self.colors[usize::from(square % 2.0 != 0.0)]
    }
}

const SIZE: [u32; 2] = [400, 200];
const D: f64 = 200.0;
const EYE: Vector = vector(0.0, 0.0, 0.0);
const LIGHT: Vector = vector(-20.0, -25.0, -15.0);
const BACKGROUND: Vector = vector(50.0, 50.0, 50.0);

fn objects() -> Vec<Box<dyn Object>> {
    vec![
        Box::new(Sphere {
            center: vector(0.0, 0.0, 5.0),
            radius: 1.0,
            color: vector(52.0, 84.0, 216.0),
        }),
        Box::new(Sphere {
            center: vector(-1.06, -0.8, 3.94),
            radius: 0.4,
            color: vector(216.0, 116.0, 52.0),
        }),
        Box::new(Plane {
            point: vector(0.37, 1.0, 0.37),
            normal: vector(0.0, -1.0, 0.0),
            colors: [vector(230.0, 230.0, 230.0), vector(90.0, 90.0, 90.0)],
        }),
    ]
}

fn color(objects: &[Box<dyn Object>], u: Vector) -> Vector {
    let met = (0..objects.len()).filter_map(|i| Some((objects[i].intersection(EYE, u)?, i)));
    let Some((t, i)) = met.min_by(|a, b| a.0.total_cmp(&b.0)) else { return BACKGROUND };
    let at = EYE + t * u;
    let to_light = LIGHT - at;
    let cosine = objects[i].normal(at).dot(to_light.unit());
    // The object that the ray leaves is not asked: what is round or flat cannot shade itself.
    let shaded = objects
        .iter()
        .enumerate()
        .any(|(j, object)| j != i && object.intersection(at, to_light).is_some_and(|t| t < 1.0));
    if cosine <= 0.0 || shaded { BACKGROUND * 0.0 } else { objects[i].color(at) * cosine }
}

fn main() -> Result<(), image::ImageError> {
    let [width, height] = SIZE;
    let objects = objects();
    let picture = image::RgbImage::from_fn(width, height, |x, y| {
        let u = vector(
            f64::from(x) - f64::from(width) / 2.0,
            f64::from(y) - f64::from(height) / 2.0,
            D,
        );
        image::Rgb(color(&objects, u).rgb())
    });
    let name = std::env::args().nth(1).unwrap_or_else(|| "classes.png".to_owned());
    picture.save(&name)?;
    println!("{name}");
    Ok(())
}
