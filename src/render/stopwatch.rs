//! The measurement of time: by the clock, and that of the processors.

use std::ops::AddAssign;
use std::time::{Duration, Instant};

/// An amount of time that passed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Elapsed {
    /// The time by the clock.
    pub wall: Duration,
    /// The time of all processors that worked for this process, in it and in the kernel; zero where the
    /// system does not tell.
    pub cpu: Duration,
}

impl AddAssign for Elapsed {
    fn add_assign(&mut self, other: Self) {
        self.wall += other.wall;
        self.cpu += other.cpu;
    }
}

/// A moment from which time is measured.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    wall: Instant,
    cpu: Duration,
}

impl Stopwatch {
    /// Starts to measure.
    pub fn start() -> Self {
        Self { wall: Instant::now(), cpu: process_cpu_time() }
    }

    /// Returns the time that passed since the start.
    pub fn elapsed(&self) -> Elapsed {
        let cpu = process_cpu_time().saturating_sub(self.cpu);
        Elapsed { wall: self.wall.elapsed(), cpu }
    }
}

/// Returns the time that processors have worked for this process since it began.
fn process_cpu_time() -> Duration {
    #[cfg(unix)]
    {
        use rustix::time::{ClockId, clock_gettime};
        let time = clock_gettime(ClockId::ProcessCPUTime);
        Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
    }
    #[cfg(not(unix))]
    Duration::ZERO
}
