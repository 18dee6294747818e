//! An environment filtered for surfaces that blur it: its irradiance by normal, and its reflections by
//! direction and roughness.

use std::f32::consts::PI;
use std::ops::RangeInclusive;
use std::sync::OnceLock;

use glam::{DVec3, Vec3};

use super::cube_map::CubeMap;
use super::map_light::{CELLS, Cell, MapLight, pyramid};
use super::reflections::{CellLight, NarrowReflection, mean_of_cells};
use crate::scene::{Image, Transfer};

/// The number of texels along a face of the map of irradiance.
const IRRADIANCE_SIZE: usize = CELLS;

/// The number of filtered reflections: those of the roughnesses 1/10, 2/10, …, 1.
const LEVELS: usize = 10;

/// The first level whose lobe is so wide that the cells of directions are summed for it.
const FIRST_WIDE: usize = 4;

/// An environment filtered for diffuse and rough reflections, in the axes of its map.
#[derive(Clone, Debug, PartialEq)]
pub struct FilteredEnvironment {
    /// The irradiance of a surface divided by π, by its normal: what a white diffuse surface reflects.
    irradiance: CubeMap,
    /// The mean of the radiance that microfacets of each roughness reflect, by the mirrored direction; each made
    /// when it is first needed.
    levels: [OnceLock<CubeMap>; LEVELS],
    /// The light of cells of directions, of which the rougher levels are made.
    cells: Vec<CellLight>,
    /// Ever coarser maps of the radiance, of which the sharper levels are made.
    pyramid: Vec<CubeMap>,
    /// The number of texels along a face of the finest of them.
    size: usize,
    mean: Vec3,
}

impl FilteredEnvironment {
    /// Filters a map for diffuse reflections, on all threads of the current pool.
    pub(super) fn new(map: &Image, transfer: Transfer) -> Self {
        let MapLight { cells, texels, size } = MapLight::collect(map, transfer);
        let sum: DVec3 = cells.iter().map(|cell| cell.sum.as_dvec3()).sum();
        Self {
            irradiance: irradiance(&cells),
            cells: cells.iter().enumerate().map(CellLight::new).collect(),
            levels: Default::default(),
            pyramid: pyramid(texels, size),
            size,
            mean: (sum / (4.0 * std::f64::consts::PI)).as_vec3(),
        }
    }

    /// Filters the map for reflections by microfacets of a range of roughnesses, on all threads of the current pool.
    /// Roughnesses that are not prepared are filtered where they are first asked for, on one thread.
    pub fn prepare(&self, roughnesses: RangeInclusive<f32>) {
        let (first, _) = place_of(*roughnesses.start());
        let (last, fraction) = place_of(*roughnesses.end());
        for level in first..=last + usize::from(fraction > 0.0) {
            // Not within `get_or_init`: a thread that waits for others there may take up work that asks for the
            // same level.
            if self.levels[level].get().is_none() {
                let (size, reflected) = self.reflection_of(level);
                let map = CubeMap::from_fn(size, reflected);
                self.levels[level].get_or_init(|| map);
            }
        }
    }

    fn level(&self, level: usize) -> &CubeMap {
        self.levels[level].get_or_init(|| {
            let (size, reflected) = self.reflection_of(level);
            CubeMap::from_fn_here(size, reflected)
        })
    }

    /// Returns the number of texels along a face of a level, and the mean of the radiance that is reflected about a
    /// mirrored direction.
    fn reflection_of(&self, level: usize) -> (usize, Box<dyn Fn(Vec3) -> Vec3 + Sync + '_>) {
        let roughness = (level + 1) as f32 / LEVELS as f32;
        let alpha = roughness * roughness;
        if level >= FIRST_WIDE {
            let reflected = move |mirrored| mean_of_cells(&self.cells, alpha, mirrored);
            return (IRRADIANCE_SIZE / 2, Box::new(reflected));
        }
        let reflection = NarrowReflection::new(alpha, self.size, &self.pyramid);
        // The rougher, the fewer texels show all there is.
        let size = (self.size >> level).max(IRRADIANCE_SIZE.min(self.size));
        (size, Box::new(move |mirrored| reflection.mean(mirrored)))
    }

    /// Returns the irradiance of a surface with this normal divided by π: what it reflects if it is white and
    /// diffuse.
    #[inline]
    pub fn diffuse(&self, normal: Vec3) -> Vec3 {
        self.irradiance.lookup(normal)
    }

