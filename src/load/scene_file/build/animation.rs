//! The animation: a node in space and curves of other keys for each object with a name.

use glam::{DAffine3, DVec3};

use super::objects::{NamedObjects, ObjectKind, ResolvedPoint};
use super::tracks::{ObjectCurves, add_track};
use crate::error::{Error, Result};
use crate::load::scene_file::schema::animation_tables::{AnimationTable, OrbitTable};
use crate::load::scene_file::schema::spanned::{Spanned, Table};
use crate::load::scene_file::schema::tables::{ModelTable, SceneTable};
use crate::load::scene_file::source::Source;
use crate::scene::animation::{
    Anchor, Animation, Curve, Keyframes, Motion, Node, NodeId, Orbit, Rotation,
};

/// The default number of frames in a second.
const DEFAULT_FPS: f64 = 24.0;

/// The motion of an object with a name.
#[derive(Debug, Default)]
pub struct ObjectMotion {
    /// The space that it moves with.
    pub node: Option<NodeId>,
    /// True if keyframes move that space, with the object at its origin; otherwise the object is in
    /// it where its table puts it.
    pub is_keyed: bool,
    /// The curves of its animated keys.
    pub curves: ObjectCurves,
}

/// The motions of the objects of a file, by their index among the names; empty without an animation.
#[derive(Debug, Default)]
pub struct ObjectMotions(Vec<ObjectMotion>);

impl ObjectMotions {
    /// Returns the motion of an object.
    pub fn get(&self, object: usize) -> Option<&ObjectMotion> {
        self.0.get(object)
    }

    /// Returns a point that moves with the object that it is the position of.
    pub fn anchor(&self, point: ResolvedPoint) -> Anchor {
        let position = point.position;
        match point.object.and_then(|object| self.get(object)) {
            Some(ObjectMotion { node: node @ Some(_), is_keyed: true, .. }) => {
                Anchor { node: *node, point: DVec3::ZERO }
            }
            Some(motion) => Anchor { node: motion.node, point: position },
            None => Anchor::fixed(position),
        }
    }
}

/// Builds the animation of a file, with the motion of each of its objects; none if the file has none.
///
/// # Errors
/// When a track or an orbit is of no object, or of one that has no such key; when two of them
/// contradict one another; when objects orbit one another.
pub fn build_animation(
    source: &Source<'_>,
    tables: &SceneTable,
    objects: &NamedObjects,
) -> Result<(Option<Animation>, ObjectMotions)> {
    let Some(Spanned { value: Table(table), .. }) = &tables.animation else {
        return Ok((None, ObjectMotions::default()));
    };
    let fps = table.fps.map_or(DEFAULT_FPS, |fps| fps.0);
    let count = objects.objects.len();
    let mut builder = MotionBuilder {
        source,
        objects,
        models: named_models(tables, objects),
        orbits: orbits(source, table, objects)?,
        animation: Animation::new(table.frames.0, fps),
        motions: ObjectMotions((0..count).map(|_| ObjectMotion::default()).collect()),
        states: vec![BuildState::Pending; count],
    };
    // The curves first: an orbit has to know whether its centre has keys.
    for track in table.track.iter() {
        let object = objects.index(source, &track.object)?;
        let curves = &mut builder.motions.0[object].curves;
        add_track(source, &objects.objects[object], track, curves)?;
    }
    (0..count).try_for_each(|object| builder.build_with_centers(object))?;
    Ok((Some(builder.animation), builder.motions))
}

/// Returns the tables of named models, by their index among the names.
fn named_models<'t>(tables: &'t SceneTable, objects: &NamedObjects) -> Vec<Option<&'t ModelTable>> {
    let mut models = tables.model.iter().filter(|table| table.name.is_some());
    let table = |kind| if kind == ObjectKind::Model { models.next() } else { None };
    objects.objects.iter().map(|object| object.kind).map(table).collect()
}

/// An orbit, and its centre as the centre's own table gives it.
type ResolvedOrbit<'t> = (&'t OrbitTable, ResolvedPoint);

/// Returns the orbit of each object, by its index among the names.
fn orbits<'t>(
    source: &Source<'_>,
    table: &'t AnimationTable,
    objects: &NamedObjects,
) -> Result<Vec<Option<ResolvedOrbit<'t>>>> {
    let mut orbits: Vec<_> = objects.objects.iter().map(|_| None).collect();
    for table in table.orbit.iter() {
        let Spanned { span, value: name } = &table.object;
        let object = objects.index(source, &table.object)?;
        if objects.objects[object].position.is_none() {
            let noun = objects.objects[object].kind.noun();
            let message = format!("`{name}` is {noun}, which is nowhere and cannot go round");
            return Err(source.error(span, message));
        }
        let center = objects.resolve(source, &table.around)?;
        if orbits[object].replace((table, center)).is_some() {
            let message = format!("`{name}` has an orbit already");
            return Err(source.error(span, message).help("an object goes round one centre"));
        }
    }
    Ok(orbits)
}

