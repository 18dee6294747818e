//! The description that a glTF file has of itself: its `asset`, and the names of its animations.

use std::path::Path;

use gltf::json::{self, Value};

use crate::load::report::{Asset, AssetAnimation};

/// Returns the description that a file has of itself.
pub fn read(path: &Path, root: &json::Root) -> Asset {
    let json::Asset { version, generator, copyright, .. } = &root.asset;
    let animations = root.animations.iter().map(|animation| AssetAnimation {
        name: animation.name.clone(),
        seconds: last_time(root, animation),
    });
    Asset {
        file: path.to_owned(),
        version: version.clone(),
        generator: generator.clone(),
        copyright: copyright.clone(),
        animations: animations.collect(),
    }
}

/// Returns the time of the last key of an animation, as the accessors of times declare it.
fn last_time(root: &json::Root, animation: &json::Animation) -> Option<f64> {
    let accessors = animation.samplers.iter();
    let accessors = accessors.filter_map(|sampler| root.accessors.get(sampler.input.value()));
    let times = accessors.filter_map(|times| times.max.as_ref()?.get(0).and_then(Value::as_f64));
    times.reduce(f64::max)
}
