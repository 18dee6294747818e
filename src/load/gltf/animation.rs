//! A file's own animation: what its channels say of the translation, rotation and scale of nodes.
//!
//! Faults are warnings: a model that cannot move as it should can still be shown.

use std::collections::HashMap;

use glam::{DAffine3, DQuat, DVec3};
use gltf::json;
use gltf::json::Node as JsonNode;
use gltf::json::animation::{Channel, Interpolation as Kind, Property, Sampler};
use gltf::json::validation::Checked;

use super::accessor::Accessors;
use super::buffers::get;
use crate::error::{Error, Result};
use crate::load::diagnostics::Diagnostics;
use crate::load::limits::Limit;
use crate::load::sandbox::Sandbox;
use crate::load::spelling;
use crate::scene::animation::{
    Animated, Animation, Curve, Interpolate, Interpolation, Keyframes, MAX_FRAMES, Motion, Node,
    NodeId, Rotation,
};

/// Frames in a second of a model's own animation, which is made of times alone.
pub const FPS: f64 = 24.0;

/// An animation while a file is imported.
pub struct Clip {
    /// What moves, by the number of the node in the file.
    moves: HashMap<usize, Moves>,
    /// The weights of morph targets, by the number of the node in the file.
    weights: HashMap<usize, Vec<Curve<f64>>>,
    /// The time of the last key.
    seconds: f64,
    /// The nodes of the scene that is shown and move.
    nodes: Vec<Node>,
    /// What moves with them.
    pub movers: Vec<Animated>,
}

#[derive(Default)]
struct Moves {
    translation: Option<Curve<DVec3>>,
    rotation: Option<Curve<DQuat>>,
    scale: Option<Curve<DVec3>>,
}

impl Clip {
    /// The animation of a file with a name, or the first; an empty one where there is none.
    ///
    /// # Errors
    /// When there is none of that name.
    pub fn read(
        root: &json::Root,
        guard: &Sandbox,
        accessors: &Accessors,
        name: Option<&str>,
        tally: &mut Diagnostics,
    ) -> Result<Self> {
        let mut clip = Self {
            moves: HashMap::new(),
            weights: HashMap::new(),
            seconds: 0.0,
            nodes: Vec::new(),
            movers: Vec::new(),
        };
        let index = match name {
            Some(name) => named(root, name)?,
            None => 0,
        };
        let Some(animation) = root.animations.get(index) else { return Ok(clip) };
        for (i, channel) in animation.channels.iter().enumerate() {
            let at = format!("animations[{index}].channels[{i}]");
            let place = format!("animations[{index}]");
            let sampler = get(&animation.samplers, channel.sampler.value(), "sampler", &at);
            let read = sampler.and_then(|sampler| {
                let reader = Reader { accessors, guard, sampler, place: &place };
                clip.channel(root, channel, &reader)
            });
            if let Err(error) = read {
                let reason = "{} animation channels are left out: they are damaged";
                let advice = error.advice().map(|advice| format!("; {advice}")).unwrap_or_default();
                tally.add(reason, 1, || format!("{at} ({}{advice})", error.message()));
            }
        }
        Ok(clip)
    }

    fn channel(&mut self, root: &json::Root, channel: &Channel, reader: &Reader) -> Result<()> {
        let Checked::Valid(property) = channel.target.path else {
            return Err(Error::input("it moves something unknown"));
        };
        let node = get(&root.nodes, channel.target.node.value(), "node", reader.place)?;
        let morphs = property == Property::MorphTargetWeights;
        if node.matrix.is_some() && !morphs {
            return Err(Error::input("it moves a node with a matrix, which cannot be"));
        }
        let node = channel.target.node.value();
        let (is_there, last) = match property {
            Property::MorphTargetWeights => {
                let mesh = node_mesh(root, node)?;
                let targets = mesh.primitives.first().and_then(|p| p.targets.as_ref());
                let curves = reader.weights(targets.map_or(0, Vec::len))?;
                let last = curves.first().and_then(|c| c.times.last()).copied().unwrap_or(0.0);
                (self.weights.insert(node, curves).is_some(), last)
            }
            Property::Translation => {
                let curve = reader.curve(vector)?;
                put(&mut self.moves.entry(node).or_default().translation, curve)
            }
            Property::Rotation => {
                let curve = reader.curve(rotation)?;
                put(&mut self.moves.entry(node).or_default().rotation, curve)
            }
            Property::Scale => {
                let curve = reader.curve(vector)?;
                put(&mut self.moves.entry(node).or_default().scale, curve)
            }
        };
        if is_there {
            return Err(Error::input("another one moves the same"));
        }
        self.seconds = self.seconds.max(last);
        Ok(())
    }