/// The animation while it is built.
struct MotionBuilder<'a, 't> {
    source: &'a Source<'a>,
    objects: &'a NamedObjects,
    models: Vec<Option<&'t ModelTable>>,
    orbits: Vec<Option<ResolvedOrbit<'t>>>,
    animation: Animation,
    motions: ObjectMotions,
    states: Vec<BuildState>,
}

/// The state of an object's nodes.
#[derive(Clone, Copy, PartialEq)]
enum BuildState {
    Pending,
    /// The nodes of the orbit's centre have to be built first.
    InProgress,
    Built,
}

impl MotionBuilder<'_, '_> {
    /// Builds an object's nodes, after those of the objects that it orbits.
    fn build_with_centers(&mut self, object: usize) -> Result<()> {
        // From the object to its centre, and on to that one's centre.
        let mut chain = Vec::new();
        let mut next = Some(object);
        while let Some(object) = next.filter(|&object| self.states[object] != BuildState::Built) {
            if self.states[object] == BuildState::InProgress {
                return Err(self.cycle_error(object));
            }
            self.states[object] = BuildState::InProgress;
            chain.push(object);
            next = self.center_object(object);
        }
        for object in chain.into_iter().rev() {
            self.build_nodes(object)?;
            self.states[object] = BuildState::Built;
        }
        Ok(())
    }

    /// Returns the object that an object orbits.
    fn center_object(&self, object: usize) -> Option<usize> {
        self.orbits[object].as_ref()?.1.object
    }

    /// Returns the error that an object orbits itself, directly or by way of others.
    fn cycle_error(&self, object: usize) -> Error {
        let name = &self.objects.objects[object].name;
        let orbit = self.orbits[object].as_ref();
        let span = orbit.map_or(0..0, |(table, _)| table.around.span.clone());
        let message = match self.center_object(object) {
            Some(center) if center != object => {
                let is_direct = self.center_object(center) == Some(object);
                let other = &self.objects.objects[center].name;
                let verb = if is_direct { "goes" } else { "in the end goes" };
                format!("`{name}` goes round `{other}`, which {verb} round `{name}`")
            }
            _ => format!("`{name}` cannot go round itself"),
        };
        let help = "one of a chain of orbits must go round a point or what has no orbit";
        self.source.error(&span, message).help(help)
    }

    /// Adds the node of an object's orbit, and within it that of its keyframes.
    fn build_nodes(&mut self, object: usize) -> Result<()> {
        let orbit = self.orbit(object)?.map(Motion::Orbit);
        let keyframes = self.keyframes(object).map(Motion::Keyframes);
        let is_keyed = keyframes.is_some();
        let mut node = None;
        for motion in [orbit, keyframes].into_iter().flatten() {
            let base = DAffine3::IDENTITY;
            node = Some(self.animation.add_node(Node { parent: node, base, motion }));
        }
        let motion = &mut self.motions.0[object];
        (motion.node, motion.is_keyed) = (node, is_keyed);
        Ok(())
    }

    /// Returns the orbit of an object, if it has one.
    fn orbit(&self, object: usize) -> Result<Option<Orbit>> {
        let Some((table, center)) = &self.orbits[object] else { return Ok(None) };
        // A track may not move what an orbit moves.
        if let Some(Spanned { span, .. }) = &self.motions.0[object].curves.position {
            let name = &self.objects.objects[object].name;
            let message = format!("`{name}` is moved by its orbit already");
            return Err(self.source.error(span, message).help("leave out one of the two"));
        }
        // At time 0 no orbit has moved anything, and keys may have.
        let center_curve = center.object.and_then(|i| self.motions.0[i].curves.position.as_ref());
        Ok(Some(Orbit {
            around: self.motions.anchor(*center),
            center: center_curve.map_or(center.position, |curve| curve.value.sample(0.0)),
            start: self.objects.objects[object].position.unwrap_or_default(),
            axis: table.axis.map_or(DVec3::Y, |axis| axis.0),
            period: table.period.map_or(f64::INFINITY, |period| period.0),
            turns_with_orbit: table.turn.unwrap_or(false),
        }))
    }

    /// Returns the keyframes of an object's own space, if its position, rotation or scale has any.
    fn keyframes(&self, object: usize) -> Option<Keyframes> {
        let ObjectCurves { position, rotation, scale, .. } = &self.motions.0[object].curves;
        if position.is_none() && rotation.is_none() && scale.is_none() {
            return None;
        }
        let curve = |curve: &Option<Spanned<Curve<DVec3>>>, still| match curve {
            Some(curve) => curve.value.clone(),
            None => Curve::constant(still),
        };
        let mut keyframes = Keyframes::identity();
        let still = self.objects.objects[object].position.unwrap_or_default();
        keyframes.translation = curve(position, still);
        if let Some(table) = self.models[object] {
            let angles = table.rotate.map_or(DVec3::ZERO, |angles| angles.radians());
            keyframes.rotation = Rotation::Angles(curve(rotation, angles));
            keyframes.scale = curve(scale, table.scale.map_or(DVec3::ONE, |scale| scale.0));
        }
        Some(keyframes)
    }
}
