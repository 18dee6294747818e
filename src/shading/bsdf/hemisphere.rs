//! Sampling of hemispheres.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// Samples the hemisphere around the normal with density cos θ/π: a point of the unit disk, lifted
/// (Malley).
pub fn sample_cosine([u, v]: [f64; 2]) -> DVec3 {
    let (sin, cos) = (TAU * u).sin_cos();
    let radius = v.sqrt();
    DVec3::new(radius * cos, radius * sin, (1.0 - v).max(0.0).sqrt())
}

/// Returns the density cos θ/π.
pub fn cosine_pdf(w: DVec3) -> f64 {
    w.z.abs() / PI
}

/// Samples the hemisphere around the normal evenly.
pub fn sample_uniform([u, v]: [f64; 2]) -> DVec3 {
    let (sin, cos) = (TAU * u).sin_cos();
    let sine = ((1.0 - v) * (1.0 + v)).max(0.0).sqrt();
    DVec3::new(sine * cos, sine * sin, v)
}

/// The density of evenly spread directions on a hemisphere.
pub const UNIFORM_PDF: f64 = 1.0 / TAU;
