//! The parameters of glTF's physically based materials at one point.

use glam::Vec3;

/// The parameters of a physically based material at one point of a surface, with its textures looked up:
/// those of the glTF 2.0 specification (3.9) and of its extensions. The default is that of glTF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialParams {
    /// The base colour, linear Rec. 709, in \[0, 1\].
    pub base_color: Vec3,
    /// The metalness, in \[0, 1\].
    pub metallic: f32,
    /// The roughness, in \[0, 1\]; its square is α.
    pub roughness: f32,
    /// The index of refraction, at least 1, or 0 for a surface that reflects everything
    /// (KHR_materials_ior).
    pub ior: f32,
    /// The strength of a dielectric's reflection, in \[0, 1\] (KHR_materials_specular).
    pub specular: f32,
    /// The colour of a dielectric's reflection at normal incidence, at least 0 (KHR_materials_specular).
    pub specular_color: Vec3,
    /// The share of the light in the base of a dielectric that is transmitted, in \[0, 1\]
    /// (KHR_materials_transmission).
    pub transmission: f32,
    /// True for a surface without an inside, through which light goes straight; false for the boundary of
    /// a volume (KHR_materials_volume).
    pub is_thin: bool,
    /// The strength of the clearcoat, in \[0, 1\] (KHR_materials_clearcoat).
    pub clearcoat: f32,
    /// The roughness of the clearcoat, in \[0, 1\].
    pub clearcoat_roughness: f32,
    /// The colour of the sheen, in \[0, 1\] (KHR_materials_sheen).
    pub sheen_color: Vec3,
    /// The roughness of the sheen, in \[0, 1\].
    pub sheen_roughness: f32,
    /// The strength of the anisotropy, in \[0, 1\] (KHR_materials_anisotropy).
    pub anisotropy: f32,
    /// The angle from the tangent to the direction of more roughness, in radians, counter-clockwise.
    pub anisotropy_rotation: f32,
    /// The strength of the iridescence, in \[0, 1\] (KHR_materials_iridescence).
    pub iridescence: f32,
    /// The index of refraction of the thin film, at least 1.
    pub iridescence_ior: f32,
    /// The thickness of the thin film in nanometres, at least 0.
    pub iridescence_thickness: f32,
    /// The dispersion, 20 divided by the Abbe number, at least 0 (KHR_materials_dispersion).
    pub dispersion: f32,
    /// The share of the diffuse light that is transmitted, in \[0, 1\]
    /// (KHR_materials_diffuse_transmission).
    pub diffuse_transmission: f32,
    /// The colour of the diffuse light that is transmitted, in \[0, 1\].
    pub diffuse_transmission_color: Vec3,
}

impl Default for MaterialParams {
    fn default() -> Self {
        Self {
            base_color: Vec3::ONE,
            metallic: 1.0,
            roughness: 1.0,
            ior: 1.5,
            specular: 1.0,
            specular_color: Vec3::ONE,
            transmission: 0.0,
            is_thin: true,
            clearcoat: 0.0,
            clearcoat_roughness: 0.0,
            sheen_color: Vec3::ZERO,
            sheen_roughness: 0.0,
            anisotropy: 0.0,
            anisotropy_rotation: 0.0,
            iridescence: 0.0,
            iridescence_ior: 1.3,
            iridescence_thickness: 400.0,
            dispersion: 0.0,
            diffuse_transmission: 0.0,
            diffuse_transmission_color: Vec3::ONE,
        }
    }
}

impl MaterialParams {
    /// Returns the parameters with each at the nearest value in its range; one that is not a number is
    /// glTF's default.
    pub(super) fn in_range(&self) -> Self {
        let default = Self::default();
        let number = |x: f32, default: f32| if x.is_nan() { default } else { x };
        let share = |x: f32, default: f32| number(x, default).clamp(0.0, 1.0);
        let color = |color: Vec3, default: Vec3| {
            Vec3::from_array(std::array::from_fn(|i| share(color[i], default[i])))
        };
        let finite = |x: f32, default: f32, least: f32| number(x, default).clamp(least, 1e6);
        Self {
            base_color: color(self.base_color, default.base_color),
            metallic: share(self.metallic, default.metallic),
            roughness: share(self.roughness, default.roughness),
            ior: if self.ior == 0.0 { 0.0 } else { finite(self.ior, default.ior, 1.0) },
            specular: share(self.specular, default.specular),
            specular_color: self.specular_color.map(|x| finite(x, 1.0, 0.0)),
            transmission: share(self.transmission, default.transmission),
            is_thin: self.is_thin,
            clearcoat: share(self.clearcoat, default.clearcoat),
            clearcoat_roughness: share(self.clearcoat_roughness, default.clearcoat_roughness),
            sheen_color: color(self.sheen_color, default.sheen_color),
            sheen_roughness: share(self.sheen_roughness, default.sheen_roughness),
            anisotropy: share(self.anisotropy, default.anisotropy),
            anisotropy_rotation: finite(self.anisotropy_rotation, 0.0, -1e6),
            iridescence: share(self.iridescence, default.iridescence),
            iridescence_ior: finite(self.iridescence_ior, default.iridescence_ior, 1.0),
            iridescence_thickness: finite(self.iridescence_thickness, 400.0, 0.0),
            dispersion: finite(self.dispersion, default.dispersion, 0.0),
            diffuse_transmission: share(self.diffuse_transmission, default.diffuse_transmission),
            diffuse_transmission_color: color(self.diffuse_transmission_color, Vec3::ONE),
        }
    }
}
