//! Bare Embree: what the library does with f32 rays that lie ready in packets, and with f32
//! callbacks for spheres. No f64, no hit records, no batches: the ceiling.
#![allow(unsafe_code)]

use std::ffi::CStr;

use embree4_sys as sys;
use envers::{Instance, Ray, Scene, Sphere};
use glam::DVec3;

/// A packet as Embree takes it, laid out and with room to spare as in `envers::internals::embree`.
#[repr(C, align(64))]
struct Record<const W: usize> {
    org: [[f32; W]; 3],
    tnear: [f32; W],
    dir: [[f32; W]; 3],
    time: [f32; W],
    tfar: [f32; W],
    mask: [u32; W],
    id: [u32; W],
    flags: [u32; W],
    ng: [[f32; W]; 3],
    uv: [[f32; W]; 2],
    prim: [u32; W],
    geom: [u32; W],
    inst: [[u32; W]; 2],
    spare: [u32; 32],
}

/// The rays of a packet, as they lie ready: no more memory goes by than must.
#[repr(C, align(64))]
pub struct Packet<const W: usize> {
    org: [[f32; W]; 3],
    dir: [[f32; W]; 3],
    tfar: [f32; W],
}

impl<const W: usize> Record<W> {
    fn new() -> Self {
        Self {
            org: [[0.0; W]; 3],
            tnear: [0.0; W],
            dir: [[0.0; W]; 3],
            time: [0.0; W],
            tfar: [0.0; W],
            mask: [u32::MAX; W],
            id: std::array::from_fn(|i| i as u32),
            flags: [0; W],
            ng: [[0.0; W]; 3],
            uv: [[0.0; W]; 2],
            prim: [u32::MAX; W],
            geom: [u32::MAX; W],
            inst: [[u32::MAX; W]; 2],
            spare: [0; 32],
        }
    }

    fn load(&mut self, packet: &Packet<W>) {
        self.org = packet.org;
        self.dir = packet.dir;
        self.tfar = packet.tfar;
        self.geom = [u32::MAX; W];
    }
}

/// The query context: Embree's own part and no more.
#[repr(C, align(64))]
struct Context([u32; 16]);

#[repr(C, align(64))]
struct Valid<const W: usize>([i32; W]);

/// The packets of rays about `center`; those that fill none are left out.
pub fn packets<const W: usize>(rays: &[Ray], center: DVec3) -> Vec<Packet<W>> {
    rays.chunks_exact(W)
        .map(|rays| {
            let mut p = Packet { org: [[0.0; W]; 3], dir: [[0.0; W]; 3], tfar: [0.0; W] };
            for (i, ray) in rays.iter().enumerate() {
                let unit = if ray.tmax == 1.0 { 1.0 } else { ray.direction.length() };
                for axis in 0..3 {
                    p.org[axis][i] = (ray.origin[axis] - center[axis]) as f32;
                    p.dir[axis][i] = (ray.direction[axis] / unit) as f32;
                }
                p.tfar[i] = ray.tmax as f32;
            }
            p
        })
        .collect()
}

/// A committed scene of the bare library, which any thread may trace.
pub struct Bare {
    device: sys::RTCDevice,
    scene: sys::RTCScene,
    /// Centre and radius of each sphere, recentred; read by the callbacks.
    _spheres: Vec<[f32; 4]>,
}

// SAFETY: Embree lets any thread trace a committed scene.
unsafe impl Sync for Bare {}

/// Vertices and triangles.
type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// The shapes of a scene of the bare library, about a centre, as f32 numbers that lie ready.
pub struct Shapes {
    /// Each mesh as it stands.
    meshes: Vec<Mesh>,
    /// Centre and radius of each sphere.
    spheres: Vec<[f32; 4]>,
}

impl Shapes {
    pub fn from_scene(scene: &Scene) -> Self {
        let center = scene.bounds().center();
        let mesh = |instance: &Instance| {
            let mesh = &scene.meshes[instance.mesh.0 as usize];
            let place = |p: DVec3| (instance.to_world(p) - center).as_vec3().to_array();
            (mesh.positions.iter().map(place).collect(), mesh.triangles.clone())
        };
        let sphere = |s: &Sphere| (s.center - center).as_vec3().extend(s.radius as f32).to_array();
        Self {
            meshes: scene.instances.iter().map(mesh).collect(),
            spheres: scene.spheres.iter().map(sphere).collect(),
        }
    }

