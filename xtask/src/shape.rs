//! Shapes: polygons with normals and texture coordinates, in metres, y up.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

/// The texture coordinates of a point.
type Uv = fn(DVec3) -> DVec2;

/// Polygons over shared corners. Seen from outside they wind counter-clockwise.
#[derive(Clone, Default)]
pub struct Shape {
    /// The places of the corners.
    pub positions: Vec<DVec3>,
    /// Their normals, of length 1.
    pub normals: Vec<DVec3>,
    /// Their texture coordinates, v running down as in glTF.
    pub uvs: Vec<DVec2>,
    /// Each polygon's corners, three or more.
    pub faces: Vec<Vec<u32>>,
}

/// Cosine and sine of an angle in full turns, the same on every platform: Taylor's series.
pub fn circle(turns: f64) -> DVec2 {
    let angle = (turns - turns.round()) * TAU;
    let (mut sum, mut term) = (DVec2::ZERO, 1.0);
    for n in 0..40 {
        let sign = if n % 4 < 2 { 1.0 } else { -1.0 };
        *(if n % 2 == 0 { &mut sum.x } else { &mut sum.y }) += sign * term;
        term *= angle / f64::from(n + 1);
    }
    sum
}

/// `count` points on the smooth curve through `points` (Catmull and Rom's), for each span.
pub fn smooth(points: &[DVec3], count: usize) -> Vec<DVec3> {
    let at = |i: usize| points[i.min(points.len() - 1)];
    let mut curve: Vec<_> = (0..points.len() - 1)
        .flat_map(|i| {
            let [a, b, c, d] = [at(i.saturating_sub(1)), at(i), at(i + 1), at(i + 2)];
            (0..count).map(move |k| {
                let t = k as f64 / count as f64;
                let (second, third) = (2.0 * a - 5.0 * b + 4.0 * c - d, 3.0 * (b - c) + d - a);
                0.5 * (2.0 * b + (c - a) * t + second * (t * t) + third * (t * t * t))
            })
        })
        .collect();
    curve.extend(points.last());
    curve
}

