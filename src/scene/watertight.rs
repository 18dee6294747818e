//! Whether meshes are closed, as bodies that light goes through must be.

use std::collections::HashMap;

use glam::DVec3;

use crate::scene::{Material, Mesh, Scene};

impl Mesh {
    /// The volume of a closed mesh: above 0 where its triangles wind counterclockwise seen from
    /// outside, below 0 where clockwise.
    ///
    /// # Panics
    /// When a triangle names a vertex that is not there.
    pub fn volume(&self) -> f64 {
        // About its middle, so that an open mesh has a sensible sign and a far one keeps its digits.
        let middle = self.bounds().center();
        let six = |triangle: &[u32; 3]| {
            let [a, b, c] =
                triangle.map(|i| DVec3::from(self.positions[i as usize].map(f64::from)) - middle);
            a.cross(b).dot(c)
        };
        self.triangles.iter().map(six).sum::<f64>() / 6.0
    }

    /// At how many edges the mesh is not closed: edges at which it does not have as many triangles
    /// on one side, by the order of their corners, as on the other. Vertices count as one that are
    /// within a millionth of the mesh's size of each other: there are several for the sake of
    /// normals and textures, and programs round the poles of a sphere each by itself.
    ///
    /// # Panics
    /// When a triangle names a vertex that is not there.
    pub fn open_edges(&self) -> usize {
        let place = self.merged_vertices();
        let mut edges: Vec<([u32; 2], i8)> = Vec::with_capacity(3 * self.triangles.len());
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|i| place[i as usize]);
            for [from, to] in [[a, b], [b, c], [c, a]] {
                if from != to {
                    edges.push(if from < to { ([from, to], 1) } else { ([to, from], -1) });
                }
            }
        }
        edges.sort_unstable();
        let balance = |of: &[([u32; 2], i8)]| of.iter().map(|&(_, way)| i64::from(way)).sum();
        edges.chunk_by(|a, b| a.0 == b.0).map(balance).filter(|&sum: &i64| sum != 0).count()
    }

    /// For each vertex the first one at its place.
    fn merged_vertices(&self) -> Vec<u32> {
        let size = self.bounds();
        let near = ((size.upper - size.lower).max_element() * 1e-6).max(f64::MIN_POSITIVE);
        // A place as large as its cell lies in at most two of them along each axis.
        let cell = |p: DVec3| (p / (2.0 * near)).floor().to_array().map(|x| x as i64);
        let mut firsts: HashMap<[i64; 3], Vec<(DVec3, u32)>> = HashMap::new();
        let position = |&p: &[f32; 3]| DVec3::from(p.map(f64::from));
        (0..)
            .zip(self.positions.iter().map(position))
            .map(|(i, p)| {
                let (lower, upper) = (cell(p - near), cell(p + near));
                let found = (0..8).find_map(|corner| {
                    let key = [0, 1, 2].map(|k| [lower[k], upper[k]][corner >> k & 1]);
                    let is_near = |first: &&(DVec3, u32)| (first.0 - p).abs().max_element() <= near;
                    Some(firsts.get(&key)?.iter().find(is_near)?.1)
                });
                found.unwrap_or_else(|| {
                    firsts.entry(cell(p)).or_default().push((p, i));
                    i
                })
            })
            .collect()
    }
}

/// Says of each mesh that is to be a body, and is not closed, that it cannot be one.
pub fn open_dielectric_warnings(scene: &Scene) -> Vec<String> {
    let mut bodies: Vec<Option<&Material>> = vec![None; scene.meshes.len()];
    for instance in &scene.instances {
        let material = &scene.materials[instance.material.0 as usize];
        if material.is_dielectric() {
            bodies[instance.mesh.0 as usize].get_or_insert(material);
        }
    }
    let mut found = Vec::new();
    for (i, (mesh, body)) in scene.meshes.iter().zip(bodies).enumerate() {
        let Some(material) = body else { continue };
        let edges = mesh.open_edges();
        if edges > 0 {
            let named = |name: &str, before: &str, after: &str| match name {
                "" => String::new(),
                name => format!("{before}`{name}`{after}"),
            };
            let (mesh, glass) = (named(&mesh.name, " (", ")"), named(&material.name, " ", ""));
            found.push(format!(
                "mesh {i}{mesh} is not closed at {edges} edges, and so no body of glass: light may \
                 enter it and never leave (close it, or make its material{glass} thin)"
            ));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Instance;
    use glam::{DAffine3, Vec3};

    /// A tetrahedron, each triangle with corners of its own.
    fn tetrahedron() -> Mesh {
        let corners: [[f32; 3]; 4] = [[0.; 3], [1., 0., 0.], [0., 1., -0.], [-0., 0., 1.]];
        let faces: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        Mesh {
            name: "gem".into(),
            positions: faces.iter().flatten().map(|&i| corners[i]).collect(),
            triangles: (0..4).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
            ..Mesh::default()
        }
    }

    fn placed(mesh: Mesh, material: Material) -> Scene {
        let mut scene = Scene::default();
        let material = scene.add_material(material);
        let mesh = scene.add_mesh(mesh);
        for _ in 0..2 {
            scene.instances.push(Instance::new(mesh, DAffine3::IDENTITY, material));
        }
        scene
    }

    fn glass() -> Material {
        Material { name: "glass".into(), transmit: Vec3::ONE, ..Material::default() }
    }

    #[test]
    fn a_tetrahedron_is_closed() {
        assert_eq!(tetrahedron().open_edges(), 0);
    }

    #[test]
    fn the_volume_of_a_mesh_is_below_0_where_it_winds_inward() {
        let mut mesh = tetrahedron();
        assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-15);
        mesh.triangles.iter_mut().for_each(|triangle| triangle.reverse());
        assert!((mesh.volume() + 1.0 / 6.0).abs() < 1e-15);
    }

    #[test]
    fn corners_that_differ_by_rounding_are_one() {
        let mut mesh = tetrahedron();
        mesh.positions[3] = [1e-7, -1e-7, 0.0];
        assert_eq!(mesh.open_edges(), 0);
        mesh.positions[3] = [1e-4, 0.0, 0.0];
        assert_ne!(mesh.open_edges(), 0);
    }

    #[test]
    fn a_triangle_left_out_opens_three_edges() {
        let mut mesh = tetrahedron();
        mesh.triangles.pop();
        assert_eq!(mesh.open_edges(), 3);
    }

    #[test]
    fn a_triangle_turned_over_opens_three_edges() {
        let mut mesh = tetrahedron();
        mesh.triangles[0].reverse();
        assert_eq!(mesh.open_edges(), 3);
    }

    #[test]
    fn an_open_body_is_told_once_however_often_it_stands() {
        let mut mesh = tetrahedron();
        mesh.triangles.pop();
        let found = open_dielectric_warnings(&placed(mesh, glass()));
        assert!(found.len() == 1 && found[0].starts_with("mesh 0 (`gem`)"), "{found:?}");
        assert!(found[0].contains("3 edges") && found[0].contains("`glass` thin"), "{found:?}");
    }

    #[test]
    fn only_bodies_need_be_closed() {
        let mut mesh = tetrahedron();
        mesh.triangles.pop();
        let thin = Material { thin: true, ..glass() };
        for material in [Material::default(), thin] {
            assert_eq!(open_dielectric_warnings(&placed(mesh.clone(), material)), [""; 0]);
        }
        assert_eq!(open_dielectric_warnings(&placed(tetrahedron(), glass())), [""; 0]);
    }
}
