//! The camera, and the primary rays that it generates.

use glam::{DAffine3, DVec3};

use crate::error::{Error, Result};
use crate::geometry::sampling::concentric_disk;
use crate::geometry::{LANES, Lanes, Ray, Ray16};

/// The projection of a camera, with its field of view.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Projection {
    /// A perspective with this angle between the lower and the upper edge, in radians, in (0, π).
    FovY(f64),
    /// A perspective with this angle between the left and the right edge, in radians, in (0, π).
    FovX(f64),
    /// A perspective with this focal length, the tutorial's D, in pixels of a picture `width` wide. For
    /// a picture of another width it is scaled, so that the field of view stays.
    FocalPx {
        /// The focal length, above 0, in pixels.
        focal: f64,
        /// The width of the picture that it refers to, in pixels.
        width: u32,
    },
    /// An orthographic projection with this height of the view, above 0, in world units.
    OrthoHeight(f64),
}

impl Projection {
    /// The same kind of projection with another angle (in radians), focal length or height.
    pub fn with_value(self, value: f64) -> Self {
        match self {
            Projection::FovY(_) => Projection::FovY(value),
            Projection::FovX(_) => Projection::FovX(value),
            Projection::FocalPx { width, .. } => Projection::FocalPx { focal: value, width },
            Projection::OrthoHeight(_) => Projection::OrthoHeight(value),
        }
    }
}

/// A pinhole or orthographic camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The name, which may be empty.
    pub name: String,
    /// The position, in world space.
    pub position: DVec3,
    /// The viewing direction, of length 1.
    pub forward: DVec3,
    /// The direction to the right of the picture, of length 1 and orthogonal to `forward`.
    pub right: DVec3,
    /// The direction to the top of the picture, `right × forward`.
    pub up: DVec3,
    /// The projection.
    pub projection: Projection,
    /// The lens, with which the integrator `path` shows what is out of focus blurred; `None` for a pinhole.
    pub lens: Option<ThinLens>,
}

/// A thin lens (Cook, Porter and Carpenter, *Distributed Ray Tracing*, SIGGRAPH 1984).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    /// The diameter of the opening, above 0, in world units.
    pub aperture: f64,
    /// The distance, along the viewing direction, of the plane that is sharp, above 0, in world units.
    pub focus_distance: f64,
}

impl Camera {
    /// A camera at `position` that looks at `target`, with `up` as upward in the picture as can be.
    ///
    /// # Errors
    /// When `target` is the position, or `up` is zero or points along the view.
    pub fn look_at(
        position: DVec3,
        target: DVec3,
        up: DVec3,
        projection: Projection,
    ) -> Result<Self> {
        let forward = (target - position).try_normalize().ok_or_else(|| {
            Error::input("the camera looks at the point where it stands")
                .help("`look_at` must differ from `position`")
        })?;
        let right = forward.cross(up.normalize_or_zero());
        if right.length() < 1e-9 {
            return Err(Error::input("the camera's `up` points along its view, or is zero")
                .help("choose an `up` across the view, such as [0, 1, 0] or [0, 0, 1]"));
        }
        let right = right.normalize();
        let up = right.cross(forward);
        Ok(Self { name: String::new(), position, forward, right, up, projection, lens: None })
    }

    /// The camera transformed, so that it sees the transformed scene as it saw the scene before; its
    /// axes stay right-handed and orthogonal also under reflections and shears. `None` when the
    /// transform is too uneven to leave it an upward direction.
    pub fn transformed(&self, transform: &DAffine3) -> Option<Self> {
        let forward = transform.transform_vector3(self.forward).try_normalize()?;
        let up = transform.transform_vector3(self.up);
        let projection = match self.projection {
            Projection::OrthoHeight(height) => Projection::OrthoHeight(height * up.length()),
            perspective => perspective,
        };
        let turned = Self::look_at(DVec3::ZERO, forward, up, projection).ok()?;
        let position = transform.transform_point3(self.position);
        let scale = transform.transform_vector3(self.forward).length();
        let lens = self.lens.map(|lens| ThinLens {
            aperture: lens.aperture * scale,
            focus_distance: lens.focus_distance * scale,
        });
        Some(Self { name: self.name.clone(), position, lens, ..turned })
    }

    /// The generator of the primary rays of a picture of `size` pixels.
    pub fn ray_generator(&self, size: [u32; 2]) -> RayGenerator {
        let [width, height] = size.map(f64::from);
        // The distance to the picture in pixels and, for parallel rays, the size of a pixel.
        let (focal, pixel) = match self.projection {
            Projection::FovY(angle) => (height * 0.5 / (angle * 0.5).tan(), 1.0),
            Projection::FovX(angle) => (width * 0.5 / (angle * 0.5).tan(), 1.0),
            Projection::FocalPx { focal, width: given } => (focal * width / f64::from(given), 1.0),
            Projection::OrthoHeight(world) => (1.0, world / height),
        };
        RayGenerator {
            origin: self.position,
            per_pixel: [self.right, -self.up].map(|axis| axis * pixel),
            forward: self.forward * focal,
            middle: [width * 0.5, height * 0.5],
            is_parallel: matches!(self.projection, Projection::OrthoHeight(_)),
            lens: self.lens.map(|lens| LensAxes {
                radii: [self.right, self.up].map(|axis| axis * (0.5 * lens.aperture)),
                focus: lens.focus_distance / focal,
            }),
        }
    }
}

