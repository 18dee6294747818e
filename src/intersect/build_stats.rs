//! The statistics of building intersectors.

/// The numbers of BLASes and TLASes that were built, and of those that were reused from an earlier
/// frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BuildStats {
    /// Meshes whose BLAS was built.
    pub meshes_built: u64,
    /// Meshes whose BLAS was reused from an earlier frame.
    pub meshes_reused: u64,
    /// Times that a TLAS was built: the level of spheres and instances above the meshes.
    pub tlas_built: u64,
    /// Times that the TLAS of the frame before was updated with what moved.
    pub tlas_updated: u64,
    /// Instances in a TLAS that was built.
    pub instances_built: u64,
    /// Instances that moved in a TLAS that was updated.
    pub instances_moved: u64,
    /// Spheres that moved in a TLAS that was updated.
    pub spheres_moved: u64,
    /// Times that a TLAS that was built has spheres in it: in Embree a user geometry, in Rust a tree.
    pub sphere_geometries: u64,
    /// Instances in a TLAS that was built whose meshes are in object space.
    pub object_space_instances: u64,
    /// Instances in a TLAS that was built whose alpha is tested.
    pub masked_instances: u64,
}

impl BuildStats {
    /// Combines each count of this with that of another.
    fn zip_with(self, other: Self, f: impl Fn(u64, u64) -> u64) -> Self {
        Self {
            meshes_built: f(self.meshes_built, other.meshes_built),
            meshes_reused: f(self.meshes_reused, other.meshes_reused),
            tlas_built: f(self.tlas_built, other.tlas_built),
            tlas_updated: f(self.tlas_updated, other.tlas_updated),
            instances_built: f(self.instances_built, other.instances_built),
            instances_moved: f(self.instances_moved, other.instances_moved),
            spheres_moved: f(self.spheres_moved, other.spheres_moved),
            sphere_geometries: f(self.sphere_geometries, other.sphere_geometries),
            object_space_instances: f(self.object_space_instances, other.object_space_instances),
            masked_instances: f(self.masked_instances, other.masked_instances),
        }
    }

    /// The counts of a frame of this many meshes for which nothing is built.
    pub fn reused(meshes: u64) -> Self {
        Self { meshes_reused: meshes, tlas_updated: 1, ..Self::default() }
    }
}

impl std::ops::AddAssign for BuildStats {
    fn add_assign(&mut self, other: Self) {
        *self = self.zip_with(other, |a, b| a + b);
    }
}

impl std::ops::Sub for BuildStats {
    type Output = Self;

    /// The counts since those of `before`.
    fn sub(self, before: Self) -> Self {
        self.zip_with(before, |a, b| a - b)
    }
}
