//! Sixteen surfaces side by side: what [`Surface::new`] gives, to the bit.

use glam::DVec3;

use super::{flat_face, normal_of_sphere, on_the_plane, smooth_normal};
use crate::geometry::{Departure, Found, Geometry, LANES, Lanes, Lines, PrimitiveId, Rays, Side};
use crate::scene::{Faces, MaterialId, Scene};

/// The points of surfaces that sixteen rays hit; any numbers where a ray hit nothing. The fields
/// are those of [`Surface`](super::Surface).
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Surfaces {
    /// The points, axis by axis.
    pub position: [Lanes<f64>; 3],
    /// The surfaces' own normals, axis by axis.
    pub geometric_normal: [Lanes<f64>; 3],
    /// The normals to shade with, axis by axis.
    pub normal: [Lanes<f64>; 3],
    /// Whether the viewer sees the side that the geometric normal does not point to.
    pub is_back: Lanes<bool>,
    /// What they are made of.
    pub material: Lanes<MaterialId>,
    /// What kinds of primitives are among them.
    pub kinds: Kinds,
}

/// Kinds of primitives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Kinds {
    /// Whether there is a sphere.
    pub spheres: bool,
    /// Whether there is a plane.
    pub planes: bool,
    /// Whether there is a triangle.
    pub triangles: bool,
}

impl Kinds {
    /// Those among `ids`.
    #[inline(always)]
    fn of(ids: &Lanes<Option<PrimitiveId>>) -> Self {
        let mut kinds = Self::default();
        for id in ids.iter().flatten() {
            match id.geometry {
                Geometry::Spheres => kinds.spheres = true,
                Geometry::Planes => kinds.planes = true,
                Geometry::Mesh(_) => kinds.triangles = true,
            }
        }
        kinds
    }

    /// Whether there is anything.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.spheres | self.planes | self.triangles
    }
}

impl Default for Surfaces {
    fn default() -> Self {
        Self {
            position: [[0.0; LANES]; 3],
            geometric_normal: [[0.0; LANES]; 3],
            normal: [[0.0; LANES]; 3],
            is_back: [false; LANES],
            material: [MaterialId(0); LANES],
            kinds: Kinds::default(),
        }
    }
}

impl Surfaces {
    /// Works out what `found`, which sixteen rays of a batch hit in `scene`, means; `block` is
    /// their number in the batch.
    ///
    /// # Panics
    /// When a hit is not one of this scene.
    #[inline(always)]
    pub fn set(&mut self, scene: &Scene, rays: &Rays, block: usize, found: &Found) {
        let lines = &rays.lines()[block];
        self.kinds = Kinds::of(&found.id);
        if self.kinds.spheres {
            self.set_spheres(scene, lines, found);
        }
        if self.kinds.planes {
            self.set_planes(scene, lines, found);
        }
        self.normal = self.geometric_normal;
        if self.kinds.triangles {
            self.set_triangles(scene, found);
        }
        self.turn(scene, rays, block, found);
    }

    #[inline(always)]
    fn put(&mut self, i: usize, position: DVec3, normal: DVec3) {
        for axis in 0..3 {
            self.position[axis][i] = position[axis];
            self.geometric_normal[axis][i] = normal[axis];
        }
    }

    #[inline(always)]
    fn set_spheres(&mut self, scene: &Scene, lines: &Lines, found: &Found) {
        let mut center = [[0.0; LANES]; 3];
        let mut radius = [0.0; LANES];
        let mut here = [false; LANES];
        for i in 0..LANES {
            let Some(id) = found.id[i] else { continue };
            if id.geometry == Geometry::Spheres {
                let sphere = &scene.spheres[id.primitive as usize];
                for axis in 0..3 {
                    center[axis][i] = sphere.center[axis];
                }
                radius[i] = sphere.radius;
                self.material[i] = sphere.material;
                here[i] = true;
            }
        }
        for i in 0..LANES {
            let (origin, direction) = lines.line(i);
            let center = DVec3::new(center[0][i], center[1][i], center[2][i]);
            let normal = normal_of_sphere(center, origin + direction * found.t[i]);
            let position = center + normal * radius[i];
            if here[i] {
                self.put(i, position, normal);
            }
        }
    }

