//! The tutorial's pictures against the tutorial's own Python program, transcribed.
//!
//! The transcription keeps the names and the order of operations of the listings (II.1 to III.3),
//! in f64 as Python has them, with one correction: `max(0, r·l)` before the power. Two things are
//! not in the listings and are decided here: `.rgb()` clamps to \[0, 255\], and what it hands to
//! numpy is cut to a whole number when it is stored as `uint8`. Ours rounds instead, so the bytes
//! may differ by 1; before that last step the two agree to within a thousandth.

use envers::internals::{Settings, png_bytes};
use envers::{Loaded, Renderer, load};
use std::ops::{Add, Mul, Sub};
use std::path::Path;

const LONGUEUR: usize = 1000;
const HAUTEUR: usize = 500;
const D: f64 = 500.0;
const FOND: f64 = 50.0;

/// The class `vecteur` of vecteur.py.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Vecteur {
    x: f64,
    y: f64,
    z: f64,
}

fn vecteur(x: f64, y: f64, z: f64) -> Vecteur {
    Vecteur { x, y, z }
}

impl Add for Vecteur {
    type Output = Self;
    fn add(self, v: Self) -> Self {
        vecteur(self.x + v.x, self.y + v.y, self.z + v.z)
    }
}

impl Sub for Vecteur {
    type Output = Self;
    fn sub(self, v: Self) -> Self {
        vecteur(self.x - v.x, self.y - v.y, self.z - v.z)
    }
}

impl Mul<Vecteur> for f64 {
    type Output = Vecteur;
    fn mul(self, v: Vecteur) -> Vecteur {
        vecteur(self * v.x, self * v.y, self * v.z)
    }
}

impl Vecteur {
    /// Not given in the tutorial. The fractions are left for the caller.
    fn rgb(self) -> [f64; 3] {
        [self.x, self.y, self.z].map(|c| c.clamp(0.0, 255.0))
    }
}

/// II.1
fn direction(x: usize, y: usize) -> Vecteur {
    vecteur(x as f64 - LONGUEUR as f64 / 2.0, y as f64 - HAUTEUR as f64 / 2.0, D)
}

/// II.2
fn intersection(u: Vecteur, oc: Vecteur, r: f64) -> f64 {
    let a = 1.0;
    let b = -2.0 * scalaire(u, oc);
    let c = norme(oc).powi(2) - r.powi(2);
    let delta = b.powi(2) - 4.0 * a * c;
    if delta == 0.0 {
        (-b / (2.0 * a)).max(0.0)
    } else if delta > 0.0 {
        let x1 = (-b - delta.sqrt()) / (2.0 * a);
        let x2 = (-b + delta.sqrt()) / (2.0 * a);
        if x1.min(x2) >= 0.0 { x1.min(x2) } else { x1.max(x2).max(0.0) }
    } else {
        0.0
    }
}

/// II.3
fn scalaire(u: Vecteur, v: Vecteur) -> f64 {
    u.x * v.x + u.y * v.y + u.z * v.z
}

/// II.3
fn norme(u: Vecteur) -> f64 {
    scalaire(u, u).sqrt()
}

/// II.3
fn unitaire(u: Vecteur) -> Vecteur {
    vecteur(u.x / norme(u), u.y / norme(u), u.z / norme(u))
}

/// III.3, with or without the correction.
fn speculaire(u: Vecteur, n: Vecteur, l: Vecteur, alpha: i32, corrected: bool) -> Vecteur {
    let couleur_lumiere = vecteur(255.0, 255.0, 255.0);
    if scalaire(l, n) > 0.0 {
        let r = unitaire(u - 2.0 * scalaire(n, u) * n);
        let base = if corrected { scalaire(l, r).max(0.0) } else { scalaire(l, r) };
        base.powi(alpha) * couleur_lumiere
    } else {
        vecteur(0.0, 0.0, 0.0)
    }
}

/// One of the tutorial's three programs.
#[derive(Clone, Copy)]
enum Part {
    /// III.1
    Circle,
    /// III.2
    Lambert,
    /// III.3
    Phong { alpha: i32, corrected: bool },
}

