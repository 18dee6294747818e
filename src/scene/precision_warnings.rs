//! Detail that numbers cannot hold: what is too small for how large the scene is, or for how far
//! from 0 it stands.

use rayon::prelude::*;

use crate::geometry::Bounds;
use crate::scene::{GRAIN, Instance, Mesh, Scene};

/// The greatest ratio of the longest side of the scene's box to the detail of a mesh that precision
/// `fast` supports on Embree.
///
/// Its f32 rays may be off by 40 · 2⁻²⁴ = 1 / 420,000 of that side (`intersect/embree/frame.rs`
/// derives it), so that finer detail could not be told apart at all; but already where triangles
/// are larger some rays meet a neighbour instead. Measured on a ball at the end of its scene, the
/// share of rays that do is 1.2e-5 at a ratio of 1e3, 7.6e-5 at 1e4, 1.5e-3 at 1e5 and 1.5e-2 at
/// 1e6; `fast` promises 1e-4.
pub const FAST_RATIO: f64 = 1e4;
/// The spacing of f32 numbers, in which meshes are stored, in units of the number.
const F32_SPACING: f64 = f32::EPSILON as f64;

/// Something whose detail is lost: a sentence for each kind of loss, about the object that loses
/// most.
///
/// The detail of a mesh is the square root of its triangles' mean area, that of a sphere its
/// radius. It is lost where it is finer than
/// - with `f32_rays`, as on Embree in precision `fast`: the longest side of the scene's box over
///   [`FAST_RATIO`] (meshes only);
/// - the spacing of f32 at the mesh's own coordinates, since files and scenes store meshes in f32;
/// - the spacing of f64 at the object's coordinates in the world.
pub fn precision_warnings(scene: &Scene, f32_rays: bool) -> Vec<String> {
    let mesh_bounds = scene.mesh_bounds();
    let bounds = scene.bounds_with(&mesh_bounds);
    if bounds.is_empty() {
        return Vec::new();
    }
    let meshes: Vec<MeshDetail> = scene
        .meshes
        .iter()
        .zip(&mesh_bounds)
        .map(|(mesh, bounds)| MeshDetail::new(mesh, bounds))
        .collect();
    let extent = bounds.size().max_element();
    let mut found = Vec::new();

    let in_file = meshes.iter().zip(&scene.meshes).map(|(grain, mesh)| Loss {
        object: format!("mesh `{}`", mesh.name),
        detail: grain.detail,
        against: grain.max_coordinate,
    });
    found.extend(worst(in_file, F32_SPACING).map(|Loss { object: what, detail, against }| {
        format!(
            "{what} stands too far from its file's origin: its triangles are about {detail:.1e} \
             large at coordinates of {against:.1e}, where f32, in which meshes are stored, has \
             lost them (ratio {:.1e}, supported up to {:.1e}); model it about the origin and \
             translate it",
            against / detail,
            1.0 / F32_SPACING
        )
    }));

    let placed = |instance: &Instance| {
        let grain = &meshes[instance.mesh.0 as usize];
        // The mean stretch; exact where it is the same along all axes.
        grain.detail * instance.transform.matrix3.determinant().abs().cbrt()
    };
    let name = |i: usize, instance: &Instance| {
        let mesh = &scene.meshes[instance.mesh.0 as usize].name;
        format!("instance {i} (mesh `{mesh}`)")
    };
    let instances = || {
        scene.instances.iter().enumerate().map(|(i, instance)| Loss {
            object: name(i, instance),
            detail: placed(instance),
            against: extent,
        })
    };
    if f32_rays {
        found.extend(worst(instances(), 1.0 / FAST_RATIO).map(|Loss { object: what, detail, against }| {
            format!(
                "{what} is fine for so large a scene: its triangles are about {detail:.1e} large \
                 in {against:.1e} (ratio {:.1e}, supported up to {FAST_RATIO:.0e} in precision \
                 fast on Embree), so that more than one ray in 10,000 may meet a neighbour of \
                 the triangle in its way; --precision certified has no such limit",
                against / detail
            )
        }));
    }

    let spheres = scene.spheres.iter().enumerate().map(|(i, s)| Loss {
        object: format!("sphere {i}"),
        detail: s.radius,
        against: s.center.abs().max_element(),
    });
    let in_world = instances().zip(&scene.instances).map(|(loss, instance)| Loss {
        against: instance.transform.translation.abs().max_element(),
        ..loss
    });
    found.extend(worst(spheres.chain(in_world), f64::EPSILON).map(|loss| {
        format!(
            "{} stands too far from the origin: it has detail of about {:.1e} at coordinates of \
             {:.1e}, where f64 has lost it",
            loss.object, loss.detail, loss.against
        )
    }));
    found
}

