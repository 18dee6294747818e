//! The GGX (Trowbridge–Reitz) distribution of microfacets, with Smith's masking and shadowing.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// The least α of a rough surface: that of roughness 0.01. Below it a surface counts as smooth, and its
/// reflection is a delta lobe.
pub const MIN_ALPHA: f64 = 1e-4;

/// A distribution of microfacet normals with a roughness α along x and along y (Trowbridge and Reitz,
/// 1975; Walter et al., 2007), equal to each other where the surface is isotropic. Directions are in the
/// local frame, with the normal along z, and on its side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    /// α along x and along y, each at least [`MIN_ALPHA`].
    alpha: [f64; 2],
}

impl Ggx {
    /// The distribution with α along x and along y; `None` for a smooth surface. Where only one is too
    /// small, the least α is taken for it.
    pub fn new(alpha: [f64; 2]) -> Option<Self> {
        let is_smooth = alpha[0].max(alpha[1]) < MIN_ALPHA;
        (!is_smooth).then(|| Self { alpha: alpha.map(|a| a.clamp(MIN_ALPHA, 1.0)) })
    }

    /// Returns D, the density of microfacets with normal `h` for each steradian and unit of area
    /// (glTF 2.0, B.3.2; anisotropic as in KHR_materials_anisotropy).
    pub fn density(&self, h: DVec3) -> f64 {
        let [x, y] = self.alpha;
        let (a, b) = (h.x / x, h.y / y);
        let square = a * a + b * b + h.z * h.z;
        1.0 / (PI * x * y * square * square)
    }

    /// The greater α of the two.
    pub fn max_alpha(&self) -> f64 {
        self.alpha[0].max(self.alpha[1])
    }

    /// The length of a direction that is stretched by α along x and y: cos θ √(1 + α² tan² θ), finite at
    /// grazing angles.
    fn stretched_length(&self, w: DVec3) -> f64 {
        DVec3::new(w.x * self.alpha[0], w.y * self.alpha[1], w.z).length()
    }

    /// Returns G₂ / (4 |cos θo|), with G₂ = 1 / (1 + Λo + Λi), the height-correlated masking and
    /// shadowing of Smith (Heitz, 2014; glTF 2.0, B.3.3). Only the height of directions counts, not on
    /// which side of the surface they are.
    pub fn visibility(&self, wo: DVec3, wi: DVec3) -> f64 {
        let (cos_o, cos_i) = (wo.z.abs(), wi.z.abs());
        0.5 / (cos_o / cos_i * self.stretched_length(wi) + self.stretched_length(wo))
    }

    /// Returns the density of the normals that are visible from `wo`, for each steradian:
    /// G₁ max(0, wo·h) D / cos θo (Heitz, 2018).
    pub fn visible_density(&self, wo: DVec3, h: DVec3) -> f64 {
        2.0 * self.density(h) * wo.dot(h).max(0.0) / (wo.z + self.stretched_length(wo))
    }

    /// Returns the density with which a mirror on the normals that are visible from `wo` sends light to
    /// where `h` is half-way: that of the normals divided by 4 wo·h.
    pub fn reflected_density(&self, wo: DVec3, h: DVec3) -> f64 {
        0.5 * self.density(h) / (wo.z + self.stretched_length(wo))
    }

    /// Samples the normals that are visible from `wo`: the sum of the stretched direction and a point on
    /// the spherical cap around it (Dupuy and Benyoub, 2023).
    pub fn sample(&self, wo: DVec3, [u, v]: [f64; 2]) -> DVec3 {
        let [x, y] = self.alpha;
        let stretched = DVec3::new(wo.x * x, wo.y * y, wo.z).normalize();
        let (sin_phi, cos_phi) = (TAU * u).sin_cos();
        let z = (1.0 - v) * (1.0 + stretched.z) - stretched.z;
        let sine = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
        let h = DVec3::new(sine * cos_phi, sine * sin_phi, z) + stretched;
        DVec3::new(h.x * x, h.y * y, h.z.max(0.0)).normalize_or(DVec3::Z)
    }
}

/// Returns the direction in which a mirror with normal `h` reflects the light that comes from `w`; both
/// directions point away from it.
pub fn reflect(w: DVec3, h: DVec3) -> DVec3 {
    h * (2.0 * w.dot(h)) - w
}
