//! Sixteen surfaces side by side: what [`Surface::new`] gives, to the bit.

use glam::DVec3;

use super::{Surface, flat_face, normal_of_sphere, on_the_plane, smooth_normal};
use crate::geometry::{Hit16, LANES, Lanes, PrimitiveId, PrimitiveId16, Ray16, RayBatch, Side};
use crate::scene::{MaterialId, Plane, Scene, Sphere, Triangles};

/// The points of surfaces that sixteen rays hit; any numbers where a ray hit nothing. The fields
/// are those of [`Surface`].
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Surface16 {
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
    pub kinds: GeometryKinds,
}

/// Kinds of primitives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GeometryKinds {
    /// Whether there is a sphere.
    pub spheres: bool,
    /// Whether there is a plane.
    pub planes: bool,
    /// Whether there is a triangle.
    pub triangles: bool,
}

impl GeometryKinds {
    /// Those among `ids`.
    #[inline(always)]
    fn of(ids: &PrimitiveId16) -> Self {
        let mut kinds = Self::default();
        for i in 0..LANES {
            kinds.spheres |= ids.geometry[i] == PrimitiveId16::SPHERES;
            kinds.planes |= ids.geometry[i] == PrimitiveId16::PLANES;
            kinds.triangles |= ids.geometry[i] >= PrimitiveId16::MESHES;
        }
        kinds
    }

    /// Whether there is anything.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.spheres | self.planes | self.triangles
    }
}

impl Default for Surface16 {
    fn default() -> Self {
        Self {
            position: [[0.0; LANES]; 3],
            geometric_normal: [[0.0; LANES]; 3],
            normal: [[0.0; LANES]; 3],
            is_back: [false; LANES],
            material: [MaterialId(0); LANES],
            kinds: GeometryKinds::default(),
        }
    }
}

impl Surface16 {
    /// Works out what `found`, which sixteen rays of a batch hit in `scene`, means; `block` is
    /// their number in the batch. Without `SMOOTH` no mesh that was hit may have normals.
    ///
    /// # Panics
    /// When a hit is not one of this scene.
    #[inline(always)]
    pub fn set<const SMOOTH: bool>(
        &mut self,
        scene: &Scene,
        rays: &RayBatch,
        block: usize,
        found: &Hit16,
    ) {
        let lines = &rays.blocks()[block];
        self.kinds = GeometryKinds::of(&found.id);
        if self.kinds.spheres {
            self.set_spheres(scene, lines, found);
        }
        if self.kinds.planes {
            self.set_planes(scene, lines, found);
        }
        if self.kinds.triangles {
            self.set_triangles::<SMOOTH>(scene, found);
        }
        self.turn(scene, rays, block, found);
    }

    #[inline(always)]
    fn put(&mut self, i: usize, position: DVec3, normal: DVec3) {
        for axis in 0..3 {
            self.position[axis][i] = position[axis];
            self.geometric_normal[axis][i] = normal[axis];
            self.normal[axis][i] = normal[axis];
        }
    }

    #[inline(always)]
    fn set_spheres(&mut self, scene: &Scene, lines: &Ray16, found: &Hit16) {
        // Lanes that hit no sphere take the first, so that all are computed alike.
        let is_sphere = |i: usize| found.id.geometry[i] == PrimitiveId16::SPHERES;
        let of = |i| if is_sphere(i) { found.id.primitive[i] } else { 0 };
        let spheres: Lanes<&Sphere> = std::array::from_fn(|i| &scene.spheres[of(i) as usize]);
        let center: [Lanes<f64>; 3] =
            std::array::from_fn(|axis| std::array::from_fn(|i| spheres[i].center[axis]));
        let radius: Lanes<f64> = std::array::from_fn(|i| spheres[i].radius);
        for i in 0..LANES {
            let (origin, direction) = lines.origin_and_direction(i);
            let center = DVec3::new(center[0][i], center[1][i], center[2][i]);
            let normal = normal_of_sphere(center, origin + direction * found.t[i]);
            let position = center + normal * radius[i];
            if is_sphere(i) {
                self.put(i, position, normal);
            }
        }
        for i in 0..LANES {
            self.material[i] = if is_sphere(i) { spheres[i].material } else { self.material[i] };
        }
    }

