//! The transforms of nodes in f64: the types of the `gltf` crate have them in f32.

use glam::DVec3;
use serde::Deserialize;

/// The transform of a node as the file has it: a matrix, by columns, or translation, rotation and scale.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct NodeTransform {
    pub matrix: Option<[f64; 16]>,
    pub translation: Option<[f64; 3]>,
    /// A quaternion, x y z w.
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
}

impl NodeTransform {
    /// Returns the numbers of each key that there is.
    pub fn numbers(&self) -> impl Iterator<Item = (&'static str, &[f64])> {
        let matrix = self.matrix.as_ref().map(|m| ("matrix", &m[..]));
        let translation = self.translation.as_ref().map(|t| ("translation", &t[..]));
        let rotation = self.rotation.as_ref().map(|q| ("rotation", &q[..]));
        let scale = self.scale.as_ref().map(|s| ("scale", &s[..]));
        [matrix, translation, rotation, scale].into_iter().flatten()
    }

    /// Returns the translation, 0 by default.
    pub fn translation(&self) -> DVec3 {
        self.translation.map_or(DVec3::ZERO, DVec3::from)
    }

    /// Returns the scale, 1 by default.
    pub fn scale(&self) -> DVec3 {
        self.scale.map_or(DVec3::ONE, DVec3::from)
    }
}

/// The transforms of all nodes of a file whose JSON the types of the `gltf` crate accept.
#[derive(Debug, Deserialize)]
pub struct NodeTransforms {
    #[serde(default)]
    pub nodes: Vec<NodeTransform>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transform_keeps_the_digits_of_f64() {
        let file = br#"{"nodes":[{"name":"a"},{"translation":[5412345.75,0.1,-1e200]}]}"#;
        let transforms = serde_json::from_slice::<NodeTransforms>(file).unwrap().nodes;
        assert_eq!(transforms[0].translation, None);
        assert_eq!(transforms[1].translation, Some([5412345.75, 0.1, -1e200]));
    }
}