    /// Builds a scene by a device of this configuration.
    pub fn build(&self, width: usize, config: &CStr, quality: sys::RTCBuildQuality) -> Bare {
        let spheres = self.spheres.clone();
        // SAFETY: the calls follow the library's manual; buffers are filled before the commit.
        unsafe {
            let device = sys::rtcNewDevice(config.as_ptr());
            let scene = sys::rtcNewScene(device);
            let flags =
                sys::RTCSceneFlags::ROBUST | sys::RTCSceneFlags::FILTER_FUNCTION_IN_ARGUMENTS;
            sys::rtcSetSceneFlags(scene, flags);
            sys::rtcSetSceneBuildQuality(scene, quality);
            for (vertices, triangles) in &self.meshes {
                let geometry = sys::rtcNewGeometry(device, sys::RTCGeometryType::TRIANGLE);
                sys::rtcSetGeometryBuildQuality(geometry, quality);
                let (vertex, index) = (sys::RTCBufferType::VERTEX, sys::RTCBufferType::INDEX);
                let (float3, uint3) = (sys::RTCFormat::FLOAT3, sys::RTCFormat::UINT3);
                let (nv, nt) = (vertices.len(), triangles.len());
                let v = sys::rtcSetNewGeometryBuffer(geometry, vertex, 0, float3, 12, nv);
                v.cast::<[f32; 3]>().copy_from(vertices.as_ptr(), nv);
                let t = sys::rtcSetNewGeometryBuffer(geometry, index, 0, uint3, 12, nt);
                t.cast::<[u32; 3]>().copy_from(triangles.as_ptr(), nt);
                sys::rtcCommitGeometry(geometry);
                sys::rtcAttachGeometry(scene, geometry);
                sys::rtcReleaseGeometry(geometry);
            }
            if !spheres.is_empty() {
                let geometry = sys::rtcNewGeometry(device, sys::RTCGeometryType::USER);
                sys::rtcSetGeometryBuildQuality(geometry, quality);
                sys::rtcSetGeometryUserPrimitiveCount(geometry, spheres.len() as u32);
                let data = spheres.as_ptr().cast_mut().cast();
                sys::rtcSetGeometryUserData(geometry, data);
                sys::rtcSetGeometryBoundsFunction(geometry, Some(bounds), std::ptr::null_mut());
                let (intersect, occluded) = callbacks(width);
                sys::rtcSetGeometryIntersectFunction(geometry, Some(intersect));
                sys::rtcSetGeometryOccludedFunction(geometry, Some(occluded));
                sys::rtcCommitGeometry(geometry);
                sys::rtcAttachGeometry(scene, geometry);
                sys::rtcReleaseGeometry(geometry);
            }
            sys::rtcCommitScene(scene);
            assert_eq!(sys::rtcGetDeviceError(device), sys::RTCError::NONE);
            Bare { device, scene, _spheres: spheres }
        }
    }
}

impl Bare {
    /// Builds the same geometry, build quality and scene flags as envers's own Embree scene.
    pub fn build(scene: &Scene, width: usize) -> Self {
        Shapes::from_scene(scene).build(width, c"threads=1", sys::RTCBuildQuality::MEDIUM)
    }

    /// True if the processor has packets of `width` natively.
    pub fn has(&self, width: usize) -> bool {
        let property = match width {
            4 => sys::RTCDeviceProperty::NATIVE_RAY4_SUPPORTED,
            8 => sys::RTCDeviceProperty::NATIVE_RAY8_SUPPORTED,
            16 => sys::RTCDeviceProperty::NATIVE_RAY16_SUPPORTED,
            _ => return true,
        };
        // SAFETY: the device is live.
        unsafe { sys::rtcGetDeviceProperty(self.device, property) != 0 }
    }

