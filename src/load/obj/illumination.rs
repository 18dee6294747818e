//! The mirrors and glass of MTL materials: illumination model, opacity, index of refraction and filter.

use glam::Vec3;

use crate::scene::Material;

/// The default index of refraction of glass.
const GLASS_IOR: f32 = 1.5;

/// The statements of a material about light that it does not scatter.
pub struct Illumination {
    /// The model, `illum`: from 0 to 10; 2 where missing.
    pub model: u8,
    /// The opacity, `d` or 1 − `Tr`: in \[0, 1\].
    pub opacity: f32,
    /// The colour of what passes through, `Tf`.
    pub filter: Option<Vec3>,
    /// The index of refraction, `Ni`.
    pub ior: Option<f32>,
}

impl Illumination {
    /// Sets reflection and transmission of a material, whose specular colour is its `Ks`.
    pub fn apply(&self, material: &mut Material) {
        if self.is_glass() {
            let filter = self.filter.unwrap_or(Vec3::ONE).min(Vec3::ONE);
            let fraction = if self.opacity < 1.0 { 1.0 - self.opacity } else { 1.0 };
            material.transmit = filter * fraction;
            // Model 4 lets light straight through; 6 and 7 refract it.
            material.thin = self.model == 4;
            material.ior = f64::from(self.ior.unwrap_or(GLASS_IOR).clamp(0.01, 100.0));
            return;
        }
        if matches!(self.model, 3 | 5) {
            material.reflect = material.specular.min(Vec3::ONE) * self.opacity;
        }
        if self.opacity < 1.0 {
            material.transmit = Vec3::splat(1.0 - self.opacity);
            material.thin = true;
            material.ior = 1.0;
        }
    }

    /// True if light goes through the material as through glass.
    pub fn is_glass(&self) -> bool {
        // Programs write 4 to 9 for opaque things too, and a filter of 1 for anything.
        matches!(self.model, 4 | 6 | 7) && (self.opacity < 1.0 || self.has_filter())
    }

    fn has_filter(&self) -> bool {
        self.filter.is_some_and(|filter| filter != Vec3::ZERO)
    }
}
