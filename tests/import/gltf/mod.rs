//! The scenes that glTF files become, each test one feature, and the errors of damaged and hostile ones,
//! each test one fault.

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
mod report;
mod shapes;
mod textures;
mod transmission;
mod validation;
mod variants;

use envers::{Material, Scene};
use envers_testing::{Folder, Model, data_uri, png};
use glam::Vec3;
use serde_json::json;

use super::loading::{LoadFile, LoadModel, assert_warns, json_place};

fn material(scene: &Scene) -> &Material {
    &scene.materials[scene.instances[0].material.0 as usize]
}

fn close(a: Vec3, b: [f32; 3]) -> bool {
    (a - Vec3::from(b)).length() < 1e-5
}
