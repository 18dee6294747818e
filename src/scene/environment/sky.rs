//! The built-in clear sky, by Preetham, Shirley and Smits, *A Practical Analytic Model for Daylight*
//! (SIGGRAPH 1999), and its sun.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DMat3, DVec3, Vec3};

use super::direction_at;
use crate::scene::{Image, Light, Texels};

/// The size of the map in pixels.
const SIZE: [usize; 2] = [1024, 512];

/// The luminance of 1, in kcd/m²: that of a white surface under 100 000 lux, about the light of the sun and the
/// sky at noon.
const WHITE: f64 = 100.0 / PI;

/// The illuminance of the sun outside of the atmosphere, in klx.
const SOLAR_ILLUMINANCE: f64 = 133.0;

/// The angular diameter of the sun in radians.
const SUN_ANGLE: f64 = 0.0093;

/// A clear sky with a sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// The height of the sun over the horizon, in radians, from 0 to π/2.
    pub elevation: f64,
    /// The direction of the sun, in radians: from +z, counter-clockwise seen from above.
    pub azimuth: f64,
    /// The turbidity of the air: 2 for a very clear sky to 10 for haze; from 1.7 to 10.
    pub turbidity: f64,
    /// The share of light that the ground reflects, linear Rec. 709: it fills the lower half.
    pub ground: Vec3,
}

impl Default for Sky {
    fn default() -> Self {
        let ground = Vec3::splat(0.25);
        Self {
            elevation: 40f64.to_radians(),
            azimuth: -(40f64.to_radians()),
            turbidity: 3.0,
            ground,
        }
    }
}

impl Sky {
    /// Returns the map of its radiance, without the sun.
    pub(super) fn map(&self) -> Image {
        let [width, height] = SIZE;
        let daylight = Daylight::new(self);
        // What the ground reflects of the light of the whole sky and of the sun.
        let upper = (0..width * height / 2).step_by(7);
        let mut sky = DVec3::ZERO;
        let mut weights = 0.0;
        let direction = |i: usize| {
            let [u, v] =
                [(i % width, width), (i / width, height)].map(|(x, n)| (x as f32 + 0.5) / n as f32);
            direction_at(u, v).as_dvec3()
        };
        for direction in upper.map(direction) {
            let solid_angle = direction.x.hypot(direction.z);
            sky += daylight.radiance(direction) * (direction.y * solid_angle);
            weights += direction.y * solid_angle;
        }
        let sun = self.sun().intensity.as_dvec3() * self.elevation.sin();
        let ground = (sky / weights + sun) * self.ground.as_dvec3();
        let texel = |i: usize| {
            let direction = direction(i);
            let radiance = if direction.y > 0.0 { daylight.radiance(direction) } else { ground };
            radiance.as_vec3().extend(1.0).to_array()
        };
        let texels = Texels::Floats((0..width * height).map(texel).collect());
        Image::new("sky", SIZE.map(|side| side as u32), texels)
    }

    /// Returns the direction to the sun.
    fn toward_sun(&self) -> DVec3 {
        let (sin, cos) = self.elevation.sin_cos();
        DVec3::new(self.azimuth.sin() * cos, sin, self.azimuth.cos() * cos)
    }

    /// Returns the sun, in the axes of the map: a directional light, reddened by the air on its way by
    /// Rayleigh's scattering and by Ångström's for haze (appendix A.1 of the paper, without its absorption
    /// bands), at three wavelengths.
    pub fn sun(&self) -> Light {
        let zenith_angle = FRAC_PI_2 - self.elevation;
        let air =
            1.0 / (zenith_angle.cos() + 0.15 * (93.885 - zenith_angle.to_degrees()).powf(-1.253));
        let haze = (0.04608 * self.turbidity - 0.04586).max(0.0);
        // In micrometres, for red, green and blue.
        let transmittance = [0.61, 0.55, 0.465].map(|wavelength: f64| {
            let depth = 0.008735 * wavelength.powf(-4.08) + haze * wavelength.powf(-1.3);
            (-depth * air).exp()
        });
        let intensity = DVec3::from(transmittance) * (SOLAR_ILLUMINANCE / PI / WHITE);
        Light::sun(-self.toward_sun())
            .with_intensity(intensity.as_vec3())
            .with_angle(SUN_ANGLE)
            .with_name("sun")
    }
}

/// The light of a sky: luminance and chromaticity by Perez's formula, as the paper's appendix A.2 has them.
struct Daylight {
    toward_sun: DVec3,
    /// For Y, x and y: the value at the zenith divided by the formula there, and the formula's coefficients.
    channels: [(f64, [f64; 5]); 3],
}

