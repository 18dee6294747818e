//! The environment: light from infinitely far away, by direction.

mod cube_map;
mod distribution;
mod filtered;
mod map_light;
mod reflections;
mod sky;
mod studio;

use std::f32::consts::{PI, TAU};
use std::sync::{Arc, OnceLock};

use glam::{DMat3, DVec3, Vec3};

use crate::scene::{Image, Light, Texels, Transfer};
pub use distribution::EnvironmentDistribution;
pub use filtered::{FilteredEnvironment, SHARPEST_REFLECTION};
pub use sky::Sky;

/// An environment that surrounds the scene: its radiance by direction, from an equirectangular map.
///
/// In the map's own axes +y is up. The map's column u in \[0, 1\] and row v, down from the top, show the
/// direction (x, y, z) with u = 1/2 + atan2(z, x)/2π and v = 1/2 − asin(y)/π: its middle column is +x, and a
/// quarter of its width to the left −z.
#[derive(Clone, Debug)]
pub struct Environment {
    /// The map; an environment of one colour has a single pixel.
    map: Arc<Image>,
    /// The encoding of the map's colours, if it has integers; floats are linear.
    transfer: Transfer,
    /// The rotation from world space to the map's axes.
    pub to_map: DMat3,
    /// The factor of the map's radiance, linear Rec. 709.
    pub intensity: Vec3,
    /// True if camera rays that hit nothing see it, rather than the film's background.
    pub visible: bool,
    /// The map filtered for diffuse and rough reflections: made when it is first asked for, and shared by the
    /// scenes at different times of an animation.
    filtered: Arc<OnceLock<FilteredEnvironment>>,
    /// The distribution of the map's light, made and shared likewise.
    distribution: Arc<OnceLock<EnvironmentDistribution>>,
}

impl Environment {
    /// An environment that shows this map, in the map's axes; `transfer` is the encoding of its colours, which
    /// are linear where they are floats.
    pub fn new(map: Arc<Image>, transfer: Transfer) -> Self {
        Self {
            map,
            transfer,
            to_map: DMat3::IDENTITY,
            intensity: Vec3::ONE,
            visible: true,
            filtered: Arc::default(),
            distribution: Arc::default(),
        }
    }

    /// The map.
    pub fn map(&self) -> &Image {
        &self.map
    }

    /// An environment of the same radiance from all directions.
    pub fn even(radiance: Vec3) -> Self {
        let texels = Texels::Floats(vec![radiance.extend(1.0).to_array()]);
        Self::new(Arc::new(Image::new("even", [1, 1], texels)), Transfer::None)
    }

    /// The built-in studio: a bright dome with soft boxes, for pictures of models.
    pub fn studio() -> Self {
        Self { visible: false, ..Self::new(Arc::new(studio::map()), Transfer::None) }
    }

    /// The built-in clear sky, and its sun.
    pub fn sky(sky: &Sky) -> (Self, Light) {
        (Self::new(Arc::new(sky.map()), Transfer::None), sky.sun())
    }

    /// Turns it about its vertical axis, counter-clockwise seen from above, by an angle in radians.
    #[must_use]
    pub fn rotated(mut self, angle: f64) -> Self {
        self.to_map = DMat3::from_rotation_y(-angle) * self.to_map;
        self
    }

    /// Turns its axes (x, y and z) to the directions of world space that are the columns of a rotation.
    #[must_use]
    pub fn with_axes(mut self, axes: DMat3) -> Self {
        self.to_map *= axes.transpose();
        self
    }

    /// Sets the factor of the map's radiance.
    #[must_use]
    pub fn with_intensity(self, intensity: Vec3) -> Self {
        Self { intensity, ..self }
    }

    /// Sets whether camera rays that hit nothing see it.
    #[must_use]
    pub fn with_visible(self, visible: bool) -> Self {
        Self { visible, ..self }
    }

    /// Returns the radiance from a direction of any length but zero, pointing to where the light comes from.
    pub fn radiance(&self, direction: DVec3) -> Vec3 {
        let toward = (self.to_map * direction).as_vec3();
        lookup(&self.map, self.transfer, toward) * self.intensity
    }

    /// Returns the map filtered for diffuse and rough reflections. The first call makes it, on all threads of
    /// the current pool.
    pub fn filtered(&self) -> &FilteredEnvironment {
        self.filtered.get_or_init(|| FilteredEnvironment::new(&self.map, self.transfer))
    }

    /// Samples a direction to where light comes from, in proportion to the map's luminance, by a point of the unit
    /// square, and returns it with its density per steradian. The first call makes the distribution, on all threads
    /// of the current pool.
    pub fn sample(&self, u: [f64; 2]) -> (DVec3, f64) {
        let (direction, pdf) = self.distribution().sample(u);
        (self.to_map.transpose() * direction, pdf)
    }

    /// Returns the density per steradian with which [`sample`](Self::sample) returns a direction of length 1.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        self.distribution().pdf(self.to_map * direction)
    }

    /// Returns the distribution of the map's light.
    pub fn distribution(&self) -> &EnvironmentDistribution {
        let new = || EnvironmentDistribution::new(&self.map, self.transfer);
        self.distribution.get_or_init(new)
    }

    /// Returns the irradiance of a surface with this normal, of length 1, divided by π: what it reflects if it is
    /// white and diffuse.
    pub fn diffuse_light(&self, normal: DVec3) -> Vec3 {
        self.filtered().diffuse((self.to_map * normal).as_vec3()) * self.intensity
    }

    /// Returns the mean over all directions of the radiance.
    pub fn mean_radiance(&self) -> Vec3 {
        self.filtered().mean() * self.intensity
    }
}

