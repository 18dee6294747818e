//! What changes the shape of meshes: morph targets and skins.

use std::collections::HashMap;

use glam::{DAffine3, DMat4};
use gltf::json;
use gltf::json::Value;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

use super::accessor::Accessors;
use super::buffers::get;
use super::nodes::Placed;
use crate::error::{Error, Place, Result};
use crate::load::diagnostics::Diagnostics;
use crate::scene::animation::{Influences, Joint, MorphTarget};

/// The morph targets of a primitive of so many vertices.
///
/// # Errors
/// When an accessor cannot be read, or is not as long as the positions.
pub fn morphs(
    primitive: &Primitive,
    accessors: &Accessors,
    count: usize,
    tally: &mut Diagnostics,
    at: &str,
) -> Result<Vec<MorphTarget>> {
    let mut morphs = Vec::new();
    for (i, target) in primitive.targets.iter().flatten().enumerate() {
        let read = |index: &Option<json::Index<json::Accessor>>, name: &str| {
            let Some(index) = index else { return Ok(Vec::new()) };
            let place = format!("{at}.targets[{i}].{name}");
            let values = accessors.floats::<3>(index.value(), &place)?;
            match values.len() == count {
                true => Ok(values),
                false => Err(Error::input(format!("{} values for {count} vertices", values.len()))
                    .place(Place::Json(place))),
            }
        };
        let mut morph = MorphTarget {
            positions: read(&target.positions, "POSITION")?,
            normals: read(&target.normals, "NORMAL")?,
        };
        let mut bad = 0;
        for x in morph.positions.iter_mut().chain(&mut morph.normals).flatten() {
            if !x.is_finite() {
                *x = 0.0;
                bad += 1;
            }
        }
        tally.add("{} numbers of morph targets are not finite and become 0", bad, || {
            format!("{at}.targets[{i}]")
        });
        morphs.push(morph);
    }
    Ok(morphs)
}

/// How many attributes of a primitive's targets are none that is morphed here.
pub fn not_morphed(root: &Value, mesh: usize, primitive: usize) -> u64 {
    let targets = root.pointer(&format!("/meshes/{mesh}/primitives/{primitive}/targets"));
    let targets = targets.and_then(Value::as_array).into_iter().flatten();
    let names = targets.filter_map(Value::as_object).flat_map(|target| target.keys());
    names.filter(|n| n.starts_with("TEXCOORD_") || n.starts_with("COLOR_")).count() as u64
}

/// How the vertices of a primitive hang on joints, if they do.
///
/// # Errors
/// When an accessor cannot be read, or is not as long as the positions.
pub fn influences(
    primitive: &Primitive,
    accessors: &Accessors,
    count: usize,
    tally: &mut Diagnostics,
    at: &str,
) -> Result<Option<Influences>> {
    let index = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(|i| i.value());
    let sets = (0..).map_while(|n| index(Semantic::Joints(n)).zip(index(Semantic::Weights(n))));
    let mut read = Vec::new();
    for (n, (joints, weights)) in sets.enumerate() {
        let place = |name: &str| format!("{at}.attributes.{name}_{n}");
        let joints = accessors.floats::<4>(joints, &place("JOINTS"))?;
        let weights = accessors.colors::<4>(weights, &place("WEIGHTS"))?;
        for (found, name) in [(joints.len(), "JOINTS"), (weights.len(), "WEIGHTS")] {
            if found != count {
                return Err(Error::input(format!("{found} values for {count} vertices"))
                    .place(Place::Json(place(name))));
            }
        }
        read.push((joints, weights));
    }
    if read.is_empty() {
        return Ok(None);
    }
    let mut made = Influences { per_vertex: 4 * read.len(), ..Influences::default() };
    let (mut bad, mut loose) = (0, 0);
    for vertex in 0..count {
        let first = made.weights.len();
        for (joints, weights) in &read {
            made.joints.extend(joints[vertex].map(|joint| joint as u16));
            made.weights.extend(weights[vertex].map(|weight| {
                let sound = weight.is_finite() && weight >= 0.0;
                bad += u64::from(!sound);
                if sound { weight } else { 0.0 }
            }));
        }
        loose += u64::from(made.weights[first..].iter().all(|weight| *weight == 0.0));
    }
    let place = || format!("{at}.attributes.WEIGHTS_0");
    tally.add("{} weights of joints are negative or not finite and become 0", bad, place);
    tally.add("{} vertices have no weight at any joint and hang on their first", loose, place);
    Ok(Some(made))
}

/// The joints of a skin: as the file places them, and as they move.
///
/// # Errors
/// When it names what is not there, or its matrices cannot be read.
pub fn joints(
    root: &json::Root,
    accessors: &Accessors,
    nodes: &HashMap<usize, Placed>,
    skin: usize,
    by: &str,
) -> Result<Joints> {
    let source = get(&root.skins, skin, "skin", by)?;
    let count = source.joints.len();
    let at = format!("skins[{skin}].inverseBindMatrices");
    let binds = match source.inverse_bind_matrices {
        Some(index) => accessors.floats::<16>(index.value(), &at)?,
        None => vec![DMat4::IDENTITY.as_mat4().to_cols_array(); count],
    };
    if binds.len() < count {
        return Err(Error::input(format!("{} matrices for {count} joints", binds.len()))
            .place(Place::Json(at)));
    }
    if !binds.as_flattened().iter().all(|x| x.is_finite()) {
        return Err(Error::input("a matrix has a number that is not finite").place(Place::Json(at)));
    }
    let mut made = Joints { still: Vec::with_capacity(count), moving: Vec::new(), moves: false };
    for (i, (joint, bind)) in source.joints.iter().zip(&binds).enumerate() {
        let by = format!("skins[{skin}].joints[{i}]");
        get(&root.nodes, joint.value(), "node", &by)?;
        let placed = nodes.get(&joint.value());
        let bind = DAffine3::from_mat4(DMat4::from_cols_array(&bind.map(f64::from)));
        let (world, node, rest) = placed
            .map_or((DAffine3::IDENTITY, None, DAffine3::IDENTITY), |placed| {
                (placed.world, placed.mover, placed.rest)
            });
        made.still.push(Joint { node: None, transform: world, inverse_bind: bind });
        made.moving.push(Joint { node, transform: rest, inverse_bind: bind });
        made.moves |= node.is_some();
    }
    Ok(made)
}

/// The joints of a skin.
#[derive(Clone)]
pub struct Joints {
    /// As the file places them.
    pub still: Vec<Joint>,
    /// As they move with the nodes of the animation.
    pub moving: Vec<Joint>,
    /// Whether any does.
    pub moves: bool,
}
