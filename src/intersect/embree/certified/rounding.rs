//! Precision `certified`, at the end of a packet: the hits that were kept, their distances rounded.

use glam::DVec3;

use crate::geometry::{Geometry, Hit, Hit16, PrimitiveId, sphere, triangle};
use crate::intersect::embree::ffi::records::QueryContext;

/// Distances and weights side by side, and which of them are proven.
struct Rounded<const W: usize> {
    t: [f64; W],
    u: [f64; W],
    v: [f64; W],
    certain: [bool; W],
}

impl<const W: usize> QueryContext<'_, W> {
    /// Writes the hits that were found, from lane `at` on.
    ///
    /// Spheres and triangles are rounded all at once, in double-double numbers; where these leave
    /// a distance open, exactly.
    #[inline(always)]
    pub fn finish(&self, found: &mut Hit16, at: usize) {
        let mut ids = [None; W];
        let (mut spheres, mut triangles) = (false, false);
        for i in 0..self.rays.count {
            ids[i] = self.nearest.id(self.scene, i);
            let is_sphere = ids[i].is_some_and(|id| id.geometry == Geometry::Spheres);
            spheres |= is_sphere;
            triangles |= ids[i].is_some() & !is_sphere;
        }
        let mut rounded = Rounded { t: [0.0; W], u: [0.0; W], v: [0.0; W], certain: [false; W] };
        if spheres {
            self.round_spheres(&ids, &mut rounded);
        }
        if triangles {
            self.round_triangles(&ids, &mut rounded);
        }
        for i in 0..self.rays.count {
            let hit = ids[i].and_then(|id| {
                if rounded.certain[i] {
                    Some(Hit { t: rounded.t[i], u: rounded.u[i], v: rounded.v[i], id })
                } else {
                    self.test(i, id)
                }
            });
            found.set(at + i, hit);
        }
    }

    #[inline(always)]
    fn round_spheres(&self, ids: &[Option<PrimitiveId>; W], to: &mut Rounded<W>) {
        let mut center = [[0.0; W]; 3];
        let mut radius = [0.0; W];
        let mut here = [false; W];
        for i in 0..W {
            let Some(id) = ids[i].filter(|id| id.geometry == Geometry::Spheres) else { continue };
            let s = &self.scene.spheres[id.primitive as usize];
            for axis in 0..3 {
                center[axis][i] = s.center[axis];
            }
            radius[i] = s.radius;
            // A ray that goes into a sphere that it starts on meets its far root. Those were settled
            // exactly; they are few.
            let settled = self.leaves && self.nearest.error[i] == 0.0;
            here[i] = !settled;
        }
        for i in 0..W {
            let (origin, direction) = self.exact.line(i);
            let center = DVec3::new(center[0][i], center[1][i], center[2][i]);
            let r = sphere::certified::round(center, radius[i], origin, direction, false);
            to.t[i] = r.t;
            to.certain[i] = r.is_certain & here[i];
        }
    }

    #[inline(always)]
    fn round_triangles(&self, ids: &[Option<PrimitiveId>; W], to: &mut Rounded<W>) {
        let mut corners = [[[0.0; W]; 3]; 3];
        let mut here = [false; W];
        for i in 0..W {
            let Some(id) = ids[i].filter(|id| id.geometry != Geometry::Spheres) else { continue };
            for (to, corner) in corners.iter_mut().zip(self.scene.triangle_vertices(id)) {
                for axis in 0..3 {
                    to[axis][i] = corner[axis];
                }
            }
            here[i] = true;
        }
        let mut found = Rounded { t: [0.0; W], u: [0.0; W], v: [0.0; W], certain: here };
        for i in 0..W {
            let (origin, direction) = self.exact.line(i);
            let corner =
                |c: usize| DVec3::new(corners[c][0][i], corners[c][1][i], corners[c][2][i]);
            let r =
                triangle::certified::round([corner(0), corner(1), corner(2)], origin, direction);
            found.t[i] = r.t;
            found.u[i] = r.u;
            found.v[i] = r.v;
            found.certain[i] &= r.is_certain;
        }
        for i in (0..W).filter(|&i| here[i]) {
            to.t[i] = found.t[i];
            to.u[i] = found.u[i];
            to.v[i] = found.v[i];
            to.certain[i] = found.certain[i];
        }
    }
}