/// Returns the radiance of a map in a direction of its own axes, interpolated between its four nearest pixels.
fn lookup(map: &Image, transfer: Transfer, toward: Vec3) -> Vec3 {
    let (width, height) = (map.width as usize, map.height as usize);
    let texel = |index: usize| map.texels.linear(index, transfer).truncate();
    if width * height == 1 {
        return texel(0);
    }
    let [u, v] = equirectangular(toward);
    let (x, y) = (u * width as f32 - 0.5, v * height as f32 - 0.5);
    let (left, top) = (x.floor(), y.floor());
    let (fx, fy) = (x - left, y - top);
    let column = |x: f32| (x as i64).rem_euclid(width as i64) as usize;
    let row = |y: f32| (y.max(0.0) as usize).min(height - 1);
    let (columns, rows) = ([column(left), column(left + 1.0)], [row(top), row(top + 1.0)]);
    let at = |i: usize, j: usize| texel(rows[j] * width + columns[i]);
    let above = at(0, 0).lerp(at(1, 0), fx);
    let below = at(0, 1).lerp(at(1, 1), fx);
    above.lerp(below, fy)
}

impl PartialEq for Environment {
    fn eq(&self, other: &Self) -> bool {
        let rest = |e: &Self| (e.transfer, e.to_map, e.intensity, e.visible);
        self.map == other.map && rest(self) == rest(other)
    }
}

/// Returns the place, from 0 to 1, of a direction in an equirectangular map.
fn equirectangular(toward: Vec3) -> [f32; 2] {
    let across = toward.x.hypot(toward.z);
    // Not by asin(y), which near the poles has few digits.
    [0.5 + toward.z.atan2(toward.x) / TAU, 0.5 - toward.y.atan2(across) / PI]
}

/// Returns the direction at a place, from 0 to 1, of an equirectangular map.
fn direction_at(u: f32, v: f32) -> Vec3 {
    let (sin_azimuth, cos_azimuth) = ((u - 0.5) * TAU).sin_cos();
    let (sin_elevation, cos_elevation) = ((0.5 - v) * PI).sin_cos();
    Vec3::new(cos_elevation * cos_azimuth, sin_elevation, cos_elevation * sin_azimuth)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A map whose pixels are all different.
    fn map(width: u32, height: u32) -> Arc<Image> {
        let texels = (0..width * height).map(|i| [i as f32, 1.0, 2.0, 1.0]).collect();
        Arc::new(Image::new("", [width, height], Texels::Floats(texels)))
    }

    #[test]
    fn the_middle_of_the_map_is_at_positive_x_and_a_quarter_to_the_left_at_negative_z() {
        let near = |v: Vec3, u: f32, w: f32| {
            let [x, y] = equirectangular(v);
            assert!((x - u).abs() < 1e-6 && (y - w).abs() < 1e-6, "{v}: {x} {y}");
        };
        near(Vec3::X, 0.5, 0.5);
        near(Vec3::NEG_Z, 0.25, 0.5);
        near(Vec3::Z, 0.75, 0.5);
        near(Vec3::new(1e-4, 1.0, 0.0), 0.5, 3.2e-5);
        let [_, bottom] = equirectangular(Vec3::NEG_Y);
        assert_eq!(bottom, 1.0);
    }

    #[test]
    fn a_direction_has_the_place_that_it_is_at() {
        for (u, v) in [(0.1, 0.2), (0.5, 0.5), (0.93, 0.81)] {
            let [x, y] = equirectangular(direction_at(u, v));
            assert!((x - u).abs() < 1e-6 && (y - v).abs() < 1e-6);
        }
    }

    #[test]
    fn the_centre_of_a_pixel_has_its_radiance() {
        let environment =
            Environment::new(map(8, 4), Transfer::None).with_intensity(Vec3::splat(2.0));
        let toward = direction_at(2.5 / 8.0, 1.5 / 4.0).as_dvec3();
        let expected = Vec3::new(2.0 * 10.0, 2.0, 4.0);
        assert!((environment.radiance(toward * 7.0) - expected).abs().max_element() < 1e-3);
    }

    #[test]
    fn the_map_has_no_seam() {
        let environment = Environment::new(map(8, 4), Transfer::None);
        let at = |u| environment.radiance(direction_at(u, 0.4).as_dvec3()).x;
        assert!((at(1e-5) - at(1.0 - 1e-5)).abs() < 1e-2);
    }

    #[test]
    fn a_rotation_moves_what_was_seen_at_x_toward_negative_z() {
        let environment = Environment::new(map(8, 4), Transfer::None);
        let turned = environment.clone().rotated(std::f64::consts::FRAC_PI_2);
        let difference = environment.radiance(DVec3::X) - turned.radiance(DVec3::NEG_Z);
        assert!(difference.abs().max_element() < 1e-3);
    }

    #[test]
    fn an_even_environment_is_the_same_everywhere() {
        let environment = Environment::even(Vec3::new(0.1, 0.2, 0.3));
        assert_eq!(environment.radiance(DVec3::new(3.0, -1.0, 2.0)), Vec3::new(0.1, 0.2, 0.3));
    }
}
