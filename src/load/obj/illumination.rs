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
    /// Reads the statements of a material, as they are.
    pub fn read(source: &tobj::Material) -> Self {
        let statement = |key: &str| source.unknown_param.get(key);
        let transparency = statement("Tr").and_then(|t| t.parse().ok()).unwrap_or(0.0f32);
        let filter = statement("Tf").map(|tf| {
            let mut numbers = tf.split_whitespace().flat_map(str::parse);
            Vec3::from_array([0; 3].map(|_| numbers.next().unwrap_or(0.0)))
        });
        Self {
            model: source.illumination_model.unwrap_or(2),
            opacity: source.dissolve.map_or(1.0 - transparency, |d| d as f32).clamp(0.0, 1.0),
            filter,
            ior: source.optical_density.map(|ior| ior as f32),
        }
    }

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
        // Programs write 4 to 9 for opaque things too.
        let is_filter = |filter: Vec3| filter != Vec3::ZERO && !self.is_idle_filter();
        matches!(self.model, 4 | 6 | 7)
            && (self.opacity < 1.0 || self.filter.is_some_and(is_filter))
    }

    /// True if the material would be glass by its filter alone, and could not be seen: a white filter
    /// changes no light, and neither does a pane, nor a body whose index of refraction is 1. Maya
    /// writes such a filter for whatever is opaque.
    pub fn is_idle_filter(&self) -> bool {
        let is_white = self.filter.is_some_and(|filter| filter.min_element() >= 1.0);
        self.opacity == 1.0 && is_white && (self.model == 4 || self.bends_nothing())
    }

    /// True if nothing of the material can be seen: all light passes straight through it.
    pub fn is_invisible(&self) -> bool {
        let is_clear = self.filter.is_none_or(|filter| filter.min_element() >= 1.0);
        self.opacity == 0.0 && (!self.is_glass() || is_clear && self.bends_nothing())
    }

    /// True if light passes a body of the material as if nothing were there: its index is 1.
    fn bends_nothing(&self) -> bool {
        matches!(self.model, 4 | 6 | 7) && self.ior == Some(1.0)
    }
}