/// A detail, and what it is small against.
struct Loss {
    object: String,
    detail: f64,
    against: f64,
}

/// The one with the least detail, if that is below `share` of what it is held against.
fn worst(all: impl Iterator<Item = Loss>, share: f64) -> Option<Loss> {
    all.filter(|loss| loss.detail > 0.0 && loss.detail < share * loss.against)
        .min_by(|a, b| (a.detail / a.against).total_cmp(&(b.detail / b.against)))
}

/// How fine a mesh is, in its own space.
struct MeshDetail {
    /// The square root of the mean area of its triangles; 0 when all are degenerate.
    detail: f64,
    /// Its largest absolute coordinate.
    max_coordinate: f64,
}

impl MeshDetail {
    fn new(mesh: &Mesh, bounds: &Bounds) -> Self {
        let area = |t: &[u32; 3]| {
            let corners = t.map(|i| glam::DVec3::from(mesh.positions[i as usize].map(f64::from)));
            0.5 * crate::geometry::triangle::area_normal(corners).length()
        };
        // Parts that are added up in order: the same sum on any number of threads.
        let parts: Vec<f64> =
            mesh.triangles.par_chunks(GRAIN).map(|part| part.iter().map(area).sum()).collect();
        let detail = (parts.iter().sum::<f64>() / mesh.triangles.len().max(1) as f64).sqrt();
        Self { detail, max_coordinate: if bounds.is_empty() { 0.0 } else { bounds.max_abs() } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{MaterialId, Sphere};
    use glam::{DAffine3, DVec3};

    /// A triangle with legs of `size`, `away` along its own x axis, placed by `transform`.
    fn scene(size: f32, away: f32, transform: DAffine3) -> Scene {
        let mut scene = Scene::default();
        let mesh = scene.add_mesh(Mesh {
            name: "speck".into(),
            positions: vec![[away, 0., 0.], [away, size, 0.], [away, 0., size]],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        });
        scene.instances.push(Instance::new(mesh, transform, MaterialId(0)));
        scene
    }

    fn beside_a_ball(size: f32) -> Scene {
        let mut scene = scene(size, 0.0, DAffine3::IDENTITY);
        scene.spheres.push(Sphere::new(DVec3::ZERO, 0.5, MaterialId(0)));
        scene
    }

    #[test]
    fn an_ordinary_scene_loses_nothing() {
        assert_eq!(precision_warnings(&beside_a_ball(0.01), true), [""; 0]);
    }

    #[test]
    fn a_speck_in_a_large_scene_is_lost_to_f32_rays_only() {
        // The square root of the area is 1 / √2 of the legs.
        let scene = beside_a_ball(1.4e-4);
        let found = precision_warnings(&scene, true);
        assert!(found.len() == 1 && found[0].contains("instance 0 (mesh `speck`)"), "{found:?}");
        assert!(found[0].contains("--precision certified"), "{found:?}");
        assert_eq!(precision_warnings(&scene, false), [""; 0]);
        assert_eq!(precision_warnings(&beside_a_ball(1.5e-4), true), [""; 0]);
    }

    #[test]
    fn a_mesh_far_from_its_own_origin_is_lost_in_its_file() {
        let found = precision_warnings(&scene(0.1, 1e6, DAffine3::IDENTITY), false);
        assert!(found.len() == 1 && found[0].contains("f32, in which meshes"), "{found:?}");
        assert_eq!(precision_warnings(&scene(0.1, 1e5, DAffine3::IDENTITY), false), [""; 0]);
    }

    #[test]
    fn what_stands_too_far_out_for_f64_is_named() {
        let far = DAffine3::from_translation(DVec3::X * 1e15);
        let found = precision_warnings(&scene(0.1, 0.0, far), false);
        assert!(found.len() == 1 && found[0].contains("f64 has lost it"), "{found:?}");
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::X * 1e15, 0.1, MaterialId(0)));
        assert!(precision_warnings(&scene, false)[0].starts_with("sphere 0 "));
    }

    #[test]
    fn a_scene_of_planes_has_no_detail_to_lose() {
        assert_eq!(precision_warnings(&Scene::default(), true), [""; 0]);
    }
}
