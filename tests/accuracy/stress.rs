//! The sweeps of `envers stress`, with few rays of each kind; and that a sweep can fail.

use envers::geometry::Ray;
use envers::measure::stress::{Goal, Method, Options, Row, Table, plot, stress};
use glam::DVec3;

fn run(goals: &[Goal], rays: u64) -> Vec<Row> {
    let options = Options { goals: goals.into(), rays, ..Options::default() };
    stress(&options, &|_| {}).unwrap()
}

fn passes(goal: Goal, rays: u64) {
    let rows = run(&[goal], rays);
    assert!(!rows.is_empty());
    assert!(rows.iter().all(|row| row.passed && row.tally.rays >= rays), "\n{}", Table(&rows));
}

fn failing(method: Method, goal: Goal) -> Vec<Row> {
    let options = Options { goals: vec![goal], rays: 200, method, ..Options::default() };
    let rows = stress(&options, &|_| {}).unwrap();
    rows.into_iter().filter(|row| !row.passed).collect()
}

#[test]
fn sphere_distances_are_correctly_rounded() {
    passes(Goal::SphereDistance, 200);
}

#[test]
fn tangency_is_decided_exactly() {
    passes(Goal::Tangency, 500);
}

#[test]
fn trees_equal_brute_force() {
    passes(Goal::Traversal, 300);
}

#[test]
fn closed_meshes_do_not_leak() {
    passes(Goal::Watertight, 200);
}

#[test]
fn grazing_triangles_are_decided_exactly() {
    passes(Goal::Grazing, 300);
}

#[test]
fn spheres_do_not_shadow_themselves() {
    passes(Goal::SelfShadow, 500);
}

#[test]
fn pictures_do_not_depend_on_scale_threads_and_tiles() {
    passes(Goal::Invariance, 1000);
}

#[test]
fn seed_decides_the_rows() {
    let rows = |seed| {
        let goals = vec![Goal::Tangency];
        stress(&Options { goals, rays: 20, seed, ..Options::default() }, &|_| {}).unwrap()
    };
    assert_eq!(rows(7), rows(7));
    assert_ne!(rows(7), rows(8));
}

/// Haines's formula: some ulp off, and now and then wrong at a tangent.
fn rounded(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
    use envers::geometry::sphere::{first_root, inverse_length_squared, roots};
    let inverse = inverse_length_squared(ray.direction);
    first_root(roots(center, radius, ray.origin, ray.direction, inverse)?, ray.tmax, false)
}

#[test]
fn distance_that_is_not_correctly_rounded_fails() {
    let rows = failing(rounded, Goal::SphereDistance);
    assert!(rows.iter().any(|row| row.tally.max_ulp > Some(0.5)), "\n{}", Table(&rows));
}

#[test]
fn distance_one_ulp_off_fails_in_every_cell_that_hits() {
    fn next(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
        envers::measure::stress::certified(center, radius, ray).map(f64::next_up)
    }
    let failed = failing(next, Goal::Tangency).len();
    assert_eq!(failed, 34, "of G2's 34 cells");
}

#[test]
fn hit_that_is_missed_fails() {
    fn blind(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
        // Blind for what lies less than a millionth of the radius within the rim.
        envers::measure::stress::certified(center, radius * (1.0 - 1e-6), ray)
            .and(envers::measure::stress::certified(center, radius, ray))
    }
    let rows = failing(blind, Goal::Tangency);
    assert!(rows.iter().any(|row| row.tally.misclassified > 0), "\n{}", Table(&rows));
}

#[test]
fn finished_cells_are_not_tried_again() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("finished.jsonl");
    let options = Options {
        goals: vec![Goal::Tangency],
        rays: 20,
        resume: Some(file.clone()),
        ..Options::default()
    };
    let first = stress(&options, &|_| {}).unwrap();
    let kept = std::fs::read_to_string(&file).unwrap();
    assert_eq!(kept.lines().count(), first.len());
    // A formula that always misses would fail every row that is tried.
    let again = Options { method: |_, _, _| None, ..options.clone() };
    assert_eq!(stress(&again, &|_| {}).unwrap(), first);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), kept);
    let other = Options { seed: 2, ..again };
    assert!(stress(&other, &|_| {}).unwrap().iter().all(|row| !row.passed));
}

#[test]
fn unfinished_last_line_is_tried_again() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("finished.jsonl");
    let goals = vec![Goal::Tangency];
    let options = Options { goals, rays: 20, resume: Some(file.clone()), ..Options::default() };
    let first = stress(&options, &|_| {}).unwrap();
    let kept = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, &kept[..kept.len() - 30]).unwrap();
    assert_eq!(stress(&options, &|_| {}).unwrap(), first);
    assert_eq!(stress(&options, &|_| {}).unwrap(), first);
}

#[test]
fn other_files_are_not_taken_for_finished_cells() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("finished.jsonl");
    std::fs::write(&file, "not a cell\nnor this\n").unwrap();
    let options = Options { resume: Some(file.clone()), ..Options::default() };
    let error = stress(&options, &|_| {}).unwrap_err();
    assert!(error.message().contains("line 1"), "{}", error.message());
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "not a cell\nnor this\n");
}

#[test]
fn plot_shows_every_formula() {
    let svg = plot(1, 50).unwrap();
    for name in ["f32", "b² − 4ac in f64", "Haines", "certified"] {
        assert!(svg.contains(name), "{name}");
    }
    assert!(svg.matches("<polyline").count() >= 4);
}