    #[inline(always)]
    fn set_planes(&mut self, scene: &Scene, lines: &Lines, found: &Found) {
        let mut point = [[0.0; LANES]; 3];
        let mut normal = [[0.0; LANES]; 3];
        let mut here = [false; LANES];
        for i in 0..LANES {
            let Some(id) = found.id[i] else { continue };
            if id.geometry == Geometry::Planes {
                let plane = &scene.planes[id.primitive as usize];
                for axis in 0..3 {
                    point[axis][i] = plane.point[axis];
                    normal[axis][i] = plane.normal[axis];
                }
                self.material[i] = plane.material;
                here[i] = true;
            }
        }
        for i in 0..LANES {
            let (origin, direction) = lines.line(i);
            let point = DVec3::new(point[0][i], point[1][i], point[2][i]);
            let normal = DVec3::new(normal[0][i], normal[1][i], normal[2][i]);
            let position = on_the_plane(point, normal, origin + direction * found.t[i]);
            if here[i] {
                self.put(i, position, normal);
            }
        }
    }

    #[inline(always)]
    fn set_triangles(&mut self, scene: &Scene, found: &Found) {
        let Some(faces) = Faces::of(scene, &found.id) else { return };
        let mut here = [false; LANES];
        for i in 0..LANES {
            let Some(id) = found.id[i] else { continue };
            if let Geometry::Mesh(_) = id.geometry {
                self.material[i] = scene.instances[id.instance as usize].material;
                here[i] = true;
            }
        }
        for i in 0..LANES {
            let (position, normal) = flat_face(faces.corners(i), found.u[i], found.v[i]);
            if here[i] {
                self.put(i, position, normal);
                for axis in 0..3 {
                    self.normal[axis][i] = normal[axis];
                }
            }
        }
        for i in (0..LANES).filter(|&i| here[i]) {
            let Some(hit) = found.hit(i) else { continue };
            if let Some(normal) = smooth_normal(scene, &hit, self.geometric_normal(i)) {
                for axis in 0..3 {
                    self.normal[axis][i] = normal[axis];
                }
            }
        }
    }

    /// Turns the normals to the viewer where they are to be.
    #[inline(always)]
    fn turn(&mut self, scene: &Scene, rays: &Rays, block: usize, found: &Found) {
        let lines = &rays.lines()[block];
        for i in 0..LANES {
            let away = self.geometric_normal(i).dot(lines.line(i).1);
            self.is_back[i] = away > 0.0;
        }
        let mut turns = [true; LANES];
        if self.kinds.spheres {
            for i in 0..LANES {
                let Some(id) = found.id[i] else { continue };
                if id.geometry == Geometry::Spheres {
                    turns[i] = scene.materials[self.material[i].0 as usize].double_sided;
                    let left = Departure { id, side: Side::Back };
                    let past = if rays.are_unbroken() { None } else { rays.past(block * LANES + i) };
                    self.is_back[i] |= past.is_some_and(|past| past.through == left);
                }
            }
        }
        for axis in 0..3 {
            for i in 0..LANES {
                let n = self.normal[axis][i];
                self.normal[axis][i] = if self.is_back[i] & turns[i] { -n } else { n };
            }
        }
    }

    /// The point in lane `i`.
    #[inline(always)]
    pub fn position(&self, i: usize) -> DVec3 {
        at(&self.position, i)
    }

    /// The geometric normal in lane `i`.
    #[inline(always)]
    pub fn geometric_normal(&self, i: usize) -> DVec3 {
        at(&self.geometric_normal, i)
    }

    /// The normal to shade with in lane `i`.
    #[inline(always)]
    pub fn normal(&self, i: usize) -> DVec3 {
        at(&self.normal, i)
    }

    /// The side that the viewer sees in lane `i`.
    #[inline(always)]
    pub fn side(&self, i: usize) -> Side {
        if self.is_back[i] { Side::Back } else { Side::Front }
    }
}

#[inline(always)]
fn at(v: &[Lanes<f64>; 3], i: usize) -> DVec3 {
    DVec3::new(v[0][i], v[1][i], v[2][i])
}
