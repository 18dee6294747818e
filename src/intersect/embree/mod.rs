//! The Embree intersector.
//!
//! Embree traverses recentred f32 copies of the rays (`frame`); planes are merged as for every
//! backend.
//!
//! Precision `fast`: spheres are one user geometry whose callbacks compute in f64 from the exact
//! rays (`spheres`); the triangles that Embree reports (`native`) are intersected again in f64
//! (`refine`). What this does not promise is which of two triangles is hit where f32 cannot tell:
//! along edges and at equal depths.
//!
//! Precision `certified`: spheres, triangles and instances are all user geometry (`meshes`,
//! `placements`), in boxes that no exact ray can miss with its f32 copy; each is tested in f64
//! with an error bound, and exactly where that cannot tell (`certified`).
//!
//! embree4-rs owns device, scene, meshes and their lifetimes. Its ray queries are not used: they
//! take records smaller than the library writes (`layout`).

mod canary;
mod certified;
mod decide;
mod filter;
mod finish;
mod frame;
mod layout;
mod meshes;
mod native;
mod nearest;
mod placements;
mod query;
mod raw;
mod refine;
mod spheres;
mod triangles;
mod user;
mod width;

use std::sync::OnceLock;

use embree4_rs::geometry::Geometry;
use embree4_rs::{CommittedScene, Device, SceneOptions};
use embree4_sys::{RTCBuildQuality, RTCDeviceProperty, RTCSceneFlags};

use crate::error::{Error, Result};
use crate::geometry::{Hit, Ray};
use crate::intersect::{Coherence, Intersector, Precision, leaving};
use crate::scene::Scene;
use canary::failed;
use frame::Frame;
use meshes::Meshes;
use raw::{DeviceHandle, scene_handle};
use spheres::SphereTable;
use width::Width;

/// The Embree intersector of one scene.
pub struct Embree<'s> {
    scene: &'s Scene,
    frame: Frame,
    width: Width,
    precision: Precision,
    /// The largest absolute coordinate in the scene.
    reach: f64,
    /// For each geometry that is attached, the instance that stands there.
    instance_of: Vec<u32>,
    committed: CommittedScene,
    version: String,
    /// Read by the callbacks; dropped after the scene that calls them.
    _spheres: Option<Box<SphereTable>>,
    _meshes: Meshes<'s>,
}

// SAFETY: the only thing in it that is not Send and Sync by itself is the handle of a committed
// scene. Embree lets any thread trace a committed scene, and release it.
#[allow(unsafe_code)]
unsafe impl Send for Embree<'_> {}
#[allow(unsafe_code)]
unsafe impl Sync for Embree<'_> {}

impl<'s> Embree<'s> {
    /// Builds a checked scene on `threads` threads (0: all there are).
    ///
    /// # Errors
    /// When the library is not as expected, or runs out of memory.
    pub fn build(scene: &'s Scene, precision: Precision, threads: usize) -> Result<Self> {
        Self::with_width(scene, precision, threads, None)
    }

    /// As [`Embree::build`], but traces ray by ray instead of in packets: to measure what packets
    /// bring, and to compare the two.
    ///
    /// # Errors
    /// As [`Embree::build`].
    pub fn build_single(scene: &'s Scene, precision: Precision, threads: usize) -> Result<Self> {
        Self::with_width(scene, precision, threads, Some(Width::One))
    }

    fn with_width(
        scene: &'s Scene,
        precision: Precision,
        threads: usize,
        width: Option<Width>,
    ) -> Result<Self> {
        static CHECKED: OnceLock<std::result::Result<(), String>> = OnceLock::new();
        CHECKED
            .get_or_init(|| canary::check().map_err(|e| e.to_string()))
            .clone()
            .map_err(Error::failed)?;

        let device = Device::try_new(Some(&format!("threads={threads}\0"))).map_err(failed)?;
        let options = SceneOptions { build_quality: QUALITY, flags: flags() };
        let top = embree4_rs::Scene::try_new(device, options).map_err(failed)?;
        let device = DeviceHandle::of(&top);
        let bounds = scene.bounds();
        let frame = Frame::around(bounds);
        let width = width.unwrap_or_else(|| Width::native(&device));

        let mut instance_of = Vec::new();
        let mut _meshes = Meshes::default();
        match precision {
            Precision::Fast => instance_of = native::attach_meshes(scene, &top, &device, &frame)?,
            Precision::Certified => _meshes.attach(scene, &top, &device, frame, width)?,
        }
        let _spheres = (!scene.spheres.is_empty()).then(|| SphereTable::new(scene, frame));
        if let Some(table) = &_spheres {
            let callbacks = match precision {
                Precision::Fast => spheres::callbacks(width),
                Precision::Certified => certified::spheres(width),
            };
            attach(&top, &user::geometry(&top.device, &device, &**table, callbacks)?)?;
        }
        let committed = top
            .commit()
            .map_err(|e| Error::failed(format!("Embree cannot build the scene: {e}")))?;
        let version = version_of(&device);
        Ok(Self {
            scene,
            frame,
            width,
            precision,
            reach: leaving::scene_reach(scene, &bounds),
            instance_of,
            committed,
            version,
            _spheres,
            _meshes,
        })
    }

    /// How far, in world units, the f32 rays may be from the exact ones anywhere in the scene: what
    /// `fast` cannot tell apart. Within an instance it may be magnified by the instance's own
    /// space.
    pub fn margin(&self) -> f64 {
        self.frame.margin()
    }

