//! The motion of named objects: from `[animation]` to nodes, and to curves for what is not a place.

use glam::{DAffine3, DVec3};

use super::animation_tables::{AnimationTable, OrbitTable};
use super::names::{Names, What};
use super::source::Source;
use super::spanned::{At, Table};
use super::tables::{ModelTable, SceneTable};
use super::track::{Curves, curves};
use crate::error::{Error, Result};
use crate::scene::animation::{
    Anchor, Animation, Curve, Keyframes, Motion, Node, NodeId, Orbit, Rotation,
};

/// Frames in a second of an animation that says nothing of it.
const DEFAULT_FPS: f64 = 24.0;

/// How a named object moves.
#[derive(Debug, Default)]
pub struct Rig {
    /// The space that it moves with.
    pub node: Option<NodeId>,
    /// Whether that space is its own, with the object at its origin; otherwise the object stands
    /// in it where its table places it.
    pub is_own: bool,
    /// What changes besides.
    pub curves: Curves,
}

/// How all objects of a file move, by their index among the names.
#[derive(Debug, Default)]
pub struct Rigs(Vec<Rig>);

impl Rigs {
    /// How an object moves; nothing for one without a name.
    pub fn get(&self, object: Option<usize>) -> Option<&Rig> {
        self.0.get(object?)
    }

    /// The point that is an object's place; `position` is where its table puts it.
    pub fn anchor(&self, object: Option<usize>, position: DVec3) -> Anchor {
        Self::anchor_of(self.get(object), position)
    }

    fn anchor_of(rig: Option<&Rig>, position: DVec3) -> Anchor {
        match rig {
            Some(Rig { node: node @ Some(_), is_own: true, .. }) => {
                Anchor { node: *node, point: DVec3::ZERO }
            }
            Some(rig) => Anchor { node: rig.node, point: position },
            None => Anchor::fixed(position),
        }
    }
}

/// The animation of a file, and how each of its objects moves in it.
pub fn animation(
    source: &Source<'_>,
    tables: &SceneTable,
    names: &Names,
) -> Result<(Option<Animation>, Rigs)> {
    let Some(At { value: Table(table), .. }) = &tables.animation else {
        return Ok((None, Rigs::default()));
    };
    let fps = table.fps.map_or(DEFAULT_FPS, |fps| fps.0);
    let mut builder = Builder {
        source,
        names,
        models: models(tables, names),
        orbits: orbits(source, table, names)?,
        animation: Animation::new(table.frames.0, fps),
        rigs: (0..names.objects.len()).map(|_| Rig::default()).collect(),
        state: vec![State::Open; names.objects.len()],
    };
    for track in &table.track.0 {
        let track = &track.value.0;
        let At { span, value: name } = &track.object;
        let object = names.find(source, name, span)?;
        curves(source, &names.objects[object], track, &mut builder.rigs[object].curves)?;
    }
    for object in 0..names.objects.len() {
        builder.chain(object)?;
    }
    Ok((Some(builder.animation), Rigs(builder.rigs)))
}

/// The tables of named models, by their index among the names.
fn models<'t>(tables: &'t SceneTable, names: &Names) -> Vec<Option<&'t ModelTable>> {
    let mut named = tables.model.0.iter().map(|t| &t.value.0).filter(|table| table.name.is_some());
    let of = |what| if what == What::Model { named.next() } else { None };
    names.objects.iter().map(|object| object.what).map(of).collect()
}

/// The orbit of each object, with the object that it goes round and where that is.
fn orbits<'t>(
    source: &Source<'_>,
    table: &'t AnimationTable,
    names: &Names,
) -> Result<Vec<Option<Around<'t>>>> {
    let mut orbits: Vec<Option<Around<'t>>> = names.objects.iter().map(|_| None).collect();
    for orbit in &table.orbit.0 {
        let orbit = &orbit.value.0;
        let At { span, value: name } = &orbit.object;
        let object = names.find(source, name, span)?;
        if names.objects[object].position.is_none() {
            let what = names.objects[object].what.name();
            let message = format!("`{name}` is {what}, which is nowhere and cannot go round");
            return Err(source.error(span, message));
        }
        let (around, center) = names.spot(source, &orbit.around)?;
        if orbits[object].replace(Around { orbit, around, center }).is_some() {
            let message = format!("`{name}` has an orbit already");
            return Err(source.error(span, message).help("an object goes round one centre"));
        }
    }
    Ok(orbits)
}

struct Around<'t> {
    orbit: &'t OrbitTable,
    around: Option<usize>,
    /// Where the centre's own table puts it.
    center: DVec3,
}

