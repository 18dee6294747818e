//! The models and pictures of the gallery: a gem, a cube, a ring, skies and a planet's clouds.

use std::fmt::Write;

use glam::DVec3;

use super::paint;
use crate::shape::circle;

/// Flat polygons, without shared corners' normals.
#[derive(Default)]
struct Solid {
    corners: Vec<DVec3>,
    faces: Vec<Vec<usize>>,
}

/// The files: their names within `assets/scenes/gallery/models/`, and their bytes.
pub fn files() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("cube.obj", cube().obj("A cube of side 1 about the origin.")),
        ("gem.obj", gem().obj("A brilliant: its girdle has radius 1 and lies in y = 0.")),
        ("ring.obj", ring().obj("A flat ring in y = 0, from radius 0.86 to 1.")),
        ("sky.png", paint::sky()),
        ("dusk.png", paint::dusk()),
        ("planet.png", paint::planet()),
    ]
}

impl Solid {
    /// Adds a corner and gives its index.
    fn corner(&mut self, p: DVec3) -> usize {
        self.corners.push(p);
        self.corners.len() - 1
    }

    /// Adds a ring of corners about the y axis, the first `turns` off the x axis.
    fn around(&mut self, count: usize, radius: f64, y: f64, turns: f64) -> Vec<usize> {
        (0..count)
            .map(|i| {
                let at = circle(i as f64 / count as f64 + turns) * radius;
                self.corner(DVec3::new(at.x, y, at.y))
            })
            .collect()
    }

    /// Adds a face of a body that holds the origin, wound so that it faces outward.
    fn face(&mut self, corners: &[usize]) {
        let at = |i: usize| self.corners[corners[i]];
        let normal = (at(1) - at(0)).cross(at(2) - at(0));
        let mut face = corners.to_vec();
        if normal.dot(at(0)) < 0.0 {
            face.reverse();
        }
        self.faces.push(face);
    }

    /// The OBJ file, which says first what it is.
    fn obj(&self, what: &str) -> Vec<u8> {
        let mut obj = format!("# {what} Made by xtask make-assets.\n");
        let mut line = |text: std::fmt::Arguments<'_>| {
            writeln!(obj, "{text}").expect("ok: a String takes all that is written");
        };
        // Adding 0 turns a negative zero into a positive one.
        let round = |x: f64| (x * 1e6).round() / 1e6 + 0.0;
        for p in &self.corners {
            line(format_args!("v {} {} {}", round(p.x), round(p.y), round(p.z)));
        }
        for face in &self.faces {
            let corners: Vec<_> = face.iter().map(|i| (i + 1).to_string()).collect();
            line(format_args!("f {}", corners.join(" ")));
        }
        obj.into_bytes()
    }
}

fn cube() -> Solid {
    let mut cube = Solid::default();
    for i in 0..8 {
        let side = |bit: i32| if i & bit == 0 { -0.5 } else { 0.5 };
        cube.corner(DVec3::new(side(1), side(2), side(4)));
    }
    for [a, b, c, d] in
        [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]
    {
        cube.face(&[a, b, c, d]);
    }
    cube
}

/// A brilliant of 57 facets, a culet and a girdle, in Tolkowsky's proportions: crown angle 34.5°,
/// pavilion angle 40.7°.
fn gem() -> Solid {
    const GIRDLE: f64 = 0.02;
    let (table_radius, table_height) = (0.55, 0.33);
    let culet_height = -0.88;
    // The kites are flat: their side corners lie in the planes of the angles.
    let crown =
        |x: f64| table_height - (x - table_radius) * (table_height - GIRDLE) / (1.0 - table_radius);
    let pavilion = |x: f64| culet_height - x * (GIRDLE + culet_height);
    let half = circle(1.0 / 16.0).x;
    let (star, lower) = (0.78, 0.24);

    let mut gem = Solid::default();
    let table = gem.around(8, table_radius, table_height, 0.0);
    let stars = gem.around(8, star, crown(star * half), 1.0 / 16.0);
    let above = gem.around(16, 1.0, GIRDLE, 0.0);
    let below = gem.around(16, 1.0, -GIRDLE, 0.0);
    let lowers = gem.around(8, lower, pavilion(lower * half), 1.0 / 16.0);
    let culet = gem.corner(DVec3::new(0.0, culet_height, 0.0));
    gem.face(&table);
    for i in 0..8 {
        let (before, next) = ((i + 7) % 8, (i + 1) % 8);
        let (corner, middle, end) = (2 * i, 2 * i + 1, (2 * i + 2) % 16);
        gem.face(&[table[i], table[next], stars[i]]);
        gem.face(&[table[i], stars[before], above[corner], stars[i]]);
        gem.face(&[stars[i], above[corner], above[middle]]);
        gem.face(&[stars[i], above[middle], above[end]]);
        gem.face(&[above[corner], above[middle], below[middle], below[corner]]);
        gem.face(&[above[middle], above[end], below[end], below[middle]]);
        gem.face(&[lowers[i], below[corner], below[middle]]);
        gem.face(&[lowers[i], below[middle], below[end]]);
        gem.face(&[culet, lowers[before], below[corner], lowers[i]]);
    }
    gem
}

fn ring() -> Solid {
    const COUNT: usize = 192;
    let mut ring = Solid::default();
    let inner = ring.around(COUNT, 0.86, 0.0, 0.0);
    let outer = ring.around(COUNT, 1.0, 0.0, 0.0);
    for i in 0..COUNT {
        let next = (i + 1) % COUNT;
        ring.faces.push(vec![inner[i], inner[next], outer[next], outer[i]]);
    }
    ring
}
