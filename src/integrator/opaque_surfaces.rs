//! The opaque physically based surfaces of a block, without layers and too rough to be traced: most surfaces of
//! models. They are shaded side by side, where other physically based surfaces are shaded one by one.

use glam::{DVec3, Vec3};

use crate::geometry::{LANES, Lanes};
use crate::integrator::radiance::lane;
use crate::scene::{MetallicRoughness, ray_share};
use crate::shading::{self, Bsdf, OpaqueBsdf, OpaqueBsdf16};
use crate::surface::{PbrParams, Surface16};

/// A physically based material, at one point, that is opaque, without layers and rough.
#[derive(Clone, Copy)]
pub(super) struct OpaqueMaterial {
    /// Its BSDF.
    pub bsdf: OpaqueBsdf,
    /// Its roughness.
    pub roughness: f32,
}

impl OpaqueMaterial {
    /// The material of these parameters, if it is one of these.
    pub fn new(params: &PbrParams) -> Option<Self> {
        let PbrParams { factors, alpha, .. } = params;
        let &MetallicRoughness { roughness, clearcoat, anisotropy, transmission, .. } = factors;
        // What is not is found before its BSDF is made.
        let may_be = *alpha >= 1.0
            && ray_share(roughness) == 0.0
            && clearcoat == 0.0
            && anisotropy == 0.0
            && transmission == 0.0;
        let bsdf = if may_be { Bsdf::new(factors, 1.0).opaque()? } else { return None };
        Some(Self { bsdf, roughness })
    }
}

/// The opaque ones of sixteen surfaces.
#[repr(C, align(64))]
pub(super) struct OpaqueSurfaces16 {
    /// True in each lane with such a surface.
    pub is_opaque: Lanes<bool>,
    /// Their BSDFs.
    bsdf: OpaqueBsdf16,
    /// Their roughnesses.
    roughness: Lanes<f32>,
    /// The cosines of the angles between the normals and the viewer.
    cosine: Lanes<f32>,
    /// The directions to the viewer.
    viewer: [Lanes<f32>; 3],
    /// The shares of the light that they reflect off their microfacets, and diffusely.
    albedos: [[Lanes<f32>; 3]; 2],
    /// The directions about which they reflect.
    mirrored: [Lanes<f32>; 3],
}

impl OpaqueSurfaces16 {
    /// Surfaces of one material, in all lanes or in none yet.
    pub fn new(material: &OpaqueMaterial, in_all_lanes: bool) -> Self {
        Self {
            is_opaque: [in_all_lanes; LANES],
            bsdf: OpaqueBsdf16::splat(&material.bsdf),
            roughness: [material.roughness; LANES],
            cosine: [0.0; LANES],
            viewer: [[0.0; LANES]; 3],
            albedos: [[[0.0; LANES]; 3]; 2],
            mirrored: [[0.0; LANES]; 3],
        }
    }

    /// Sets the material in one lane.
    pub fn set(&mut self, i: usize, material: &OpaqueMaterial) {
        self.is_opaque[i] = true;
        self.bsdf.set(i, &material.bsdf);
        self.roughness[i] = material.roughness;
    }

    /// Computes what follows from the surfaces' normals and the directions along which they are seen, and returns
    /// the albedos.
    #[inline(always)]
    pub fn set_viewer(
        &mut self,
        surface: &Surface16,
        incoming: &[Lanes<f64>; 3],
    ) -> [Lanes<f32>; 3] {
        let incoming = shading::normalize_lanes(incoming, &self.is_opaque);
        let mut cosine = [0.0; LANES];
        for i in 0..LANES {
            let seen = DVec3::new(incoming[0][i], incoming[1][i], incoming[2][i]);
            cosine[i] = -surface.normal(i).dot(seen) as f32;
        }
        for axis in 0..3 {
            for i in 0..LANES {
                self.viewer[axis][i] = -incoming[axis][i] as f32;
            }
        }
        self.cosine = cosine;
        self.albedos = self.bsdf.set_viewer(&cosine);
        // The rougher, the nearer to the normal (Lagarde and de Rousiers, 2014, listing 23).
        for i in 0..LANES {
            let alpha = self.roughness[i] * self.roughness[i];
            let smoothness = 1.0 - alpha;
            let share = smoothness * (smoothness.sqrt() + alpha);
            for axis in 0..3 {
                let normal = surface.normal[axis][i] as f32;
                let mirrored = 2.0 * cosine[i] * normal - self.viewer[axis][i];
                self.mirrored[axis][i] = normal + (mirrored - normal) * share;
            }
        }
        let mut all = self.albedos[0];
        for channel in 0..3 {
            for i in 0..LANES {
                all[channel][i] += self.albedos[1][channel][i];
            }
        }
        all
    }

    /// Sets, in lanes of these surfaces, the shares of light from directions of length 1, with these cosines to the
    /// normals, that goes to the viewer. Intensities are irradiances divided by π.
    #[inline(always)]
    pub fn reflect(
        &self,
        toward: &[Lanes<f64>; 3],
        cosine: &Lanes<f64>,
        share: &mut [Lanes<f32>; 3],
    ) {
        let (mut to_normal, mut to_viewer) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            to_normal[i] = cosine[i].max(0.0) as f32;
            to_viewer[i] = toward[0][i] as f32 * self.viewer[0][i]
                + toward[1][i] as f32 * self.viewer[1][i]
                + toward[2][i] as f32 * self.viewer[2][i];
        }
        let value = self.bsdf.evaluate(&to_normal, &to_viewer);
        for channel in 0..3 {
            for i in 0..LANES {
                let x = &mut share[channel][i];
                *x = if self.is_opaque[i] { value[channel][i] } else { *x };
            }
        }
    }

    /// Returns the lobes in one lane.
    #[inline(always)]
    pub fn lobes(&self, i: usize) -> OpaqueLobes {
        OpaqueLobes {
            reflection: lane(&self.albedos[0], i),
            diffuse: lane(&self.albedos[1], i),
            mirrored: lane(&self.mirrored, i),
            roughness: self.roughness[i],
            cosine: self.cosine[i].abs(),
        }
    }
}

/// The lobes of an opaque surface, whose light is looked up in a filtered environment.
pub(super) struct OpaqueLobes {
    /// The share of the light that its microfacets reflect.
    pub reflection: Vec3,
    /// The share that is reflected diffusely.
    pub diffuse: Vec3,
    /// The direction about which it reflects.
    pub mirrored: Vec3,
    /// Its roughness.
    pub roughness: f32,
    /// The cosine of the angle between its normal and the viewer.
    pub cosine: f32,
}
