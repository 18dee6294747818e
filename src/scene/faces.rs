//! Triangles side by side.

use glam::DVec3;

use crate::geometry::{Geometry, PrimitiveId};
use crate::scene::Scene;

/// The corners of `W` triangles in world space: corner, axis, lane. Where there is no triangle they
/// are all at one point.
#[repr(C, align(64))]
pub struct Faces<const W: usize>([[[f64; W]; 3]; 3]);

impl<const W: usize> Faces<W> {
    /// The triangles among `ids`; `None` where there is none.
    ///
    /// # Panics
    /// When one is not in the scene.
    #[inline(always)]
    pub fn of(scene: &Scene, ids: &[Option<PrimitiveId>; W]) -> Option<Self> {
        let mut local = [[[0.0f32; W]; 3]; 3];
        let mut first = None;
        let mut alike = true;
        for i in 0..W {
            let Some(id) = ids[i] else { continue };
            let Geometry::Mesh(mesh) = id.geometry else { continue };
            let corners = scene.meshes[mesh as usize].corners(id.primitive);
            for (to, p) in local.iter_mut().zip(corners) {
                for axis in 0..3 {
                    to[axis][i] = p[axis];
                }
            }
            alike &= *first.get_or_insert(id.instance) == id.instance;
        }
        let first = first?;
        let mut world = [[[0.0; W]; 3]; 3];
        // Nearly always all stand in one instance, whose transform then is the same for all.
        let placed = &scene.instances[first as usize];
        for (to, from) in world.iter_mut().zip(&local) {
            for i in 0..W {
                let p = placed.bake([from[0][i], from[1][i], from[2][i]]);
                for axis in 0..3 {
                    to[axis][i] = p[axis];
                }
            }
        }
        if !alike {
            for i in 0..W {
                let Some(id) = ids[i] else { continue };
                let Geometry::Mesh(_) = id.geometry else { continue };
                let placed = &scene.instances[id.instance as usize];
                for (to, from) in world.iter_mut().zip(&local) {
                    let p = placed.bake([from[0][i], from[1][i], from[2][i]]);
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
    pub fn corners(&self, i: usize) -> [DVec3; 3] {
        let corner = |c: usize| DVec3::new(self.0[c][0][i], self.0[c][1][i], self.0[c][2][i]);
        [corner(0), corner(1), corner(2)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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

    #[test]
    fn corners_are_those_of_the_scene_whatever_the_instances() {
        let scene = scene();
        let face = |t, i| Some(PrimitiveId::triangle(0, t, i));
        for ids in [[face(0, 1), None, face(2, 1), face(1, 1)], [face(0, 0), None, face(2, 1), face(1, 0)]] {
            let faces = Faces::of(&scene, &ids).unwrap();
            for (i, id) in ids.iter().enumerate().filter_map(|(i, id)| Some((i, (*id)?))) {
                assert_eq!(faces.corners(i), scene.triangle(id));
            }
        }
    }

    #[test]
    fn without_triangles_there_are_no_faces() {
        let ids = [None, Some(PrimitiveId::sphere(0)), Some(PrimitiveId::plane(0)), None];
        assert!(Faces::of(&scene(), &ids).is_none());
    }
}
