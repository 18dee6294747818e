//! What glTF files become, each test one feature, and what is said of damaged and hostile ones,
//! each test one fault.

#[path = "../import_common/mod.rs"]
mod common;

mod animation;
mod basis;
mod damaged_data;
mod damaged_files;
mod deform;
mod draco;
mod geometry;
mod lights;
mod materials;
mod nodes;
mod optics;
mod report;
mod shapes;
mod textures;
mod validation;
mod variants;

use common::{Folder, Model, assert_warns, data_uri, json_place, png};
use envers::scene::{Material, Scene};
use glam::Vec3;
use serde_json::json;

fn material(scene: &Scene) -> &Material {
    &scene.materials[scene.instances[0].material.0 as usize]
}

fn close(a: Vec3, b: [f32; 3]) -> bool {
    (a - Vec3::from(b)).length() < 1e-5
}
