//! glTF's physically based materials as BSDFs.
//!
//! The model is that of the glTF 2.0 specification, appendix B, with its extensions for materials. From
//! the top: a clearcoat, a sheen, and a base that mixes a metal and a dielectric, which covers what is
//! diffuse or transmitted. Each layer takes from those below what it reflects by itself, so that no
//! material sends on more light than it receives (albedo scaling, as KHR_materials_sheen has it), and
//! light paths can be reversed. Only the surface's own scattering is here: absorption within volumes is
//! [`transmittance`](crate::shading::transmittance).

mod base;
mod clearcoat;
mod energy;
mod fresnel;
mod ggx;
mod hemisphere;
mod iridescence;
mod layers;
mod lobes;
mod opaque;
mod reflection;
mod refraction;
mod sheen;
mod table;
// They do not depend on the backend: one run of the tests is enough.
#[cfg(all(test, feature = "embree"))]
mod tests;

use glam::{DVec3, Vec3};

use self::base::Base;
use self::hemisphere::{sample_cosine, sample_uniform};
use self::layers::Layers;
pub use self::lobes::LobeAlbedos;
pub use self::opaque::{OpaqueBsdf, OpaqueBsdf16};
use crate::scene::MetallicRoughness;

/// The number of lobes that are sampled.
const LOBES: usize = 6;

/// The least share of samples of a lobe that sends on any light: no sample has then much more weight than
/// others.
const MIN_SHARE: f32 = 0.05;

/// A lobe of a BSDF: a part that is sampled by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Lobe {
    Reflection,
    Diffuse,
    Refraction,
    DiffuseTransmission,
    Clearcoat,
    Sheen,
}

const ALL_LOBES: [Lobe; LOBES] = [
    Lobe::Reflection,
    Lobe::Diffuse,
    Lobe::Refraction,
    Lobe::DiffuseTransmission,
    Lobe::Clearcoat,
    Lobe::Sheen,
];

/// The bidirectional scattering distribution function of a surface at one point.
///
/// Directions have length 1, point away from the surface and are in the local frame: z is the normal, on
/// the outside of a volume, and x the tangent. ωo is where light goes, ωi where it comes from. A thin
/// surface is alike on both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Bsdf {
    base: Base,
    layers: Layers,
    is_thin: bool,
    /// The cosine and the sine of the angle from the tangent to the direction of more roughness.
    rotation: [f64; 2],
}

/// A direction sampled from a BSDF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// The direction to where the light comes from.
    pub wi: DVec3,
    /// f |cos θi|, or the factor of a delta lobe.
    pub value: Vec3,
    /// The density for each steradian, or the probability of a delta lobe.
    pub pdf: f64,
    /// True if the lobe has this one direction.
    pub is_delta: bool,
    /// True if the light comes through the surface.
    pub is_transmission: bool,
}

/// A pair of directions in the frame in which ωo is on the side of the normal and roughness is greatest
/// along x.
#[derive(Clone, Copy)]
struct Frame {
    wo: DVec3,
    /// True if ωo is within a volume.
    is_inside: bool,
}

impl Bsdf {
    /// The BSDF of a material in a medium with index of refraction `outside`. Parameters out of their
    /// ranges are taken as the nearest that are not.
    pub fn new(params: &MetallicRoughness, outside: f32) -> Self {
        let params = params.in_range();
        let (sin, cos) = f64::from(params.anisotropy_rotation).sin_cos();
        Self {
            base: Base::new(&params, outside),
            layers: Layers::new(&params),
            is_thin: params.is_thin,
            rotation: [cos, sin],
        }
    }

    /// Returns f(ωo, ωi) |cos θi|, without delta lobes.
    pub fn evaluate(&self, wo: DVec3, wi: DVec3) -> Vec3 {
        if wo.z == 0.0 || wi.z == 0.0 {
            return Vec3::ZERO;
        }
        let Frame { wo: o, is_inside } = self.frame(wo);
        let i = self.in_frame(wi, wo);
        let base = self.base.evaluate(o, i, is_inside);
        let mut sum = base * self.layers.transmittance(o, i, is_inside, self.is_thin);
        if i.z > 0.0 && !is_inside {
            sum += self.layers.evaluate(o, i);
        }
        sum
    }

