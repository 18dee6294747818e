//! An animation of the file: the channels that move nodes and morph meshes.
//!
//! Damaged channels are warnings: a model that cannot move as it should can still be shown.

use std::collections::HashMap;

use glam::{DAffine3, DQuat, DVec3};
use gltf::json::animation::{Channel, Interpolation as SamplerInterpolation, Property, Sampler};
use gltf::json::{self, validation::Checked};

use super::vectors::{unit_quaternion, vector};
use crate::error::{Error, Result};
use crate::load::diagnostics::Diagnostics;
use crate::load::gltf::accessor::Accessors;
use crate::load::gltf::json::{NodeTransform, lookup};
use crate::load::limits::Limit;
use crate::load::spelling;
use crate::scene::animation::{
    Animated, Animation, Curve, Interpolate, Interpolation, Keyframes, MAX_FRAMES, Motion, Node,
    NodeId, Rotation,
};

/// The frames per second of a model's own animation, which has times alone.
const FPS: f64 = 24.0;

/// The animation of a file that is imported.
#[derive(Default)]
pub struct AnimationClip {
    /// The curves of nodes, by the index of the node in the file.
    nodes: HashMap<usize, NodeCurves>,
    /// The weights of each morph target over time, where they change, by the index of the node in
    /// the file.
    pub weights: HashMap<usize, Vec<Curve<f64>>>,
    /// The time of the last key, in seconds.
    duration: f64,
    /// The animated nodes of the scene that is shown.
    scene_nodes: Vec<Node>,
    /// The animated objects of the scene.
    pub objects: Vec<Animated>,
}

/// The curves of a node's transform.
#[derive(Default)]
struct NodeCurves {
    translation: Option<Curve<DVec3>>,
    rotation: Option<Curve<DQuat>>,
    scale: Option<Curve<DVec3>>,
}

impl AnimationClip {
    /// Reads the animation of a file that has a name, or the first; an empty one if there is none.
    ///
    /// # Errors
    /// When there is none of that name.
    pub fn read(
        accessors: &Accessors,
        name: Option<&str>,
        diagnostics: &mut Diagnostics,
    ) -> Result<Self> {
        let mut clip = Self::default();
        let root = accessors.buffers.root;
        // The first animation is played, unless another one is chosen.
        let index = name.map_or(Ok(0), |name| find_animation(root, name))?;
        let Some(animation) = root.animations.get(index) else { return Ok(clip) };

        // Each channel moves one property of one node; damaged ones are left out.
        let path = format!("animations[{index}]");
        for (i, channel) in animation.channels.iter().enumerate() {
            let at = format!("{path}.channels[{i}]");
            let sampler = lookup(&animation.samplers, channel.sampler.value(), "sampler", &at);
            let read = sampler.and_then(|sampler| {
                clip.add_channel(channel, &SamplerReader { accessors, sampler, path: &path })
            });
            if let Err(error) = read {
                let reason = "{} animation channels are left out: they are damaged";
                let advice = error.advice().map(|advice| format!("; {advice}")).unwrap_or_default();
                diagnostics.add(reason, 1, || format!("{at} ({}{advice})", error.message()));
            }
        }
        Ok(clip)
    }

    /// Adds the curve of a node's property, or of the weights of its morph targets.
    fn add_channel(&mut self, channel: &Channel, reader: &SamplerReader) -> Result<()> {
        // The property and the node that it moves.
        let Checked::Valid(property) = channel.target.path else {
            return Err(Error::input("it moves something unknown"));
        };
        let root = reader.accessors.buffers.root;
        let index = channel.target.node.value();
        let node = lookup(&root.nodes, index, "node", reader.path)?;
        if node.matrix.is_some() && property != Property::MorphTargetWeights {
            return Err(Error::input("it moves a node with a matrix, which cannot be"));
        }
        // A curve that cannot be read leaves the node as it is.
        let last = match property {
            Property::MorphTargetWeights => {
                let mesh = node.mesh.and_then(|mesh| root.meshes.get(mesh.value()));
                let mesh = mesh.ok_or_else(|| Error::input("it morphs a node without a mesh"))?;
                // All primitives of a mesh have as many targets as the first.
                let targets = mesh.primitives.first().and_then(|p| p.targets.as_ref());
                let count = targets.map_or(0, Vec::len);
                let curves = reader.curves(count, |[weight], _| f64::from(weight))?;
                let last = curves.first().map_or(0.0, last_time);
                check_first(self.weights.insert(index, curves))?;
                last
            }
            Property::Translation => {
                let curve = reader.curve(|v, _| vector(v))?;
                set_curve(&mut self.nodes.entry(index).or_default().translation, curve)?
            }
            Property::Rotation => {
                let curve = reader.curve(rotation)?;
                set_curve(&mut self.nodes.entry(index).or_default().rotation, curve)?
            }
            Property::Scale => {
                let curve = reader.curve(|v, _| vector(v))?;
                set_curve(&mut self.nodes.entry(index).or_default().scale, curve)?
            }
        };
        self.duration = self.duration.max(last);
        Ok(())
    }

    /// The period after which the animation begins again, in seconds.
    pub fn period(&self) -> Option<f64> {
        (self.duration > 0.0).then_some(self.duration)
    }

