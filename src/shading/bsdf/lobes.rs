//! The albedos of a BSDF's lobes, for integrators that look up the light of each lobe as a whole, instead of
//! sampling it.

use glam::{DVec3, Vec3};

use super::{Bsdf, Frame};

/// The shares of the light from one direction that the lobes of a BSDF send on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LobeAlbedos {
    /// The share that the microfacets of the base reflect, without that of a transmissive base.
    pub reflection: Vec3,
    /// The share that is reflected diffusely.
    pub diffuse: Vec3,
    /// The share that is transmitted diffusely.
    pub diffuse_transmission: Vec3,
    /// The share that the clearcoat reflects.
    pub clearcoat: Vec3,
    /// The share that the sheen reflects.
    pub sheen: Vec3,
    /// The share of a transmissive base: Fresnel's law reflects a part of it and transmits the rest, by the
    /// indices of refraction of both sides.
    pub transmissive: f32,
    /// The colour of what is transmitted.
    pub transmission_color: Vec3,
}

impl LobeAlbedos {
    /// Interpolates between these albedos, at `t` = 0, and others, at 1.
    pub fn lerp(&self, other: &Self, t: f32) -> Self {
        Self {
            reflection: self.reflection.lerp(other.reflection, t),
            diffuse: self.diffuse.lerp(other.diffuse, t),
            diffuse_transmission: self.diffuse_transmission.lerp(other.diffuse_transmission, t),
            clearcoat: self.clearcoat.lerp(other.clearcoat, t),
            sheen: self.sheen.lerp(other.sheen, t),
            transmissive: self.transmissive + (other.transmissive - self.transmissive) * t,
            transmission_color: self.transmission_color,
        }
    }
}

impl Bsdf {
    /// Samples the normal of a microfacet of the base that is visible from `wo`, and on its side of the surface; the
    /// surface's normal if it is smooth.
    pub fn sample_microfacet(&self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        let frame = self.frame(wo);
        self.out_of_frame(self.base.sample_microfacet(frame.wo, u), wo)
    }

    /// Samples the direction to where light comes from that the microfacets of the base mirror to `wo`, by the
    /// normals that are visible from there; `None` where it would come from below the surface.
    pub fn sample_reflection(&self, wo: DVec3, u: [f64; 2]) -> Option<DVec3> {
        let frame = self.frame(wo);
        let wi = self.base.sample_reflection(frame.wo, u)?;
        Some(self.out_of_frame(wi, wo))
    }

    /// Returns f |cos θi| of the clearcoat alone, without a delta lobe. It is the same about the normal, so that any
    /// frame of its own will do.
    pub fn evaluate_clearcoat(&self, wo: DVec3, wi: DVec3) -> Vec3 {
        self.layers.evaluate_clearcoat(wo, wi)
    }

    /// Returns the albedos of the lobes for light from `wo`.
    pub fn lobe_albedos(&self, wo: DVec3) -> LobeAlbedos {
        let Frame { wo, is_inside } = self.frame(wo);
        let below = self.layers.transmittance_to(wo, is_inside);
        let [reflection, diffuse, diffuse_transmission] = self.base.opaque_albedo(wo);
        let [clearcoat, sheen] = if is_inside { [Vec3::ZERO; 2] } else { self.layers.albedo(wo) };
        let (transmissive, transmission_color) = self.base.transmissive();
        LobeAlbedos {
            reflection: reflection * below,
            diffuse: diffuse * below,
            diffuse_transmission: diffuse_transmission * below,
            clearcoat,
            sheen,
            transmissive: transmissive * below,
            transmission_color,
        }
    }
}
