//! The vertices of several triangles, side by side.

use glam::DVec3;

use crate::geometry::PrimitiveId16;
use crate::scene::{Mesh, Positions, Scene};

/// The vertices of `W` triangles in world space, by vertex, axis and lane. In a lane without triangle
/// all three are at one point.
#[repr(C, align(64))]
pub struct Triangles<const W: usize>([[[f64; W]; 3]; 3]);

impl<const W: usize> Triangles<W> {
    /// Gathers the triangles among the primitives with these ids, coded as in [`PrimitiveId16`];
    /// `None` if there is no triangle.
    ///
    /// # Panics
    /// When a triangle is not in the scene.
    #[inline(always)]
    pub fn from_ids(
        scene: &Scene,
        geometry: &[u32; W],
        primitive: &[u32; W],
        instance: &[u32; W],
    ) -> Option<Self> {
        // The mesh in each lane, and what they have in common.
        let is_triangle = |i: usize| geometry[i] >= PrimitiveId16::MESHES;
        let mesh = |i: usize| &*scene.meshes[(geometry[i] - PrimitiveId16::MESHES) as usize];
        let first = (0..W).find(|&i| is_triangle(i))?;
        let mut alike = true;
        for i in 0..W {
            alike &= !is_triangle(i) | (instance[i] == instance[first]);
        }

        // The vertices in the spaces of their meshes: those of one mesh in f32 are converted in a loop that
        // vectorises.
        let mut local = [[[0.0; W]; 3]; 3];
        if alike && let Mesh { positions: Positions::F32(positions), triangles, .. } = mesh(first) {
            let mut narrow = [[[0.0f32; W]; 3]; 3];
            for i in (0..W).filter(|&i| is_triangle(i)) {
                for (to, vertex) in narrow.iter_mut().zip(triangles[primitive[i] as usize]) {
                    for axis in 0..3 {
                        to[axis][i] = positions[vertex as usize][axis];
                    }
                }
            }
            for (to, from) in local.iter_mut().zip(&narrow) {
                for axis in 0..3 {
                    for i in 0..W {
                        to[axis][i] = f64::from(from[axis][i]);
                    }
                }
            }
        } else {
            for i in (0..W).filter(|&i| is_triangle(i)) {
                for (to, p) in local.iter_mut().zip(mesh(i).triangle_vertices(primitive[i])) {
                    for axis in 0..3 {
                        to[axis][i] = p[axis];
                    }
                }
            }
        }

        // Nearly always all are of one instance: one transform, in a loop that vectorises.
        let mut world = [[[0.0; W]; 3]; 3];
        let shared = &scene.instances[instance[first] as usize];
        for (to, from) in world.iter_mut().zip(&local) {
            for i in 0..W {
                let p = shared.to_world(DVec3::new(from[0][i], from[1][i], from[2][i]));
                for axis in 0..3 {
                    to[axis][i] = p[axis];
                }
            }
        }

        // Otherwise each lane has its own transform.
        if !alike {
            for i in 0..W {
                if geometry[i] < PrimitiveId16::MESHES {
                    continue;
                }
                let own = &scene.instances[instance[i] as usize];
                for (to, from) in world.iter_mut().zip(&local) {
                    let p = own.to_world(DVec3::new(from[0][i], from[1][i], from[2][i]));
                    for axis in 0..3 {
                        to[axis][i] = p[axis];
                    }
                }
            }
        }
        Some(Self(world))
    }

    /// The vertices in lane `i`.
    #[inline(always)]
    pub fn vertices(&self, i: usize) -> [DVec3; 3] {
        let vertex = |v: usize| DVec3::new(self.0[v][0][i], self.0[v][1][i], self.0[v][2][i]);
        [vertex(0), vertex(1), vertex(2)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::PrimitiveId;
    use crate::scene::{Instance, MaterialId, Mesh};
    use glam::DAffine3;

    fn scene() -> Scene {
        let mut scene = Scene::default();
        let positions = (0..9).map(|i| [i as f32, (i * i) as f32, 0.5]).collect();
        let mesh = scene.add_mesh(Mesh {
            positions,
            triangles: vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]],
            ..Mesh::default()
        });
        for turn in [0.0, 0.7] {
            let transform = DAffine3::from_rotation_y(turn);
            scene.instances.push(Instance::new(mesh, transform, MaterialId(0)));
        }
        scene
    }

    /// Three triangles with, as the third lane of four, nothing.
    fn gather(instances: [u32; 4], triangles: [u32; 4]) -> Option<Triangles<4>> {
        let geometry = [
            PrimitiveId16::MESHES,
            PrimitiveId16::MESHES,
            PrimitiveId16::NONE,
            PrimitiveId16::MESHES,
        ];
        Triangles::from_ids(&scene(), &geometry, &triangles, &instances)
    }

    #[test]
    fn vertices_are_those_of_the_scene_whatever_the_instances() {
        for instances in [[1, 1, 0, 1], [0, 1, 0, 0]] {
            let triangles = [2, 0, 0, 1];
            let gathered = gather(instances, triangles).unwrap();
            for i in [0, 1, 3] {
                let id = PrimitiveId::triangle(0, triangles[i], instances[i]);
                assert_eq!(gathered.vertices(i), scene().triangle_vertices(id));
            }
        }
    }

    #[test]
    fn without_triangles_nothing_is_gathered() {
        let geometry = [
            PrimitiveId16::NONE,
            PrimitiveId16::SPHERES,
            PrimitiveId16::PLANES,
            PrimitiveId16::NONE,
        ];
        assert!(Triangles::from_ids(&scene(), &geometry, &[0; 4], &[0; 4]).is_none());
    }
}
