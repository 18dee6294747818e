//! What of a scene moves, once its objects are there.

use glam::{DVec3, Vec3};

use super::animation::Rig;
use super::resolve::Resolver;
use super::tables::{CameraTable, LightTable, SphereTable};
use crate::error::Result;
use crate::scene::animation::{Aim, AimTarget, Anchor, Animated};
use crate::scene::{Camera, Light, LightKind, Sphere};

/// How the next sphere of the scene moves, if it does.
pub fn sphere(resolver: &Resolver<'_>, table: &SphereTable, sphere: &Sphere) -> Option<Animated> {
    let rig = resolver.rig(&table.name)?;
    let radius = rig.curves.radius.clone();
    let (moves, node) = (rig.node.is_some() || radius.is_some(), rig.node);
    let center = if rig.is_own { DVec3::ZERO } else { sphere.center };
    let sphere = resolver.scene.spheres.len();
    moves.then_some(Animated::Sphere { sphere, node, center, radius })
}

/// How the next light of the scene moves, if it does.
///
/// # Errors
/// When its colour times its intensity is beyond f32 at some time.
pub fn light(
    resolver: &Resolver<'_>,
    table: &LightTable,
    light: &Light,
) -> Result<Option<Animated>> {
    let Some(rig) = resolver.rig(&table.name) else { return Ok(None) };
    let mut rest = light.clone();
    if rig.is_own
        && let LightKind::Point { position, .. } | LightKind::Spot { position, .. } = &mut rest.kind
    {
        *position = DVec3::ZERO;
    }
    let direction = rig.curves.direction.clone();
    let mut intensity = None;
    if let Some(curve) = &rig.curves.intensity {
        let transfer = resolver.scene.film.transfer;
        rest.intensity = table.color.map_or(Vec3::ONE, |c| c.linear(transfer));
        let greatest = curve.value.values.iter().fold(0.0f64, |a, &b| a.max(b));
        if !(rest.intensity * greatest as f32).is_finite() {
            let message = "`color` times `intensity` is too large";
            return Err(resolver.source.error(&curve.span, message));
        }
        intensity = Some(curve.value.clone());
    }
    let moves = rig.node.is_some() || direction.is_some() || intensity.is_some();
    let (light, node) = (resolver.scene.lights.len(), rig.node);
    Ok(moves.then_some(Animated::Light { light, node, rest, direction, intensity }))
}

/// How the next camera of the scene moves, or what it looks at; nothing when neither does.
///
/// # Errors
/// When it looks at an object that there is not.
pub fn camera(
    resolver: &Resolver<'_>,
    table: &CameraTable,
    camera: &Camera,
) -> Result<Option<Animated>> {
    let still = Rig::default();
    let rig = resolver.rig(&table.name).unwrap_or(&still);
    let mut rest = camera.clone();
    if rig.is_own {
        rest.position = DVec3::ZERO;
    }
    let mut target = None;
    if let Some(look_at) = &table.look_at {
        let (object, position) = resolver.names.spot(resolver.source, look_at)?;
        target = Some(resolver.rigs.anchor(object, position));
    }
    let toward = match (&rig.curves.look_at, &rig.curves.direction, target) {
        (Some(points), ..) => Some(AimTarget::Points(points.clone())),
        (None, Some(directions), _) => Some(AimTarget::Directions(directions.clone())),
        (None, None, target) => target.map(AimTarget::Anchor),
    };
    let lens = rig.curves.lens.as_ref().map(|(make, curve)| {
        rest.projection = make(curve.sample(0.0), resolver.scene.film.size[0]);
        curve.clone()
    });
    let aims_at_rest = matches!(toward, None | Some(AimTarget::Anchor(Anchor { node: None, .. })));
    if aims_at_rest && lens.is_none() && rig.node.is_none() {
        return Ok(None);
    }
    let up = table.up.as_ref().map_or(DVec3::Y, |up| up.value.0);
    let aim = toward.map(|toward| Aim { target: toward, up });
    let (camera, node) = (resolver.scene.cameras.len(), rig.node);
    Ok(Some(Animated::Camera { camera, node, rest, aim, lens }))
}
