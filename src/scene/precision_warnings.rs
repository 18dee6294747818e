//! The warnings about lost precision: detail that is too fine for its distance from the origin.
//!
//! ```
//! use envers::scene::precision_warnings;
//! use envers::scene::{MaterialId, Scene, Sphere};
//! use glam::DVec3;
//!
//! let mut scene = Scene::default();
//! scene.spheres.push(Sphere::new(DVec3::X * 1e15, 0.1, MaterialId(0)));
//! let warnings = precision_warnings(&scene);
//! assert!(warnings[0].message.starts_with("sphere 0 stands too far from the origin"));
//! ```

use rayon::prelude::*;

use crate::scene::{GRAIN, Mesh, Positions, Scene};

/// The relative spacing of f32 numbers, in which glTF files store meshes.
const F32_SPACING: f64 = f32::EPSILON as f64;

/// A warning about an object whose detail is lost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PrecisionWarning {
    /// The warning, in one sentence.
    pub message: String,
}

/// Warns of lost detail: one warning for each kind of loss, about the object that loses most.
///
/// The detail of a mesh is the square root of its triangles' mean area, that of a sphere its
/// radius. It is lost where it is finer than
/// - the spacing of f32 at the mesh's own coordinates, if its positions are in f32 ([`Positions`]);
/// - the spacing of f64 at the object's coordinates, in the world or in the mesh.
pub fn precision_warnings(scene: &Scene) -> Vec<PrecisionWarning> {
    let mesh_bounds = scene.mesh_bounds();
    if scene.bounds_with(&mesh_bounds).is_empty() {
        return Vec::new();
    }
    let meshes = || scene.meshes.iter().zip(&mesh_bounds);
    let details: Vec<f64> = meshes().map(|(mesh, _)| mesh_detail(mesh)).collect();
    let mut warnings = Vec::new();
    let mut warn = |message: Option<String>| {
        warnings.extend(message.map(|message| PrecisionWarning { message }));
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
    warn(message);

    // What f64 cannot resolve, in a mesh's own space or in world space.
    let spheres = scene.spheres.iter().enumerate().map(|(i, s)| Loss {
        object: format!("sphere {i}"),
        detail: s.radius,
        extent: s.center.abs().max_element(),
    });
    let instances = scene.instances.iter().enumerate().map(|(i, instance)| {
        let mesh = instance.mesh.0 as usize;
        // The mean scale; exact where it is the same along all axes.
        let scale = instance.transform.matrix3.determinant().abs().cbrt();
        Loss {
            object: format!("instance {i} (mesh `{}`)", scene.meshes[mesh].name),
            detail: details[mesh] * scale,
            extent: instance.transform.translation.abs().max_element(),
        }
    });
    let lost = worst(spheres.chain(instances).chain(stored(false)), f64::EPSILON);
    let message = lost.map(|Loss { object, detail, extent }| {
        format!(
            "{object} stands too far from the origin: it has detail of about {detail:.1e} at \
             coordinates of {extent:.1e}, where f64 has lost it"
        )
    });
    warn(message);
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
    use crate::scene::{Instance, MaterialId, Sphere};
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

    #[test]
    fn detail_of_any_size_is_kept_beside_what_is_large() {
        for size in [0.01, 1.4e-4, 1e-9] {
            let mut scene = scene(size, 0.0, DAffine3::IDENTITY);
            scene.spheres.push(Sphere::new(DVec3::ZERO, 0.5, MaterialId(0)));
            assert_eq!(precision_warnings(&scene), []);
        }
    }

    #[test]
    fn a_mesh_far_from_its_own_origin_is_lost_in_its_file() {
        let found = precision_warnings(&scene(0.1, 1e6, DAffine3::IDENTITY));
        assert!(
            found.len() == 1 && found[0].message.contains("f32, in which the file"),
            "{found:?}"
        );
        assert_eq!(precision_warnings(&scene(0.1, 1e5, DAffine3::IDENTITY)), []);
    }

    #[test]
    fn a_mesh_in_f64_is_lost_only_where_f64_has_lost_it() {
        let placed = |away: f64| {
            let mut scene = scene(0.1, 0.0, DAffine3::IDENTITY);
            let mesh = std::sync::Arc::make_mut(&mut scene.meshes[0]);
            mesh.positions = mesh.positions.map(|_, p| p + DVec3::X * away);
            precision_warnings(&scene)
        };
        assert_eq!(placed(5412345.7), []);
        assert!(placed(1e15 + 0.125)[0].message.contains("f64 has lost it"));
    }

    #[test]
    fn what_stands_too_far_out_for_f64_is_named() {
        let far = DAffine3::from_translation(DVec3::X * 1e15);
        let found = precision_warnings(&scene(0.1, 0.0, far));
        assert!(found.len() == 1 && found[0].message.contains("f64 has lost it"), "{found:?}");
        let mut scene = Scene::default();
        scene.spheres.push(Sphere::new(DVec3::X * 1e15, 0.1, MaterialId(0)));
        assert!(precision_warnings(&scene)[0].message.starts_with("sphere 0 "));
    }

    #[test]
    fn a_scene_of_planes_has_no_detail_to_lose() {
        assert_eq!(precision_warnings(&Scene::default()), []);
    }
}
