//! What the rays of a wave see of the pictures on surfaces.

use crate::geometry::{Hit, Ray};
use crate::integrator::counts::FeatureCounts;
use crate::integrator::{Integrator, Wave};
use crate::scene::{FilmSettings, RayGenerator, ShadingParams};
use crate::surface::{self, Footprint, RayCone, Surface, TextureContext};

/// How wide the rays from the eye are.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelCone {
    /// The width of a sample on a plane one unit of the ray's t away, and where it starts.
    width: [f64; 2],
}

impl PixelCone {
    /// Of the rays of a film. A pixel's samples share its square.
    pub fn of(rays: &RayGenerator, film: &FilmSettings) -> Self {
        let most = film.adaptive.map_or(film.spp, |adaptive| adaptive.max);
        let share = 1.0 / f64::from(most).sqrt();
        Self { width: rays.pixel_size().map(|width| width * share) }
    }
}

impl Integrator<'_> {
    /// The cone of a ray from the eye.
    pub(super) fn cone(&self, ray: &Ray) -> RayCone {
        self.lens.map_or(RayCone::default(), |PixelCone { width: [slope, width] }| RayCone {
            width: width as f32,
            spread: (slope / ray.direction.length()) as f32,
        })
    }

    /// The cone of what a surface sends on of one that met it after a `length`. That glass makes it
    /// wider or narrower is left out.
    pub(super) fn cone_onward(
        &self,
        cone: &RayCone,
        length: f64,
        surface: &Surface,
        is_refracted: bool,
    ) -> RayCone {
        if self.lens.is_none() {
            return *cone;
        }
        let bend = if is_refracted { 0.0 } else { surface::curvature(self.scene, surface) };
        cone.onward(length, bend)
    }

    /// What the material that `ray` hit does with light there.
    pub(super) fn finish_at(
        &self,
        ray: &Ray,
        hit: &Hit,
        surface: &Surface,
        cone: &RayCone,
    ) -> ShadingParams {
        let look = &self.looks[surface.material.0 as usize];
        if !self.has_details || !self.details.are_asked(look, hit) {
            return look.finish;
        }
        let area = self.lens.map(|_| footprint(ray, hit, surface, cone));
        let place = [surface.position, surface.geometric_normal];
        let detail = TextureContext::new(self.scene, hit, place, look.is_textured, area.as_ref());
        surface::shading_params(
            self.scene,
            &self.scene.materials[surface.material.0 as usize],
            &detail,
        )
    }

    /// The detail of what ray `i` of a wave hit.
    pub(super) fn detail(
        &self,
        wave: &Wave,
        i: usize,
        hit: &Hit,
        surface: &Surface,
        work: &mut FeatureCounts,
    ) -> TextureContext {
        let look = &self.looks[surface.material.0 as usize];
        let area = self.lens.filter(|_| look.is_textured).map(|_| {
            work.mipmaps += 1;
            let ray = wave.rays.ray(i);
            let cone = wave.paths.get(i).map_or_else(|| self.cone(&ray), |path| path.cone);
            footprint(&ray, hit, surface, &cone)
        });
        let place = [surface.position, surface.geometric_normal];
        TextureContext::new(self.scene, hit, place, look.is_textured, area.as_ref())
    }
}

/// How much of a surface a ray with this cone sees.
fn footprint(ray: &Ray, hit: &Hit, surface: &Surface, cone: &RayCone) -> Footprint {
    let length = ray.direction.length();
    let width = cone.at(hit.t * length);
    Footprint::new(ray.direction / length, surface.geometric_normal, width)
}