/// `coloration` of III.1, III.2 and III.3: the value of each channel before it becomes a byte.
fn coloration(part: Part) -> Vec<f64> {
    let centre = vecteur(0.0, 0.0, 10.0);
    let rayon = 1.0;
    let couleur_sphere = match part {
        Part::Circle | Part::Lambert => vecteur(58.0, 84.0, 216.0),
        Part::Phong { .. } => vecteur(52.0, 84.0, 216.0),
    };
    let lumiere = vecteur(-20.0, -25.0, -15.0);
    let mut image = vec![FOND; HAUTEUR * LONGUEUR * 3];
    for x in 0..LONGUEUR {
        for y in 0..HAUTEUR {
            let u = unitaire(direction(x, y));
            let t = intersection(u, centre, rayon);
            if t == 0.0 {
                continue;
            }
            let om = t * u;
            let l = unitaire(lumiere - om);
            let n = unitaire(om - centre);
            let lambert = scalaire(n, l).max(0.0) * couleur_sphere;
            let couleur = match part {
                Part::Circle => couleur_sphere,
                Part::Lambert => lambert,
                Part::Phong { alpha, corrected } => lambert + speculaire(u, n, l, alpha, corrected),
            };
            image[3 * (y * LONGUEUR + x)..][..3].copy_from_slice(&couleur.rgb());
        }
    }
    image
}

/// Holds a scene's picture to the tutorial's.
fn compare(name: &str, part: Part) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes/tutorial").join(name);
    let Loaded { scene, report, .. } = load(&path).expect("the scene loads");
    assert_eq!(report.warnings, [""; 0]);
    let film = Renderer::new(&scene).render().expect("the scene renders").film;
    let settings = Settings::from_film(&scene.film);
    let ours = png_bytes(&film, &settings);
    let theirs = coloration(part);
    assert_eq!(ours.len(), theirs.len());
    for (i, (&ours, &theirs)) in ours.iter().zip(&theirs).enumerate() {
        let (x, y, channel) = (i / 3 % LONGUEUR, i / 3 / LONGUEUR, i % 3);
        // numpy stores a float in uint8 by cutting its fraction.
        assert!(
            ours.abs_diff(theirs as u8) <= 1 && (f64::from(ours) - theirs).abs() <= 0.501,
            "pixel ({x}, {y}), channel {channel}: {ours} for {theirs}"
        );
    }
}

#[test]
fn circle_of_part_3_1() {
    compare("3-1-circle.toml", Part::Circle);
}

#[test]
fn lambert_of_part_3_2() {
    compare("3-2-lambert.toml", Part::Lambert);
}

#[test]
fn phong_of_part_3_3() {
    compare("3-3-phong.toml", Part::Phong { alpha: 50, corrected: true });
}

#[test]
fn alpha_10_of_part_3_3() {
    compare("3-3-alpha-10.toml", Part::Phong { alpha: 10, corrected: true });
}

#[test]
fn alpha_30_of_part_3_3() {
    compare("3-3-alpha-30.toml", Part::Phong { alpha: 30, corrected: true });
}

#[test]
fn alpha_100_of_part_3_3() {
    compare("3-3-alpha-100.toml", Part::Phong { alpha: 100, corrected: true });
}

/// Counts the pixels that the correction darkens, in bytes as numpy stores them; and by how much
/// at most.
fn darkened(alpha: i32) -> (usize, u8) {
    let [with, without] = [true, false].map(|corrected| {
        let values = coloration(Part::Phong { alpha, corrected });
        values.iter().map(|&c| c as u8).collect::<Vec<_>>()
    });
    let differences = with.chunks(3).zip(without.chunks(3)).map(|(with, without)| {
        with.iter().zip(without).map(|(a, b)| b.saturating_sub(*a)).max().unwrap_or(0)
    });
    differences.fold((0, 0), |(n, most), d| (n + usize::from(d > 0), most.max(d)))
}

/// Without `max(0, r·l)` an even α lights pixels whose mirror direction leads away from the light.
/// The greater α, the fainter: in the tutorial's own pictures only α = 10 shows it.
/// docs/tutorial/errata.md gives these counts.
#[test]
fn correction_darkens_what_looks_away_from_the_mirror_direction() {
    let counts = [2, 10, 30, 50, 100].map(darkened);
    assert_eq!(counts, [(2351, 106), (592, 3), (0, 0), (0, 0), (0, 0)]);
}
