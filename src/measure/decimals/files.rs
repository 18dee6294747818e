//! The decimals of the files that a scene is loaded from, read by code of their own: the positions of
//! OBJ files, the node transforms of glTF files, and the spheres, planes and models of scene files.

use dashu_ratio::RBig;
use glam::{DAffine3, DMat3, DVec3};
use serde::Deserialize;
use serde_json::value::RawValue;
use toml::de::{DeTable, DeValue};

use super::number::{Affine, Vector, decimal, float, nearest};

/// A transform twice: as its f64 expression gives it, and exact.
#[derive(Clone, Debug)]
pub struct Transform {
    pub rounded: DAffine3,
    pub exact: Affine,
}

impl Transform {
    /// Returns the transform that changes nothing.
    pub fn identity() -> Self {
        Self { rounded: DAffine3::IDENTITY, exact: Affine::identity() }
    }

    /// Returns the transform that does `first` before this one. Of the f64 matrix, each column of the
    /// product is (x·bₓ + y·b_y) + z·b_z.
    pub fn after(&self, first: &Self) -> Self {
        let [a, b] = [&self.rounded, &first.rounded];
        let turn = |v: DVec3| {
            let [x, y, z] =
                [a.matrix3.x_axis * v.x, a.matrix3.y_axis * v.y, a.matrix3.z_axis * v.z];
            x + y + z
        };
        let columns = [b.matrix3.x_axis, b.matrix3.y_axis, b.matrix3.z_axis].map(turn);
        let rounded = DAffine3 {
            matrix3: DMat3::from_cols(columns[0], columns[1], columns[2]),
            translation: turn(b.translation) + a.translation,
        };
        Self { rounded, exact: self.exact.after(&first.exact) }
    }
}

/// Returns the positions of an OBJ file that are near some `vertices`, with the weight of those that have
/// one divided out; what is no position is passed over.
pub fn obj_positions(text: &str, vertices: &[DVec3]) -> impl Iterator<Item = Vector> {
    text.lines().filter_map(|line| {
        let words = line.trim_start().strip_prefix('v')?.split_ascii_whitespace();
        // Nearly all positions are others, which a first reading in f64 tells.
        let rough: Vec<f64> = words.clone().map_while(|word| word.parse().ok()).collect();
        let [x, y, z] = *rough.first_chunk()?;
        let weight = if rough.len() == 4 { rough[3] } else { 1.0 };
        let rough = DVec3::new(x, y, z) / weight;
        let is_near = |p: &DVec3| (rough - *p).abs().max_element() <= 1e-9 * p.abs().max_element();
        if !vertices.iter().any(is_near) {
            return None;
        }
        let numbers: Vec<RBig> = words.map_while(decimal).collect();
        match &numbers[..] {
            [x, y, z] | [x, y, z, _, _, _, ..] => Some([x.clone(), y.clone(), z.clone()]),
            [x, y, z, w] if !w.is_zero() => Some([x / w, y / w, z / w]),
            _ => None,
        }
    })
}

/// The nodes of a glTF file, as far as their transforms go.
#[derive(Deserialize)]
struct Nodes<'a> {
    #[serde(default, borrow)]
    nodes: Vec<Node<'a>>,
}

#[derive(Deserialize)]
struct Node<'a> {
    #[serde(default)]
    children: Vec<usize>,
    #[serde(default, borrow)]
    matrix: Vec<&'a RawValue>,
    #[serde(default, borrow)]
    translation: Vec<&'a RawValue>,
    #[serde(default, borrow)]
    rotation: Vec<&'a RawValue>,
    #[serde(default, borrow)]
    scale: Vec<&'a RawValue>,
}

/// Returns the transforms to world space of the nodes of a glTF file, text or binary; none where they
/// cannot be read.
pub fn gltf_transforms(bytes: &[u8]) -> Option<Vec<Transform>> {
    let json = match bytes.strip_prefix(b"glTF") {
        // The header has 12 bytes, and the first chunk its length, its type and the JSON.
        Some(_) => {
            let length = u32::from_le_bytes(bytes.get(12..16)?.try_into().ok()?);
            bytes.get(20..20usize.checked_add(length as usize)?)?
        }
        None => bytes,
    };
    let Nodes { nodes } = serde_json::from_slice(json).ok()?;
    // From the roots down; a node that is reached again is not followed.
    let mut is_child = vec![false; nodes.len()];
    for &child in nodes.iter().flat_map(|node| &node.children) {
        *is_child.get_mut(child)? = true;
    }
    let mut found = vec![None; nodes.len()];
    let roots = (0..nodes.len()).filter(|&i| !is_child[i]);
    let mut stack: Vec<(usize, Transform)> = roots.map(|i| (i, Transform::identity())).collect();
    while let Some((i, parent)) = stack.pop() {
        if found[i].is_some() {
            continue;
        }
        let world = parent.after(&local_transform(&nodes[i])?);
        stack.extend(nodes[i].children.iter().map(|&child| (child, world.clone())));
        found[i] = Some(world);
    }
    Some(found.into_iter().flatten().collect())
}

