//! The validity checks of spheres, planes, meshes and instances.

use super::MAX_COORDINATE;
use super::require::{
    require, require_color, require_index, require_position, require_unit_length,
};
use crate::error::Result;
use crate::scene::{MaterialId, Scene};

impl Scene {
    /// Checks sphere `i`.
    pub(in crate::scene) fn check_sphere(&self, i: usize) -> Result<()> {
        let sphere = &self.spheres[i];
        require_position(|| format!("sphere {i}: center"), sphere.center)?;
        require(sphere.radius > 0.0 && sphere.radius <= MAX_COORDINATE, || {
            let found = sphere.radius;
            format!("sphere {i}: radius must be above 0 (and at most 1e15), found {found}")
        })?;
        self.check_unmasked(|| format!("sphere {i}"), sphere.material)
    }

    /// Checks plane `i`.
    pub(super) fn check_plane(&self, i: usize) -> Result<()> {
        let plane = &self.planes[i];
        require_position(|| format!("plane {i}: point"), plane.point)?;
        require_unit_length(|| format!("plane {i}: normal"), plane.normal)?;
        self.check_unmasked(|| format!("plane {i}"), plane.material)?;
        require(plane.texture_size > 0.0 && plane.texture_size.is_finite(), || {
            format!("plane {i}: texture_size must be above 0, found {}", plane.texture_size)
        })?;
        let Some(checker) = plane.checker else { return Ok(()) };
        for color in checker.colors {
            require_color(|| format!("plane {i}: checker"), color)?;
        }
        require(checker.size > 0.0 && checker.size.is_finite(), || {
            format!("plane {i}: the checker's size must be above 0, found {}", checker.size)
        })
    }

    /// Checks that the material of a sphere or plane exists and has no mask.
    fn check_unmasked(&self, label: impl Fn() -> String, material: MaterialId) -> Result<()> {
        require_index(&label, "material", material.0, self.materials.len())?;
        require(!self.materials[material.0 as usize].is_masked(), || {
            format!("{}: only meshes can have a mask", label())
        })
        .map_err(|e| e.help("blend its alpha instead"))
    }

    /// Checks mesh `i`.
    pub(in crate::scene) fn check_mesh(&self, i: usize) -> Result<()> {
        let mesh = &self.meshes[i];
        let label = format!("mesh {i} (`{}`)", mesh.name);
        let count = mesh.positions.len();
        require(mesh.positions.are_finite(), || format!("{label}: a vertex is not finite"))?;
        require(mesh.has_all_vertices(), || {
            format!("{label}: a triangle names a vertex that is not there ({count} vertices)")
        })?;
        // The optional attributes are there for every vertex, or for none.
        for (name, length) in [
            ("normals", mesh.normals.len()),
            ("uvs", mesh.uvs.len()),
            ("second uvs", mesh.second_uvs.len()),
            ("colors", mesh.colors.len()),
            ("alphas", mesh.alphas.len()),
            ("tangents", mesh.tangents.len()),
        ] {
            require(length == 0 || length == count, || {
                format!("{label}: {length} {name} for {count} vertices")
            })?;
        }
        Ok(())
    }

    /// Checks instance `i`.
    pub(in crate::scene) fn check_instance(&self, i: usize, may_be_flat: bool) -> Result<()> {
        let instance = &self.instances[i];
        let label = || format!("instance {i}");
        require_index(label, "mesh", instance.mesh.0, self.meshes.len())?;
        require_index(label, "material", instance.material.0, self.materials.len())?;
        let is_sound = instance.transform.is_finite() && (may_be_flat || !instance.is_flat());
        require(is_sound, || {
            format!("{}: its transform cannot be inverted (a scale of 0?)", label())
        })
    }
}
