//! The validity checks of a scene, which all scenes pass before they are rendered.
//!
//! ```
//! use envers::Scene;
//!
//! let mut scene = Scene::default();
//! scene.film.max_depth = 65_537;
//! let error = scene.check().unwrap_err();
//! assert_eq!(error.message(), "max_depth must be at most 65536, found 65537");
//! ```

mod camera;
mod environment;
mod film;
mod light;
mod material;
mod require;
mod shape;
mod texture;

pub use film::{MAX_DEPTH, MAX_OCCLUSION_RAYS, MAX_SPP, check_samples, check_size};

pub(in crate::scene) use require::require;

use crate::error::Result;
use crate::geometry::Bounds;
use crate::scene::{Material, Scene};

/// The greatest absolute coordinate in world space: Embree ignores what lies beyond 1.8e18, and
/// f32 products of coordinates must stay finite.
pub const MAX_COORDINATE: f64 = 1e15;

impl Scene {
    /// Checks that all numbers are finite and in range, and all indices valid; everything else relies on
    /// this.
    ///
    /// # Errors
    /// The first condition that does not hold, with the object's index.
    pub fn check(&self) -> Result<()> {
        film::check(&self.film)?;
        let textures = self.textures.len();
        let mut materials = self.materials.iter().enumerate();
        materials.try_for_each(|(i, material)| material::check(i, material, textures))?;
        (0..self.spheres.len()).try_for_each(|i| self.check_sphere(i))?;
        (0..self.planes.len()).try_for_each(|i| self.check_plane(i))?;
        (0..self.meshes.len()).try_for_each(|i| self.check_mesh(i))?;
        // An animated instance may be flat at one time, and is then left out.
        let moved = self
            .animation
            .as_ref()
            .map(|animation| animation.moved_instances())
            .unwrap_or_default();
        (0..self.instances.len()).try_for_each(|i| self.check_instance(i, moved.contains(&i)))?;
        self.check_textures()?;
        check_extent(&self.bounds())?;
        self.environment.iter().try_for_each(environment::check)?;
        self.check_lights_and_cameras()?;
        self.animation.iter().try_for_each(|animation| animation.check(self))
    }

    /// Checks the textures; an image need not have been read if no material in use has it as a texture.
    fn check_textures(&self) -> Result<()> {
        let mut in_use = vec![false; self.textures.len()];
        let maps = self.materials_in_use().flat_map(Material::textures);
        maps.for_each(|map| in_use[map.0 as usize] = true);
        let mut textures = self.textures.iter().zip(in_use).enumerate();
        textures.try_for_each(|(i, (texture, is_in_use))| texture::check(i, texture, is_in_use))
    }

    /// Checks lights and cameras, which are cheap to check.
    pub(in crate::scene) fn check_lights_and_cameras(&self) -> Result<()> {
        self.lights.iter().enumerate().try_for_each(|(i, light)| light::check(i, light))?;
        self.cameras.iter().enumerate().try_for_each(|(i, camera)| camera::check(i, camera))
    }
}

/// Checks that no coordinate within these bounds is beyond [`MAX_COORDINATE`].
pub(in crate::scene) fn check_extent(bounds: &Bounds) -> Result<()> {
    let extent = bounds.max_abs();
    require(extent <= MAX_COORDINATE, || {
        format!("the scene reaches out to {extent:e}, beyond the {MAX_COORDINATE:e} supported")
    })
}
