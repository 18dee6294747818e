//! The material of a surface at one point, with its textures looked up.

use glam::Vec3;

/// The shading parameters at one point of a surface, linear Rec. 709; the fields are those of
/// [`Material`](crate::scene::Material).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingParams {
    /// The share of light scattered to all sides.
    pub diffuse: Vec3,
    /// The share of light in the highlight.
    pub specular: Vec3,
    /// Phong's exponent.
    pub shininess: f32,
    /// The emitted radiance.
    pub emission: Vec3,
    /// The share of light reflected as by a mirror.
    pub reflect: Vec3,
    /// The share of light transmitted.
    pub transmit: Vec3,
}

impl ShadingParams {
    /// The parameters of a surface that covers only `alpha` of what lies behind it, and transmits
    /// nothing by itself: the rest is seen straight through.
    pub fn with_alpha(self, alpha: f32) -> Self {
        Self {
            emission: self.emission * alpha,
            reflect: self.reflect * alpha,
            transmit: Vec3::splat(1.0 - alpha),
            ..self
        }
    }

    /// True if the surface sends secondary rays: reflected or transmitted.
    pub fn spawns_rays(&self) -> bool {
        self.reflect != Vec3::ZERO || self.transmit != Vec3::ZERO
    }
}
