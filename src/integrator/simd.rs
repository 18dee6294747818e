//! The dispatch of loops over sixteen lanes to the instruction sets of the processor.

/// Calls a closure that is compiled for several instruction sets, in the version for this processor.
///
/// The closure and what its loops call must be `#[inline(always)]`, to be part of each version.
#[inline(always)]
pub(super) fn dispatch(arch: pulp::Arch, kernel: impl FnMut()) {
    arch.dispatch(Kernel(kernel));
}

/// A closure for [`pulp::Arch::dispatch`], which takes closures, too, but calls them by
/// `FnOnce::call_once`: a function in between, which is compiled for the least instruction set only.
struct Kernel<F>(F);

impl<F: FnMut()> pulp::WithSimd for Kernel<F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(mut self, _: S) {
        (self.0)();
    }
}
