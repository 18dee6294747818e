//! The options of a rendering.

use crate::film::View;
use crate::integrator::Tiling;
use crate::intersect::{Backend, BuildQuality, Precision};
use crate::scene::{Light, Scene};

/// The options of a rendering; size, samples and background are the scene's film settings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RenderOptions {
    /// The backend that finds the hits; `None` takes [`Backend::default`].
    pub backend: Option<Backend>,
    /// The precision of the hits.
    pub precision: Precision,
    /// The quality of Embree's trees; `None` chooses it by the number of rays to come.
    pub quality: Option<BuildQuality>,
    /// The number of threads; 0 means all there are.
    pub threads: usize,
    /// The index of the scene's camera.
    pub camera: usize,
    /// The view: the beauty, or a debug view.
    pub view: View,
    /// The tiles that the picture is cut into.
    pub tiling: Tiling,
}

impl RenderOptions {
    /// The backend that is chosen, or else the default.
    pub fn backend(&self) -> Backend {
        self.backend.unwrap_or_default()
    }

    /// Chooses the quality of a scene's trees, unless it is set, by the number of primary rays and their
    /// shadow rays. All frames of an animation count, also when only some are rendered: a frame must not
    /// depend on which others are.
    pub(super) fn build_quality(&self, scene: &Scene) -> BuildQuality {
        let (spp, lights) = match self.view {
            View::Beauty => {
                let lights = scene.lights.iter().filter(|light| light.casts_shadow());
                (scene.film.spp, lights.map(Light::sample_count).sum::<u32>())
            }
            _ => (1, 0),
        };
        let frames = scene.animation.as_ref().map_or(1, |animation| animation.frames);
        let [width, height] = scene.film.size;
        let factors = [width, height, spp, frames, 1 + lights];
        let rays = factors.into_iter().map(u64::from).fold(1, u64::saturating_mul);
        self.quality.unwrap_or(BuildQuality::for_rays(rays, scene.primitive_count()))
    }
}
