//! Dielectric interfaces between two media: Snell–Descartes, Fresnel, Beer–Lambert.

use glam::{DVec3, Vec3};

/// The interface between two media, for light at one angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DielectricInterface {
    /// The share of light that is reflected, in \[0, 1\]; the rest is refracted.
    pub reflected: f64,
    /// The relative index of refraction η = n₁/n₂, with n₁ on the side of the incident light.
    ratio: f64,
    /// The cosines of the incident and the refracted angle to the normal; the second is 0 where all is
    /// reflected.
    cosines: [f64; 2],
}

impl DielectricInterface {
    /// Computes the interface for light that arrives at an angle to the normal with this cosine, in
    /// \[0, 1\], from a medium of index `from` at one of index `to`, both above 0.
    ///
    /// Fresnel's equations for unpolarised light: the mean of the squares of
    /// (n₁ cos θ₁ − n₂ cos θ₂) / (n₁ cos θ₁ + n₂ cos θ₂) and
    /// (n₂ cos θ₁ − n₁ cos θ₂) / (n₂ cos θ₁ + n₁ cos θ₂), with n₁ sin θ₁ = n₂ sin θ₂; all of it
    /// where no θ₂ fulfils that (total internal reflection). Born and Wolf, *Principles of Optics*,
    /// 1.5.2. They are rearranged so that indices that are nearly equal lose no digits: with the
    /// difference n₁² − n₂², of which everything else is computed, as (n₁ − n₂)(n₁ + n₂),
    /// (n₂ cos θ₂)² = (n₁ cos θ₁)² − (n₁² − n₂²), the first quotient is (n₁² − n₂²) / (n₁ cos θ₁ +
    /// n₂ cos θ₂)², and the second one is the first times cos(θ₁ + θ₂) / cos(θ₁ − θ₂).
    pub fn new(cosine: f64, from: f64, to: f64) -> Self {
        let cosine = cosine.clamp(0.0, 1.0);
        let ratio = from / to;
        if ratio == 1.0 {
            return Self { reflected: 0.0, ratio, cosines: [cosine; 2] };
        }
        // (n₂ cos θ₂)², at most 0 under total reflection.
        let difference = (from - to) * (from + to);
        let square = (from * cosine) * (from * cosine) - difference;
        if square <= 0.0 {
            return Self { reflected: 1.0, ratio, cosines: [cosine, 0.0] };
        }
        let refracted = (square.sqrt() / to).min(1.0);
        let sum = from * cosine + to * refracted;
        let perpendicular = difference / (sum * sum);
        // cos θ₁ cos θ₂ and sin θ₁ sin θ₂, of which cos(θ₁ ± θ₂) are made.
        let (along, across) = (cosine * refracted, ratio * ((1.0 - cosine) * (1.0 + cosine)));
        let parallel = perpendicular * ((along - across) / (along + across));
        let reflected = (perpendicular * perpendicular + parallel * parallel) * 0.5;
        Self { reflected, ratio, cosines: [cosine, refracted] }
    }

    /// Computes the interface of a thin sheet of index `sheet` in a medium of index `around`.
    ///
    /// Light goes to and fro within it, and each of its faces reflects F: in all
    /// F + (1−F)²F(1 + F² + F⁴ + …) = 2F/(1+F) comes back (Stokes, 1862), and what goes through goes
    /// on in its direction.
    pub fn thin_sheet(cosine: f64, around: f64, sheet: f64) -> Self {
        let face = Self::new(cosine, around, sheet).reflected;
        let cosines = [cosine.clamp(0.0, 1.0); 2];
        Self { reflected: 2.0 * face / (1.0 + face), ratio: 1.0, cosines }
    }

    /// True if refracted light goes on in the same direction.
    pub fn is_straight(&self) -> bool {
        self.ratio == 1.0
    }