impl Daylight {
    fn new(sky: &Sky) -> Self {
        let t = sky.turbidity;
        let sun = FRAC_PI_2 - sky.elevation;
        let linear = |a: f64, b: f64| a * t + b;
        let coefficients = [
            [
                linear(0.1787, -1.4630),
                linear(-0.3554, 0.4275),
                linear(-0.0227, 5.3251),
                linear(0.1206, -2.5771),
                linear(-0.0670, 0.3703),
            ],
            [
                linear(-0.0193, -0.2592),
                linear(-0.0665, 0.0008),
                linear(-0.0004, 0.2125),
                linear(-0.0641, -0.8989),
                linear(-0.0033, 0.0452),
            ],
            [
                linear(-0.0167, -0.2608),
                linear(-0.0950, 0.0092),
                linear(-0.0079, 0.2102),
                linear(-0.0441, -1.6537),
                linear(-0.0109, 0.0529),
            ],
        ];
        // The values at the zenith.
        let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * sun);
        let luminance = (4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192;
        let cubic = |rows: [[f64; 4]; 3]| {
            let of = |[a, b, c, d]: [f64; 4]| ((a * sun + b) * sun + c) * sun + d;
            (of(rows[0]) * t + of(rows[1])) * t + of(rows[2])
        };
        let x = cubic([
            [0.00166, -0.00375, 0.00209, 0.0],
            [-0.02903, 0.06377, -0.03202, 0.00394],
            [0.11693, -0.21196, 0.06052, 0.25886],
        ]);
        let y = cubic([
            [0.00275, -0.00610, 0.00317, 0.0],
            [-0.04214, 0.08970, -0.04153, 0.00516],
            [0.15346, -0.26756, 0.06670, 0.26688],
        ]);
        let zenith = [luminance.max(0.0), x, y];
        let channels = std::array::from_fn(|i| {
            (zenith[i] / perez(&coefficients[i], 1.0, sun), coefficients[i])
        });
        Self { toward_sun: sky.toward_sun(), channels }
    }

    /// Returns the radiance from a direction of length 1 above the horizon, linear Rec. 709.
    fn radiance(&self, direction: DVec3) -> DVec3 {
        let angle = direction.dot(self.toward_sun).clamp(-1.0, 1.0).acos();
        let cosine = direction.y.max(0.01);
        let [luminance, x, y] =
            self.channels.each_ref().map(|(scale, c)| scale * perez(c, cosine, angle));
        let luminance = luminance.max(0.0) / WHITE;
        let xyz = DVec3::new(x / y, 1.0, (1.0 - x - y) / y) * luminance;
        (XYZ_TO_RGB * xyz).max(DVec3::ZERO)
    }
}

/// Returns Perez's formula, by the cosine of the angle from the zenith and the angle from the sun.
fn perez([a, b, c, d, e]: &[f64; 5], cosine: f64, angle: f64) -> f64 {
    let cos_angle = angle.cos();
    (1.0 + a * (b / cosine).exp()) * (1.0 + c * (d * angle).exp() + e * cos_angle * cos_angle)
}

/// The matrix from CIE XYZ to linear Rec. 709 (IEC 61966-2-1), by columns.
const XYZ_TO_RGB: DMat3 = DMat3::from_cols(
    DVec3::new(3.2406, -0.9689, 0.0557),
    DVec3::new(-1.5372, 1.8758, -0.2040),
    DVec3::new(-0.4986, 0.0415, 1.0570),
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Environment;

    fn radiance(sky: &Sky, direction: DVec3) -> Vec3 {
        Environment::sky(sky).0.radiance(direction)
    }

    #[test]
    fn the_sky_is_blue_above_and_brightest_near_the_sun() {
        let sky = Sky::default();
        let zenith = radiance(&sky, DVec3::Y);
        assert!(zenith.z > 1.5 * zenith.x, "{zenith}");
        let toward = sky.toward_sun();
        let near = radiance(&sky, toward).y;
        assert!(near > 3.0 * zenith.y, "{near} {zenith}");
        // A clear sky's zenith has about 3 to 6 kcd/m² with the sun at 40°.
        let luminance = zenith.dot(Vec3::new(0.2126, 0.7152, 0.0722)) as f64 * WHITE;
        assert!((2.0..7.0).contains(&luminance), "{luminance} kcd/m²");
    }

    #[test]
    fn the_sun_is_where_the_sky_is_brightest_and_reddens_toward_the_horizon() {
        let at = |degrees: f64| Sky { elevation: degrees.to_radians(), ..Sky::default() }.sun();
        let [high, low] = [at(60.0).intensity, at(5.0).intensity];
        assert!(low.x < high.x && low.z / low.x < 0.5 * high.z / high.x, "{high} {low}");
        // About 100 klx under a high sun.
        assert!((0.8..1.2).contains(&high.y), "{high}");
    }

    #[test]
    fn every_sky_is_finite_and_not_negative() {
        for elevation in [0.0, 0.1, 0.7, FRAC_PI_2] {
            for turbidity in [1.7, 3.0, 10.0] {
                let sky = Sky { elevation, turbidity, ..Sky::default() };
                let Texels::Floats(texels) = sky.map().texels else { panic!() };
                let is_valid = |x: &f32| x.is_finite() && *x >= 0.0;
                assert!(texels.as_flattened().iter().all(is_valid), "{sky:?}");
            }
        }
    }
}
