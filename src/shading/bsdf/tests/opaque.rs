//! Opaque surfaces side by side.

use super::robustness::material;
use super::*;
use crate::geometry::{LANES, Lanes};
use crate::shading::bsdf::{OpaqueBsdf, OpaqueBsdf16};

/// Returns sixteen random opaque materials as BSDFs, in either form.
fn opaque_bsdfs(random: &mut Random) -> Vec<(MetallicRoughness, Bsdf, OpaqueBsdf)> {
    let mut found = Vec::new();
    while found.len() < LANES {
        let material = MetallicRoughness {
            transmission: 0.0,
            anisotropy: 0.0,
            clearcoat: 0.0,
            sheen_color: Vec3::ZERO,
            iridescence: 0.0,
            diffuse_transmission: 0.0,
            roughness: 0.3 + 0.7 * random.next() as f32,
            ..material(random)
        };
        let bsdf = Bsdf::new(&material, 1.0);
        let opaque = bsdf.opaque().expect("an opaque material");
        found.push((material, bsdf, opaque));
    }
    found
}

/// Returns a direction of the upper side, and not quite along the surface.
fn direction(random: &mut Random) -> DVec3 {
    let z = 2e-3 + (1.0 - 2e-3) * random.next();
    let (sin, cos) = (TAU * random.next()).sin_cos();
    let sine = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(sine * cos, sine * sin, z)
}

#[test]
fn side_by_side_opaque_surfaces_reflect_what_each_does_by_itself() {
    let mut random = Random(7);
    let mut worst = 0.0f32;
    for _ in 0..2000 {
        let materials = opaque_bsdfs(&mut random);
        let mut sixteen = OpaqueBsdf16::splat(&materials[3].2);
        (0..LANES).for_each(|i| sixteen.set(i, &materials[i].2));
        let wo: [DVec3; LANES] = std::array::from_fn(|_| direction(&mut random));
        let wi: [DVec3; LANES] = std::array::from_fn(|_| direction(&mut random));
        let cosine: Lanes<f32> = wo.map(|w| w.z as f32);
        let albedos = sixteen.set_viewer(&cosine);
        let dot = std::array::from_fn(|i| wo[i].dot(wi[i]) as f32);
        let values = sixteen.evaluate(&wi.map(|w| w.z as f32), &dot);
        for (i, (material, bsdf, _)) in materials.iter().enumerate() {
            let expected = bsdf.evaluate(wo[i], wi[i]) * std::f32::consts::PI;
            let lobes = bsdf.lobe_albedos(wo[i]);
            let lane = |colors: &[Lanes<f32>; 3]| Vec3::from(colors.map(|lanes| lanes[i]));
            let pairs = [
                (lane(&values), expected),
                (lane(&albedos[0]), lobes.reflection),
                (lane(&albedos[1]), lobes.diffuse),
            ];
            for (found, expected) in pairs {
                let error = ((found - expected) / (expected + 0.01)).abs().max_element();
                assert!(error < 3e-4, "{material:?} {} {}: {found} {expected}", wo[i], wi[i]);
                worst = worst.max(error);
            }
        }
    }
    println!("largest relative difference: {worst:.1e}");
}

#[test]
fn what_is_not_opaque_or_has_layers_or_a_direction_is_shaded_by_itself() {
    let base = plastic(0.5, 1.5);
    assert!(Bsdf::new(&base, 1.0).opaque().is_some());
    let others = [
        MetallicRoughness { transmission: 0.1, ..base },
        MetallicRoughness { diffuse_transmission: 0.1, ..base },
        MetallicRoughness { clearcoat: 0.1, ..base },
        MetallicRoughness { sheen_color: Vec3::splat(0.1), ..base },
        MetallicRoughness { iridescence: 0.1, ..base },
        MetallicRoughness { anisotropy: 0.1, ..base },
        MetallicRoughness { roughness: 0.0, ..base },
    ];
    for material in others {
        assert!(Bsdf::new(&material, 1.0).opaque().is_none(), "{material:?}");
    }
}