    /// How much of each morph target a node's mesh has over time, where that changes.
    pub fn weights(&self, index: usize) -> Option<&[Curve<f64>]> {
        self.weights.get(&index).map(Vec::as_slice)
    }

    /// After how long it begins again.
    pub fn repeats(&self) -> Option<f64> {
        (self.seconds > 0.0).then_some(self.seconds)
    }

    /// The node of the animation for a node of the file, if that moves. `place` is where its parent
    /// stands in the space of the animation's node `parent`.
    pub fn node(
        &mut self,
        index: usize,
        node: &JsonNode,
        parent: Option<NodeId>,
        place: DAffine3,
    ) -> Option<NodeId> {
        let moves = self.moves.get(&index)?;
        let vector = |v: [f32; 3]| DVec3::from(v.map(f64::from));
        let still = node.rotation.unwrap_or_default().0.map(f64::from);
        let still = DQuat::from_array(still);
        let still = if still.length() > 0.0 { still.normalize() } else { DQuat::IDENTITY };
        let translation = vector(node.translation.unwrap_or_default());
        let scale = vector(node.scale.unwrap_or([1.0; 3]));
        let keys = Keyframes {
            translation: moves.translation.clone().unwrap_or(Curve::constant(translation)),
            rotation: Rotation::Quaternions(
                moves.rotation.clone().unwrap_or(Curve::constant(still)),
            ),
            scale: moves.scale.clone().unwrap_or(Curve::constant(scale)),
            period: self.repeats(),
        };
        self.nodes.push(Node { parent, base: place, motion: Motion::Keyframes(keys) });
        Some(NodeId(self.nodes.len() as u32 - 1))
    }

    /// The animation, as long as the file's; none where nothing moves.
    pub fn finish(self) -> Option<Animation> {
        if self.movers.is_empty() {
            return None;
        }
        // Rounding in f32 makes no frame of its own.
        let frames = (self.seconds * FPS - 1e-3).ceil().clamp(1.0, f64::from(MAX_FRAMES));
        let (nodes, movers) = (self.nodes, self.movers);
        Some(Animation { frames: frames as u32, fps: FPS, nodes, objects: movers })
    }
}

/// The mesh of a node of the file.
fn node_mesh(root: &json::Root, node: usize) -> Result<&json::Mesh> {
    let mesh = root.nodes.get(node).and_then(|node| node.mesh);
    let mesh = mesh.and_then(|mesh| root.meshes.get(mesh.value()));
    mesh.ok_or_else(|| Error::input("it morphs a node without a mesh"))
}

/// Puts a curve in its place; says whether there was one, and when it ends.
fn put<T: Interpolate>(to: &mut Option<Curve<T>>, curve: Curve<T>) -> (bool, f64) {
    let last = curve.times.last().copied().unwrap_or(0.0);
    (to.replace(curve).is_some(), last)
}

/// The number of the animation with a name.
fn named(root: &json::Root, name: &str) -> Result<usize> {
    let of = |animation: &json::Animation| animation.name.as_deref() == Some(name);
    root.animations.iter().position(of).ok_or_else(|| {
        let names: Vec<&str> = root.animations.iter().filter_map(|a| a.name.as_deref()).collect();
        Error::input(format!("there is no animation `{name}`")).help(match &names[..] {
            [] => "no animation of the file has a name; without one the first is played".to_owned(),
            names => spelling::choice(name, names, "animations"),
        })
    })
}

struct Reader<'a> {
    accessors: &'a Accessors<'a>,
    guard: &'a Sandbox,
    sampler: &'a Sampler,
    place: &'a str,
}

