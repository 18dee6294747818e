//! The test for watertight meshes, as those of dielectrics must be, and the volume of a mesh.
//!
//! ```
//! use envers::scene::Mesh;
//!
//! let tetrahedron = Mesh {
//!     positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].into(),
//!     triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
//!     ..Mesh::default()
//! };
//! assert_eq!(tetrahedron.open_edges(), 0);
//! ```

use std::cmp::Ordering;
use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use crate::scene::{GRAIN, Material, Mesh, Scene};

impl Mesh {
    /// The volume of a closed mesh: above 0 if its triangles wind counterclockwise seen from outside,
    /// below 0 if clockwise.
    ///
    /// # Panics
    /// When a triangle has the index of no vertex.
    pub fn volume(&self) -> f64 {
        // Relative to the centre, so that an open mesh has a sensible sign and a far one keeps its
        // digits.
        let center = self.bounds().center();
        let six_volumes = |triangle: &[u32; 3]| {
            let [a, b, c] = self.corners(triangle).map(|p| p - center);
            a.cross(b).dot(c)
        };
        self.triangles.iter().map(six_volumes).sum::<f64>() / 6.0
    }

    /// The number of edges at which the mesh is not closed: which it does not have as often in one
    /// direction, by the order of the triangles' vertices, as in the other. Vertices within a millionth
    /// of the mesh's size of each other count as one: there are several for the sake of normals and
    /// textures, and programs round the poles of a sphere separately.
    ///
    /// # Panics
    /// When a triangle has the index of no vertex.
    pub fn open_edges(&self) -> usize {
        let merged = self.merged_vertices();
        let mut edges: Vec<([u32; 2], i8)> = Vec::with_capacity(3 * self.triangles.len());
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|i| merged[i as usize]);
            for [from, to] in [[a, b], [b, c], [c, a]] {
                if from != to {
                    edges.push(if from < to { ([from, to], 1) } else { ([to, from], -1) });
                }
            }
        }
        edges.sort_unstable();
        let balance = |same: &[([u32; 2], i8)]| same.iter().map(|&(_, sign)| i64::from(sign)).sum();
        edges.chunk_by(|a, b| a.0 == b.0).map(balance).filter(|&sum: &i64| sum != 0).count()
    }

    /// True if the mesh is closed: it has triangles, and no [open edge](Mesh::open_edges). In a mesh of
    /// more than 65536 triangles or vertices only vertices at exactly one position count as one, so that
    /// this takes little memory.
    ///
    /// # Panics
    /// When a triangle has the index of no vertex.
    pub fn is_closed(&self) -> bool {
        /// The most triangles, and vertices, of a mesh whose vertices are merged.
        const MAX_MERGED: usize = 1 << 16;
        let count = self.triangles.len().max(self.positions.len());
        !self.triangles.is_empty()
            && (self.edges_cancel_exactly() || count <= MAX_MERGED && self.open_edges() == 0)
    }

    /// True if each edge comes as often in one direction as in the other, by the positions of its
    /// vertices. Edges are told apart by a hash of 64 bits: that they cancel by chance does not happen.
    fn edges_cancel_exactly(&self) -> bool {
        let key = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
        let hash = |edge: [[u64; 3]; 2]| {
            edge.as_flattened().iter().fold(0u64, |hash, &bits| mix(hash.wrapping_add(bits)))
        };
        let sum = |triangles: &[[u32; 3]]| {
            triangles.iter().fold(0u64, |sum, triangle| {
                let [a, b, c] = self.corners(triangle).map(key);
                [[a, b], [b, c], [c, a]].into_iter().fold(sum, |sum, [from, to]| {
                    match from.cmp(&to) {
                        Ordering::Less => sum.wrapping_add(hash([from, to])),
                        Ordering::Equal => sum,
                        Ordering::Greater => sum.wrapping_sub(hash([to, from])),
                    }
                })
            })
        };
        self.triangles.par_chunks(GRAIN).map(sum).reduce(|| 0, u64::wrapping_add) == 0
    }

    /// For each vertex the index of the first one at its position, to within a millionth of the size.
    fn merged_vertices(&self) -> Vec<u32> {
        let near = (self.bounds().size().max_element() * 1e-6).max(f64::MIN_POSITIVE);
        // A grid whose cells are as large as the neighbourhood of a point, which then overlaps at most
        // two of them along each axis.
        let cell = |p: DVec3| (p / (2.0 * near)).floor().to_array().map(|x| x as i64);
        let mut firsts: HashMap<[i64; 3], Vec<(DVec3, u32)>> = HashMap::new();
        (0..)
            .zip(self.positions.iter())
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

/// Mixes the bits of a number: a step of SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom
/// number generators", 2014).
fn mix(bits: u64) -> u64 {
    let z = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Warns of each dielectric mesh that is not closed.
pub fn open_dielectric_warnings(scene: &Scene) -> Vec<String> {
    // The dielectric material of each mesh that has one in any instance.
    let mut dielectrics: Vec<Option<&Material>> = vec![None; scene.meshes.len()];
    for instance in &scene.instances {
        let material = &scene.materials[instance.material.0 as usize];
        if material.is_dielectric() {
            dielectrics[instance.mesh.0 as usize].get_or_insert(material);
        }
    }
    let mut found = Vec::new();
    for (i, (mesh, material)) in scene.meshes.iter().zip(dielectrics).enumerate() {
        let Some(material) = material else { continue };
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

    fn two_instances(mesh: Mesh, material: Material) -> Scene {
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
        assert!(tetrahedron().edges_cancel_exactly() && tetrahedron().is_closed());
        assert!(!Mesh::default().is_closed());
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
        let mut move_last = |to: [f64; 3]| {
            mesh.positions = mesh.positions.map(|i, p| if i == 3 { to.into() } else { p });
            mesh.open_edges()
        };
        assert_eq!(move_last([1e-7, -1e-7, 0.0]), 0);
        assert_ne!(move_last([1e-4, 0.0, 0.0]), 0);
    }

    #[test]
    fn a_mesh_whose_corners_differ_by_rounding_is_closed() {
        let mut mesh = tetrahedron();
        mesh.positions =
            mesh.positions.map(|i, p| if i == 3 { DVec3::new(1e-7, -1e-7, 0.0) } else { p });
        assert!(!mesh.edges_cancel_exactly() && mesh.is_closed());
    }

    #[test]
    fn a_triangle_left_out_opens_three_edges() {
        let mut mesh = tetrahedron();
        mesh.triangles.pop();
        assert_eq!(mesh.open_edges(), 3);
        assert!(!mesh.is_closed());
    }

    #[test]
    fn a_triangle_turned_over_opens_three_edges() {
        let mut mesh = tetrahedron();
        mesh.triangles[0].reverse();
        assert_eq!(mesh.open_edges(), 3);
        assert!(!mesh.is_closed());
    }

    #[test]
    fn an_open_dielectric_is_warned_of_once_for_all_its_instances() {
        let mut mesh = tetrahedron();
        mesh.triangles.pop();
        let found = open_dielectric_warnings(&two_instances(mesh, glass()));
        assert!(found.len() == 1 && found[0].starts_with("mesh 0 (`gem`)"), "{found:?}");
        assert!(found[0].contains("3 edges") && found[0].contains("`glass` thin"), "{found:?}");
    }

    #[test]
    fn only_dielectrics_need_be_closed() {
        let mut mesh = tetrahedron();
        mesh.triangles.pop();
        let thin = Material { thin: true, ..glass() };
        for material in [Material::default(), thin] {
            assert_eq!(open_dielectric_warnings(&two_instances(mesh.clone(), material)), [""; 0]);
        }
        assert_eq!(open_dielectric_warnings(&two_instances(tetrahedron(), glass())), [""; 0]);
    }
}
