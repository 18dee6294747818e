//! The layers over the base of a material: a sheen, and a clearcoat over it.

use glam::{DVec3, Vec3};

use super::clearcoat::Clearcoat;
use super::hemisphere::UNIFORM_PDF;
use super::sheen::Sheen;
use crate::scene::MetallicRoughness;

/// The layers over a base. Directions are given with ωo on the side of the normal.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    clearcoat: Option<Clearcoat>,
    /// The sheen, and its colour.
    sheen: Option<(Sheen, Vec3)>,
}

impl Layers {
    /// The layers of a material whose parameters are in their ranges.
    pub fn new(params: &MetallicRoughness) -> Self {
        let clearcoat = || Clearcoat::new(params.clearcoat, params.clearcoat_roughness);
        let sheen = || (Sheen::new(params.sheen_roughness), params.sheen_color);
        Self {
            clearcoat: (params.clearcoat > 0.0).then(clearcoat),
            sheen: (params.sheen_color != Vec3::ZERO).then(sheen),
        }
    }

    /// True if there is no layer.
    pub fn is_empty(&self) -> bool {
        self.clearcoat.is_none() && self.sheen.is_none()
    }

    /// Returns f |cos θi| of the layers, for light that comes from above to above, without delta lobes.
    pub fn evaluate(&self, wo: DVec3, wi: DVec3) -> Vec3 {
        let mut sum = Vec3::ZERO;
        if let Some((sheen, color)) = &self.sheen {
            let below = self.below_clearcoat(wo).min(self.below_clearcoat(wi));
            sum += *color * (below * sheen.evaluate(wo, wi) as f32);
        }
        sum + self.evaluate_clearcoat(wo, wi)
    }

    /// Returns f |cos θi| of the clearcoat alone, of light from above the surface to above it.
    pub fn evaluate_clearcoat(&self, wo: DVec3, wi: DVec3) -> Vec3 {
        let is_above = wo.z > 0.0 && wi.z > 0.0;
        let clearcoat = self.clearcoat.as_ref().filter(|_| is_above);
        Vec3::splat(clearcoat.map_or(0.0, |clearcoat| clearcoat.evaluate(wo, wi)))
    }

    /// Returns the densities of `wi` among the samples of the clearcoat and of the sheen.
    pub fn pdf(&self, wo: DVec3, wi: DVec3) -> [f64; 2] {
        [self.clearcoat.as_ref().map_or(0.0, |clearcoat| clearcoat.pdf(wo, wi)), UNIFORM_PDF]
    }

    /// Returns the share of the light from `wo` that the clearcoat and the sheen reflect.
    pub fn albedo(&self, wo: DVec3) -> [Vec3; 2] {
        let clearcoat = self.clearcoat.as_ref().map_or(0.0, |clearcoat| clearcoat.albedo(wo));
        let sheen = |(sheen, color): (Sheen, Vec3)| color * sheen.albedo(wo);
        let sheen = self.sheen.map_or(Vec3::ZERO, sheen);
        [Vec3::splat(clearcoat), sheen * self.below_clearcoat(wo)]
    }

    /// Samples the clearcoat; `None` below the surface.
    pub fn sample_clearcoat(&self, wo: DVec3, u: [f64; 2]) -> Option<DVec3> {
        self.clearcoat.as_ref()?.sample(wo, u)
    }

    /// Returns the factor of the clearcoat's reflection if it is a delta lobe.
    pub fn clearcoat_delta(&self, wo: DVec3) -> Option<Vec3> {
        let clearcoat = self.clearcoat.as_ref().filter(|clearcoat| clearcoat.is_smooth())?;
        Some(Vec3::splat(clearcoat.albedo(wo)))
    }

    /// Returns the share of light that gets through the layers on its way between `wi` and `wo` by the
    /// base: that of the direction from which less gets through, of those above the layers
    /// (KHR_materials_sheen, albedo scaling). So the factor is the same both ways.
    pub fn transmittance(&self, wo: DVec3, wi: DVec3, is_inside: bool, is_thin: bool) -> f32 {
        let of = |share: &dyn Fn(DVec3) -> f32| {
            let o = if is_inside { 1.0 } else { share(wo) };
            // The other side of a thin surface has the same layers.
            let is_above = is_thin || (wi.z > 0.0) != is_inside;
            if is_above { o.min(share(wi)) } else { o }
        };
        of(&|w| self.below_clearcoat(w)) * of(&|w| self.below_sheen(w))
    }

    /// Returns the share of light from `wo` that gets through the layers.
    pub fn transmittance_to(&self, wo: DVec3, is_inside: bool) -> f32 {
        if is_inside { 1.0 } else { self.below_clearcoat(wo) * self.below_sheen(wo) }
    }

    fn below_clearcoat(&self, w: DVec3) -> f32 {
        self.clearcoat.as_ref().map_or(1.0, |clearcoat| 1.0 - clearcoat.albedo(w))
    }

    fn below_sheen(&self, w: DVec3) -> f32 {
        self.sheen.map_or(1.0, |(sheen, color)| 1.0 - color.max_element() * sheen.albedo(w))
    }
}
