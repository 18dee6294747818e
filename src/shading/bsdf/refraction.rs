//! Refraction through rough and smooth boundaries of volumes (Walter et al., 2007).

use glam::{DVec3, Vec3};

use super::fresnel::{COSINES, Fresnel};
use super::ggx::{Ggx, MIN_ALPHA};
use super::table::at_node;
use crate::shading::indices_by_color;

/// The least α |η − 1| of a boundary that blurs what is seen through it.
const MIN_BLUR: f64 = MIN_ALPHA / 4.0;

/// The refraction from one side of a boundary to the other, with an index of refraction for each colour.
///
/// Light is carried as elsewhere in envers: radiance is not scaled by n². So
/// f(ωo, ωi) no² = f(ωi, ωo) ni² for the indices on the sides of ωo and ωi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refraction {
    /// ni/no for red, green and blue: the index on the other side divided by that on the side of ωo.
    eta: [f64; 3],
}

impl Refraction {
    /// The refraction from the outside to the inside, with KHR_materials_dispersion.
    pub fn new(outside: f32, inside: f32, dispersion: f32) -> Self {
        let inside = indices_by_color(f64::from(inside), dispersion);
        Self { eta: inside.map(|index| index / f64::from(outside)) }
    }

    /// The refraction the other way.
    pub fn reversed(self) -> Self {
        Self { eta: self.eta.map(f64::recip) }
    }

    /// The relative index of a colour: 0 is red.
    pub fn eta(&self, channel: usize) -> f64 {
        self.eta[channel]
    }

    /// True if colours are refracted apart.
    pub fn is_dispersive(&self) -> bool {
        self.eta[0] != self.eta[2]
    }

    /// The distribution by which light is blurred; `None` where the boundary is smooth, or bends so
    /// little that nothing is seen of its roughness.
    pub fn blur(&self, ggx: Option<Ggx>) -> Option<Ggx> {
        let is_bent =
            |ggx: &Ggx| self.eta.iter().all(|eta| ggx.max_alpha() * (eta - 1.0).abs() > MIN_BLUR);
        ggx.filter(is_bent)
    }

    /// Returns the reflectance of microfacets by the cosine on the side of ωo. Schlick's formula takes
    /// that in the thinner medium; beyond the critical angle all is reflected.
    pub fn reflectance(&self, fresnel: &Fresnel, cosine: f64) -> Vec3 {
        let of = |channel: usize| {
            thin_cosine(cosine, self.eta[channel]).map_or(Vec3::ONE, |cosine| fresnel.at(cosine))
        };
        if self.is_dispersive() { Vec3::new(of(0).x, of(1).y, of(2).z) } else { of(1) }
    }

    /// Returns the same at evenly spread cosines from 0 to 1.
    pub fn reflectances(&self, fresnel: &Fresnel) -> [Vec3; COSINES] {
        std::array::from_fn(|k| self.reflectance(fresnel, at_node(k, COSINES)))
    }

    /// Returns the share of a colour that a microfacet lets through, by the cosine on the side of ωo:
    /// what is left of the colour that is reflected most.
    pub fn transmittance(&self, fresnel: &Fresnel, cosine: f64, channel: usize) -> f32 {
        let cosine = thin_cosine(cosine, self.eta[channel]);
        cosine.map_or(0.0, |cosine| 1.0 - fresnel.at(cosine).max_element())
    }

    /// Returns the mean transmittance over all directions, given the mean reflectance in the thinner
    /// medium: from the denser side less goes through, by the square of the indices.
    pub fn mean_reflectance(&self, in_thinner: Vec3) -> Vec3 {
        let square = self.eta.map(|eta| (eta * eta).min(1.0) as f32);
        Vec3::ONE - (Vec3::ONE - in_thinner) * Vec3::from(square)
    }

    /// Returns what the boundary transmits from `wi` to `wo`, f |cos θi| (Walter et al., 2007, equation
    /// 21). `wo` is on the side of the normal and `wi` on the other.
    pub fn evaluate(&self, ggx: &Ggx, fresnel: &Fresnel, wo: DVec3, wi: DVec3) -> Vec3 {
        let of = |channel: usize| {
            let Some(facet) = Facet::between(wo, wi, self.eta[channel]) else { return 0.0 };
            let transmittance = self.transmittance(fresnel, facet.cosine, channel);
            let blurred = 4.0 * ggx.density(facet.normal) * ggx.visibility(wo, wi);
            transmittance * (blurred * facet.cosine * facet.spread) as f32
        };
        if self.is_dispersive() { Vec3::new(of(0), of(1), of(2)) } else { Vec3::splat(of(1)) }
    }

    /// Returns the density of `wi` among the directions that are sampled.
    pub fn pdf(&self, ggx: &Ggx, wo: DVec3, wi: DVec3) -> f64 {
        let of = |channel: usize| {
            let facet = Facet::between(wo, wi, self.eta[channel]);
            facet.map_or(0.0, |facet| ggx.visible_density(wo, facet.normal) * facet.spread)
        };
        if self.is_dispersive() { (of(0) + of(1) + of(2)) / 3.0 } else { of(1) }
    }
}

/// A microfacet that refracts one direction into another.
struct Facet {
    /// The normal.
    normal: DVec3,
    /// The cosine of ωo to it.
    cosine: f64,
    /// The solid angle of normals divided by that of ωi: |ωi·h| / (ωi·h + ωo·h/η)².
    spread: f64,
}

impl Facet {
    /// Finds the microfacet by its relative index of refraction.
    fn between(wo: DVec3, wi: DVec3, eta: f64) -> Option<Self> {
        let normal = (wo + wi * eta).try_normalize()?;
        let normal = if normal.z < 0.0 { -normal } else { normal };
        let (cosine, other) = (wo.dot(normal), wi.dot(normal));
        let sum = other + cosine / eta;
        let spread = -other / (sum * sum);
        // Both directions must be on the sides of the microfacet that they are on of the surface.
        (cosine > 0.0 && other < 0.0 && spread.is_finite()).then_some(Self {
            normal,
            cosine: cosine.min(1.0),
            spread,
        })
    }
}

/// Returns the cosine on the side of the thinner medium, by that on this side and the relative index of
/// the other one; `None` beyond the critical angle.
fn thin_cosine(cosine: f64, eta: f64) -> Option<f64> {
    if eta >= 1.0 { Some(cosine) } else { refracted_cosine(cosine, eta) }
}

/// Returns the cosine of the refracted angle; `None` beyond the critical angle.
fn refracted_cosine(cosine: f64, eta: f64) -> Option<f64> {
    let square = 1.0 - (1.0 - cosine) * (1.0 + cosine) / (eta * eta);
    (square > 0.0).then(|| square.sqrt())
}

/// Returns the direction into which a boundary with normal `h` refracts `wo`, both pointing away from
/// it, by Snell's law; `None` beyond the critical angle.
pub fn refract(wo: DVec3, h: DVec3, eta: f64) -> Option<DVec3> {
    let cosine = wo.dot(h);
    let refracted = refracted_cosine(cosine, eta)?;
    Some((h * (cosine / eta - refracted) - wo / eta).normalize())
}