    fn target(&self) -> query::Target<'_> {
        query::Target {
            handle: scene_handle(&self.committed.scene),
            scene: self.scene,
            instance_of: &self.instance_of,
            frame: &self.frame,
            width: self.width,
            precision: self.precision,
            careful: false,
            reach: self.reach,
        }
    }
}

const QUALITY: RTCBuildQuality = RTCBuildQuality::MEDIUM;

fn flags() -> RTCSceneFlags {
    RTCSceneFlags::ROBUST | RTCSceneFlags::FILTER_FUNCTION_IN_ARGUMENTS
}

fn attach(top: &embree4_rs::Scene, geometry: &dyn Geometry) -> Result<()> {
    top.attach_geometry(geometry).map(|_| ()).map_err(failed)
}

/// How often each mesh stands in the scene.
fn uses(scene: &Scene) -> Vec<u32> {
    let mut uses = vec![0; scene.meshes.len()];
    scene.instances.iter().for_each(|i| uses[i.mesh.0 as usize] += 1);
    uses
}

fn version_of(device: &DeviceHandle) -> String {
    let of = |property| device.property(property);
    format!(
        "{}.{}.{}",
        of(RTCDeviceProperty::VERSION_MAJOR),
        of(RTCDeviceProperty::VERSION_MINOR),
        of(RTCDeviceProperty::VERSION_PATCH)
    )
}

/// The version of the Embree library, such as `4.4.0`.
///
/// # Errors
/// When the library does not start.
pub fn version() -> Result<String> {
    let device = Device::try_new(Some("threads=1\0")).map_err(failed)?;
    let scene = embree4_rs::Scene::try_new(device, SceneOptions::default()).map_err(failed)?;
    Ok(version_of(&DeviceHandle::of(&scene)))
}

impl Intersector for Embree<'_> {
    fn name(&self) -> &'static str {
        "embree"
    }

    fn version(&self) -> String {
        self.version.clone()
    }

    fn closest(&self, rays: &[Ray], coherence: Coherence, hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one hit for each ray");
        self.target().closest(rays, coherence, hits);
    }

    fn occluded(&self, rays: &[Ray], coherence: Coherence, blocked: &mut [bool]) {
        assert_eq!(rays.len(), blocked.len(), "one answer for each ray");
        self.target().occluded(rays, coherence, blocked);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Departure, PrimitiveId, Side};
    use crate::intersect::Bvh;
    use crate::scene::{Instance, MaterialId, Mesh, Sphere};
    use glam::{DAffine3, DVec3};

    /// Numbers in [-1, 1) from a linear congruence (Knuth's MMIX constants).
    fn random(state: &mut u64) -> f64 {
        *state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Spheres, a mesh that stands once and one that stands twice.
    fn scene(state: &mut u64) -> Scene {
        let mut scene = Scene::default();
        let mut point = || DVec3::new(random(state), random(state), random(state));
        for _ in 0..40 {
            scene.spheres.push(Sphere::new(point() * 2.0, 0.15, MaterialId(0)));
        }
        for uses in [1, 2] {
            let positions: Vec<[f32; 3]> = (0..60).map(|_| point().as_vec3().to_array()).collect();
            let triangles = (0..20).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let mesh = scene.add_mesh(Mesh { positions, triangles, ..Mesh::default() });
            for _ in 0..uses {
                let transform = DAffine3::from_translation(point());
                scene.instances.push(Instance::new(mesh, transform, MaterialId(0)));
            }
        }
        scene
    }

    /// Rays of which a third leaves a sphere and a third a triangle; not a multiple of any width.
    fn rays(state: &mut u64) -> Vec<Ray> {
        (0..4003)
            .map(|i| {
                let mut point = || DVec3::new(random(state), random(state), random(state)) * 3.0;
                let (origin, target) = (point(), point());
                let id = match i % 3 {
                    0 => None,
                    1 => Some(PrimitiveId::sphere(i % 40)),
                    _ => Some(PrimitiveId::triangle(0, i % 20, 0)),
                };
                let side = if i % 2 == 0 { Side::Front } else { Side::Back };
                let from = id.map(|id| Departure { id, side });
                Ray {
                    from,
                    tmax: if i % 5 == 0 { 1.0 } else { f64::INFINITY },
                    ..Ray::new(origin, target - origin)
                }
            })
            .collect()
    }

    fn check(width: Width) {
        compare(width, Precision::Fast);
        compare(width, Precision::Certified);
    }

    fn compare(width: Width, precision: Precision) {
        let mut state = 7;
        let scene = scene(&mut state);
        let rays = rays(&mut state);
        let embree = Embree::with_width(&scene, precision, 1, Some(width)).unwrap();
        let judge = Bvh::build(&scene, precision);
        let closest = |i: &dyn Intersector| {
            let mut hits = vec![None; rays.len()];
            i.closest(&rays, Coherence::Incoherent, &mut hits);
            hits
        };
        assert_eq!(closest(&embree), closest(&judge));
        let occluded = |i: &dyn Intersector| {
            let mut blocked = vec![false; rays.len()];
            i.occluded(&rays, Coherence::Coherent, &mut blocked);
            blocked
        };
        assert_eq!(occluded(&embree), occluded(&judge));
    }

    #[test]
    fn single_rays_equal_the_bvh() {
        check(Width::One);
    }

    #[test]
    fn packets_of_four_equal_the_bvh() {
        check(Width::Four);
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    fn packets_of_eight_equal_the_bvh() {
        if is_x86_feature_detected!("avx2") {
            check(Width::Eight);
        }
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    fn packets_of_sixteen_equal_the_bvh() {
        if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512bw") {
            check(Width::Sixteen);
        }
    }
}