    #[inline(always)]
    fn set_planes(&mut self, scene: &Scene, lines: &Ray16, found: &Hit16) {
        let is_plane = |i: usize| found.id.geometry[i] == PrimitiveId16::PLANES;
        let of = |i| if is_plane(i) { found.id.primitive[i] } else { 0 };
        let planes: Lanes<&Plane> = std::array::from_fn(|i| &scene.planes[of(i) as usize]);
        let point: [Lanes<f64>; 3] =
            std::array::from_fn(|axis| std::array::from_fn(|i| planes[i].point[axis]));
        let normal: [Lanes<f64>; 3] =
            std::array::from_fn(|axis| std::array::from_fn(|i| planes[i].normal[axis]));
        for i in 0..LANES {
            let (origin, direction) = lines.origin_and_direction(i);
            let point = DVec3::new(point[0][i], point[1][i], point[2][i]);
            let normal = DVec3::new(normal[0][i], normal[1][i], normal[2][i]);
            let position = on_the_plane(point, normal, origin + direction * found.t[i]);
            if is_plane(i) {
                self.put(i, position, normal);
            }
        }
        for i in 0..LANES {
            self.material[i] = if is_plane(i) { planes[i].material } else { self.material[i] };
        }
    }

    #[inline(always)]
    fn set_triangles<const SMOOTH: bool>(&mut self, scene: &Scene, found: &Hit16) {
        let PrimitiveId16 { geometry, primitive, instance } = &found.id;
        let Some(faces) = Triangles::from_ids(scene, geometry, primitive, instance) else { return };
        let is_face = |i: usize| geometry[i] >= PrimitiveId16::MESHES;
        for i in 0..LANES {
            let (position, normal) = flat_face(faces.vertices(i), found.u[i], found.v[i]);
            if is_face(i) {
                self.put(i, position, normal);
            }
        }
        for i in (0..LANES).filter(|&i| is_face(i)) {
            self.material[i] = scene.instances[instance[i] as usize].material;
            let mesh = (geometry[i] - PrimitiveId16::MESHES) as usize;
            if !SMOOTH || scene.meshes[mesh].normals.is_empty() {
                continue;
            }
            let smooth =
                found.hit(i).and_then(|hit| smooth_normal(scene, &hit, self.geometric_normal(i)));
            if let Some(normal) = smooth {
                for axis in 0..3 {
                    self.normal[axis][i] = normal[axis];
                }
            }
        }
    }

    /// Turns the normals to the viewer where they are to be.
    #[inline(always)]
    fn turn(&mut self, scene: &Scene, rays: &RayBatch, block: usize, found: &Hit16) {
        let lines = &rays.blocks()[block];
        for i in 0..LANES {
            let away = self.geometric_normal(i).dot(lines.origin_and_direction(i).1);
            self.is_back[i] = away > 0.0;
        }
        if !rays.have_no_continuations() {
            for i in 0..LANES {
                let past = rays.continuation(block * LANES + i);
                let left = past.filter(|past| past.crossed.side == Side::Back);
                let is_left = left.is_some_and(|past| Some(past.crossed.id) == found.id.get(i));
                self.is_back[i] |= is_left & (found.id.geometry[i] == PrimitiveId16::SPHERES);
            }
        }
        if !self.is_back.contains(&true) {
            return;
        }
        let mut turns = self.is_back;
        if self.kinds.spheres {
            for i in (0..LANES).filter(|&i| found.id.geometry[i] == PrimitiveId16::SPHERES) {
                turns[i] &= scene.materials[self.material[i].0 as usize].double_sided;
            }
        }
        for axis in 0..3 {
            for i in 0..LANES {
                let n = self.normal[axis][i];
                self.normal[axis][i] = if turns[i] { -n } else { n };
            }
        }
    }

    /// The surface in lane `i`, where `id` was hit.
    pub fn surface(&self, i: usize, id: PrimitiveId) -> Surface {
        Surface {
            position: self.position(i),
            geometric_normal: self.geometric_normal(i),
            normal: self.normal(i),
            side: self.side(i),
            material: self.material[i],
            id,
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

    /// Changes the normal to shade with in lane `i`.
    #[inline(always)]
    pub fn set_normal(&mut self, i: usize, normal: DVec3) {
        for axis in 0..3 {
            self.normal[axis][i] = normal[axis];
        }
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