    /// Returns the density with which [`sample`](Self::sample) returns `wi`, for each steradian, without
    /// delta lobes.
    pub fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wo.z == 0.0 || wi.z == 0.0 {
            return 0.0;
        }
        let frame = self.frame(wo);
        self.pdf_in_frame(frame, self.in_frame(wi, wo), &self.shares(frame))
    }

    fn pdf_in_frame(&self, frame: Frame, wi: DVec3, shares: &[f32; LOBES]) -> f64 {
        let base = self.base.pdf(frame.wo, wi, frame.is_inside);
        let is_above = wi.z > 0.0 && !frame.is_inside;
        let [clearcoat, sheen] = if is_above { self.layers.pdf(frame.wo, wi) } else { [0.0; 2] };
        let densities = [
            base.reflection,
            base.diffuse,
            base.refraction,
            base.diffuse_transmission,
            clearcoat,
            sheen,
        ];
        shares.iter().zip(densities).map(|(share, density)| f64::from(*share) * density).sum()
    }

    /// Samples where light that goes to `wo` comes from: `u_lobe` chooses the lobe and `u` the direction
    /// within it, all in \[0, 1). `None` where the sample has no light.
    pub fn sample(&self, wo: DVec3, u_lobe: f64, u: [f64; 2]) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let frame = self.frame(wo);
        let shares = self.shares(frame);
        let (lobe, share, rest) = choose(&shares, u_lobe)?;
        let Frame { wo: o, is_inside } = frame;
        // Refraction takes one of the colours where it disperses them.
        let is_split = lobe == Lobe::Refraction && self.base.is_dispersive();
        let channel = if is_split { ((rest * 3.0) as usize).min(2) } else { 1 };
        let i = match lobe {
            Lobe::Reflection => self.base.sample_reflection(o, u)?,
            Lobe::Refraction => self.base.sample_refraction(o, channel, u, is_inside)?,
            Lobe::Diffuse => sample_cosine(u),
            Lobe::DiffuseTransmission => base::mirror(sample_cosine(u)),
            Lobe::Clearcoat => self.layers.sample_clearcoat(o, u)?,
            Lobe::Sheen => sample_uniform(u),
        };
        let delta = self.delta_factor(lobe, frame, i);
        let (value, pdf) = match delta {
            Some(factor) if is_split => (only(factor, channel), f64::from(share) / 3.0),
            Some(factor) => (factor, f64::from(share)),
            None => {
                let value = self.evaluate(wo, self.out_of_frame(i, wo));
                (value, self.pdf_in_frame(frame, i, &shares))
            }
        };
        let sample = BsdfSample {
            wi: self.out_of_frame(i, wo),
            value,
            pdf,
            is_delta: delta.is_some(),
            is_transmission: i.z < 0.0,
        };
        (pdf > 0.0 && i.z != 0.0).then_some(sample)
    }

    /// Returns the share of the light from `wo` that the surface reflects and transmits, from tables and
    /// without integration. Where a sheen or a clearcoat covers the base it is up to what light loses in
    /// them on its way in, and through rough boundaries of volumes what is lost by reflecting often.
    pub fn albedo(&self, wo: DVec3) -> Vec3 {
        self.sampled_albedos(self.frame(wo)).into_iter().sum()
    }

    /// Returns the albedo of each lobe that is sampled.
    fn sampled_albedos(&self, Frame { wo, is_inside }: Frame) -> [Vec3; LOBES] {
        let below = self.layers.transmittance_to(wo, is_inside);
        let base = self.base.albedo(wo, is_inside);
        let [clearcoat, sheen] = if is_inside { [Vec3::ZERO; 2] } else { self.layers.albedo(wo) };
        [
            base.reflection * below,
            base.diffuse * below,
            base.refraction * below,
            base.diffuse_transmission * below,
            clearcoat,
            sheen,
        ]
    }

    /// Returns the probability with which each lobe is sampled.
    fn shares(&self, frame: Frame) -> [f32; LOBES] {
        let mut shares = self.sampled_albedos(frame).map(Vec3::max_element);
        // What is scattered often is sampled as if it were diffuse.
        let [reflected, transmitted] = self.base.multiple_albedo(frame.wo, frame.is_inside);
        shares[Lobe::Diffuse as usize] += reflected.max_element();
        shares[Lobe::DiffuseTransmission as usize] += transmitted.max_element();
        let sum: f32 = shares.iter().sum();
        let shares = shares.map(|share| if share > 0.0 { share.max(sum * MIN_SHARE) } else { 0.0 });
        let sum: f32 = shares.iter().sum();
        shares.map(|share| if sum > 0.0 { share / sum } else { 0.0 })
    }

    /// Returns the factor of a lobe if it is a delta lobe.
    fn delta_factor(&self, lobe: Lobe, Frame { wo, is_inside }: Frame, wi: DVec3) -> Option<Vec3> {
        let below = || self.layers.transmittance(wo, wi, is_inside, self.is_thin);
        match lobe {
            Lobe::Reflection if self.base.is_smooth() => {
                Some(self.base.mirror_factor(wo, is_inside) * below())
            }
            Lobe::Refraction if self.base.refracts_sharply() => {
                Some(self.base.refraction_factor(wo, is_inside) * below())
            }
            Lobe::Clearcoat => self.layers.clearcoat_delta(wo),
            _ => None,
        }
    }

    /// The frame of ωo.
    fn frame(&self, wo: DVec3) -> Frame {
        Frame { wo: self.in_frame(wo, wo), is_inside: !self.is_thin && wo.z < 0.0 }
    }

    /// Takes a direction into the frame of `wo`.
    fn in_frame(&self, w: DVec3, wo: DVec3) -> DVec3 {
        let [cos, sin] = self.rotation;
        let z = if wo.z < 0.0 { -w.z } else { w.z };
        DVec3::new(cos * w.x + sin * w.y, cos * w.y - sin * w.x, z)
    }

    /// Takes a direction out of the frame of `wo`.
    fn out_of_frame(&self, w: DVec3, wo: DVec3) -> DVec3 {
        let [cos, sin] = self.rotation;
        let z = if wo.z < 0.0 { -w.z } else { w.z };
        DVec3::new(cos * w.x - sin * w.y, cos * w.y + sin * w.x, z)
    }
}

/// Chooses a lobe by a number in \[0, 1); also returns its share, and what is left of the number, in
/// \[0, 1\].
fn choose(shares: &[f32; LOBES], u: f64) -> Option<(Lobe, f32, f64)> {
    let mut before = 0.0;
    let mut chosen = None;
    for (lobe, &share) in ALL_LOBES.into_iter().zip(shares) {
        if share > 0.0 && (chosen.is_none() || u >= before) {
            chosen = Some((lobe, share, ((u - before) / f64::from(share)).clamp(0.0, 1.0)));
        }
        before += f64::from(share);
    }
    chosen
}

/// Returns one colour of three.
fn only(color: Vec3, channel: usize) -> Vec3 {
    let mut one = Vec3::ZERO;
    one[channel] = color[channel];
    one
}
