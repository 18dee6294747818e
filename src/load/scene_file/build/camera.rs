//! The cameras, and their motion.

use glam::DVec3;

use super::SceneBuilder;
use super::animation::ObjectMotion;
use super::tracks::{FOCAL_PX, FOV_X, FOV_Y, ONE_LENS, ORTHO_HEIGHT};
use crate::error::Result;
use crate::load::scene_file::schema::tables::CameraTable;
use crate::load::scene_file::schema::values::normalize;
use crate::load::scene_file::source::{Source, Span};
use crate::scene::animation::{Aim, AimTarget, Anchor, Animated};
use crate::scene::{Camera, Projection, ThinLens};

/// The default vertical field of view, in degrees.
const DEFAULT_FOV_Y: f64 = 45.0;

impl SceneBuilder<'_> {
    /// Adds the camera of the table at `span`.
    ///
    /// # Errors
    /// When its keys do not fit each other, or it looks at an object that there is not.
    pub fn add_camera(&mut self, table: &CameraTable, span: &Span) -> Result<()> {
        let camera = self.camera(table, span)?;
        let animated = self.animated_camera(table, &camera)?;
        self.add_animated(animated);
        self.scene.cameras.push(camera);
        Ok(())
    }

    /// Returns the camera that a table describes.
    fn camera(&self, table: &CameraTable, span: &Span) -> Result<Camera> {
        let source = self.source;
        // The forward direction, and the span of the key that gives it.
        let position = table.position.0;
        let (forward, forward_span) = match (&table.look_at, &table.direction) {
            (Some(target), None) => {
                let point = self.objects.resolve(source, target)?.position;
                let forward = normalize(point - position).ok_or_else(|| {
                    source
                        .error(&target.span, "the camera looks at the point where it stands")
                        .help("`look_at` must differ from `position`")
                })?;
                (forward, &target.span)
            }
            (None, Some(direction)) => (direction.value.0, &direction.span),
            (Some(_), Some(direction)) => {
                let key = source.key_span("direction", &direction.span);
                let message = "a camera has `look_at` or `direction`, not both";
                return Err(source.error(&key, message).help("leave one out"));
            }
            (None, None) => {
                let message = "[camera] needs the key `look_at`, or `direction`";
                return Err(source.error(span, message));
            }
        };
        // The axes and the projection.
        let up = table.up.as_ref().map_or(DVec3::Y, |up| up.value.0);
        let projection = projection(source, table, self.scene.film.size[0])?;
        let up_span = table.up.as_ref().map_or(forward_span, |up| &up.span);
        // From the origin, so that a position far out does not round the direction.
        let camera = Camera::look_at(DVec3::ZERO, forward, up, projection)
            .map_err(|e| source.locate(up_span, e))?;
        let name = table.name.as_ref().map(|name| name.value.clone()).unwrap_or_default();
        let distance = match &table.look_at {
            Some(target) => {
                Some((self.objects.resolve(source, target)?.position - position).length())
            }
            None => None,
        };
        let lens = thin_lens(source, table, &camera, distance)?;
        Ok(Camera { name, position, lens, ..camera })
    }

    /// Returns the animation of the next camera of the scene: none if neither the camera nor the
    /// object that it looks at moves.
    fn animated_camera(&self, table: &CameraTable, camera: &Camera) -> Result<Option<Animated>> {
        let still = ObjectMotion::default();
        let motion = self.motion(&table.name).unwrap_or(&still);
        let mut rest = camera.clone();
        if motion.is_keyed {
            rest.position = DVec3::ZERO;
        }
        // A track of the camera's own counts before the target in its table.
        let target = match &table.look_at {
            Some(look_at) => Some(self.motions.anchor(self.objects.resolve(self.source, look_at)?)),
            None => None,
        };
        let curves = &motion.curves;
        let target = match (&curves.look_at, &curves.direction, target) {
            (Some(points), ..) => Some(AimTarget::Points(points.value.clone())),
            (None, Some(directions), _) => Some(AimTarget::Directions(directions.value.clone())),
            (None, None, target) => target.map(AimTarget::Anchor),
        };
        // The projection; at rest it is that of time 0.
        let lens = curves.projection.as_ref().map(|(make, curve)| {
            rest.projection = make(curve.value.sample(0.0), self.scene.film.size[0]);
            curve.value.clone()
        });
        let has_fixed_aim =
            matches!(target, None | Some(AimTarget::Anchor(Anchor { node: None, .. })));
        if has_fixed_aim && lens.is_none() && motion.node.is_none() {
            return Ok(None);
        }
        let up = table.up.as_ref().map_or(DVec3::Y, |up| up.value.0);
        let aim = target.map(|target| Aim { target, up });
        let camera = self.scene.cameras.len();
        Ok(Some(Animated::Camera { camera, node: motion.node, rest, aim, lens }))
    }
}

/// Returns the lens of a camera, if it has one. It looks at a point at this distance, if at any.
fn thin_lens(
    source: &Source<'_>,
    table: &CameraTable,
    camera: &Camera,
    distance: Option<f64>,
) -> Result<Option<ThinLens>> {
    let (aperture, focus) = match (&table.aperture, &table.focus_distance) {
        (None, None) => return Ok(None),
        (None, Some(focus)) => {
            let key = source.key_span("focus_distance", &focus.span);
            let message = "`focus_distance` is about a lens, and the camera has none";
            return Err(source.error(&key, message).help("add `aperture`, the lens's diameter"));
        }
        (Some(aperture), focus) => (aperture, focus),
    };
    let key = source.key_span("aperture", &aperture.span);
    if matches!(camera.projection, Projection::OrthoHeight(_)) {
        let message = "an orthographic camera has no lens";
        return Err(source.error(&key, message).help("leave out `aperture`, or `ortho_height`"));
    }
    let given = focus.as_ref().map(|focus| focus.value.0);
    let Some(focus_distance) = given.or(distance) else {
        let message = "a lens needs the key `focus_distance`, or `look_at`";
        return Err(source.error(&key, message).help("add `focus_distance`"));
    };
    Ok(Some(ThinLens { aperture: aperture.value.0, focus_distance }))
}

/// Returns the projection of a camera for a film of a width in pixels.
fn projection(source: &Source<'_>, table: &CameraTable, width: u32) -> Result<Projection> {
    let given = [
        table.fov_y.as_ref().map(|a| (FOV_Y, &a.span, a.value.0.to_radians())),
        table.fov_x.as_ref().map(|a| (FOV_X, &a.span, a.value.0.to_radians())),
        table.focal_px.as_ref().map(|focal| (FOCAL_PX, &focal.span, focal.value.0)),
        table.ortho_height.as_ref().map(|height| (ORTHO_HEIGHT, &height.span, height.value.0)),
    ];
    match given.into_iter().flatten().collect::<Vec<_>>()[..] {
        [] => Ok(Projection::FovY(DEFAULT_FOV_Y.to_radians())),
        [((_, make_projection), _, value)] => Ok(make_projection(value, width)),
        [((first, _), ..), ((second, _), span, _), ..] => {
            let message = format!("a camera cannot have both `{first}` and `{second}`");
            Err(source.error(&source.key_span(second, span), message).help(ONE_LENS))
        }
    }
}
