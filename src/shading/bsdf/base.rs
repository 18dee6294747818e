//! The base of a material, below clearcoat and sheen: a mixture of a metal and a dielectric.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::fresnel::Fresnel;
use super::ggx::reflect;
use super::hemisphere::cosine_pdf;
use super::reflection::{Microfacets, Reflection, multiple_factor};
use super::refraction::{Refraction, refract};
use crate::scene::MetallicRoughness;

/// The side of the boundary of a volume on which ωo is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Glass {
    /// The refraction to the other side.
    refraction: Refraction,
    /// The factor of light that is reflected more than once.
    multiple: Vec3,
}

/// The base of a material (glTF 2.0, B.2): `mix(dielectric_brdf, metal_brdf, metallic)`. All directions
/// are given with ωo on the side of the normal, whichever side of the surface that is.
///
/// The dielectric is itself a mixture of one that transmits (KHR_materials_transmission) and one with a
/// diffuse base. Appendix B takes 1 − F(ωo·h) of such a base, so that together they reflect more light
/// than arrives at grazing angles; here the base gets what the reflection leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct Base {
    pub(super) microfacets: Microfacets,
    pub(super) color: Vec3,
    pub(super) conductor: Reflection,
    pub(super) dielectric: Reflection,
    /// The shares of the metal, the diffuse dielectric and the transmissive dielectric.
    pub(super) metal: f32,
    pub(super) diffuse: f32,
    pub(super) transmissive: f32,
    /// The share of the diffuse light that is transmitted, and its colour.
    pub(super) diffuse_transmission: f32,
    diffuse_transmission_color: Vec3,
    /// Both sides of the boundary of a volume, the outside first; `None` for a thin surface, and where nothing is
    /// transmitted.
    glass: Option<[Glass; 2]>,
}

/// The lobes of a base, each with the light that it sends to ωo, or part of it.
pub struct BaseLobes<T> {
    /// A reflection off microfacets.
    pub reflection: T,
    /// A diffuse reflection.
    pub diffuse: T,
    /// The light that is refracted.
    pub refraction: T,
    /// The light that is transmitted in all directions.
    pub diffuse_transmission: T,
}

impl Base {
    /// The base of a material whose parameters are in their ranges, in a medium of this index of
    /// refraction.
    pub fn new(params: &MetallicRoughness, outside: f32) -> Self {
        let microfacets = Microfacets::new(params.roughness, params.anisotropy);
        let reflection = |fresnel: Fresnel| {
            let MetallicRoughness { iridescence, iridescence_ior, iridescence_thickness, .. } =
                *params;
            let film =
                fresnel.with_film(outside, iridescence_ior, iridescence_thickness, iridescence);
            Reflection::new(&microfacets, film)
        };
        let (specular, color) = (params.specular, params.specular_color);
        let MetallicRoughness { metallic, transmission, .. } = *params;
        let dielectric = if metallic < 1.0 {
            reflection(Fresnel::dielectric(outside, params.ior, specular, color))
        } else {
            Reflection::none()
        };
        let conductor = if metallic > 0.0 {
            reflection(Fresnel::conductor(params.base_color))
        } else {
            Reflection::none()
        };
        // With an index of 0 everything is reflected; what is not goes straight through.
        let inside = if params.ior == 0.0 { outside } else { params.ior };
        let reflectance = dielectric.mean_reflectance;
        let glass = |refraction: Refraction| {
            let mean = refraction.mean_reflectance(reflectance);
            Glass { refraction, multiple: multiple_factor(&microfacets.energy, mean) }
        };
        let refraction = Refraction::new(outside, inside, params.dispersion);
        let transmissive = (1.0 - metallic) * transmission;
        let has_volume = !params.is_thin && transmissive > 0.0;
        Self {
            microfacets,
            color: params.base_color,
            conductor,
            dielectric,
            metal: metallic,
            diffuse: (1.0 - metallic) * (1.0 - transmission),
            transmissive,
            diffuse_transmission: params.diffuse_transmission,
            diffuse_transmission_color: params.diffuse_transmission_color,
            glass: has_volume.then(|| [glass(refraction), glass(refraction.reversed())]),
        }
    }

    /// True if its reflection is a delta lobe.
    pub fn is_smooth(&self) -> bool {
        self.microfacets.ggx.is_none()
    }

    /// True if its refraction is a delta lobe.
    pub fn refracts_sharply(&self) -> bool {
        match &self.glass {
            None => self.is_smooth(),
            Some([glass, _]) => glass.refraction.blur(self.microfacets.ggx).is_none(),
        }
    }

    /// The side of the volume's boundary on which ωo is, if there is a volume.
    fn side(&self, is_inside: bool) -> Option<&Glass> {
        self.glass.as_ref().map(|sides| &sides[usize::from(is_inside)])
    }

