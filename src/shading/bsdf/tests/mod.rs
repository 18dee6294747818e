//! Tests of whole BSDFs.

mod extensions;
mod furnace;
mod limits;
mod opaque;
mod reciprocity;
mod robustness;
mod sampling;

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::Bsdf;
use super::table::midpoints;
use crate::scene::MetallicRoughness;

/// A clear dielectric boundary of a volume.
fn glass(roughness: f32, ior: f32) -> MetallicRoughness {
    MetallicRoughness {
        metallic: 0.0,
        roughness,
        ior,
        transmission: 1.0,
        is_thin: false,
        ..Default::default()
    }
}

fn metal(roughness: f32) -> MetallicRoughness {
    MetallicRoughness { roughness, ..Default::default() }
}

fn plastic(roughness: f32, ior: f32) -> MetallicRoughness {
    MetallicRoughness { metallic: 0.0, roughness, ior, ..Default::default() }
}

/// Materials of every kind, with names.
fn materials() -> Vec<(&'static str, MetallicRoughness)> {
    let gold = Vec3::new(1.0, 0.77, 0.34);
    let rose = Vec3::new(0.8, 0.2, 0.3);
    let varnish = MetallicRoughness { clearcoat: 1.0, ..metal(0.5) };
    vec![
        ("metal", metal(0.6)),
        ("sharp gold", MetallicRoughness { base_color: gold, ..metal(0.25) }),
        ("rough metal", metal(1.0)),
        ("brushed", MetallicRoughness { anisotropy: 0.8, anisotropy_rotation: 0.5, ..metal(0.3) }),
        ("plastic", MetallicRoughness { base_color: rose, ..plastic(0.4, 1.5) }),
        ("diamond white", plastic(0.7, 2.4)),
        ("half metal", MetallicRoughness { metallic: 0.5, base_color: rose, ..metal(0.4) }),
        ("thin pane", MetallicRoughness { is_thin: true, base_color: gold, ..glass(0.4, 1.5) }),
        ("frosted", glass(0.5, 1.5)),
        ("clear", glass(0.3, 1.33)),
        (
            "half frosted",
            MetallicRoughness { transmission: 0.5, base_color: rose, ..glass(0.6, 1.8) },
        ),
        ("prism", MetallicRoughness { dispersion: 2.0, ..glass(0.35, 1.7) }),
        (
            "leaf",
            MetallicRoughness {
                diffuse_transmission: 0.6,
                diffuse_transmission_color: gold,
                base_color: rose,
                ..plastic(0.5, 1.5)
            },
        ),
        (
            "velvet",
            MetallicRoughness {
                sheen_color: Vec3::new(0.9, 0.6, 1.0),
                sheen_roughness: 0.4,
                ..plastic(0.8, 1.5)
            },
        ),
        ("rough varnish", MetallicRoughness { clearcoat_roughness: 0.4, ..varnish }),
        ("varnish", varnish),
        ("soap", MetallicRoughness { iridescence: 1.0, ..plastic(0.4, 1.5) }),
        (
            "anodized",
            MetallicRoughness {
                iridescence: 0.8,
                iridescence_ior: 1.8,
                iridescence_thickness: 300.0,
                base_color: Vec3::splat(0.6),
                ..metal(0.5)
            },
        ),
        (
            "colored specular",
            MetallicRoughness {
                specular: 0.7,
                specular_color: Vec3::new(3.0, 1.0, 0.2),
                ..plastic(0.5, 1.5)
            },
        ),
        (
            "everything",
            MetallicRoughness {
                metallic: 0.3,
                transmission: 0.4,
                clearcoat: 0.7,
                clearcoat_roughness: 0.3,
                sheen_color: gold,
                sheen_roughness: 0.5,
                anisotropy: 0.5,
                iridescence: 0.5,
                dispersion: 1.0,
                diffuse_transmission: 0.5,
                ..glass(0.45, 1.6)
            },
        ),
    ]
}

/// The direction at an angle from the normal and an azimuth, in degrees.
fn at(theta: f64, phi: f64) -> DVec3 {
    let ((sin, cos), (y, x)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    DVec3::new(sin * x, sin * y, cos)
}

/// A generator of numbers in [0, 1) (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn pair(&mut self) -> [f64; 2] {
        [self.next(), self.next()]
    }

    fn direction(&mut self) -> DVec3 {
        let (z, phi) = (2.0 * self.next() - 1.0, TAU * self.next());
        let sine = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(sine * phi.cos(), sine * phi.sin(), z)
    }
}

/// Integrates over the sphere in polar coordinates that are dense around an axis: θ = π t³.
fn integrate_around(axis: DVec3, steps: usize, mut f: impl FnMut(DVec3) -> Vec3) -> Vec3 {
    let (x, y) = axis.any_orthonormal_pair();
    let mut sum = Vec3::ZERO;
    for t in midpoints(steps) {
        let (sin, cos) = (PI * t.powi(3)).sin_cos();
        let area = 3.0 * PI * t * t * sin * TAU / (steps * steps) as f64;
        for u in midpoints(steps) {
            let (b, a) = (TAU * u).sin_cos();
            sum += f((x * a + y * b) * sin + axis * cos) * area as f32;
        }
    }
    sum
}

/// Integrates over both hemispheres, each around where a smooth surface sends light from `wo`.
fn integrate(wo: DVec3, eta: f64, steps: usize, f: impl Fn(DVec3) -> Vec3) -> [Vec3; 2] {
    let mirrored = DVec3::new(-wo.x, -wo.y, wo.z);
    let normal = DVec3::Z * wo.z.signum();
    let refracted = super::refraction::refract(wo, normal, eta).unwrap_or(-wo);
    let on = |side: f64| move |wi: DVec3| wi.z * wo.z * side > 0.0;
    let part = |axis, side| {
        integrate_around(axis, steps, |wi| if on(side)(wi) { f(wi) } else { Vec3::ZERO })
    };
    [part(mirrored, 1.0), part(refracted, -1.0)]
}

/// Returns what the delta lobes send to `wo`.
fn delta_lobes(bsdf: &Bsdf, wo: DVec3) -> [Vec3; 2] {
    let mut found: Vec<super::BsdfSample> = Vec::new();
    for u in midpoints(997) {
        let Some(sample) = bsdf.sample(wo, u, [0.5; 2]) else { continue };
        if sample.is_delta && !found.contains(&sample) {
            found.push(sample);
        }
    }
    let of = |side: bool| {
        found.iter().filter(|s| s.is_transmission == side).map(|s| s.value).sum::<Vec3>()
    };
    [of(false), of(true)]
}

/// Returns the light that is reflected and transmitted to `wo` in a white world, by integration.
fn furnace(params: &MetallicRoughness, wo: DVec3, steps: usize) -> [Vec3; 2] {
    let bsdf = Bsdf::new(params, 1.0);
    let index = f64::from(params.ior.max(1.0));
    let eta = match params.is_thin {
        true => 1.0,
        false if wo.z < 0.0 => 1.0 / index,
        false => index,
    };
    let rough = integrate(wo, eta, steps, |wi| bsdf.evaluate(wo, wi));
    let delta = delta_lobes(&bsdf, wo);
    [rough[0] + delta[0], rough[1] + delta[1]]
}