    /// Returns the mean of the radiance around a mirrored direction that microfacets of this roughness, at
    /// least 1/10, reflect: the first of the two sums of Karis (*Real Shading in Unreal Engine 4*, 2013), for
    /// which the surface is seen head-on.
    #[inline]
    pub fn reflection(&self, direction: Vec3, roughness: f32) -> Vec3 {
        let (level, fraction) = place_of(roughness);
        let near = self.level(level).lookup(direction);
        if fraction == 0.0 {
            return near;
        }
        near.lerp(self.level(level + 1).lookup(direction), fraction)
    }

    /// Returns the mean radiance over all directions.
    pub(super) fn mean(&self) -> Vec3 {
        self.mean
    }
}

/// The roughness of the sharpest filtered reflection.
pub const SHARPEST_REFLECTION: f32 = 1.0 / LEVELS as f32;

/// Returns the level before a roughness, and the fraction of the way to the next, which is less than 1.
#[inline]
fn place_of(roughness: f32) -> (usize, f32) {
    let place = (roughness * LEVELS as f32 - 1.0).clamp(0.0, (LEVELS - 1) as f32);
    (place as usize, place.fract())
}

/// Returns the irradiance by normal, divided by π.
fn irradiance(cells: &[Cell]) -> CubeMap {
    /// The number of cells that are added up side by side.
    const SIDE: usize = 8;
    // The x, y and z of cells side by side, for each channel.
    type Vectors = [[f32; SIDE]; 3];
    let (groups, rest) = cells.as_chunks::<SIDE>();
    assert!(rest.is_empty(), "the number of cells is a multiple of 8");
    let vectors = |channel: usize| -> Vec<Vectors> {
        let of = |group: &[Cell; SIDE]| {
            let axis = |axis: usize| group.map(|cell| cell.vectors[channel][axis]);
            [axis(0), axis(1), axis(2)]
        };
        groups.iter().map(of).collect()
    };
    let channels = [vectors(0), vectors(1), vectors(2)];
    CubeMap::from_fn(IRRADIANCE_SIZE, |normal| {
        let sum = |vectors: &Vec<Vectors>| {
            let mut sums = [0.0; SIDE];
            for [x, y, z] in vectors {
                for i in 0..SIDE {
                    sums[i] += (normal.x * x[i] + normal.y * y[i] + normal.z * z[i]).max(0.0);
                }
            }
            sums.iter().sum::<f32>()
        };
        Vec3::from(channels.each_ref().map(sum)) / PI
    })
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use super::*;
    use crate::scene::Texels;
    use crate::scene::environment::direction_at;

    fn filtered(size: [u32; 2], radiance: impl Fn(Vec3) -> Vec3) -> FilteredEnvironment {
        let [width, height] = size.map(|x| x as usize);
        let texel = |i: usize| {
            let (x, y) = (i % width, i / width);
            let [u, v] = [(x, width), (y, height)].map(|(x, n)| (x as f32 + 0.5) / n as f32);
            radiance(direction_at(u, v)).extend(1.0).to_array()
        };
        let texels = Texels::Floats((0..width * height).map(texel).collect());
        FilteredEnvironment::new(&Image::new("", size, texels), Transfer::Srgb)
    }

    const DIRECTIONS: [Vec3; 5] = [
        Vec3::X,
        Vec3::NEG_Y,
        Vec3::new(0.6, 0.0, 0.8),
        Vec3::new(-0.48, 0.64, 0.6),
        Vec3::new(0.36, -0.48, -0.8),
    ];

    #[test]
    fn a_reflection_is_the_same_whether_it_was_prepared_or_not() {
        let map = |_| filtered([64, 32], |d| Vec3::new(1.0 + d.x, d.y.max(0.0), d.z * d.z));
        let [prepared, other] = [0, 1].map(map);
        prepared.prepare(0.25..=0.5);
        let is_made = |environment: &FilteredEnvironment| {
            environment.levels.iter().map(|level| level.get().is_some()).collect::<Vec<_>>()
        };
        // Those of the roughnesses 0.2, 0.3, 0.4 and 0.5.
        assert_eq!(is_made(&prepared), [0, 1, 1, 1, 1, 0, 0, 0, 0, 0].map(|is| is == 1));
        for direction in DIRECTIONS {
            for roughness in [0.25, 0.3, 0.47, 0.5] {
                let [a, b] = [&prepared, &other].map(|e| e.reflection(direction, roughness));
                assert_eq!(a, b, "{direction} {roughness}");
            }
        }
        assert_eq!(is_made(&prepared), is_made(&other));
    }

    #[test]
    fn an_even_environment_is_even_however_it_is_filtered() {
        for size in [[1, 1], [7, 3], [512, 256]] {
            let environment = filtered(size, |_| Vec3::new(1.0, 0.5, 0.25));
            for direction in DIRECTIONS {
                let found = [0.1, 0.25, 0.5, 1.0].map(|r| environment.reflection(direction, r));
                for found in found.into_iter().chain([environment.diffuse(direction)]) {
                    let ratio = found / Vec3::new(1.0, 0.5, 0.25);
                    assert!((ratio - 1.0).abs().max_element() < 2e-3, "{size:?} {found}");
                }
            }
            assert!((environment.mean().x - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn irradiance_under_a_bright_half_is_that_of_the_half_that_is_seen() {
        // The upper half of directions has radiance 1: E/π is (1 + cos θ)/2 for a normal at θ from the top.
        let environment = filtered([1024, 512], |d| Vec3::splat(if d.y > 0.0 { 1.0 } else { 0.0 }));
        for direction in DIRECTIONS {
            let expected = 0.5 * (1.0 + direction.y);
            let found = environment.diffuse(direction).x;
            assert!((found - expected).abs() < 2e-3, "{direction}: {found} {expected}");
        }
    }

    #[test]
    fn irradiance_of_a_small_sun_is_that_of_a_directional_light() {
        let sun = Vec3::new(0.48, 0.6, 0.64);
        let environment =
            filtered([2048, 1024], |d| Vec3::splat(if d.dot(sun) > 0.9998 { 1e4 } else { 0.0 }));
        // Its irradiance if it faces the sun: 4π times the mean.
        let facing = environment.mean().x * 4.0;
        for direction in DIRECTIONS {
            let expected = direction.dot(sun).max(0.0) * facing;
            let found = environment.diffuse(direction).x;
            assert!((found - expected).abs() < 0.01 * facing, "{direction}: {found} {expected}");
        }
    }

    #[test]
    fn the_rougher_a_reflection_the_wider_is_a_light_in_it() {
        let environment =
            filtered([1024, 512], |d| Vec3::splat(if d.x > 0.99 { 100.0 } else { 0.0 }));
        let at = |roughness, angle: f32| {
            environment.reflection(Vec3::new(angle.cos(), angle.sin(), 0.0), roughness).x
        };
        assert!((at(0.1, 0.0) - 100.0).abs() < 3.0, "{}", at(0.1, 0.0));
        assert!(at(0.1, 0.5) < 0.3 && at(0.5, 0.5) > 2.0, "{} {}", at(0.1, 0.5), at(0.5, 0.5));
        assert!(at(1.0, 0.0) < at(0.5, 0.0) && at(0.5, 0.0) < at(0.2, 0.0));
    }

    #[test]
    fn a_filtered_reflection_is_the_integral_over_the_microfacets() {
        let light = |d: Vec3| 1.0 + d.x + 2.0 * d.y * d.y;
        let environment = filtered([512, 256], |d| Vec3::splat(light(d)));
        for roughness in [0.3f32, 0.6, 1.0] {
            let alpha = roughness * roughness;
            for mirrored in DIRECTIONS {
                // The integral, on a fine grid of microfacets.
                let (x, y) = mirrored.any_orthonormal_pair();
                let (mut sum, mut total) = (0.0, 0.0);
                for i in 0..300 {
                    let u = (i as f32 + 0.5) / 300.0;
                    let square = (1.0 - u) / (1.0 + (alpha * alpha - 1.0) * u);
                    let cosine = 2.0 * square - 1.0;
                    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
                    for j in 0..60 {
                        let phi = TAU * j as f32 / 60.0;
                        let l = x * (sine * phi.cos()) + y * (sine * phi.sin()) + mirrored * cosine;
                        sum += light(l) * cosine.max(0.0);
                        total += cosine.max(0.0);
                    }
                }
                let found = environment.reflection(mirrored, roughness).x;
                let expected = sum / total;
                assert!((found / expected - 1.0).abs() < 0.03, "{roughness}: {found} {expected}");
            }
        }
    }
}
