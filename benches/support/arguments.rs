//! The command line of a bench.

use std::str::FromStr;

/// The arguments of a bench, without `--bench`, from which flags are taken one after the other.
pub struct Arguments {
    usage: &'static str,
    left: Vec<String>,
}

impl Arguments {
    /// Returns the arguments if `cargo bench` runs the bench, which alone passes `--bench`:
    /// `cargo test --benches` must not take long.
    pub fn of_bench(usage: &'static str) -> Option<Self> {
        let mut arguments = Self { usage, left: std::env::args().skip(1).collect() };
        arguments.flag("--bench").then_some(arguments)
    }

    /// True if a flag, or a word, is among them.
    pub fn flag(&mut self, name: &str) -> bool {
        let count = self.left.len();
        self.left.retain(|argument| argument != name);
        self.left.len() < count
    }

    /// Returns the value that follows a flag. Ends the process where there is none, or it is not a
    /// `T`.
    pub fn value<T: FromStr>(&mut self, name: &str) -> Option<T> {
        let at = self.left.iter().position(|argument| argument == name)?;
        let text = self.left.drain(at..self.left.len().min(at + 2)).nth(1);
        let value = text.and_then(|text| text.parse().ok());
        value.or_else(|| self.refuse())
    }

    /// Returns the two numbers of a value like `640x480`. Ends the process where it is none.
    pub fn pair<T: FromStr>(&mut self, name: &str) -> Option<[T; 2]> {
        let text: String = self.value(name)?;
        let pair = text.split_once('x').and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
        pair.or_else(|| self.refuse())
    }

    /// Returns what is left. Ends the process where a flag is, or fewer than `least`.
    pub fn rest(self, least: usize) -> Vec<String> {
        if self.left.len() < least || self.left.iter().any(|argument| argument.starts_with("--")) {
            self.refuse()
        }
        self.left
    }

    fn refuse(&self) -> ! {
        eprintln!("usage: cargo bench --bench {}", self.usage);
        std::process::exit(2)
    }
}
