//! The sweeps of `envers stress`, with few rays of each kind; and that a sweep can fail.

use envers::Ray;
use envers::measure::stress::{self, Goal, Method, Row, StressOptions, Table, plot};
use glam::DVec3;

fn run(goals: &[Goal], rays: u64) -> Vec<Row> {
    let options = StressOptions { goals: goals.into(), rays, ..StressOptions::default() };
    stress::run(&options, &|_| {}).unwrap()
}

fn passes(goal: Goal, rays: u64) {
    let rows = run(&[goal], rays);
    assert!(!rows.is_empty());
    assert!(rows.iter().all(|row| row.passed && row.stats.rays >= rays), "\n{}", Table(&rows));
}

fn failing(method: Method, goal: Goal) -> Vec<Row> {
    let options =
        StressOptions { goals: vec![goal], rays: 200, method, ..StressOptions::default() };
    let rows = stress::run(&options, &|_| {}).unwrap();
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
fn surfaces_ulps_apart_are_hit_in_their_order() {
    passes(Goal::Order, 100);
}

#[test]
fn lamps_on_surfaces_light_what_they_see() {
    passes(Goal::LampOnSurface, 300);
}

#[test]
fn closed_meshes_keep_their_light_in() {
    passes(Goal::Enclosure, 300);
}

#[test]
fn nothing_passes_through_flat_caps_and_far_planes() {
    passes(Goal::FlatCaps, 300);
}

#[test]
fn hits_do_not_depend_on_scale() {
    passes(Goal::Scale, 300);
}

#[test]
fn millimetres_are_hit_at_map_coordinates() {
    passes(Goal::FarDetail, 200);
}

#[test]
fn seed_decides_the_rows() {
    let rows = |seed| {
        let goals = vec![Goal::Tangency];
        stress::run(&StressOptions { goals, rays: 20, seed, ..StressOptions::default() }, &|_| {})
            .unwrap()
    };
    assert_eq!(rows(7), rows(7));
    assert_ne!(rows(7), rows(8));
}

/// Haines's formula: some ulp off, and now and then wrong at a tangent.
fn rounded(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
    use envers::internals::sphere::first_root;
    use envers::internals::sphere::inverse_length_squared;
    use envers::internals::sphere::roots;
    let inverse = inverse_length_squared(ray.direction);
    first_root(roots(center, radius, ray.origin, ray.direction, inverse)?, ray.tmax, false)
}

#[test]
fn distance_that_is_not_correctly_rounded_fails() {
    let rows = failing(rounded, Goal::SphereDistance);
    assert!(rows.iter().any(|row| row.stats.max_ulp > Some(0.5)), "\n{}", Table(&rows));
}

#[test]
fn distance_one_ulp_off_fails_in_every_cell_that_hits() {
    fn next(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
        stress::certified(center, radius, ray).map(f64::next_up)
    }
    let failed = failing(next, Goal::Tangency).len();
    assert_eq!(failed, 34, "of G2's 34 cells");
}

#[test]
fn hit_that_is_missed_fails() {
    fn blind(center: DVec3, radius: f64, ray: &Ray) -> Option<f64> {
        // Blind for what lies less than a millionth of the radius within the rim.
        stress::certified(center, radius * (1.0 - 1e-6), ray)
            .and(stress::certified(center, radius, ray))
    }
    let rows = failing(blind, Goal::Tangency);
    assert!(rows.iter().any(|row| row.stats.misclassified > 0), "\n{}", Table(&rows));
}

#[test]
fn finished_cases_are_not_run_again() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("finished.jsonl");
    let options = StressOptions {
        goals: vec![Goal::Tangency],
        rays: 20,
        resume: Some(file.clone()),
        ..StressOptions::default()
    };
    let first = stress::run(&options, &|_| {}).unwrap();
    let kept = std::fs::read_to_string(&file).unwrap();
    assert_eq!(kept.lines().count(), first.len());
    // A formula that always misses would fail every case that is run.
    let again = StressOptions { method: |_, _, _| None, ..options.clone() };
    assert_eq!(stress::run(&again, &|_| {}).unwrap(), first);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), kept);
    let other = StressOptions { seed: 2, ..again };
    assert!(stress::run(&other, &|_| {}).unwrap().iter().all(|row| !row.passed));
}

#[test]
fn incomplete_last_line_is_run_again() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("finished.jsonl");
    let goals = vec![Goal::Tangency];
    let options =
        StressOptions { goals, rays: 20, resume: Some(file.clone()), ..StressOptions::default() };
    let first = stress::run(&options, &|_| {}).unwrap();
    let kept = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, &kept[..kept.len() - 30]).unwrap();
    assert_eq!(stress::run(&options, &|_| {}).unwrap(), first);
    assert_eq!(stress::run(&options, &|_| {}).unwrap(), first);
}

#[test]
fn other_files_are_not_taken_for_finished_cases() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("finished.jsonl");
    std::fs::write(&file, "not a cell\nnor this\n").unwrap();
    let options = StressOptions { resume: Some(file.clone()), ..StressOptions::default() };
    let error = stress::run(&options, &|_| {}).unwrap_err();
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
