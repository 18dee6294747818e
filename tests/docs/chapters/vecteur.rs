//! `vecteur.py`, which the tutorial's listings ask for: what they do with it works, and what makes
//! no sense is an error.

use std::process::Command;

use super::book::tutorial;

/// Returns what Python prints for an expression, after `from vecteur import *`; or the kind of its error.
fn python(expression: &str) -> String {
    let program = format!("from vecteur import *\nprint({expression})");
    let mut command = Command::new("python3");
    command.args(["-B", "-c", &program]).current_dir(tutorial().join("programs"));
    let answer = command.output().expect("python3 starts");
    let text = if answer.status.success() { answer.stdout } else { answer.stderr };
    let text = String::from_utf8_lossy(&text).trim().to_owned();
    let last = text.lines().last().unwrap_or_default();
    if answer.status.success() { text } else { last.split(':').next().unwrap().to_owned() }
}

#[test]
fn importing_everything_brings_the_three_classes_and_no_other_name() {
    let names = "sorted(name for name in globals() if not name.startswith('__'))";
    assert_eq!(python(names), "['plan', 'sphere', 'vecteur']");
}

#[test]
fn a_number_may_stand_on_either_side_of_a_vector() {
    assert_eq!(python("2 * vecteur(1, 2, 3)"), "vecteur(2, 4, 6)");
    assert_eq!(python("vecteur(1, 2, 3) * 2"), "vecteur(2, 4, 6)");
}

#[test]
fn a_vector_is_subtracted_after_two_products_as_in_the_listing_of_the_highlight() {
    let r = "vecteur(3, 1, 0) - 2 * vecteur(0, 1, 0).scalaire(vecteur(3, 1, 0)) * vecteur(0, 1, 0)";
    assert_eq!(python(r), "vecteur(3, -1, 0)");
}

#[test]
fn vectors_are_added_negated_divided_and_compared() {
    assert_eq!(python("-(vecteur(1, 2, 3) + vecteur(1, 0, 1)) / 2"), "vecteur(-1.0, -1.0, -2.0)");
    assert_eq!(python("vecteur(1, 2, 3) == vecteur(1.0, 2.0, 3.0)"), "True");
    assert_eq!(python("vecteur(1, 2, 3) == 6"), "False");
}

#[test]
fn product_of_two_vectors_is_an_error() {
    assert_eq!(python("vecteur(1, 2, 3) * vecteur(1, 2, 3)"), "TypeError");
}

#[test]
fn sum_of_a_vector_and_a_number_is_an_error() {
    assert_eq!(python("vecteur(1, 2, 3) + 3"), "TypeError");
    assert_eq!(python("3 - vecteur(1, 2, 3)"), "TypeError");
}

#[test]
fn bytes_of_a_colour_are_rounded_and_clamped() {
    assert_eq!(python("vecteur(58, 84, 216).rgb()"), "(58, 84, 216)");
    assert_eq!(python("vecteur(300, -3, 126.5).rgb()"), "(255, 0, 127)");
}

#[test]
fn sphere_around_the_eye_is_met_at_its_far_side_and_one_behind_it_is_not() {
    let t = |center: &str| {
        let sphere = format!("sphere(vecteur({center}), 2, None)");
        python(&format!("{sphere}.intersection(vecteur(0, 0, 0), vecteur(0, 0, 1))"))
    };
    assert_eq!([t("0, 0, 5"), t("0, 0, 1"), t("0, 0, -5")], ["3.0", "3.0", "None"]);
}

#[test]
fn plane_is_met_ahead_and_neither_behind_nor_alongside() {
    let t = |u: &str| {
        let plane = "plan(vecteur(0, 2, 0), vecteur(0, -3, 0), None)";
        python(&format!("{plane}.intersection(vecteur(0, 0, 0), vecteur({u}))"))
    };
    assert_eq!([t("0, 1, 0"), t("0, -1, 0"), t("1, 0, 0")], ["2.0", "None", "None"]);
}
