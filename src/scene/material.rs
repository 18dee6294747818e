//! What surfaces are made of.

use glam::Vec3;

use crate::scene::TextureId;

/// The index of a material in `Scene::materials`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialId(pub u32);

/// A Lambert and Phong material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name, unique in a scene file; model files may repeat names.
    pub name: String,
    /// Share of light scattered to all sides, linear Rec. 709; without Lambert's 1/π, as in the
    /// tutorial.
    pub diffuse: Vec3,
    /// Colours multiplied with `diffuse`, by the surface's texture coordinates.
    pub diffuse_map: Option<TextureId>,
    /// Share of light in the highlight, linear Rec. 709.
    pub specular: Vec3,
    /// The tutorial's α, above 0: the greater, the smaller the highlight.
    pub shininess: f32,
    /// Radiance of its own, linear Rec. 709; it lights nothing else.
    pub emission: Vec3,
    /// Colours multiplied with `emission`, by the surface's texture coordinates.
    pub emission_map: Option<TextureId>,
    /// Share of what is seen in it as in a mirror, linear Rec. 709.
    pub reflect: Vec3,
    /// Share of what is seen through it as through glass, linear Rec. 709; of it Fresnel's law
    /// splits off what is reflected. `reflect` and `transmit` are at most 1 together.
    pub transmit: Vec3,
    /// The index of refraction of its inside, relative to empty space, in \[0.01, 100\].
    pub ior: f64,
    /// What is lost in its inside for each unit of length: light falls to e^(−absorption).
    pub absorption: Vec3,
    /// Whether it is a thin sheet with no inside: light goes straight through.
    pub thin: bool,
    /// Which of two things holds where both are: the one with the greater priority; of two equal
    /// ones, the smaller thing.
    pub priority: i32,
    /// Whether a sphere is lit on its inside too. Planes and meshes always are, on the side that
    /// the viewer sees.
    pub double_sided: bool,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            diffuse: Vec3::splat(0.8),
            diffuse_map: None,
            specular: Vec3::ZERO,
            shininess: 50.0,
            emission: Vec3::ZERO,
            emission_map: None,
            reflect: Vec3::ZERO,
            transmit: Vec3::ZERO,
            ior: 1.5,
            absorption: Vec3::ZERO,
            thin: false,
            priority: 0,
            double_sided: false,
        }
    }
}

impl Material {
    /// Whether light goes on from it, off it or through it.
    pub fn is_followed(&self) -> bool {
        self.reflect != Vec3::ZERO || self.transmit != Vec3::ZERO
    }

    /// Whether what it covers is a body that light goes through, with an inside.
    pub fn is_body(&self) -> bool {
        self.transmit != Vec3::ZERO && !self.thin
    }

    /// Whether light that comes from a medium with index of refraction `ior`, and goes on into one,
    /// passes as if nothing were there.
    pub fn is_clear_in(&self, ior: f64) -> bool {
        self.transmit == Vec3::ONE && self.emission == Vec3::ZERO && self.ior == ior
    }

    /// Whether shading it needs texture coordinates.
    pub fn is_textured(&self) -> bool {
        self.diffuse_map.is_some() || self.emission_map.is_some()
    }
}
