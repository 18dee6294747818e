//! The options of the camera that frames a bare model.

use glam::{DMat3, DVec3};

use crate::error::{Error, Result};

/// The options of the camera that frames a bare model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Framing {
    /// The direction in the file that is upward in the picture; none for +Y, as glTF has it.
    pub up: Option<UpAxis>,
    /// The angle in radians, around the upward axis, from the model's front to where the camera stands: a
    /// quarter turn is its right side. Without it, as the model's shape suggests.
    pub azimuth: Option<f64>,
    /// The angle in radians by which the camera stands higher than the model, from −π/2, below it, to π/2,
    /// above it. Without it, as the model's shape suggests.
    pub elevation: Option<f64>,
}

/// An axis of a file's coordinates, in either direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// +X; the front is +Z.
    X,
    /// +Y; the front is +Z, as in glTF.
    #[default]
    Y,
    /// +Z; the front is −Y, as in many CAD programs.
    Z,
    /// −X; the front is +Z.
    NegX,
    /// −Y; the front is −Z.
    NegY,
    /// −Z; the front is +Y.
    NegZ,
}

impl Framing {
    /// True if nothing is asked for.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// True if it says from where the model is seen, which the cameras of the file then do not.
    pub fn has_direction(&self) -> bool {
        self.azimuth.is_some() || self.elevation.is_some()
    }

    /// Checks that its angles are finite.
    ///
    /// # Errors
    /// When one is not.
    pub(super) fn check(&self) -> Result<()> {
        let mut angles = [self.azimuth, self.elevation].into_iter().flatten();
        match angles.find(|angle| !angle.is_finite()) {
            Some(angle) => Err(Error::input(format!("an angle of the framing is {angle}"))
                .help("angles are finite numbers of radians")),
            None => Ok(()),
        }
    }

    /// Returns the rotation that takes right, up and front (x, y, z) to the file's coordinates.
    pub(super) fn axes(&self) -> DMat3 {
        self.up.unwrap_or_default().axes()
    }
}

impl UpAxis {
    /// Returns the upward direction, of length 1.
    pub fn direction(self) -> DVec3 {
        self.axes().y_axis
    }

    /// Returns the rotation that takes right, up and front (x, y, z) to the file's coordinates.
    fn axes(self) -> DMat3 {
        let (up, front) = match self {
            UpAxis::X => (DVec3::X, DVec3::Z),
            UpAxis::Y => (DVec3::Y, DVec3::Z),
            UpAxis::Z => (DVec3::Z, DVec3::NEG_Y),
            UpAxis::NegX => (DVec3::NEG_X, DVec3::Z),
            UpAxis::NegY => (DVec3::NEG_Y, DVec3::NEG_Z),
            UpAxis::NegZ => (DVec3::NEG_Z, DVec3::Y),
        };
        DMat3::from_cols(up.cross(front), up, front)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_that_are_not_finite_are_an_error() {
        let framing = |azimuth, elevation| Framing { azimuth, elevation, ..Framing::default() };
        assert!(framing(Some(f64::NAN), None).check().is_err());
        assert!(framing(Some(0.0), Some(f64::INFINITY)).check().is_err());
        assert!(framing(Some(9.0), Some(-9.0)).check().is_ok());
    }

    #[test]
    fn axes_are_rotations() {
        use UpAxis::*;
        for axis in [X, Y, Z, NegX, NegY, NegZ] {
            let axes = axis.axes();
            assert_eq!(axes.determinant(), 1.0, "{axis:?}");
            assert_eq!(axes.transpose() * axes, DMat3::IDENTITY, "{axis:?}");
            assert_eq!(axes * DVec3::Y, axis.direction());
        }
        assert_eq!(Y.axes(), DMat3::IDENTITY);
    }
}