    /// Returns the direction in which light along `incoming` is refracted, by Snell–Descartes:
    /// η u + (η cos θ₁ − cos θ₂) n. Both vectors have length 1, and the normal is on the side that
    /// the light comes from. `None` where all is reflected.
    pub fn refract(&self, incoming: DVec3, normal: DVec3) -> Option<DVec3> {
        if self.reflected >= 1.0 {
            return None;
        }
        let [incident, refracted] = self.cosines;
        Some((incoming * self.ratio + normal * (self.ratio * incident - refracted)).normalize())
    }
}

/// Returns the indices of refraction of red, green and blue, of a medium with this index and dispersion, which is 20
/// divided by the Abbe number: half of what blue and red differ by is (n − 1) dispersion/40
/// (KHR_materials_dispersion). The index of red does not fall below that of a vacuum.
pub fn indices_by_color(ior: f64, dispersion: f32) -> [f64; 3] {
    let spread = (ior - 1.0).max(0.0) * 0.025 * f64::from(dispersion);
    [(ior - spread).max(ior.min(1.0)), ior, ior + spread]
}

/// Returns the share of light that is left after `length` in a medium: e^(−absorption · length), by
/// Beer and Lambert. Without absorption it is 1, even after an infinite length.
pub fn transmittance(absorption: Vec3, length: f64) -> DVec3 {
    let share = |a: f32| if a == 0.0 { 1.0 } else { (-f64::from(a) * length).exp() };
    DVec3::new(share(absorption.x), share(absorption.y), share(absorption.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GLASS: f64 = 1.5;

    fn at(degrees: f64, from: f64, to: f64) -> DielectricInterface {
        DielectricInterface::new(degrees.to_radians().cos(), from, to)
    }

    #[test]
    fn indices_by_color_differ_by_the_abbe_number() {
        let [red, green, blue] = indices_by_color(1.5, 20.0 / 58.0);
        // V = (n − 1) / (n of blue − n of red).
        assert!(((green - 1.0) / (blue - red) - 58.0).abs() < 1e-4);
        assert_eq!(indices_by_color(1.5, 0.0), [1.5; 3]);
        assert_eq!(indices_by_color(1.5, 100.0)[0], 1.0);
    }

    #[test]
    fn fresnel_head_on_is_the_squared_difference_over_the_sum() {
        assert!((at(0.0, 1.0, GLASS).reflected - 0.04).abs() < 1e-15);
        assert!((at(0.0, GLASS, 1.0).reflected - 0.04).abs() < 1e-15);
    }

    #[test]
    fn fresnel_at_45_degrees() {
        // θ₂ = asin(sin 45° / 1.5): r⊥ = −sin(θ₁−θ₂)/sin(θ₁+θ₂), r∥ = tan(θ₁−θ₂)/tan(θ₁+θ₂).
        let (before, behind) = (45f64.to_radians(), (45f64.to_radians().sin() / GLASS).asin());
        let (difference, sum) = (before - behind, before + behind);
        let across = (difference.sin() / sum.sin()).powi(2);
        let along = (difference.tan() / sum.tan()).powi(2);
        let expected = (across + along) / 2.0;
        assert!((at(45.0, 1.0, GLASS).reflected - expected).abs() < 1e-15, "{expected}");
    }

    #[test]
    fn at_brewsters_angle_only_one_polarisation_is_reflected() {
        // tan θ = n₂/n₁ gives r∥ = 0 and r⊥ = (n₁² − n₂²)/(n₁² + n₂²).
        let brewster = GLASS.atan().to_degrees();
        let across: f64 = (1.0 - GLASS * GLASS) / (1.0 + GLASS * GLASS);
        let expected = across * across / 2.0;
        assert!((at(brewster, 1.0, GLASS).reflected - expected).abs() < 1e-15);
    }

    #[test]
    fn nearly_equal_indices_keep_their_digits_near_the_critical_angle() {
        // n₂ = 1, and cos θ₂ is given: cos² θ₁ = (cos² θ₂ + n₁² − 1) / n₁².
        for exponent in [-23, -30, -40] {
            let small = 2f64.powi(exponent);
            let (index, refracted) = (1.0 + small, 2f64.powi(exponent / 2 - 2));
            let cosine = (refracted * refracted + small * (2.0 + small)).sqrt() / index;
            let across = (index * cosine - refracted) / (index * cosine + refracted);
            let along = (cosine - index * refracted) / (cosine + index * refracted);
            let expected = (across * across + along * along) / 2.0;
            let found = DielectricInterface::new(cosine, index, 1.0).reflected;
            assert!((found / expected - 1.0).abs() < 1e-14, "{exponent}: {found} {expected}");
        }
    }

    #[test]
    fn beyond_the_critical_angle_all_is_reflected() {
        let critical = (1.0 / GLASS).asin().to_degrees();
        let normal = DVec3::Y;
        let beyond = at(critical + 1e-9, GLASS, 1.0);
        assert_eq!((beyond.reflected, beyond.refract(DVec3::NEG_Y, normal)), (1.0, None));
        let before = at(critical - 1e-9, GLASS, 1.0);
        assert!(before.reflected < 1.0 && before.reflected > 0.99);
    }

    #[test]
    fn snells_angle_from_air_into_glass() {
        let incoming = DVec3::new(30f64.to_radians().sin(), -30f64.to_radians().cos(), 0.0);
        let refracted = at(30.0, 1.0, GLASS).refract(incoming, DVec3::Y).unwrap();
        assert!((refracted.x - 0.5 / GLASS).abs() < 1e-15, "{refracted}");
        assert!((refracted.length() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn equal_media_are_no_interface() {
        let interface = at(80.0, 1.33, 1.33);
        assert_eq!((interface.reflected, interface.is_straight()), (0.0, true));
    }

    #[test]
    fn a_sheet_reflects_what_its_two_faces_do() {
        // 4% at either face: 0.04 + 0.96²·0.04/(1 − 0.04²).
        let expected = 0.04 + 0.96 * 0.96 * 0.04 / (1.0 - 0.04 * 0.04);
        assert!(
            (DielectricInterface::thin_sheet(1.0, 1.0, GLASS).reflected - expected).abs() < 1e-15
        );
    }

    #[test]
    fn absorption_over_a_known_length() {
        let left = transmittance(Vec3::new(0.0, 0.5, 2.0), 3.0);
        assert_eq!(left, DVec3::new(1.0, (-1.5f64).exp(), (-6f64).exp()));
        assert_eq!(transmittance(Vec3::X, f64::INFINITY), DVec3::new(0.0, 1.0, 1.0));
    }

    proptest! {
        #[test]
        fn the_share_that_is_reflected_is_the_same_both_ways(
            cosine in 0.01..1.0f64, from in 0.5..3.0f64, to in 0.5..3.0f64,
        ) {
            let (rare, dense) = (from.min(to), from.max(to));
            let inside = DielectricInterface::new(cosine, rare, dense).cosines[1];
            // The way out comes first: its small cosine, which has lost digits, is then that of both.
            let outward = DielectricInterface::new(inside, dense, rare);
            let inward = DielectricInterface::new(outward.cosines[1], rare, dense);
            prop_assert!((outward.reflected - inward.reflected).abs() < 1e-13);
        }

        #[test]
        fn shares_lie_between_nothing_and_all(
            cosine in 0.0..=1.0f64, from in 0.01..100.0f64, to in 0.01..100.0f64,
        ) {
            for interface in [DielectricInterface::new(cosine, from, to), DielectricInterface::thin_sheet(cosine, from, to)] {
                prop_assert!((0.0..=1.0).contains(&interface.reflected), "{interface:?}");
            }
        }

        #[test]
        fn refracted_directions_keep_n_times_the_sine(
            x in -1.0..1.0f64, z in -1.0..1.0f64, from in 0.5..3.0f64, to in 0.5..3.0f64,
        ) {
            let incoming = DVec3::new(x, -0.5, z).normalize();
            let interface = DielectricInterface::new(-incoming.y, from, to);
            if let Some(out) = interface.refract(incoming, DVec3::Y) {
                let (before, behind) = (incoming.cross(DVec3::Y), out.cross(DVec3::Y));
                prop_assert!((before * from - behind * to).length() < 1e-12);
            }
        }
    }
}
