//! The description of the machine that a benchmark runs on.

use serde::Serialize;
use sysinfo::{CpuRefreshKind, RefreshKind, System};

/// The description of a machine, as far as the system tells.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// The processor's model name.
    pub processor: String,
    /// The number of physical cores; null where the system does not tell.
    pub cores: Option<usize>,
    /// The number of threads that this process may run at once.
    pub threads: usize,
    /// The instruction sets that matter to a ray tracer, the widest last.
    pub features: Vec<&'static str>,
    /// The system's name, version and architecture.
    pub system: String,
    /// The version of envers.
    pub envers: &'static str,
    /// The version of Embree; null where it is not built in.
    pub embree: Option<String>,
}

impl Machine {
    /// Returns the description of the machine that this runs on.
    pub fn current() -> Self {
        let refresh = RefreshKind::nothing().with_cpu(CpuRefreshKind::nothing());
        let system = System::new_with_specifics(refresh);
        let processor = system.cpus().first().map(|cpu| cpu.brand().trim().to_owned());
        let name = System::long_os_version().unwrap_or(std::env::consts::OS.to_owned());
        let kernel = System::kernel_version().unwrap_or_default();
        #[cfg(feature = "embree")]
        let embree = crate::intersect::embree_version().ok();
        #[cfg(not(feature = "embree"))]
        let embree = None;
        Self {
            processor: processor.filter(|name| !name.is_empty()).unwrap_or("unknown".to_owned()),
            cores: System::physical_core_count(),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            features: features(),
            system: format!("{name}, {kernel}, {}", std::env::consts::ARCH),
            envers: env!("CARGO_PKG_VERSION"),
            embree,
        }
    }
}

/// Returns the names of the instruction sets that the processor supports.
#[cfg(target_arch = "x86_64")]
fn features() -> Vec<&'static str> {
    let sets = [
        ("SSE4.2", is_x86_feature_detected!("sse4.2")),
        ("AVX", is_x86_feature_detected!("avx")),
        ("FMA", is_x86_feature_detected!("fma")),
        ("AVX2", is_x86_feature_detected!("avx2")),
        ("AVX-512", is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl")),
    ];
    sets.into_iter().filter_map(|(name, is_supported)| is_supported.then_some(name)).collect()
}

/// Returns the names of the instruction sets that this build uses.
#[cfg(not(target_arch = "x86_64"))]
fn features() -> Vec<&'static str> {
    if cfg!(target_feature = "neon") { vec!["NEON"] } else { Vec::new() }
}