/// Returns the transform from a node's space to its parent's: the matrix, or T·R·S.
fn local_transform(node: &Node) -> Option<Transform> {
    if !node.matrix.is_empty() {
        let m: [RBig; 16] = exact_numbers(&node.matrix)?;
        let column = |i: usize| [m[i].clone(), m[i + 1].clone(), m[i + 2].clone()];
        let exact = Affine { columns: [0, 4, 8].map(column), translation: column(12) };
        return Some(Transform { rounded: round(&exact), exact });
    }
    let numbers = |values: &[&RawValue], default: u8| {
        if values.is_empty() {
            return Some([(); 3].map(|()| RBig::from(default)));
        }
        exact_numbers::<3>(values)
    };
    let (translation, scale) = (numbers(&node.translation, 0)?, numbers(&node.scale, 1)?);
    let rotation = if node.rotation.is_empty() {
        Transform::identity()
    } else {
        rotation(exact_numbers(&node.rotation)?)?
    };
    Some(with_scale_and_translation(rotation, &scale, translation))
}

/// Returns the transform that scales, then turns, then moves.
fn with_scale_and_translation(turn: Transform, scale: &Vector, translation: Vector) -> Transform {
    let [x, y, z] = [0, 1, 2].map(|i| nearest(&scale[i]));
    let matrix = turn.rounded.matrix3;
    let matrix3 = DMat3::from_cols(matrix.x_axis * x, matrix.y_axis * y, matrix.z_axis * z);
    let mut exact = turn.exact;
    for (column, factor) in exact.columns.iter_mut().zip(scale) {
        column.iter_mut().for_each(|c| *c *= factor);
    }
    let rounded = DAffine3 { matrix3, translation: vector(&translation) };
    Transform { rounded, exact: Affine { translation, ..exact } }
}

/// Returns the rotation of a quaternion x y z w of any length but 0.
fn rotation(q: [RBig; 4]) -> Option<Transform> {
    // Exact: the matrix of the quaternion over the square of its length.
    let [x, y, z, w] = &q;
    let square = x * x + y * y + z * z + w * w;
    if square.is_zero() {
        return Some(Transform::identity());
    }
    let two = RBig::from(2u8);
    let term = |a: &RBig, b: &RBig| &two * a * b / &square;
    let one = RBig::ONE;
    let columns = [
        [&one - term(y, y) - term(z, z), term(x, y) + term(w, z), term(x, z) - term(w, y)],
        [term(x, y) - term(w, z), &one - term(x, x) - term(z, z), term(y, z) + term(w, x)],
        [term(x, z) + term(w, y), term(y, z) - term(w, x), &one - term(x, x) - term(y, y)],
    ];
    // Rounded: each component over the length, and the usual products.
    let [x, y, z, w] = [0, 1, 2, 3].map(|i| nearest(&q[i]));
    let length = (x * x + y * y + z * z + w * w).sqrt();
    let [x, y, z, w] = [x, y, z, w].map(|c| c / length);
    let [x2, y2, z2] = [x + x, y + y, z + z];
    let [xx, xy, xz] = [x * x2, x * y2, x * z2];
    let [yy, yz, zz] = [y * y2, y * z2, z * z2];
    let [wx, wy, wz] = [w * x2, w * y2, w * z2];
    let matrix3 = DMat3::from_cols(
        DVec3::new(1.0 - (yy + zz), xy + wz, xz - wy),
        DVec3::new(xy - wz, 1.0 - (xx + zz), yz + wx),
        DVec3::new(xz + wy, yz - wx, 1.0 - (xx + yy)),
    );
    let rounded = DAffine3 { matrix3, translation: DVec3::ZERO };
    let exact = Affine { columns, translation: [RBig::ZERO; 3] };
    Some(Transform { rounded, exact })
}