/// A lens as rays are generated through it.
#[derive(Clone, Copy, Debug)]
struct LensAxes {
    /// The vectors from the middle of the lens to its rim, to the right and upward.
    radii: [DVec3; 2],
    /// The t at which rays through the middle of the lens are in focus.
    focus: f64,
}

/// A generator of primary rays: through each point of a picture, from the camera.
///
/// The direction of a perspective ray is measured in pixels, as the tutorial's `direction(x, y)`:
/// (x − width/2, y − height/2, D) in the camera's own axes, and not of length 1.
#[derive(Clone, Copy, Debug)]
pub struct RayGenerator {
    origin: DVec3,
    per_pixel: [DVec3; 2],
    forward: DVec3,
    middle: [f64; 2],
    is_parallel: bool,
    lens: Option<LensAxes>,
}

impl RayGenerator {
    /// The point from which all rays start; none for an orthographic camera.
    pub fn eye(&self) -> Option<DVec3> {
        (!self.is_parallel).then_some(self.origin)
    }

    /// The growth of a pixel's width per unit of a ray's t, and its width at the ray's origin, in world
    /// units.
    pub fn pixel_size(&self) -> [f64; 2] {
        let width = self.per_pixel[0].length();
        if self.is_parallel { [0.0, width] } else { [width, 0.0] }
    }

    /// The ray through (x, y), in pixels from the upper left corner of the picture.
    #[inline(always)]
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let offset =
            self.per_pixel[0] * (x - self.middle[0]) + self.per_pixel[1] * (y - self.middle[1]);
        let (shift, turn) =
            if self.is_parallel { (offset, DVec3::ZERO) } else { (DVec3::ZERO, offset) };
        Ray::new(self.origin + shift, turn + self.forward)
    }

    /// The ray through (x, y) and a point of the lens, given by a point of the unit square; all of those through
    /// (x, y) meet where they are in focus.
    pub fn ray_through_lens(&self, x: f64, y: f64, u: [f64; 2]) -> Ray {
        let ray = self.ray(x, y);
        let Some(LensAxes { radii, focus }) = self.lens else { return ray };
        let point = concentric_disk(u);
        let shift = radii[0] * point[0] + radii[1] * point[1];
        Ray::new(ray.origin + shift, ray.direction - shift / focus)
    }

    /// Generates the rays through sixteen points of the picture, as [`RayGenerator::ray`].
    #[inline(always)]
    pub fn ray16(&self, x: &Lanes<f64>, y: &Lanes<f64>, rays: &mut Ray16) {
        for i in 0..LANES {
            let ray = self.ray(x[i], y[i]);
            for axis in 0..3 {
                rays.origin[axis][i] = ray.origin[axis];
                rays.direction[axis][i] = ray.direction[axis];
            }
            rays.tmax[i] = ray.tmax;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn tutorial_camera_gives_the_tutorials_directions() {
        let lens = Projection::FocalPx { focal: 500.0, width: 1000 };
        let camera = Camera::look_at(DVec3::ZERO, DVec3::Z, -DVec3::Y, lens).unwrap();
        let ray = camera.ray_generator([1000, 500]).ray(3.0, 7.0);
        assert_eq!(ray.direction, DVec3::new(3.0 - 500.0, 7.0 - 250.0, 500.0));
    }

    #[test]
    fn right_of_the_picture_is_plus_x_when_looking_down_minus_z() {
        let camera =
            Camera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, Projection::FovY(FRAC_PI_2)).unwrap();
        assert_eq!((camera.right, camera.up), (DVec3::X, DVec3::Y));
    }

    #[test]
    fn ninety_degrees_see_as_far_up_as_ahead() {
        let camera =
            Camera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, Projection::FovY(FRAC_PI_2)).unwrap();
        let top = camera.ray_generator([200, 100]).ray(100.0, 0.0).direction.normalize();
        assert!((top.y + top.z).abs() < 1e-15, "{top}");
    }

    #[test]
    fn focal_length_scales_with_the_width() {
        let lens = Projection::FocalPx { focal: 500.0, width: 1000 };
        let camera = Camera::look_at(DVec3::ZERO, DVec3::Z, DVec3::Y, lens).unwrap();
        let corner = |w: u32| camera.ray_generator([w, w / 2]).ray(0.0, 0.0).direction.normalize();
        assert!((corner(1000) - corner(250)).length() < 1e-15);
    }

    #[test]
    fn orthographic_rays_are_parallel() {
        let camera =
            Camera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, Projection::OrthoHeight(2.0))
                .unwrap();
        let rays = camera.ray_generator([100, 100]);
        let (a, b) = (rays.ray(0.0, 0.0), rays.ray(100.0, 50.0));
        assert_eq!(a.direction, b.direction);
        assert_eq!((a.origin, b.origin), (DVec3::new(-1.0, 1.0, 0.0), DVec3::X));
    }

    #[test]
    fn up_along_the_view_is_an_error() {
        let camera = Camera::look_at(DVec3::ZERO, DVec3::Y, DVec3::Y, Projection::FovY(1.0));
        assert!(camera.unwrap_err().message().contains("up"));
    }
}