    /// Traces every packet; returns how many rays hit.
    pub fn closest<const W: usize>(&self, packets: &[Packet<W>], coherent: bool) -> usize {
        let mut context = Context([u32::MAX; 16]);
        let flags = match coherent {
            true => sys::RTCRayQueryFlags::COHERENT,
            false => sys::RTCRayQueryFlags::INCOHERENT,
        };
        let mut args = sys::RTCIntersectArguments {
            flags,
            feature_mask: sys::RTCFeatureFlags(u32::MAX),
            context: std::ptr::from_mut(&mut context).cast(),
            filter: None,
            intersect: None,
        };
        let valid = Valid([-1; W]);
        let mut p = Record::<W>::new();
        let mut hits = 0;
        for packet in packets {
            p.load(packet);
            let ptr = std::ptr::from_mut(&mut p);
            // SAFETY: packet, mask and context are aligned and large enough for any version.
            unsafe {
                match W {
                    1 => sys::rtcIntersect1(self.scene, ptr.cast(), &mut args),
                    4 => sys::rtcIntersect4(valid.0.as_ptr(), self.scene, ptr.cast(), &mut args),
                    8 => sys::rtcIntersect8(valid.0.as_ptr(), self.scene, ptr.cast(), &mut args),
                    _ => sys::rtcIntersect16(valid.0.as_ptr(), self.scene, ptr.cast(), &mut args),
                }
            }
            hits += p.geom.iter().filter(|&&g| g != u32::MAX).count();
        }
        hits
    }

    /// Traces single rays; returns the primitives that they hit.
    #[allow(dead_code)] // Not every bench asks for primitives.
    pub fn primitives(&self, rays: &[Packet<1>]) -> Vec<Option<u32>> {
        let mut context = Context([u32::MAX; 16]);
        let mut args = sys::RTCIntersectArguments {
            flags: sys::RTCRayQueryFlags::INCOHERENT,
            feature_mask: sys::RTCFeatureFlags(u32::MAX),
            context: std::ptr::from_mut(&mut context).cast(),
            filter: None,
            intersect: None,
        };
        let mut record = Record::<1>::new();
        let mut primitive = |ray| {
            record.load(ray);
            let ptr = std::ptr::from_mut(&mut record);
            // SAFETY: as in `closest`.
            unsafe { sys::rtcIntersect1(self.scene, ptr.cast(), &mut args) };
            (record.geom[0] != u32::MAX).then_some(record.prim[0])
        };
        rays.iter().map(&mut primitive).collect()
    }

    /// Asks for every packet's occlusion; returns how many rays are blocked.
    pub fn occluded<const W: usize>(&self, packets: &[Packet<W>]) -> usize {
        let mut context = Context([u32::MAX; 16]);
        let mut args = sys::RTCOccludedArguments {
            flags: sys::RTCRayQueryFlags::COHERENT,
            feature_mask: sys::RTCFeatureFlags(u32::MAX),
            context: std::ptr::from_mut(&mut context).cast(),
            filter: None,
            occluded: None,
        };
        let valid = Valid([-1; W]);
        let mut p = Record::<W>::new();
        let mut blocked = 0;
        for packet in packets {
            p.load(packet);
            let ptr = std::ptr::from_mut(&mut p);
            // SAFETY: as in `closest`.
            unsafe {
                match W {
                    1 => sys::rtcOccluded1(self.scene, ptr.cast(), &mut args),
                    4 => sys::rtcOccluded4(valid.0.as_ptr(), self.scene, ptr.cast(), &mut args),
                    8 => sys::rtcOccluded8(valid.0.as_ptr(), self.scene, ptr.cast(), &mut args),
                    _ => sys::rtcOccluded16(valid.0.as_ptr(), self.scene, ptr.cast(), &mut args),
                }
            }
            blocked += p.tfar.iter().filter(|&&t| t == f32::NEG_INFINITY).count();
        }
        blocked
    }
}

impl Drop for Bare {
    fn drop(&mut self) {
        // SAFETY: these are the references that `build` was given.
        unsafe {
            sys::rtcReleaseScene(self.scene);
            sys::rtcReleaseDevice(self.device);
        }
    }
}

