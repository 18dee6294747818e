//! Triangles side by side.

use glam::DVec3;

use crate::geometry::PrimitiveId16;
use crate::scene::Scene;

/// The corners of `W` triangles in world space: corner, axis, lane. Where there is no triangle they
/// are all at one point.
#[repr(C, align(64))]
pub struct Triangles<const W: usize>([[[f64; W]; 3]; 3]);

impl<const W: usize> Triangles<W> {
    /// The triangles among what these codes of [`PrimitiveId16`] name; `None` where there is none.
    ///
    /// # Panics
    /// When one is not in the scene.
    #[inline(always)]
    pub fn from_ids(
        scene: &Scene,
        geometry: &[u32; W],
        primitive: &[u32; W],
        instance: &[u32; W],
    ) -> Option<Self> {
        let mut local = [[[0.0f32; W]; 3]; 3];
        let mut first = None;
        let mut alike = true;
        for i in 0..W {
            if geometry[i] < PrimitiveId16::MESHES {
                continue;
            }
            let mesh = &scene.meshes[(geometry[i] - PrimitiveId16::MESHES) as usize];
            let corners = mesh.triangle_vertices(primitive[i]);
            for (to, p) in local.iter_mut().zip(corners) {
                for axis in 0..3 {
                    to[axis][i] = p[axis];
                }
            }
            alike &= *first.get_or_insert(instance[i]) == instance[i];
        }
        let first = first?;
        let mut world = [[[0.0; W]; 3]; 3];
        // Nearly always all stand in one instance, whose transform then is the same for all.
        let placed = &scene.instances[first as usize];
        for (to, from) in world.iter_mut().zip(&local) {
            for i in 0..W {
                let p = placed.to_world([from[0][i], from[1][i], from[2][i]]);
                for axis in 0..3 {
                    to[axis][i] = p[axis];
                }
            }
        }
        if !alike {
            for i in 0..W {
                if geometry[i] < PrimitiveId16::MESHES {
                    continue;
                }
                let placed = &scene.instances[instance[i] as usize];
                for (to, from) in world.iter_mut().zip(&local) {
                    let p = placed.to_world([from[0][i], from[1][i], from[2][i]]);
                    for axis in 0..3 {
                        to[axis][i] = p[axis];
                    }
                }
            }
        }
        Some(Self(world))
    }

    /// The corners in lane `i`.
    #[inline(always)]
    pub fn vertices(&self, i: usize) -> [DVec3; 3] {
        let corner = |c: usize| DVec3::new(self.0[c][0][i], self.0[c][1][i], self.0[c][2][i]);
        [corner(0), corner(1), corner(2)]
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

    /// The codes of three triangles and, third, of nothing.
    fn faces(instances: [u32; 4], triangles: [u32; 4]) -> Option<Triangles<4>> {
        let geometry = [
            PrimitiveId16::MESHES,
            PrimitiveId16::MESHES,
            PrimitiveId16::NONE,
            PrimitiveId16::MESHES,
        ];
        Triangles::from_ids(&scene(), &geometry, &triangles, &instances)
    }

    #[test]
    fn corners_are_those_of_the_scene_whatever_the_instances() {
        for instances in [[1, 1, 0, 1], [0, 1, 0, 0]] {
            let triangles = [2, 0, 0, 1];
            let faces = faces(instances, triangles).unwrap();
            for i in [0, 1, 3] {
                let id = PrimitiveId::triangle(0, triangles[i], instances[i]);
                assert_eq!(faces.vertices(i), scene().triangle_vertices(id));
            }
        }
    }

    #[test]
    fn without_triangles_there_are_no_faces() {
        let geometry = [
            PrimitiveId16::NONE,
            PrimitiveId16::SPHERES,
            PrimitiveId16::PLANES,
            PrimitiveId16::NONE,
        ];
        assert!(Triangles::from_ids(&scene(), &geometry, &[0; 4], &[0; 4]).is_none());
    }
}
