//! The warnings about lost precision: detail that is too fine for the size of the scene, or for its
//! distance from the origin.
//!
//! ```
//! use envers::scene::precision_warnings;
//! use envers::scene::{MaterialId, Scene, Sphere};
//! use glam::DVec3;
//!
//! let mut scene = Scene::default();
//! scene.spheres.push(Sphere::new(DVec3::X * 1e15, 0.1, MaterialId(0)));
//! let warnings = precision_warnings(&scene, false);
//! assert!(warnings[0].message.starts_with("sphere 0 stands too far from the origin"));
//! ```

use rayon::prelude::*;

use crate::scene::{GRAIN, Instance, Mesh, Positions, Scene};

/// The greatest ratio of the longest side of the scene's box to the detail of a mesh that precision
/// `fast` supports on Embree.
///
/// Its f32 rays may be off by 40 · 2⁻²⁴ = 1 / 420,000 of that side (`intersect/embree/f32_space.rs`
/// derives it), so that finer detail could not be told apart at all; but some rays hit a neighbour
/// already where triangles are larger. Measured on a ball at the end of its scene, the share of rays
/// that do is 1.2e-5 at a ratio of 1e3, 7.6e-5 at 1e4, 1.5e-3 at 1e5 and 1.5e-2 at
/// 1e6; `fast` promises 1e-4.
pub const FAST_RATIO: f64 = 1e4;
/// The relative spacing of f32 numbers, in which glTF files store meshes.
const F32_SPACING: f64 = f32::EPSILON as f64;

/// A warning about an object whose detail is lost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PrecisionWarning {
    /// The warning, in one sentence.
    pub message: String,
    /// True if precision `certified` preserves the detail, which only f32 rays lose.
    pub is_of_fast_only: bool,
}

/// Warns of lost detail: one warning for each kind of loss, about the object that loses most.
///
/// The detail of a mesh is the square root of its triangles' mean area, that of a sphere its
/// radius. It is lost where it is finer than
/// - with `f32_rays`, as on Embree in precision `fast`: the longest side of the scene's box over
///   `FAST_RATIO` (meshes only);
/// - the spacing of f32 at the mesh's own coordinates, if its positions are in f32 ([`Positions`]);
/// - the spacing of f64 at the object's coordinates, in the world or in the mesh.
pub fn precision_warnings(scene: &Scene, f32_rays: bool) -> Vec<PrecisionWarning> {
    let mesh_bounds = scene.mesh_bounds();
    let bounds = scene.bounds_with(&mesh_bounds);
    if bounds.is_empty() {
        return Vec::new();
    }
    let meshes = || scene.meshes.iter().zip(&mesh_bounds);
    let details: Vec<f64> = meshes().map(|(mesh, _)| mesh_detail(mesh)).collect();
    let mut warnings = Vec::new();
    let mut warn = |message: Option<String>, is_of_fast_only: bool| {
        warnings.extend(message.map(|message| PrecisionWarning { message, is_of_fast_only }));
    };

    // Meshes that the numbers they are stored in cannot hold, in their own space.
    let stored = |is_f32: bool| {
        let stored = meshes().zip(&details);
        let stored =
            stored.filter(move |((m, _), _)| matches!(m.positions, Positions::F32(_)) == is_f32);
        stored.map(|((mesh, bounds), &detail)| Loss {
            object: format!("mesh `{}`", mesh.name),
            detail,
            extent: bounds.max_abs(),
        })
    };
    let message = worst(stored(true), F32_SPACING).map(|Loss { object, detail, extent }| {
        let (ratio, supported) = (extent / detail, 1.0 / F32_SPACING);
        format!(
            "{object} stands too far from its file's origin: its triangles are about {detail:.1e} \
             large at coordinates of {extent:.1e}, where f32, in which the file stores them, has \
             lost them (ratio {ratio:.1e}, supported up to {supported:.1e}); model it about the \
             origin and translate it"
        )
    });
    warn(message, false);

    // Instances that f32 rays cannot resolve in so large a scene.
    let instances = |extent: &dyn Fn(&Instance) -> f64| {
        let losses = scene.instances.iter().enumerate().map(|(i, instance)| {
            let mesh = instance.mesh.0 as usize;
            // The mean scale; exact where it is the same along all axes.
            let scale = instance.transform.matrix3.determinant().abs().cbrt();
            Loss {
                object: format!("instance {i} (mesh `{}`)", scene.meshes[mesh].name),
                detail: details[mesh] * scale,
                extent: extent(instance),
            }
        });
        losses.collect::<Vec<_>>()
    };
    if f32_rays {
        let size = bounds.size().max_element();
        let lost = worst(instances(&|_| size), 1.0 / FAST_RATIO);
        let message = lost.map(|Loss { object, detail, extent }| {
            let ratio = extent / detail;
            format!(
                "{object} is fine for so large a scene: its triangles are about {detail:.1e} large \
                 in {extent:.1e} (ratio {ratio:.1e}, supported up to {FAST_RATIO:.0e} in precision \
                 fast on Embree), so that more than one ray in 10,000 may meet a neighbour of \
                 the triangle in its way"
            )
        });
        warn(message, true);
    }

    // What f64 cannot resolve, in a mesh's own space or in world space.
    let spheres = scene.spheres.iter().enumerate().map(|(i, s)| Loss {
        object: format!("sphere {i}"),
        detail: s.radius,
        extent: s.center.abs().max_element(),
    });
    let instances = instances(&|i| i.transform.translation.abs().max_element());
    let lost = worst(spheres.chain(instances).chain(stored(false)), f64::EPSILON);
    let message = lost.map(|Loss { object, detail, extent }| {
        format!(
            "{object} stands too far from the origin: it has detail of about {detail:.1e} at \
             coordinates of {extent:.1e}, where f64 has lost it"
        )
    });
    warn(message, false);
    warnings
}