impl Reader<'_> {
    /// The times of so many curves.
    fn times(&self, curves: u64) -> Result<Vec<f64>> {
        // A small file can name the same ones any number of times.
        let keys = self.accessors.count(self.sampler.input.value()).saturating_mul(curves);
        self.guard.take(Limit::Keys, keys)?;
        let place = format!("{}.samplers.input", self.place);
        let times = self.accessors.floats::<1>(self.sampler.input.value(), &place)?;
        Ok(times.into_iter().map(|[t]| f64::from(t)).collect())
    }

    /// The curves of so many weights, which the file has side by side for each time; a spline's
    /// slopes stand before and after them (appendix C of the standard).
    fn weights(&self, count: usize) -> Result<Vec<Curve<f64>>> {
        let times = self.times(count.max(1) as u64)?;
        let place = format!("{}.samplers.output", self.place);
        let values = self.accessors.floats::<1>(self.sampler.output.value(), &place)?;
        let Checked::Valid(kind) = self.sampler.interpolation else {
            return Err(Error::input("the interpolation is of no known kind"));
        };
        let rows = if kind == Kind::CubicSpline { 3 } else { 1 };
        if count == 0 || values.len() != times.len() * count * rows {
            let (found, times) = (values.len(), times.len());
            return Err(Error::input(format!(
                "{found} numbers for {count} morph targets at {times} times"
            )));
        }
        let value = |time: usize, row: usize, i: usize| {
            f64::from(values[(time * rows + row) * count + i][0])
        };
        let curve = |i: usize| {
            let every = || 0..times.len();
            let (middle, interpolation) = match kind {
                Kind::Linear => (0, Interpolation::Linear),
                Kind::Step => (0, Interpolation::Step),
                Kind::CubicSpline => {
                    let slopes = every().map(|t| [value(t, 0, i), value(t, 2, i)]);
                    (1, Interpolation::Cubic(slopes.collect()))
                }
            };
            let values = every().map(|t| value(t, middle, i)).collect();
            let curve = Curve { times: times.clone(), values, interpolation };
            curve.check().map(|()| curve)
        };
        (0..count).map(curve).collect()
    }

    /// The curve of a sampler; `value` makes a value of its numbers, or a slope where the flag is
    /// not set.
    fn curve<T: Interpolate, const N: usize>(
        &self,
        value: impl Fn([f32; N], bool) -> T,
    ) -> Result<Curve<T>> {
        let by = |what: &str| format!("{}.samplers.{what}", self.place);
        let times = self.times(1)?;
        let read = self.accessors.floats::<N>(self.sampler.output.value(), &by("output"))?;
        let Checked::Valid(kind) = self.sampler.interpolation else {
            return Err(Error::input("the interpolation is of no known kind"));
        };
        let (values, interpolation) = match kind {
            Kind::Linear => (read.iter().map(|&v| value(v, true)).collect(), Interpolation::Linear),
            Kind::Step => (read.iter().map(|&v| value(v, true)).collect(), Interpolation::Step),
            Kind::CubicSpline => {
                let (triples, rest) = read.as_chunks::<3>();
                if !rest.is_empty() {
                    return Err(Error::input("a spline's values do not come in threes"));
                }
                let slopes = triples.iter().map(|[a, _, b]| [value(*a, false), value(*b, false)]);
                let slopes = slopes.collect();
                let values = triples.iter().map(|[_, v, _]| value(*v, true)).collect();
                (values, Interpolation::Cubic(slopes))
            }
        };
        let curve = Curve { times, values, interpolation };
        curve.check()?;
        Ok(curve)
    }
}

fn vector(v: [f32; 3], _: bool) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

/// A rotation, which f32 leaves a little off length 1, or a slope, which has any.
fn rotation(v: [f32; 4], is_value: bool) -> DQuat {
    let quaternion = DQuat::from_array(v.map(f64::from));
    // One of length 0 is no rotation, which `Curve::check` finds.
    if is_value && quaternion.length() > 0.0 { quaternion.normalize() } else { quaternion }
}
