//! `envers stress`.

use super::*;

#[test]
fn stress_quick_passes_and_its_json_has_every_field() {
    let rows = Folder::new().run("stress --quick --json -").good().json();
    let rows = rows.as_array().unwrap();
    for goal in (1..=13).map(|i| format!("G{i}")) {
        assert!(rows.iter().any(|row| row["goal"] == goal), "{goal}");
    }
    for row in rows {
        assert!(row["rays"].as_u64().unwrap() > 0, "{row}");
        assert_eq!((&row["misclassified"], &row["passed"]), (&0.into(), &true.into()), "{row}");
        for field in ["cell", "method"] {
            assert!(row[field].is_string(), "{field}: {row}");
        }
        for field in ["max_ulp", "max_relative", "fast", "naive"] {
            assert!(row.get(field).is_some(), "{field}: {row}");
        }
    }
    let spheres = rows.iter().filter(|row| row["goal"] == "G1");
    assert!(spheres.clone().all(|row| row["max_ulp"].as_f64().unwrap() <= 0.5));
    assert!(spheres.clone().any(|row| row["naive"]["misclassified"].as_u64().unwrap() > 0));
}

#[test]
fn stress_prints_a_table_of_the_goal_asked_for() {
    let stdout = Folder::new().run("stress --quick --goal g2").good().stdout;
    assert!(stdout.starts_with("goal "), "{stdout}");
    assert!(stdout.lines().skip(1).take(34).all(|line| line.starts_with("G2 ")), "{stdout}");
    assert!(stdout.lines().last().unwrap().starts_with("passed: 34 rows"), "{stdout}");
}

#[test]
fn stress_tables_fit_a_terminal_of_120_columns() {
    let stdout = Folder::new().run("stress --quick").good().stdout;
    assert_eq!(stdout.lines().filter(|line| line.starts_with("goal ")).count(), 13);
    for line in stdout.lines() {
        assert!(line.chars().count() <= 120, "{line}");
    }
}

#[test]
fn stress_runs_a_goal_once_that_is_named_twice() {
    let stdout = Folder::new().run("stress --quick --goal G2,g2").good().stdout;
    assert!(stdout.lines().last().unwrap().starts_with("passed: 34 rows"), "{stdout}");
}

#[test]
fn stress_refuses_to_keep_cells_where_they_would_be_lost() {
    let folder = Folder::new();
    for (arguments, why) in [
        ("--resume -", "name it .jsonl"),
        ("--resume done.toml", "name it .jsonl"),
        ("--resume done.jsonl --json ./done.jsonl", "two outputs are this file"),
    ] {
        let message = folder.run(&format!("stress --quick --goal G2 {arguments}")).refused();
        assert!(message.contains(why), "{message}");
    }
    assert!(folder.names().is_empty());
}

#[test]
fn stress_plot_is_an_svg() {
    let folder = Folder::new();
    folder.run("stress --quick --goal G2 --plot error.svg").good();
    assert!(folder.read("error.svg").starts_with(b"<svg"));
    assert_eq!(folder.names(), ["error.svg"]);
}

#[test]
fn stress_refuses_a_goal_that_is_none_and_a_plot_that_is_no_svg() {
    let message = Folder::new().run("stress --goal G99").refused();
    assert!(message.contains("G99") && message.contains("G1 to G13"), "{message}");
    assert!(Folder::new().run("stress --plot error.png").refused().contains("error.png"));
}

#[test]
fn stress_keeps_finished_cells() {
    let folder = Folder::new();
    let first = folder.run("stress --quick --goal G2 --resume done.jsonl").good().stdout;
    let kept = folder.read("done.jsonl");
    assert_eq!(kept.iter().filter(|b| **b == b'\n').count(), 34);
    assert_eq!(folder.run("stress --quick --goal G2 --resume done.jsonl").good().stdout, first);
    assert_eq!(folder.read("done.jsonl"), kept);
}
