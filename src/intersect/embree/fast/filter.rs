//! The filter that secondary rays carry: it drops the surface that a ray left, triangles that f64
//! says are not in its way, what a mask cuts out, and, for shadow rays, what blocks no light.
//!
//! Primary rays carry none, unless something has a mask.
#![allow(unsafe_code)]

use embree4_sys as sys;

use crate::geometry::{PrimitiveId, triangle};
use crate::intersect::Precision;
use crate::intersect::embree::ffi::records::{INVALID, QueryContext};
use crate::intersect::embree::ffi::user_geometry::{ID, TFAR, in_order};
use crate::intersect::primitive::Primitives;

/// The fields of a hit: the normal, of any length, in the space of the triangle's own mesh.
const NG: usize = 0;
const PRIM: usize = 5;
const GEOM: usize = 6;
const INST: usize = 7;
/// The fields of a ray.
const DIR: usize = 4;

/// What Embree calls for each hit that it finds.
pub type Filter = unsafe extern "C" fn(*const sys::RTCFilterFunctionNArguments);

/// The filter for packets of `W`; `SHADOW` for occlusion calls.
pub fn filter<const W: usize, const SHADOW: bool>() -> Filter {
    match W {
        #[cfg(target_arch = "x86_64")]
        8 => compiled!(W, SHADOW, target_feature(enable = "avx2,fma")),
        #[cfg(target_arch = "x86_64")]
        16 => {
            compiled!(W, SHADOW, target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,fma"))
        }
        _ => compiled!(W, SHADOW, inline(never)),
    }
}

/// The filter, compiled for the processor features that a width comes with.
macro_rules! compiled {
    ($w:ident, $shadow:ident, $attribute:meta) => {{
        // SAFETY: as of `look_at_all`; those with target features are only chosen for widths that
        // `Width::native` chose, which asks the processor.
        #[$attribute]
        unsafe extern "C" fn filter<const W: usize, const SHADOW: bool>(
            args: *const sys::RTCFilterFunctionNArguments,
        ) {
            unsafe { look_at_all::<W, SHADOW>(args) }
        }
        filter::<$w, $shadow>
    }};
}
use compiled;

#[inline(always)]
unsafe fn look_at_all<const W: usize, const SHADOW: bool>(
    args: *const sys::RTCFilterFunctionNArguments,
) {
    // SAFETY: Embree passes pointers to `N` rays and hits and the context of the call, which
    // `query` made for packets of this width.
    unsafe {
        let args = &*args;
        let n = args.N as usize;
        let context = &*args.context.cast::<QueryContext<'_, W>>();
        let (ray, hit) = (args.ray.cast::<u32>(), args.hit.cast::<u32>());
        let sure = match n == W && in_order(&*ray.add(ID * W).cast::<[u32; W]>()) {
            true => sure_of_all(context, ray, hit),
            false => [false; W],
        };
        let all_count = (!SHADOW | context.all_block) & context.masked.is_empty();
        if n == W && all_count && sure_are_valid(&sure, args.valid) {
            return;
        }
        for slot in 0..n {
            let valid = args.valid.add(slot);
            if *valid == 0 {
                continue;
            }
            let field = |base: *const u32, field: usize| *base.add(field * n + slot);
            let lane = field(ray, ID) as usize;
            let ids = [PRIM, GEOM, INST].map(|f| field(hit, f));
            let vector = |base, at| [0, 1, 2].map(|axis| f32::from_bits(field(base, at + axis)));
            let is_sure = if n == W {
                sure[slot]
            } else {
                let t = f32::from_bits(field(ray, TFAR));
                let rise = Rise::new(vector(hit, NG), vector(ray, DIR));
                is_sure(context, lane, t, &rise, ids[2])
            };
            if !stands_in_the_way::<W, SHADOW>(context, lane, is_sure, ids) {
                *valid = 0;
            }
        }
    }
}

/// Which candidates certainly count, of a packet that came as it was sent.
#[inline(always)]
unsafe fn sure_of_all<const W: usize>(
    context: &QueryContext<'_, W>,
    ray: *const u32,
    hit: *const u32,
) -> [bool; W] {
    // SAFETY: by the caller's word there are `W` rays and hits, each field side by side.
    unsafe {
        let all = |base: *const u32, field: usize| &*base.add(field * W).cast::<[f32; W]>();
        let (normal, direction) =
            ([0, 1, 2].map(|axis| all(hit, NG + axis)), [0, 1, 2].map(|axis| all(ray, DIR + axis)));
        let (t, inst) = (all(ray, TFAR), &*hit.add(INST * W).cast::<[u32; W]>());
        let mut sure = [false; W];
        for i in 0..W {
            let rise = Rise::new(normal.map(|x| x[i]), direction.map(|x| x[i]));
            sure[i] = is_sure(context, i, t[i], &rise, inst[i]);
        }
        sure
    }
}

/// Whether all candidates that there are certainly count.
#[inline(always)]
unsafe fn sure_are_valid<const W: usize>(sure: &[bool; W], valid: *const i32) -> bool {
    // SAFETY: by the caller's word there are `W` of them.
    let valid = unsafe { &*valid.cast::<[i32; W]>() };
    let mut open = 0;
    for i in 0..W {
        open |= if sure[i] { 0 } else { valid[i] };
    }
    open == 0
}

/// How far a ray rises over a triangle for each unit of t: the quotient of two numbers, squared.
struct Rise {
    way: f32,
    normal: f32,
}

impl Rise {
    #[inline(always)]
    fn new(normal: [f32; 3], direction: [f32; 3]) -> Self {
        let (normal, direction) = (glam::Vec3::from(normal), glam::Vec3::from(direction));
        let way = normal.dot(direction);
        Self { way: way * way, normal: normal.length_squared() }
    }
}

/// Whether the candidate that Embree's f32 arithmetic found at `t` certainly counts for the ray in
/// `lane`.
///
/// The f32 ray is off by at most the frame's margin, and twice that is [`Frame::doubt`] / 512: where
/// its ends stand higher over the triangle than that, so do those of the exact ray, on the same
/// sides. A ray that grazes a triangle in whose plane it starts or ends may seem to cross it
/// anywhere; the triangle that it left is one of those.
///
/// [`Frame::doubt`]: crate::intersect::embree::f32_space::F32Space::doubt
#[inline(always)]
fn is_sure<const W: usize>(
    context: &QueryContext<'_, W>,
    lane: usize,
    t: f32,
    rise: &Rise,
    inst: u32,
) -> bool {
    let height = context.doubt / 512.0;
    let clear = |way: f32| {
        (way > context.doubt) & ((way * way) * rise.way > (height * height) * rise.normal)
    };
    // In an instance normal and direction stand in two spaces.
    (inst == INVALID) & !context.goes_on & clear(t) & clear(context.end[lane] - t)
}

/// Whether a candidate counts for the ray in `lane`.
#[inline(always)]
fn stands_in_the_way<const W: usize, const SHADOW: bool>(
    context: &QueryContext<'_, W>,
    lane: usize,
    sure: bool,
    [prim, geom, inst]: [u32; 3],
) -> bool {
    if sure && (!SHADOW || context.all_block) && context.masked.is_empty() {
        return true;
    }
    let attached = if inst == INVALID { geom } else { inst };
    let Some(&instance) = context.instance_of.get(attached as usize) else { return true };
    let placed = &context.scene.instances[instance as usize];
    let id = PrimitiveId::triangle(placed.mesh.0, prim, instance);
    if SHADOW && !context.scene.blocks_light(id) {
        return false;
    }
    if !sure && !stands_exactly(context, lane, id) {
        return false;
    }
    !(context.is_masked(instance) && is_cut_out(context, lane, id))
}

/// Whether a mask cuts a hole where the ray in `lane` meets a triangle, by the weights in f64 that
/// `refine` gives.
#[inline(never)]
fn is_cut_out<const W: usize>(context: &QueryContext<'_, W>, lane: usize, id: PrimitiveId) -> bool {
    let (origin, direction) = context.exact.line(lane);
    let (u, v) =
        triangle::EdgeFunctions::new(context.scene.triangle_vertices(id), origin, direction)
            .weights();
    context.scene.is_cut_out(id, u, v)
}

/// Whether a triangle stands in the way of the ray in `lane` by the formulas in f64.
#[cold]
#[inline(never)]
fn stands_exactly<const W: usize>(
    context: &QueryContext<'_, W>,
    lane: usize,
    id: PrimitiveId,
) -> bool {
    let primitives = Primitives { scene: context.scene, precision: Precision::Fast };
    let ray = context.rays.get(lane);
    ray.is_some_and(|ray| primitives.triangle(id, &ray, f64::INFINITY).is_some())
}