struct Builder<'a, 't> {
    source: &'a Source<'a>,
    names: &'a Names,
    models: Vec<Option<&'t ModelTable>>,
    orbits: Vec<Option<Around<'t>>>,
    animation: Animation,
    rigs: Vec<Rig>,
    state: Vec<State>,
}

/// How far an object's nodes are.
#[derive(Clone, Copy, PartialEq)]
enum State {
    Open,
    /// For what it goes round.
    Waits,
    Built,
}

impl Builder<'_, '_> {
    /// Builds an object's nodes, after those that it goes round.
    fn chain(&mut self, object: usize) -> Result<()> {
        let mut chain = Vec::new();
        let mut next = Some(object);
        while let Some(object) = next.filter(|&object| self.state[object] != State::Built) {
            if self.state[object] == State::Waits {
                return Err(self.circle(object));
            }
            self.state[object] = State::Waits;
            chain.push(object);
            next = self.orbits[object].as_ref().and_then(|orbit| orbit.around);
        }
        for object in chain.into_iter().rev() {
            self.build(object)?;
            self.state[object] = State::Built;
        }
        Ok(())
    }

    /// The error that an object goes round itself.
    fn circle(&self, object: usize) -> Error {
        let name = &self.names.objects[object].name;
        let orbit = self.orbits[object].as_ref();
        let span = orbit.map_or(0..0, |orbit| orbit.orbit.around.span.clone());
        let message = match orbit.and_then(|orbit| orbit.around) {
            Some(around) if around != object => {
                let next = |object: usize| self.orbits[object].as_ref().and_then(|o| o.around);
                let direct = next(around) == Some(object);
                let other = &self.names.objects[around].name;
                let by = if direct { "goes" } else { "in the end goes" };
                format!("`{name}` goes round `{other}`, which {by} round `{name}`")
            }
            _ => format!("`{name}` cannot go round itself"),
        };
        let help = "one of a chain of orbits must go round a point or what has no orbit";
        self.source.error(&span, message).help(help)
    }

    fn build(&mut self, object: usize) -> Result<()> {
        let orbit = self.orbit(object)?;
        let node = orbit.map(|orbit| {
            let (parent, place) = (None, DAffine3::IDENTITY);
            self.animation.add_node(Node { parent, base: place, motion: Motion::Orbit(orbit) })
        });
        self.rigs[object].node = node;
        let Some(keys) = self.keys(object) else { return Ok(()) };
        let keyed =
            Node { parent: node, base: DAffine3::IDENTITY, motion: Motion::Keyframes(keys) };
        self.rigs[object].node = Some(self.animation.add_node(keyed));
        self.rigs[object].is_own = true;
        Ok(())
    }

    fn orbit(&self, object: usize) -> Result<Option<Orbit>> {
        let Some(Around { orbit, around, center }) = &self.orbits[object] else { return Ok(None) };
        if let Some(At { span, .. }) = &self.rigs[object].curves.position {
            let name = &self.names.objects[object].name;
            let message = format!("`{name}` is moved by its orbit already");
            return Err(self.source.error(span, message).help("leave out one of the two"));
        }
        let anchor = Rigs::anchor_of(around.map(|around| &self.rigs[around]), *center);
        let start = self.names.objects[object].position.unwrap_or_default();
        // At time 0 no orbit has moved anything, and keys may have.
        let keyed = around.and_then(|around| self.rigs[around].curves.position.as_ref());
        Ok(Some(Orbit {
            around: anchor,
            center: keyed.map_or(*center, |curve| curve.value.sample(0.0)),
            start,
            axis: orbit.axis.map_or(DVec3::Y, |axis| axis.0),
            period: orbit.period.map_or(f64::INFINITY, |period| period.0),
            turns_with_orbit: orbit.turn.unwrap_or(false),
        }))
    }

    /// The keys of an object's own space, if its place, rotation or scale has any.
    fn keys(&self, object: usize) -> Option<Keyframes> {
        let curves = &self.rigs[object].curves;
        let position = curves.position.as_ref().map(|curve| curve.value.clone());
        if position.is_none() && curves.rotation.is_none() && curves.scale.is_none() {
            return None;
        }
        let still = self.names.objects[object].position.unwrap_or_default();
        let mut keys = Keyframes::identity();
        keys.translation = position.unwrap_or(Curve::constant(still));
        if let Some(table) = self.models[object] {
            let angles = table.rotate.map_or(DVec3::ZERO, |angles| angles.radians());
            let scale = table.scale.map_or(DVec3::ONE, |scale| scale.0);
            let rotation = curves.rotation.clone().unwrap_or(Curve::constant(angles));
            keys.rotation = Rotation::Angles(rotation);
            keys.scale = curves.scale.clone().unwrap_or(Curve::constant(scale));
        }
        Some(keys)
    }
}
