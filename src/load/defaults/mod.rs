//! The defaults for what files leave out, and what is derived from them: camera, lights, ground,
//! tangents, alpha coverage and mipmaps.

mod alpha;
pub mod auto_camera;
pub mod auto_lighting;
mod extents;
pub mod ground;
mod mipmaps;
mod surroundings;
mod tangents;
mod view_direction;

use crate::scene::Scene;

/// Completes the meshes, materials and textures of a scene whose images are decoded.
pub fn complete(scene: &mut Scene) {
    tangents::add_tangents(scene);
    alpha::remove_opaque_coverage(scene);
    alpha::blend_masked_shapes(scene);
    mipmaps::build_mipmaps(scene);
}