    /// Adds a node of the file to the animation, if it moves. `base` takes the space of its parent
    /// to that of the animation's node `parent`.
    pub fn add_node(
        &mut self,
        index: usize,
        node: &NodeTransform,
        parent: Option<NodeId>,
        base: DAffine3,
    ) -> Option<NodeId> {
        let NodeCurves { translation, rotation, scale } = self.nodes.get(&index)?;
        // Properties without a curve keep the value of the node.
        let still = node.rotation.and_then(unit_quaternion).unwrap_or(DQuat::IDENTITY);
        let keys = Keyframes {
            translation: translation.clone().unwrap_or_else(|| Curve::constant(node.translation())),
            rotation: Rotation::Quaternions(
                rotation.clone().unwrap_or_else(|| Curve::constant(still)),
            ),
            scale: scale.clone().unwrap_or_else(|| Curve::constant(node.scale())),
            period: self.period(),
        };
        // The node stands where its parent's space places it.
        self.scene_nodes.push(Node { parent, base, motion: Motion::Keyframes(keys) });
        Some(NodeId(self.scene_nodes.len() as u32 - 1))
    }

    /// Returns the animation, as long as the file's; `None` if nothing moves.
    pub fn into_animation(self) -> Option<Animation> {
        if self.objects.is_empty() {
            return None;
        }
        // Rounding in f32 makes no frame of its own.
        let frames = (self.duration * FPS - 1e-3).ceil().clamp(1.0, f64::from(MAX_FRAMES)) as u32;
        Some(Animation { frames, fps: FPS, nodes: self.scene_nodes, objects: self.objects })
    }
}

/// The time of a curve's last key, in seconds.
fn last_time<T>(curve: &Curve<T>) -> f64 {
    curve.times.last().copied().unwrap_or(0.0)
}

/// Sets a curve of a node, and returns the time of its last key.
///
/// # Errors
/// When there was one before.
fn set_curve<T>(slot: &mut Option<Curve<T>>, curve: Curve<T>) -> Result<f64> {
    let last = last_time(&curve);
    check_first(slot.replace(curve))?;
    Ok(last)
}

/// Checks that the curves of a channel replace no others.
fn check_first<T>(replaced: Option<T>) -> Result<()> {
    replaced.map_or(Ok(()), |_| Err(Error::input("another one moves the same")))
}

/// Returns the index of the animation with a name.
fn find_animation(root: &json::Root, name: &str) -> Result<usize> {
    let has_name = |animation: &json::Animation| animation.name.as_deref() == Some(name);
    root.animations.iter().position(has_name).ok_or_else(|| {
        let names: Vec<&str> = root.animations.iter().filter_map(|a| a.name.as_deref()).collect();
        Error::input(format!("there is no animation `{name}`")).help(match &names[..] {
            [] => "no animation of the file has a name; without one the first is played".to_owned(),
            names => spelling::choice(name, names, "animations"),
        })
    })
}

/// A sampler of an animation.
struct SamplerReader<'a> {
    accessors: &'a Accessors<'a>,
    sampler: &'a Sampler,
    /// The JSON path of the animation.
    path: &'a str,
}

impl SamplerReader<'_> {
    /// Returns the curve of a property; `convert` makes a value of its numbers, or a slope if the
    /// flag is not set.
    fn curve<T: Interpolate, const N: usize>(
        &self,
        convert: impl Fn([f32; N], bool) -> T,
    ) -> Result<Curve<T>> {
        Ok(self.curves(1, convert)?.remove(0))
    }

    /// Returns `count` curves, whose values the file stores side by side for each time. The slopes
    /// of a spline are before and after its values (appendix C of the standard).
    fn curves<T: Interpolate, const N: usize>(
        &self,
        count: usize,
        convert: impl Fn([f32; N], bool) -> T,
    ) -> Result<Vec<Curve<T>>> {
        // A small file can name the same times for any number of curves.
        let Sampler { input, output, .. } = self.sampler;
        let keys = self.accessors.count(input.value()).saturating_mul(count.max(1) as u64);
        self.accessors.buffers.sandbox.consume(Limit::Keys, keys)?;

        // Times and values, of which a spline has three for each time.
        let path = |property: &str| format!("{}.samplers.{property}", self.path);
        let times = self.accessors.floats(input.value(), &path("input"))?;
        let times: Vec<f64> = times.into_iter().map(|[t]| f64::from(t)).collect();
        let values = self.accessors.floats(output.value(), &path("output"))?;
        let Checked::Valid(kind) = self.sampler.interpolation else {
            return Err(Error::input("the interpolation is of no known kind"));
        };
        let rows = if kind == SamplerInterpolation::CubicSpline { 3 } else { 1 };
        // There must be a value for each curve, time and row.
        if count == 0 || values.len() != times.len() * count * rows {
            let (found, times) = (values.len(), times.len());
            let message = format!("{found} values for {count} curves at {times} times");
            return Err(Error::input(message));
        }

        // Each curve takes its own column of the values.
        let curve = |i: usize| {
            // The values of a row, of which a spline has three: slope before, value, slope after.
            let row = |row: usize, is_value: bool| {
                let values = values.iter().skip(row * count + i).step_by(rows * count);
                let convert = &convert;
                values.map(move |&v| convert(v, is_value))
            };
            let (values, interpolation) = match kind {
                SamplerInterpolation::Linear => (row(0, true), Interpolation::Linear),
                SamplerInterpolation::Step => (row(0, true), Interpolation::Step),
                SamplerInterpolation::CubicSpline => {
                    let slopes = row(0, false).zip(row(2, false)).map(|(a, b)| [a, b]);
                    (row(1, true), Interpolation::Cubic(slopes.collect()))
                }
            };
            let curve = Curve { times: times.clone(), values: values.collect(), interpolation };
            curve.check().map(|()| curve)
        };
        (0..count).map(curve).collect()
    }
}

/// Returns a rotation, which f32 leaves a little off length 1, or a slope, which has any length.
fn rotation(v: [f32; 4], is_value: bool) -> DQuat {
    let quaternion = DQuat::from_array(v.map(f64::from));
    // A rotation of length 0 is found by `Curve::check`.
    if is_value && quaternion.length() > 0.0 { quaternion.normalize() } else { quaternion }
}