    /// Returns the reflectance of microfacets by the cosine to them.
    fn reflectance(&self, cosine: f64, is_inside: bool) -> Vec3 {
        let dielectric = self.dielectric.fresnel.at(cosine);
        let glass = match self.side(is_inside) {
            Some(side) if self.transmissive > 0.0 => {
                side.refraction.reflectance(&self.dielectric.fresnel, cosine)
            }
            _ => dielectric,
        };
        let metal = if self.metal > 0.0 { self.conductor.fresnel.at(cosine) } else { Vec3::ZERO };
        metal * self.metal + dielectric * self.diffuse + glass * self.transmissive
    }

    /// The factor of light that is reflected more than once.
    fn multiple(&self, is_inside: bool) -> Vec3 {
        let glass = self.side(is_inside).map_or(self.dielectric.multiple, |side| side.multiple);
        self.conductor.multiple * self.metal
            + self.dielectric.multiple * self.diffuse
            + glass * self.transmissive
    }

    /// Returns f |cos θi| of all lobes but delta lobes.
    pub fn evaluate(&self, wo: DVec3, wi: DVec3, is_inside: bool) -> Vec3 {
        if wi.z > 0.0 {
            self.evaluate_reflection(wo, wi, is_inside)
        } else {
            self.evaluate_transmission(wo, wi, is_inside)
        }
    }

    fn evaluate_reflection(&self, wo: DVec3, wi: DVec3, is_inside: bool) -> Vec3 {
        let mut sum = Vec3::ZERO;
        if !self.is_smooth() {
            let (once, cosine) = self.microfacets.single(wo, wi);
            sum += self.reflectance(cosine, is_inside) * once as f32;
            sum += self.multiple(is_inside) * self.microfacets.multiple(wo, wi) as f32;
        }
        let diffuse = self.diffuse * (1.0 - self.diffuse_transmission);
        if diffuse > 0.0 {
            let factor = self.dielectric.base_factor(&self.microfacets, wo, wi) * diffuse;
            sum += self.color * (factor * cosine_pdf(wi) as f32);
        }
        sum
    }

    fn evaluate_transmission(&self, wo: DVec3, wi: DVec3, is_inside: bool) -> Vec3 {
        let mut sum = Vec3::ZERO;
        if self.transmissive > 0.0 {
            sum += self.color * self.transmissive * self.refracted(wo, wi, is_inside);
        }
        let diffuse = self.diffuse * self.diffuse_transmission;
        if diffuse > 0.0 {
            let factor = self.dielectric.base_factor(&self.microfacets, wo, wi) * diffuse;
            sum += self.diffuse_transmission_color * (factor * (wi.z.abs() / PI) as f32);
        }
        sum
    }

    /// Returns f |cos θi| of what is refracted by a clear base that is all transmissive.
    fn refracted(&self, wo: DVec3, wi: DVec3, is_inside: bool) -> Vec3 {
        let fresnel = &self.dielectric.fresnel;
        match self.side(is_inside) {
            Some(Glass { refraction, .. }) => match refraction.blur(self.microfacets.ggx) {
                Some(ggx) => refraction.evaluate(&ggx, fresnel, wo, wi),
                None => Vec3::ZERO,
            },
            // Microfacets on both faces blur what is seen through a thin surface like a reflection.
            None => {
                let mirrored = mirror(wi);
                let (once, cosine) = self.microfacets.single(wo, mirrored);
                let single = once as f32 * (1.0 - fresnel.at(cosine).max_element());
                let multiple = self.microfacets.multiple(wo, mirrored) as f32;
                Vec3::splat(single + self.thin_multiple() * multiple)
            }
        }
    }

    /// Returns the densities of `wi` among the directions that each lobe samples; 0 for delta lobes.
    pub fn pdf(&self, wo: DVec3, wi: DVec3, is_inside: bool) -> BaseLobes<f64> {
        let cosine = cosine_pdf(wi);
        if wi.z > 0.0 {
            let reflection = self.microfacets.pdf(wo, wi);
            let [refraction, diffuse_transmission] = [0.0; 2];
            return BaseLobes { reflection, diffuse: cosine, refraction, diffuse_transmission };
        }
        let refraction = match self.side(is_inside) {
            Some(Glass { refraction, .. }) => {
                let ggx = refraction.blur(self.microfacets.ggx);
                ggx.map_or(0.0, |ggx| refraction.pdf(&ggx, wo, wi))
            }
            None => self.microfacets.pdf(wo, mirror(wi)),
        };
        BaseLobes { reflection: 0.0, diffuse: 0.0, refraction, diffuse_transmission: cosine }
    }

    /// Samples the normal of a visible microfacet.
    pub fn sample_microfacet(&self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        self.microfacets.ggx.map_or(DVec3::Z, |ggx| ggx.sample(wo, u))
    }

    /// Samples the reflection off microfacets; `None` below the surface.
    pub fn sample_reflection(&self, wo: DVec3, u: [f64; 2]) -> Option<DVec3> {
        let wi = match &self.microfacets.ggx {
            Some(ggx) => reflect(wo, ggx.sample(wo, u)),
            None => mirror(-wo),
        };
        (wi.z > 0.0).then_some(wi)
    }

