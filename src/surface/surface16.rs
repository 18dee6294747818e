//! The surfaces that sixteen rays hit, side by side; each is, to the bit, what [`Surface::new`] gives.

use glam::DVec3;

use super::{
    Surface, normal_spread, project_to_plane, smooth_normal, sphere_normal, triangle_point,
};
use crate::geometry::{
    Hit16, LANES, Lanes, PrimitiveId, PrimitiveId16, Ray16, RayBatch, Side, plane,
};
use crate::scene::{MaterialId, Plane, Scene, Sphere, Triangles};

/// The surfaces that sixteen rays hit; any numbers where a ray hit nothing. The fields are those of
/// [`Surface`].
#[derive(Clone, Debug, Default)]
#[repr(C, align(64))]
pub struct Surface16 {
    /// The positions, axis by axis.
    pub position: [Lanes<f64>; 3],
    /// The geometric normals, axis by axis.
    pub geometric_normal: [Lanes<f64>; 3],
    /// The shading normals, axis by axis.
    pub normal: [Lanes<f64>; 3],
    /// The spread of smooth normals, as [`normal_spread`] gives it; 0 on all else.
    pub spread: Lanes<f64>,
    /// True where the viewer sees the back.
    pub is_back: Lanes<bool>,
    /// The materials.
    pub material: Lanes<MaterialId>,
    /// True if a sphere is among what was hit.
    pub has_spheres: bool,
    /// True if a plane is among what was hit.
    pub has_planes: bool,
    /// True if a triangle is among what was hit.
    pub has_triangles: bool,
}

impl Surface16 {
    /// Sets it to the surfaces that sixteen rays of a batch hit; `block` is the number of these in
    /// the batch. Without `SMOOTH_NORMALS` no mesh that was hit may have normals.
    ///
    /// # Panics
    /// When a hit is not one of this scene.
    #[inline(always)]
    pub fn set<const SMOOTH_NORMALS: bool>(
        &mut self,
        scene: &Scene,
        rays: &RayBatch,
        block: usize,
        hits: &Hit16,
    ) {
        let ray16 = &rays.blocks()[block];
        // The kinds of primitives; each kind is computed for all lanes alike.
        let (mut has_spheres, mut has_planes, mut has_triangles) = (false, false, false);
        for i in 0..LANES {
            has_spheres |= hits.id.geometry[i] == PrimitiveId16::SPHERES;
            has_planes |= hits.id.geometry[i] == PrimitiveId16::PLANES;
            has_triangles |= hits.id.geometry[i] >= PrimitiveId16::MESHES;
        }
        self.spread = [0.0; LANES];
        self.has_spheres = has_spheres;
        self.has_planes = has_planes;
        self.has_triangles = has_triangles;
        if self.has_spheres {
            self.set_spheres(scene, ray16, hits);
        }
        if self.has_planes {
            self.set_planes(scene, ray16, hits);
        }
        if self.has_triangles {
            self.set_triangles::<SMOOTH_NORMALS>(scene, hits);
        }
        self.set_sides(scene, rays, block, hits);
    }

    /// True if any ray hit anything.
    #[inline(always)]
    pub fn has_hits(&self) -> bool {
        self.has_spheres | self.has_planes | self.has_triangles
    }

    #[inline(always)]
    fn set_lane(&mut self, i: usize, position: DVec3, normal: DVec3) {
        for axis in 0..3 {
            self.position[axis][i] = position[axis];
            self.geometric_normal[axis][i] = normal[axis];
            self.normal[axis][i] = normal[axis];
        }
    }

    #[inline(always)]
    fn set_spheres(&mut self, scene: &Scene, ray16: &Ray16, hits: &Hit16) {
        // Lanes that hit no sphere take the first, so that all are computed alike.
        let is_sphere = |i: usize| hits.id.geometry[i] == PrimitiveId16::SPHERES;
        let index = |i| if is_sphere(i) { hits.id.primitive[i] } else { 0 };
        let mut spheres: Lanes<&Sphere> = [&scene.spheres[0]; LANES];
        let (mut center, mut radius) = ([[0.0; LANES]; 3], [0.0; LANES]);
        for i in 0..LANES {
            spheres[i] = &scene.spheres[index(i) as usize];
            radius[i] = spheres[i].radius;
            for axis in 0..3 {
                center[axis][i] = spheres[i].center[axis];
            }
        }
        for i in 0..LANES {
            let (origin, direction) = ray16.origin_and_direction(i);
            let center = lane(&center, i);
            let normal = sphere_normal(center, origin + direction * hits.t[i]);
            let position = center + normal * radius[i];
            if is_sphere(i) {
                self.set_lane(i, position, normal);
            }
        }
        for i in 0..LANES {
            self.material[i] = if is_sphere(i) { spheres[i].material } else { self.material[i] };
        }
    }

