//! The price of physically based light: whole commands that render bare models with it, and without.
//!
//! `cargo bench --bench light -- MODEL... [--rounds N] [--size WxH] [--other EXECUTABLE]`. Without it means by Lambert and
//! Phong and under the key light alone (`--shading phong --environment none`), or, with `--other`, by another
//! executable, such as an older version of envers. Both take turns in one run and are timed by the clock on the
//! wall; what is printed are medians, and the median of the rounds' ratios.

#[allow(dead_code, reason = "each bench uses its own part")]
mod support {
    pub mod arguments;
    pub mod clock;
}

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use support::arguments::Arguments;
use support::clock::median;

fn main() {
    const USAGE: &str = "light -- MODEL... [--rounds N] [--size WxH] [--other EXECUTABLE]";
    let Some(mut arguments) = Arguments::of_bench(USAGE) else { return };
    let rounds = arguments.value("--rounds").unwrap_or(9);
    let [width, height] = arguments.pair("--size").unwrap_or([640u32, 480]);
    let other: Option<String> = arguments.value("--other");
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.png");
    let seconds = |executable: &str, model: &str, flags: &[&str]| {
        let start = Instant::now();
        let mut command = Command::new(executable);
        command.args(["render", model, "-q", "--size", &format!("{width}x{height}")]);
        let status = command.args(flags).arg("-o").arg(&out).status().unwrap();
        assert!(status.success(), "{executable} {model}");
        start.elapsed().as_secs_f64()
    };
    const OURS: &str = env!("CARGO_BIN_EXE_envers");
    for model in arguments.rest(1) {
        let without = || match &other {
            Some(other) => seconds(other, &model, &[]),
            None => seconds(OURS, &model, &["--shading", "phong", "--environment", "none"]),
        };
        let times: Vec<[f64; 2]> =
            (0..rounds).map(|_| [without(), seconds(OURS, &model, &[])]).collect();
        let ms = |i: usize| 1e3 * median(times.iter().map(|t| t[i]));
        let name = Path::new(&model).file_name().unwrap_or_default().to_string_lossy();
        println!("{name}, {width}x{height}, medians of {rounds} rounds");
        println!("  without {:.0} ms, with {:.0} ms", ms(0), ms(1));
        println!("  ratio {:.2}", median(times.iter().map(|[without, with]| with / without)));
    }
}