/// Returns the exact numbers of a JSON list of `N`.
fn exact_numbers<const N: usize>(values: &[&RawValue]) -> Option<[RBig; N]> {
    let numbers: Vec<RBig> = values.iter().map(|v| decimal(v.get())).collect::<Option<_>>()?;
    numbers.try_into().ok()
}

fn vector(v: &Vector) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|i| nearest(&v[i])))
}

fn round(exact: &Affine) -> DAffine3 {
    let [x, y, z] = [0, 1, 2].map(|i| vector(&exact.columns[i]));
    DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation: vector(&exact.translation) }
}

/// The decimals of a scene file.
#[derive(Default)]
pub struct SceneDecimals {
    /// The centre and the radius of each sphere.
    pub spheres: Vec<(Vector, RBig)>,
    /// A point and the normal of each plane.
    pub planes: Vec<(Vector, Vector)>,
    /// The file and the transform of each model.
    pub models: Vec<(String, Transform)>,
}

/// Returns the decimals of a scene file; none where they cannot be read.
pub fn scene_decimals(text: &str) -> Option<SceneDecimals> {
    let root = DeTable::parse(text).ok()?.into_inner();
    // A key holds one table or a list of them.
    let tables = |key: &str| -> Vec<&DeTable> {
        match root.get(key).map(|value| value.get_ref()) {
            Some(DeValue::Table(table)) => vec![table],
            Some(DeValue::Array(items)) => {
                items.iter().filter_map(|item| item.get_ref().as_table()).collect()
            }
            _ => Vec::new(),
        }
    };
    let mut found = SceneDecimals::default();
    for table in tables("sphere") {
        found.spheres.push((triple(table, "center")?, number(table.get("radius")?.get_ref())?));
    }
    for table in tables("plane") {
        found.planes.push((triple(table, "point")?, triple(table, "normal")?));
    }
    for table in tables("model") {
        let file = table.get("file")?.get_ref().as_str()?.to_owned();
        found.models.push((file, model_transform(table)?));
    }
    Some(found)
}

/// Returns a model's transform: its scale, then the rotations about x, y and z, then its translation.
fn model_transform(table: &DeTable) -> Option<Transform> {
    let scale = match table.get("scale").map(|value| value.get_ref()) {
        None => [(); 3].map(|()| RBig::ONE),
        Some(DeValue::Array(_)) => triple(table, "scale")?,
        Some(factor) => {
            let factor = number(factor)?;
            [factor.clone(), factor.clone(), factor]
        }
    };
    let zero = || [RBig::ZERO; 3];
    let angles = if table.contains_key("rotate") { triple(table, "rotate")? } else { zero() };
    let has_translation = table.contains_key("translate");
    let translation = if has_translation { triple(table, "translate")? } else { zero() };
    let [x, y, z] = [0, 1, 2].map(|axis| axis_rotation(axis, nearest(&angles[axis])));
    let turn = z?.after(&y?).after(&x?);
    Some(with_scale_and_translation(turn, &scale, translation))
}

/// Returns the rotation about a coordinate axis by an angle in degrees. Its sine and cosine are exact
/// for quarter turns; others count as the floats that they are rounded to.
fn axis_rotation(axis: usize, degrees: f64) -> Option<Transform> {
    let (sin, cos) = match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    };
    // The plane of the other two axes turns from the first to the second.
    let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut columns = Affine::identity().columns;
    columns[first][first] = float(cos)?;
    columns[first][second] = float(sin)?;
    columns[second][first] = float(-sin)?;
    columns[second][second] = float(cos)?;
    let exact = Affine { columns, translation: [RBig::ZERO; 3] };
    Some(Transform { rounded: round(&exact), exact })
}

fn triple(table: &DeTable, key: &str) -> Option<Vector> {
    let items = table.get(key)?.get_ref().as_array()?;
    let numbers: Vec<RBig> = items.iter().map(|v| number(v.get_ref())).collect::<Option<_>>()?;
    numbers.try_into().ok()
}

fn number(value: &DeValue) -> Option<RBig> {
    match value {
        DeValue::Integer(n) if n.radix() == 10 => decimal(n.as_str()),
        DeValue::Float(x) => decimal(x.as_str()),
        _ => None,
    }
}