    #[inline(always)]
    fn set_planes(&mut self, scene: &Scene, ray16: &Ray16, hits: &Hit16) {
        let is_plane = |i: usize| hits.id.geometry[i] == PrimitiveId16::PLANES;
        let index = |i| if is_plane(i) { hits.id.primitive[i] } else { 0 };
        let mut planes: Lanes<&Plane> = [&scene.planes[0]; LANES];
        let (mut point, mut normal) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for i in 0..LANES {
            planes[i] = &scene.planes[index(i) as usize];
            for axis in 0..3 {
                point[axis][i] = planes[i].point[axis];
                normal[axis][i] = planes[i].normal[axis];
            }
        }
        // Nearly always no plane is given by a point far away.
        let mut is_far = [false; LANES];
        for i in 0..LANES {
            let (origin, direction) = ray16.origin_and_direction(i);
            let (point, normal) = (lane(&point, i), lane(&normal, i));
            let on_ray = origin + direction * hits.t[i];
            let position = on_ray - normal * normal.dot(on_ray - point);
            is_far[i] = plane::is_far(point, on_ray) & is_plane(i);
            if is_plane(i) {
                self.set_lane(i, position, normal);
            }
        }
        if is_far.contains(&true) {
            for i in (0..LANES).filter(|&i| is_far[i]) {
                let (origin, direction) = ray16.origin_and_direction(i);
                let (point, normal) = (lane(&point, i), lane(&normal, i));
                let position = project_to_plane(point, normal, origin + direction * hits.t[i]);
                self.set_lane(i, position, normal);
            }
        }
        for i in 0..LANES {
            self.material[i] = if is_plane(i) { planes[i].material } else { self.material[i] };
        }
    }

    #[inline(always)]
    fn set_triangles<const SMOOTH_NORMALS: bool>(&mut self, scene: &Scene, hits: &Hit16) {
        let PrimitiveId16 { geometry, primitive, instance } = &hits.id;
        let Some(triangles) = Triangles::from_ids(scene, geometry, primitive, instance) else {
            return;
        };
        let is_triangle = |i: usize| geometry[i] >= PrimitiveId16::MESHES;
        for i in 0..LANES {
            let (position, normal) = triangle_point(triangles.vertices(i), hits.u[i], hits.v[i]);
            if is_triangle(i) {
                self.set_lane(i, position, normal);
            }
        }
        // Materials, and the normals of smooth meshes, one by one.
        for i in (0..LANES).filter(|&i| is_triangle(i)) {
            self.material[i] = scene.instances[instance[i] as usize].material;
            let mesh = (geometry[i] - PrimitiveId16::MESHES) as usize;
            if !SMOOTH_NORMALS || scene.meshes[mesh].normals.is_empty() {
                continue;
            }
            let Some(hit) = hits.hit(i) else { continue };
            let face = self.geometric_normal(i);
            if let Some(normal) = smooth_normal(scene, &hit, face) {
                self.set_normal(i, normal);
                self.spread[i] = normal_spread(scene, &hit, face);
            }
        }
    }

    /// Sets the sides that the viewer sees, and turns shading normals to the viewer.
    #[inline(always)]
    fn set_sides(&mut self, scene: &Scene, rays: &RayBatch, block: usize, hits: &Hit16) {
        let ray16 = &rays.blocks()[block];
        for i in 0..LANES {
            let cosine = self.geometric_normal(i).dot(ray16.origin_and_direction(i).1);
            self.is_back[i] = cosine > 0.0;
        }
        // A continuation ray that went into a sphere leaves it.
        if !rays.have_no_continuations() {
            for i in 0..LANES {
                let continuation = rays.continuation(block * LANES + i);
                let entered = continuation.filter(|c| c.crossed.side == Side::Back);
                let is_left = entered.is_some_and(|c| Some(c.crossed.id) == hits.id.get(i));
                self.is_back[i] |= is_left & (hits.id.geometry[i] == PrimitiveId16::SPHERES);
            }
        }
        if !self.is_back.contains(&true) {
            return;
        }
        // Spheres that are lit on their outside only keep their normals.
        let mut is_turned = self.is_back;
        if self.has_spheres {
            for i in (0..LANES).filter(|&i| hits.id.geometry[i] == PrimitiveId16::SPHERES) {
                is_turned[i] &= scene.materials[self.material[i].0 as usize].double_sided;
            }
        }
        for axis in 0..3 {
            for i in 0..LANES {
                let n = self.normal[axis][i];
                self.normal[axis][i] = if is_turned[i] { -n } else { n };
            }
        }
    }

    /// Returns the surface in lane `i`, where `id` was hit.
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

    /// Returns the position in lane `i`.
    #[inline(always)]
    pub fn position(&self, i: usize) -> DVec3 {
        lane(&self.position, i)
    }

    /// Returns the geometric normal in lane `i`.
    #[inline(always)]
    pub fn geometric_normal(&self, i: usize) -> DVec3 {
        lane(&self.geometric_normal, i)
    }

    /// Returns the shading normal in lane `i`.
    #[inline(always)]
    pub fn normal(&self, i: usize) -> DVec3 {
        lane(&self.normal, i)
    }

    /// Sets the shading normal in lane `i`.
    #[inline(always)]
    pub fn set_normal(&mut self, i: usize, normal: DVec3) {
        for axis in 0..3 {
            self.normal[axis][i] = normal[axis];
        }
    }

    /// Returns the side that the viewer sees in lane `i`.
    #[inline(always)]
    pub fn side(&self, i: usize) -> Side {
        if self.is_back[i] { Side::Back } else { Side::Front }
    }
}

/// Returns the vector in lane `i`.
#[inline(always)]
fn lane(v: &[Lanes<f64>; 3], i: usize) -> DVec3 {
    DVec3::new(v[0][i], v[1][i], v[2][i])
}
