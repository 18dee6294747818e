//! Times of two taken in turn, and how they grow.

/// The slope of the line that fits y = c·xᵏ best: least squares of the logarithms.
pub fn slope(points: &[[f64; 2]]) -> f64 {
    let logs: Vec<[f64; 2]> = points.iter().map(|p| p.map(f64::ln)).collect();
    let mean = |axis: usize| logs.iter().map(|p| p[axis]).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(0), mean(1));
    let moment =
        |axis: usize, about: f64| logs.iter().map(|p| (p[0] - x) * (p[axis] - about)).sum::<f64>();
    moment(1, y) / moment(0, x)
}

/// Ours and the bare library's at one size, in nanoseconds for each ray.
pub struct Step {
    /// The number of triangles, spheres or whatever grows.
    pub count: usize,
    /// The share of the rays that hit.
    pub hits: f64,
    /// Ours.
    pub ours: f64,
    /// The bare library's.
    pub bare: f64,
    /// The median of the rounds' ratios of ours to the bare one: what else runs on the machine
    /// slows both, and falls out.
    pub ratio: f64,
}

/// Prints the head of a table of [`print_row`]s: the kinds of rays, side by side.
pub fn print_head(what: &str, kinds: &[&str]) {
    println!("\nns a ray, one thread");
    let count = kinds.len();
    let kinds: String = kinds.iter().map(|kind| format!("  {kind:>29}")).collect();
    println!("{:>10}{kinds}", "");
    println!("{what:>10}{}", "   hit    ours    bare ours/bare".repeat(count));
}

/// Prints what was found at one size, with each kind of rays.
pub fn print_row(steps: &[Step]) {
    let cells = steps.iter().map(|s| {
        let hit = 100.0 * s.hits;
        format!("  {hit:3.0}% {:7.1} {:7.1} {:9.2}", s.ours, s.bare, s.ratio)
    });
    println!("{:>10}{}", steps[0].count, cells.collect::<String>());
}

/// Prints how both grow, and how much faster ours does.
pub fn print_growth(what: &str, kind: &str, steps: &[&Step]) {
    let (first, last) = (steps[0], steps[steps.len() - 1]);
    let fitted = |of: fn(&Step) -> f64| {
        slope(&steps.iter().map(|s| [s.count as f64, of(s)]).collect::<Vec<_>>())
    };
    println!(
        "{kind}: ours × {:.2} ({what}^{:.3}), bare × {:.2} ({what}^{:.3}); ours grows {:.2} × as fast",
        last.ours / first.ours,
        fitted(|s| s.ours),
        last.bare / first.bare,
        fitted(|s| s.bare),
        last.ratio / first.ratio,
    );
}
