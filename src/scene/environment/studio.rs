//! The built-in studio: a dome that is brighter above, with soft boxes, by formula.

use glam::Vec3;

use super::direction_at;
use crate::scene::{Image, Texels};

/// The size of the map in pixels: enough for its soft edges.
const SIZE: [usize; 2] = [128, 64];

/// A rectangle of light on the dome, with soft edges.
struct SoftBox {
    /// The direction to its middle, of any length: the viewer is at +z, and up is +y.
    toward: Vec3,
    /// Half of its width and of its height, as tangents of angles.
    half_size: [f32; 2],
    /// The radiance that it adds.
    radiance: f32,
}

/// A key light from the upper left of the viewer, a fill light from the right, and a rim light from behind.
const SOFT_BOXES: [SoftBox; 3] = [
    SoftBox { toward: Vec3::new(-0.7, 0.9, 0.7), half_size: [0.5, 0.35], radiance: 1.9 },
    SoftBox { toward: Vec3::new(0.9, 0.2, 0.55), half_size: [0.3, 0.55], radiance: 0.8 },
    SoftBox { toward: Vec3::new(0.35, 0.55, -1.0), half_size: [0.8, 0.2], radiance: 1.5 },
];

/// The width of a soft box's edge, as a tangent.
const EDGE: f32 = 0.12;

/// Returns the map.
pub fn map() -> Image {
    let [width, height] = SIZE;
    let texel = |i: usize| {
        let [u, v] =
            [(i % width, width), (i / width, height)].map(|(x, n)| (x as f32 + 0.5) / n as f32);
        let radiance = radiance(direction_at(u, v));
        [radiance, radiance, radiance, 1.0]
    };
    let texels = Texels::Floats((0..width * height).map(texel).collect());
    Image::new("studio", SIZE.map(|side| side as u32), texels)
}

/// Returns the radiance from a direction of length 1; all is grey.
fn radiance(direction: Vec3) -> f32 {
    // The floor is darker than the ceiling, without an edge between them.
    let height = 0.5 + 0.5 * direction.y;
    let dome = 0.14 + 0.3 * height * height;
    SOFT_BOXES.iter().map(|soft_box| soft_box.radiance_from(direction)).sum::<f32>() + dome
}

impl SoftBox {
    fn radiance_from(&self, direction: Vec3) -> f32 {
        let forward = self.toward.normalize();
        let right = Vec3::Y.cross(forward).normalize();
        let up = forward.cross(right);
        let depth = direction.dot(forward);
        if depth <= 0.0 {
            return 0.0;
        }
        let inside = |across: f32, half: f32| {
            let x = ((half - (across / depth).abs()) / EDGE + 0.5).clamp(0.0, 1.0);
            x * x * (3.0 - 2.0 * x)
        };
        let [width, height] = self.half_size;
        let share = inside(direction.dot(right), width) * inside(direction.dot(up), height);
        self.radiance * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Environment;

    #[test]
    fn a_white_ball_in_the_studio_is_brighter_above_than_below_and_never_overexposed() {
        let studio = Environment::studio();
        let at = |normal: Vec3| studio.filtered().diffuse(normal).x;
        let [top, front, back, bottom] = [Vec3::Y, Vec3::Z, Vec3::NEG_Z, Vec3::NEG_Y].map(at);
        assert!(top > front && front > bottom && back > bottom, "{top} {front} {back} {bottom}");
        assert!((0.4..0.8).contains(&top) && (0.15..0.4).contains(&bottom), "{top} {bottom}");
        assert!(at(Vec3::NEG_X) > at(Vec3::X) * 0.8);
    }
}