unsafe extern "C" fn bounds(args: *const sys::RTCBoundsFunctionArguments) {
    // SAFETY: called by Embree with the data set in `build`.
    unsafe {
        let args = &*args;
        let [x, y, z, r] = *args.geometryUserPtr.cast::<[f32; 4]>().add(args.primID as usize);
        let b = &mut *args.bounds_o;
        (b.lower_x, b.lower_y, b.lower_z) = (x - r, y - r, z - r);
        (b.upper_x, b.upper_y, b.upper_z) = (x + r, y + r, z + r);
    }
}

type Intersect = unsafe extern "C" fn(*const sys::RTCIntersectFunctionNArguments);
type Occluded = unsafe extern "C" fn(*const sys::RTCOccludedFunctionNArguments);

fn callbacks(width: usize) -> (Intersect, Occluded) {
    match width {
        1 => (intersect_1, occluded_1),
        4 => (intersect_4, occluded_4),
        8 => (intersect_8, occluded_8),
        _ => (intersect_16, occluded_16),
    }
}

macro_rules! callbacks {
    ($($width:literal $intersect:ident $occluded:ident $features:literal;)*) => {$(
        #[target_feature(enable = $features)]
        unsafe extern "C" fn $intersect(args: *const sys::RTCIntersectFunctionNArguments) {
            unsafe {
                let args = &*args;
                let rays = args.rayhit.cast();
                sphere::<$width, true>(args.valid, args.geometryUserPtr, args.primID, rays, args.geomID);
            }
        }

        #[target_feature(enable = $features)]
        unsafe extern "C" fn $occluded(args: *const sys::RTCOccludedFunctionNArguments) {
            unsafe {
                let args = &*args;
                let rays = args.ray.cast();
                sphere::<$width, false>(args.valid, args.geometryUserPtr, args.primID, rays, 0);
            }
        }
    )*};
}

callbacks! {
    1 intersect_1 occluded_1 "sse2";
    4 intersect_4 occluded_4 "sse4.2";
    8 intersect_8 occluded_8 "avx2,fma";
    16 intersect_16 occluded_16 "avx512f,avx512vl,avx512dq,avx512bw,fma";
}

/// One sphere against a packet, in f32, all lanes at once.
#[inline(always)]
unsafe fn sphere<const W: usize, const CLOSEST: bool>(
    valid: *const i32,
    data: *const std::ffi::c_void,
    prim: u32,
    rays: *mut Record<W>,
    geom: u32,
) {
    // SAFETY: called by Embree with a full packet, in the widths that are native.
    unsafe {
        let [cx, cy, cz, r] = *data.cast::<[f32; 4]>().add(prim as usize);
        let valid = &*valid.cast::<[i32; W]>();
        let (mut hit, mut ts, mut any) = ([false; W], [0.0f32; W], false);
        {
            let p = &*rays;
            for i in 0..W {
                let f = [p.org[0][i] - cx, p.org[1][i] - cy, p.org[2][i] - cz];
                let d = [p.dir[0][i], p.dir[1][i], p.dir[2][i]];
                let inverse = 1.0 / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
                let m = -(f[0] * d[0] + f[1] * d[1] + f[2] * d[2]) * inverse;
                let n = [f[0] + m * d[0], f[1] + m * d[1], f[2] + m * d[2]];
                let gap = r * r - (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
                let s = (gap.max(0.0) * inverse).sqrt();
                let (near, far) = (m - s, m + s);
                let t = if near > p.tnear[i] { near } else { far };
                ts[i] = t;
                hit[i] = (gap >= 0.0) & (t > p.tnear[i]) & (t < p.tfar[i]) & (valid[i] != 0);
                any |= hit[i];
            }
        }
        if !any {
            return;
        }
        if CLOSEST {
            let p = &mut *rays;
            for i in 0..W {
                if hit[i] {
                    p.tfar[i] = ts[i];
                    p.prim[i] = prim;
                    p.geom[i] = geom;
                }
            }
        } else {
            // An occlusion query's record may end with the ray: touch no more of it.
            let tfar = &raw mut (*rays).tfar;
            for i in 0..W {
                if hit[i] {
                    tfar.cast::<f32>().add(i).write(f32::NEG_INFINITY);
                }
            }
        }
    }
}