impl Shape {
    fn corner(&mut self, position: DVec3, normal: DVec3, uv: DVec2) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.uvs.push(uv);
        self.positions.len() as u32 - 1
    }

    /// A flat polygon; `uv` gives the texture coordinates of a point.
    pub fn polygon(&mut self, points: &[DVec3], uv: impl Fn(DVec3) -> DVec2) {
        let normal = (points[1] - points[0]).cross(points[2] - points[0]).normalize();
        let face = points.iter().map(|&p| self.corner(p, normal, uv(p))).collect();
        self.faces.push(face);
    }

    /// A grid of quads over `rows` of corners, smooth. Rows run upward where columns run to the
    /// right, seen from outside. Where two corners of a quad coincide it is a triangle.
    fn grid(&mut self, rows: &[Vec<(DVec3, DVec3, DVec2)>]) {
        let first = self.positions.len() as u32;
        let columns = rows[0].len() as u32;
        for &(position, normal, uv) in rows.iter().flatten() {
            self.corner(position, normal, uv);
        }
        for row in 0..rows.len() as u32 - 1 {
            for column in 0..columns - 1 {
                let a = first + row * columns + column;
                let mut face = vec![a, a + 1, a + columns + 1, a + columns];
                let place = |i: u32| self.positions[i as usize];
                face.dedup_by(|b, a| place(*a) == place(*b));
                if place(face[0]) == place(face[face.len() - 1]) {
                    face.pop();
                }
                self.faces.push(face);
            }
        }
    }

    /// A box. A texture repeats every `tile` metres, upright on its sides.
    pub fn cuboid(mut self, lower: [f64; 3], upper: [f64; 3], tile: f64) -> Self {
        let [a, b] = [lower, upper].map(DVec3::from);
        let at = |i: usize| {
            let pick = |bit: usize, low: f64, high: f64| if i & bit == 0 { low } else { high };
            DVec3::new(pick(1, a.x, b.x), pick(2, a.y, b.y), pick(4, a.z, b.z))
        };
        let sides: [([usize; 4], Uv); 3] = [
            ([5, 1, 3, 7], |p| DVec2::new(p.z, -p.y)),
            ([6, 7, 3, 2], |p| DVec2::new(p.x, p.z)),
            ([4, 5, 7, 6], |p| DVec2::new(p.x, -p.y)),
        ];
        for (axis, (side, uv)) in sides.into_iter().enumerate() {
            self.polygon(&side.map(at), |p| uv(p) / tile);
            // The opposite side has the other bit of its axis, and turns the other way.
            let opposite = [side[3], side[2], side[1], side[0]].map(|i| i ^ (1 << axis));
            self.polygon(&opposite.map(at), |p| uv(p) / tile);
        }
        self
    }

    /// A solid of revolution about the y axis. `profile` (x is the radius) runs upward along the
    /// outside, smooth but for its ends; u runs around, v from `v[0]` at its start to `v[1]`.
    pub fn lathe(mut self, profile: &[DVec2], segments: u32, v: [f64; 2]) -> Self {
        let length = |part: &[DVec2]| part.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>();
        let total = length(profile);
        let rows: Vec<Vec<_>> = (0..profile.len())
            .map(|i| {
                let along = profile[(i + 1).min(profile.len() - 1)] - profile[i.saturating_sub(1)];
                let out = DVec2::new(along.y, -along.x).normalize();
                let share = length(&profile[..=i]) / total;
                (0..=segments)
                    .map(|k| {
                        let turn = f64::from(k) / f64::from(segments);
                        let c = if k == segments { circle(0.0) } else { circle(turn) };
                        // Seen from outside and above, angles run to the right towards -z.
                        let around = |r: f64, y: f64| DVec3::new(r * c.x, y, -r * c.y);
                        let uv = DVec2::new(turn, v[0] + (v[1] - v[0]) * share);
                        (around(profile[i].x, profile[i].y), around(out.x, out.y), uv)
                    })
                    .collect()
            })
            .collect();
        self.grid(&rows);
        self
    }

    /// A flat disc about the y axis that looks up or down, as one polygon.
    pub fn disc(mut self, radius: f64, y: f64, up: bool, segments: u32) -> Self {
        let points: Vec<_> = (0..segments)
            .map(|k| {
                let c = circle(f64::from(k) / f64::from(segments)) * radius;
                DVec3::new(c.x, y, if up { -c.y } else { c.y })
            })
            .collect();
        self.polygon(&points, |p| DVec2::new(p.x, p.z));
        self
    }

    /// A round tube along a curve, without caps; a closed curve ends where it begins.
    pub fn tube(mut self, curve: &[DVec3], radius: f64, segments: u32) -> Self {
        let last = curve.len() - 1;
        let closed = curve[0].distance(curve[last]) < 1e-9;
        let tangent = |i: usize| {
            let before = if i > 0 || !closed { i.saturating_sub(1) } else { last - 1 };
            let after = if i < last || !closed { (i + 1).min(last) } else { 1 };
            (curve[after] - curve[before]).normalize()
        };
        let center = curve[..last].iter().sum::<DVec3>() / last as f64;
        let mut side = (curve[0] - center).cross(tangent(0)).normalize();
        let mut rows: Vec<Vec<(DVec3, DVec3, DVec2)>> = Vec::new();
        for (i, &point) in curve.iter().enumerate() {
            // The frame is carried along, turning no more than the curve does.
            side = (side - tangent(i) * side.dot(tangent(i))).normalize();
            let other = tangent(i).cross(side);
            let row = (0..=segments).map(|k| {
                let c = circle(f64::from(k % segments) / f64::from(segments));
                let normal = side * c.x + other * c.y;
                let uv = DVec2::new(f64::from(k) / f64::from(segments), i as f64);
                (point + normal * radius, normal, uv)
            });
            rows.push(row.collect());
        }
        self.grid(&rows);
        self
    }

    /// Adds the wall above the springing line of an arch: a panel `width` wide and `depth` thick from
    /// `spring` to `top`, with a semicircle of `radius` cut out of it, centred on x = z = 0.
    pub fn arch(
        mut self,
        [width, depth]: [f64; 2],
        [spring, top]: [f64; 2],
        radius: f64,
        segments: u32,
    ) -> Self {
        let flat = |p: DVec3| DVec2::new(p.x, -p.y);
        let (half, z) = (width / 2.0, depth / 2.0);
        let arc: Vec<_> = (0..=segments)
            .map(|k| circle(0.5 - 0.5 * f64::from(k) / f64::from(segments)))
            .collect();
        let mut edge: Vec<_> =
            arc.iter().map(|c| DVec2::new(c.x * radius, spring + c.y * radius)).collect();
        edge.insert(0, DVec2::new(-half, spring));
        edge.push(DVec2::new(half, spring));
        for w in edge.windows(2) {
            let at = |p: DVec2, z: f64| DVec3::new(p.x, p.y, z);
            let [a, b] = [w[0], w[1]];
            let [over_a, over_b] = [DVec2::new(a.x, top), DVec2::new(b.x, top)];
            self.polygon(&[at(a, z), at(b, z), at(over_b, z), at(over_a, z)], flat);
            self.polygon(&[at(b, -z), at(a, -z), at(over_a, -z), at(over_b, -z)], flat);
        }
        for (a, b) in [(-half, -radius), (radius, half)] {
            let at = |x: f64, z: f64| DVec3::new(x, spring, z);
            self.polygon(&[at(a, -z), at(b, -z), at(b, z), at(a, z)], flat);
        }
        for x in [-half, half] {
            let at = |y: f64, z: f64| DVec3::new(x, y, z * x.signum());
            self.polygon(&[at(spring, z), at(spring, -z), at(top, -z), at(top, z)], flat);
        }
        self.vault(&arc, radius, [-z, z], spring, -1.0);
        self
    }

    /// The raised band around an arch, on both of its sides: from radius `inner` to `outer`.
    pub fn band(
        mut self,
        [inner, outer]: [f64; 2],
        depth: f64,
        spring: f64,
        segments: u32,
    ) -> Self {
        let z = depth / 2.0;
        let arc: Vec<_> = (0..=segments)
            .map(|k| circle(0.5 - 0.5 * f64::from(k) / f64::from(segments)))
            .collect();
        let at = |c: DVec2, r: f64, z: f64| DVec3::new(c.x * r, spring + c.y * r, z);
        let uv = |p: DVec3| DVec2::new(p.x, -p.y);
        for w in arc.windows(2) {
            let [a, b] = [w[0], w[1]];
            let front = [at(a, inner, z), at(b, inner, z), at(b, outer, z), at(a, outer, z)];
            self.polygon(&front, uv);
            let back = [at(b, inner, -z), at(a, inner, -z), at(a, outer, -z), at(b, outer, -z)];
            self.polygon(&back, uv);
        }
        self.vault(&arc, inner, [-z, z], spring, -1.0);
        self.vault(&arc, outer, [-z, z], spring, 1.0);
        self
    }

    /// A half cylinder along z over `arc`, smooth, that looks outward or (`sign` −1) inward.
    fn vault(&mut self, arc: &[DVec2], radius: f64, [back, front]: [f64; 2], y: f64, sign: f64) {
        let row = |z: f64| {
            arc.iter()
                .map(|c| {
                    let normal = DVec3::new(c.x, c.y, 0.0) * sign;
                    let place = DVec3::new(c.x * radius, y + c.y * radius, z);
                    (place, normal, DVec2::new(place.x, z))
                })
                .collect::<Vec<_>>()
        };
        let mut rows = [row(front), row(back)];
        if sign < 0.0 {
            rows.reverse();
        }
        self.grid(&rows);
    }
}
