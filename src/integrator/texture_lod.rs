//! The level of detail of textures: the cones of rays, and the footprints that they leave.

use crate::geometry::{Hit, Ray};
use crate::scene::{FilmSettings, RayGenerator, Scene};
use crate::surface::{self, Footprint, RayCone, Surface};

/// The width of camera rays, if the scene has textures with mipmaps.
#[derive(Clone, Copy, Debug)]
pub(super) struct TextureLod(Option<CameraCone>);

/// The width of a sample in world units.
#[derive(Clone, Copy, Debug)]
struct CameraCone {
    /// The widening for each unit of a ray's `t`.
    spread: f64,
    /// The width where a ray starts.
    width: f64,
}

impl TextureLod {
    /// Returns the level of detail for the camera rays of a film, if `has_mipmaps`. The samples of a
    /// pixel share its square.
    pub fn new(has_mipmaps: bool, camera: &RayGenerator, film: &FilmSettings) -> Self {
        let most_samples = film.adaptive.map_or(film.spp, |adaptive| adaptive.max);
        let share = 1.0 / f64::from(most_samples).sqrt();
        let [spread, width] = camera.pixel_size().map(|width| width * share);
        Self(has_mipmaps.then_some(CameraCone { spread, width }))
    }

    /// True if footprints are needed.
    pub fn is_needed(&self) -> bool {
        self.0.is_some()
    }

    /// Returns the cone of a camera ray.
    pub fn camera_cone(&self, ray: &Ray) -> RayCone {
        self.0.map_or(RayCone::default(), |CameraCone { spread, width }| RayCone {
            width: width as f32,
            spread: (spread / ray.direction.length()) as f32,
        })
    }

    /// Returns the cone of a ray that a surface sends on, of a ray with this cone that hit it after
    /// a `length`. The change of its width by refraction is left out.
    pub fn spawned_cone(
        &self,
        cone: &RayCone,
        length: f64,
        scene: &Scene,
        surface: &Surface,
        is_refracted: bool,
    ) -> RayCone {
        if !self.is_needed() {
            return *cone;
        }
        let curvature = if is_refracted { 0.0 } else { surface::curvature(scene, surface) };
        cone.spawn(length, curvature)
    }

    /// Returns the footprint of a ray with this cone on the surface that it hit, if any is needed.
    pub fn footprint(
        &self,
        ray: &Ray,
        hit: &Hit,
        surface: &Surface,
        cone: &RayCone,
    ) -> Option<Footprint> {
        self.is_needed().then(|| {
            let length = ray.direction.length();
            let width = cone.width_at(hit.t * length);
            Footprint::new(ray.direction / length, surface.geometric_normal, width)
        })
    }
}
