//! Scenes that are loaded from scene files, glTF and OBJ: each feature, each mistake in a file, and
//! each limit.

mod corpus;
mod geometry_only;
mod gltf;
mod limits;
mod loading;
mod obj;
mod provenance;
mod scene_file;