    /// Samples the refraction of one colour; `None` above the surface, or where all is reflected.
    pub fn sample_refraction(
        &self,
        wo: DVec3,
        channel: usize,
        u: [f64; 2],
        is_inside: bool,
    ) -> Option<DVec3> {
        let wi = match self.side(is_inside) {
            None => mirror(self.sample_reflection(wo, u)?),
            Some(Glass { refraction, .. }) => {
                let ggx = refraction.blur(self.microfacets.ggx);
                let h = ggx.map_or(DVec3::Z, |ggx| ggx.sample(wo, u));
                refract(wo, h, refraction.eta(channel))?
            }
        };
        (wi.z < 0.0).then_some(wi)
    }

    /// True if each colour is refracted in its own direction.
    pub fn is_dispersive(&self) -> bool {
        self.glass.as_ref().is_some_and(|[glass, _]| glass.refraction.is_dispersive())
    }

    /// Returns the light from ωo that each lobe sends on.
    pub fn albedo(&self, wo: DVec3, is_inside: bool) -> BaseLobes<Vec3> {
        let energy = &self.microfacets.energy;
        let dielectric = self.dielectric.albedo(&self.microfacets, wo);
        let metal = self.conductor.albedo(&self.microfacets, wo);
        let strongest = self.dielectric.strongest_albedo(&self.microfacets, wo);
        let (glass, strongest_glass) = match self.side(is_inside) {
            Some(side) if self.transmissive > 0.0 => {
                let fresnel = &self.dielectric.fresnel;
                let once = match self.is_smooth() {
                    true => side.refraction.reflectance(fresnel, wo.z),
                    false => energy.albedo_of(wo, &side.refraction.reflectances(fresnel)),
                };
                let rest = (1.0 - energy.moments(wo).all).max(0.0);
                let glass = (once + side.multiple * rest).min(Vec3::ONE);
                (glass, glass.max_element())
            }
            _ => (dielectric, strongest),
        };
        let base = self.diffuse * (1.0 - strongest);
        let through = self.transmissive * (1.0 - strongest_glass);
        BaseLobes {
            reflection: metal * self.metal + dielectric * self.diffuse + glass * self.transmissive,
            diffuse: self.color * (base * (1.0 - self.diffuse_transmission)),
            refraction: self.color * through,
            diffuse_transmission: self.diffuse_transmission_color
                * (base * self.diffuse_transmission),
        }
    }

    /// Returns the light from ωo that the base reflects at its microfacets, without that of its transmissive
    /// share, and the light of its diffuse part, reflected and transmitted.
    pub fn opaque_albedo(&self, wo: DVec3) -> [Vec3; 3] {
        let mut reflected = Vec3::ZERO;
        if self.metal > 0.0 {
            reflected += self.conductor.albedo(&self.microfacets, wo) * self.metal;
        }
        if self.diffuse == 0.0 {
            return [reflected, Vec3::ZERO, Vec3::ZERO];
        }
        let dielectric = self.dielectric.albedo(&self.microfacets, wo);
        reflected += dielectric * self.diffuse;
        let strongest = match self.dielectric.fresnel.schlick() {
            Some(_) => dielectric.max_element(),
            None => self.dielectric.strongest_albedo(&self.microfacets, wo),
        };
        let rest = self.diffuse * (1.0 - strongest);
        let transmitted = rest * self.diffuse_transmission;
        let color = self.diffuse_transmission_color;
        [reflected, self.color * (rest - transmitted), color * transmitted]
    }

    /// The share of the transmissive dielectric, and its colour.
    pub fn transmissive(&self) -> (f32, Vec3) {
        (self.transmissive, self.color)
    }

    /// Returns the light from ωo that is reflected and transmitted after more than one reflection.
    pub fn multiple_albedo(&self, wo: DVec3, is_inside: bool) -> [Vec3; 2] {
        let rest = (1.0 - self.microfacets.energy.moments(wo).all).max(0.0);
        let is_thin = self.glass.is_none();
        let through = if is_thin { self.thin_multiple() * self.transmissive } else { 0.0 };
        [self.multiple(is_inside) * rest, self.color * (through * rest)]
    }

    /// The factor of light that a thin surface transmits after more than one reflection: what is not
    /// reflected then.
    fn thin_multiple(&self) -> f32 {
        1.0 - self.dielectric.multiple.max_element()
    }

    /// Returns the factor of a delta reflection.
    pub fn mirror_factor(&self, wo: DVec3, is_inside: bool) -> Vec3 {
        self.reflectance(wo.z, is_inside)
    }

    /// Returns the factors of a delta refraction by colour.
    pub fn refraction_factor(&self, wo: DVec3, is_inside: bool) -> Vec3 {
        self.albedo(wo, is_inside).refraction
    }
}

#[cfg(all(test, feature = "embree"))]
impl Base {
    /// Returns f |cos θi| of what is reflected more than once, in red.
    pub fn multiple_part(&self, wo: DVec3, wi: DVec3) -> f64 {
        f64::from(self.multiple(false).x) * self.microfacets.multiple(wo, wi)
    }
}

/// Returns a direction mirrored at the surface.
pub fn mirror(w: DVec3) -> DVec3 {
    DVec3::new(w.x, w.y, -w.z)
}
