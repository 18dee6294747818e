//! Cube maps: values by direction, on the six faces of a cube, each with a border for interpolation up to its
//! edges.

use glam::{Vec2, Vec3, Vec3A};
use rayon::prelude::*;

/// A map of directions: six squares of `size` × `size` texels, each surrounded by one more texel.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeMap {
    size: usize,
    /// The texels with the borders, face by face and row by row.
    texels: Vec<Vec3A>,
}

/// Returns the face that a direction of any length but zero points to, 0 to 5 for +x, −x, +y, −y, +z and −z, and
/// the place there: each coordinate is in \[−1, 1\].
#[inline]
fn face_and_place(direction: Vec3) -> (usize, Vec2) {
    let Vec3 { x, y, z } = direction;
    let [ax, ay, az] = direction.abs().to_array();
    let (axis, major, place) = if ax >= ay && ax >= az {
        (0, x, Vec2::new(y, z))
    } else if ay >= az {
        (1, y, Vec2::new(z, x))
    } else {
        (2, z, Vec2::new(x, y))
    };
    (2 * axis + usize::from(major < 0.0), place / major.abs())
}

/// Returns the direction, of length 1, at a place of a face; beyond \[−1, 1\] the face's plane goes on.
fn direction_at(face: usize, place: Vec2) -> Vec3 {
    let major = if face.is_multiple_of(2) { 1.0 } else { -1.0 };
    let direction = match face / 2 {
        0 => Vec3::new(major, place.x, place.y),
        1 => Vec3::new(place.y, major, place.x),
        _ => Vec3::new(place.x, place.y, major),
    };
    direction.normalize()
}

/// Returns the index of the texel, of `size` × `size` on each face, that a direction is in.
pub fn texel_of(direction: Vec3, size: usize) -> usize {
    let (face, place) = face_and_place(direction);
    let index = |x: f32| (((0.5 + 0.5 * x) * size as f32) as usize).min(size - 1);
    (face * size + index(place.y)) * size + index(place.x)
}

/// Returns the direction of the centre of a texel of `size` × `size` on each face.
pub fn center_of(index: usize, size: usize) -> Vec3 {
    let at = |i: usize| (2 * i + 1) as f32 / size as f32 - 1.0;
    let place = Vec2::new(at(index % size), at(index / size % size));
    direction_at(index / (size * size), place)
}

/// Returns the number of texels with the borders.
fn texel_count(size: usize) -> usize {
    6 * (size + 2) * (size + 2)
}

/// Returns the direction of a texel, with the borders.
fn direction_of_texel(index: usize, size: usize) -> Vec3 {
    let side = size + 2;
    let at = |i: usize| (2.0 * i as f32 - 1.0) / size as f32 - 1.0;
    let place = Vec2::new(at(index % side), at(index / side % side));
    direction_at(index / (side * side), place)
}

impl CubeMap {
    /// A map of the values that a function has in the directions of the texels; it is called on all threads of the
    /// current pool.
    pub fn from_fn(size: usize, value: impl Fn(Vec3) -> Vec3 + Sync) -> Self {
        let texel = |index| Vec3A::from(value(direction_of_texel(index, size)));
        Self { size, texels: (0..texel_count(size)).into_par_iter().map(texel).collect() }
    }

    /// The same on this thread alone.
    pub fn from_fn_here(size: usize, value: impl Fn(Vec3) -> Vec3) -> Self {
        let texel = |index| Vec3A::from(value(direction_of_texel(index, size)));
        Self { size, texels: (0..texel_count(size)).map(texel).collect() }
    }

    /// Returns the value in a direction of any length but zero, interpolated between texels.
    #[inline]
    pub fn lookup(&self, direction: Vec3) -> Vec3 {
        let (face, place) = face_and_place(direction);
        // With the border, the centre of the first texel is at 1.5.
        let place = (place * 0.5 + 0.5) * self.size as f32 + 0.5;
        let (x, y) = (place.x as usize, place.y as usize);
        let (fx, fy) = (place.x - x as f32, place.y - y as f32);
        let side = self.size + 2;
        let first = (face * side + y.min(self.size)) * side + x.min(self.size);
        let above = self.texels[first].lerp(self.texels[first + 1], fx);
        let below = self.texels[first + side].lerp(self.texels[first + side + 1], fx);
        above.lerp(below, fy).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_is_at_the_place_that_it_is_at() {
        let slanted = [Vec3::new(-0.3, -0.5, 0.8), Vec3::new(1.0, -0.9, 0.8), Vec3::splat(-1.0)];
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for direction in [axis, -axis].into_iter().chain(slanted) {
                let (face, place) = face_and_place(direction);
                let found = direction_at(face, place);
                assert!((found - direction.normalize()).length() < 1e-6, "{direction} {found}");
            }
        }
    }

    #[test]
    fn a_smooth_function_is_interpolated_everywhere_also_across_the_edges() {
        let map = CubeMap::from_fn(16, |direction| direction);
        let mut worst = 0.0f32;
        for i in 0..400 {
            for j in 0..50 {
                let (phi, y) = (i as f32 / 400.0 * std::f32::consts::TAU, j as f32 / 25.0 - 0.98);
                let across = (1.0 - y * y).sqrt();
                let direction = Vec3::new(across * phi.cos(), y, across * phi.sin());
                worst = worst.max((map.lookup(direction) - direction).length());
            }
        }
        // Texels are 1/8 wide; the error is that of a chord, 1/8²/8 along each of two axes.
        assert!(worst < 0.004, "{worst}");
    }

    #[test]
    fn the_texel_of_a_centre_is_its_own() {
        assert!((0..6 * 64).all(|i| texel_of(center_of(i, 8), 8) == i));
    }
}
