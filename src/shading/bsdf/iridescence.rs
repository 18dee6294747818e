//! Thin-film interference (KHR_materials_iridescence; Belcour and Barla, 2017).

use std::f32::consts::{PI, TAU};

use glam::{Mat3, Vec3};

/// The conversion from CIE XYZ to linear Rec. 709, as the extension gives it.
const XYZ_TO_REC709: Mat3 = Mat3::from_cols(
    Vec3::new(3.240_454_2, -0.969_266, 0.055_643_4),
    Vec3::new(-1.537_138_5, 1.876_010_8, -0.204_025_9),
    Vec3::new(-0.498_531_4, 0.041_556, 1.057_225_2),
);

/// The thickness in nanometres below which a film fades away.
const VANISHING: f32 = 0.03;

/// A film of one index of refraction between the outside and the base of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinFilm {
    /// The index of refraction of the outside, divided by that of the film.
    eta: f32,
    /// Twice the optical thickness, in nanometres.
    path: f32,
    /// The reflectance at normal incidence of the upper and the lower side of the film.
    sides: [Vec3; 2],
    /// The phase shift of light that goes to and fro once within the film.
    shift: Vec3,
    /// The factor of all that is reflected.
    factor: Vec3,
}

impl ThinFilm {
    /// The film of an index of refraction and a thickness in nanometres on a base that reflects `f0` at
    /// normal incidence and `factor` at grazing angles.
    pub fn new(outside: f32, ior: f32, thickness: f32, f0: Vec3, factor: Vec3) -> Self {
        // A film that gets thinner takes the index of the outside, so that it leaves the base as it is.
        let t = (thickness / VANISHING).clamp(0.0, 1.0);
        let ior = outside + (ior - outside) * (t * t * (3.0 - 2.0 * t));
        let base = f0 / factor.max(Vec3::splat(1e-6));
        let root = base.clamp(Vec3::ZERO, Vec3::splat(0.9999)).map(f32::sqrt);
        let base_ior = outside * (Vec3::ONE + root) / (Vec3::ONE - root);
        let relative = |ratio: f32| ((ratio - 1.0) / (ratio + 1.0)).powi(2);
        // Reflection off a denser medium shifts the phase by half a wave.
        let upper = if ior < outside { PI } else { 0.0 };
        let lower = base_ior.map(|base| if base < ior { PI } else { 0.0 });
        Self {
            eta: outside / ior,
            path: 2.0 * ior * thickness,
            sides: [
                Vec3::splat(relative(ior / outside)),
                base_ior.map(|base| relative(base / ior)),
            ],
            shift: lower + (PI - upper),
            factor,
        }
    }

    /// Returns the reflectance at an angle with this cosine, in \[0, 1\]: the sum over the light that
    /// went to and fro up to two times, integrated over the spectrum in Fourier space.
    pub fn reflectance(&self, cosine: f64) -> Vec3 {
        let cosine = cosine.clamp(0.0, 1.0) as f32;
        let square = 1.0 - self.eta * self.eta * (1.0 - cosine * cosine);
        // Beyond the critical angle nothing enters the film.
        if square <= 0.0 {
            return self.factor;
        }
        let within = square.sqrt();
        let schlick = |f0: Vec3, c: f32| f0 + (Vec3::ONE - f0) * (1.0 - c).powi(5);
        let upper = schlick(self.sides[0], cosine);
        let lower = schlick(self.sides[1], within);
        // What passes the upper side, and what both reflect.
        let passed = Vec3::ONE - upper;
        let both = (upper * lower).clamp(Vec3::ZERO, Vec3::splat(0.9999));
        let amplitude = both.map(f32::sqrt);
        let series = passed * passed * lower / (Vec3::ONE - both);
        // The mean, and the first two harmonics.
        let mut sum = upper + series;
        let mut harmonic = series - passed;
        for m in [1.0, 2.0] {
            harmonic *= amplitude;
            sum += harmonic * 2.0 * sensitivity(m * self.path * within, self.shift * m);
        }
        sum.clamp(Vec3::ZERO, Vec3::ONE) * self.factor
    }
}

/// Returns the colour of light with an optical path difference in nanometres and a phase shift: the
/// Fourier transform of the eye's sensitivity, as a sum of Gaussians.
fn sensitivity(path: f32, shift: Vec3) -> Vec3 {
    let phase = TAU * path * 1e-9;
    let gaussian = |value: f32, position: f32, variance: f32, shift: f32| {
        let wave = (position * phase + shift).cos() * (-variance * phase * phase).exp();
        value * (TAU * variance).sqrt() * wave
    };
    let xyz = Vec3::new(
        gaussian(5.4856e-13, 1.6810e6, 4.3278e9, shift.x)
            + gaussian(9.7470e-14, 2.2399e6, 4.5282e9, shift.x),
        gaussian(4.4201e-13, 1.7953e6, 9.3046e9, shift.y),
        gaussian(5.2481e-13, 2.2084e6, 6.6121e9, shift.z),
    );
    XYZ_TO_REC709 * (xyz / 1.0685e-7)
}