/// The detail of an object, and the extent relative to which it may be lost.
struct Loss {
    object: String,
    detail: f64,
    extent: f64,
}

/// The loss with the least detail relative to its extent, if that is below `limit`.
fn worst(losses: impl IntoIterator<Item = Loss>, limit: f64) -> Option<Loss> {
    let lost = losses.into_iter().filter(|l| l.detail > 0.0 && l.detail < limit * l.extent);
    lost.min_by(|a, b| (a.detail / a.extent).total_cmp(&(b.detail / b.extent)))
}

/// The detail of a mesh in its own space: the square root of the mean area of its triangles; 0 when
/// all are degenerate.
fn mesh_detail(mesh: &Mesh) -> f64 {
    let area =
        |t: &[u32; 3]| 0.5 * crate::geometry::triangle::area_normal(mesh.corners(t)).length();
    // Partial sums in a fixed order: the same sum on any number of threads.
    let parts: Vec<f64> =
        mesh.triangles.par_chunks(GRAIN).map(|part| part.iter().map(area).sum()).collect();
    (parts.iter().sum::<f64>() / mesh.triangles.len().max(1) as f64).sqrt()
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
            positions: vec![[away, 0., 0.], [away, size, 0.], [away, 0., size]].into(),
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
        assert_eq!(precision_warnings(&beside_a_ball(0.01), true), []);
    }

    #[test]
    fn a_speck_in_a_large_scene_is_lost_to_f32_rays_only() {
        // The square root of the area is 1 / √2 of the legs.
        let scene = beside_a_ball(1.4e-4);
        let found = precision_warnings(&scene, true);
        assert!(
            found.len() == 1 && found[0].message.contains("instance 0 (mesh `speck`)"),
            "{found:?}"
        );
        assert!(found[0].is_of_fast_only);
        assert_eq!(precision_warnings(&scene, false), []);
        assert_eq!(precision_warnings(&beside_a_ball(1.5e-4), true), []);
    }

    #[test]
    fn a_mesh_far_from_its_own_origin_is_lost_in_its_file() {
        let found = precision_warnings(&scene(0.1, 1e6, DAffine3::IDENTITY), false);
        assert!(
            found.len() == 1 && found[0].message.contains("f32, in which the file"),
            "{found:?}"
        );
        assert_eq!(precision_warnings(&scene(0.1, 1e5, DAffine3::IDENTITY), false), []);
    }

    #[test]
    fn a_mesh_in_f64_is_lost_only_where_f64_has_lost_it() {
        let placed = |away: f64| {
            let mut scene = scene(0.1, 0.0, DAffine3::IDENTITY);
            let mesh = std::sync::Arc::make_mut(&mut scene.meshes[0]);
            mesh.positions = mesh.positions.map(|_, p| p + DVec3::X * away);
            precision_warnings(&scene, false)
        };
        assert_eq!(placed(5412345.7), []);
        assert!(placed(1e15 + 0.125)[0].message.contains("f64 has lost it"));
    }

    #[test]
    fn what_stands_too_far_out_for_f64_is_named() {
        let far = DAffine3::from_translation(DVec3::X * 1e15);
        let found = precision_warnings(&scene(0.1, 0.0, far), false);
        assert!(found.len() == 1 && found[0].message.contains("f64 has lost it"), "{found:?}");
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::X * 1e15, 0.1, MaterialId(0)));
        assert!(precision_warnings(&scene, false)[0].message.starts_with("sphere 0 "));
    }

    #[test]
    fn a_scene_of_planes_has_no_detail_to_lose() {
        assert_eq!(precision_warnings(&Scene::default(), true), []);
    }
}
