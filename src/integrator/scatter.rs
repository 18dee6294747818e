//! What becomes of light at a surface: where it goes on, and with what share.

use glam::{DVec3, Vec3};

use crate::integrator::Integrator;
use crate::integrator::bodies::InterfaceMedia;
use crate::scene::ShadingParams;
use crate::shading::{DielectricInterface, reflect};
use crate::surface::Surface;

/// Where a surface sends light, and how much of it.
pub(super) struct Scattered {
    pub reflected: DVec3,
    /// `None` where it goes straight on, and where all is reflected.
    pub refracted: Option<DVec3>,
    /// Of the reflected and of the refracted ray.
    pub shares: [DVec3; 2],
}

impl Integrator<'_> {
    /// What becomes of light that comes along `incoming`, of length 1.
    pub(super) fn scatter(
        &self,
        finish: &ShadingParams,
        surface: &Surface,
        around: &InterfaceMedia,
        incoming: DVec3,
    ) -> Scattered {
        let material = &self.scene.materials[surface.material.0 as usize];
        let facing = surface.facing_normal();
        let shading = surface.normal * -surface.normal.dot(incoming).signum();
        let ior = |inside| self.bodies.medium(inside).ior;
        let by = |normal: DVec3| {
            let cosine = -normal.dot(incoming);
            let interface = if finish.transmit == Vec3::ZERO {
                DielectricInterface::new(cosine, 1.0, 1.0)
            } else if material.thin {
                DielectricInterface::sheet(cosine, ior(&around.before), material.ior)
            } else {
                DielectricInterface::new(cosine, ior(&around.before), ior(&around.behind))
            };
            let refracted = match interface.is_straight() {
                true => None,
                false => interface.refract(incoming, normal),
            };
            let (reflect_share, transmit) = (finish.reflect.as_dvec3(), finish.transmit.as_dvec3());
            Scattered {
                reflected: reflect(incoming, normal).normalize(),
                refracted,
                shares: [
                    reflect_share + transmit * interface.reflected,
                    transmit * (1.0 - interface.reflected),
                ],
            }
        };
        let scattered = by(shading);
        // An interpolated normal may send light to the wrong side of the surface itself.
        let wrong = scattered.reflected.dot(facing) <= 0.0
            || scattered.refracted.is_some_and(|refracted| refracted.dot(facing) >= 0.0);
        if wrong && shading != facing { by(facing) } else { scattered }
    }
}
