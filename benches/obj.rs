//! The time that an OBJ file of a million triangles takes, from the path to a checked scene, beside
//! what bare tobj takes for it: `cargo bench --bench obj`.
//!
//! Both read the same file in turn, and the ratio of the medians counts. tobj is asked for what
//! envers needs of it: one index for each vertex, polygons as they are.

use std::fmt::Write;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

/// Times that each file is read by either.
const ROUNDS: usize = 11;
/// Squares along the ring and around it; two triangles each.
const SQUARES: [usize; 2] = [1000, 500];

/// The attributes that the faces of a file name beside positions.
#[derive(Clone, Copy, PartialEq)]
enum With {
    Nothing,
    Smoothing,
    UvsAndNormals,
}

fn main() {
    let folder = tempfile::tempdir().unwrap();
    for (name, with) in [
        ("uvs, normals", With::UvsAndNormals),
        ("positions", With::Nothing),
        ("smoothing group", With::Smoothing),
    ] {
        let path = folder.path().join("model.obj");
        let text = torus(with);
        std::fs::write(&path, &text).unwrap();
        let mut times = [(); 2].map(|()| Vec::new());
        for _ in 0..ROUNDS {
            times[0].push(seconds(|| drop(black_box(bare(&path)))));
            times[1].push(seconds(|| drop(black_box(envers::load(&path).unwrap()))));
        }
        let [tobj, ours] = times.map(median);
        println!(
            "{name:>15}: {:.0} MB, tobj {tobj:.3} s, envers {ours:.3} s, ratio {:.2}",
            text.len() as f64 * 1e-6,
            ours / tobj
        );
    }
}

fn bare(path: &Path) -> Vec<tobj::Model> {
    let options = tobj::LoadOptions { single_index: true, ..Default::default() };
    tobj::load_obj(path, &options).unwrap().0
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// A torus with a seam, as exporters write one.
fn torus(with: With) -> String {
    let [along, around] = SQUARES;
    let mut text = String::from("# a torus\no torus\n");
    let mut uvs = String::new();
    let mut normals = String::new();
    for i in 0..=along {
        for j in 0..=around {
            let [u, v] = [i as f64 / along as f64, j as f64 / around as f64];
            let [(sin_u, cos_u), (sin_v, cos_v)] =
                [u, v].map(|x| (x * std::f64::consts::TAU).sin_cos());
            let radius = 2.0 + cos_v;
            let _ = writeln!(text, "v {:.6} {:.6} {:.6}", radius * cos_u, sin_v, radius * sin_u);
            let _ = writeln!(uvs, "vt {u:.6} {v:.6}");
            let _ = writeln!(normals, "vn {:.6} {:.6} {:.6}", cos_v * cos_u, sin_v, cos_v * sin_u);
        }
    }
    match with {
        With::Nothing => {}
        With::Smoothing => text.push_str("s 1\n"),
        With::UvsAndNormals => text.extend([uvs, normals]),
    }
    for i in 0..along {
        for j in 0..around {
            let at = |i: usize, j: usize| i * (around + 1) + j + 1;
            let square = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            for triangle in [[0, 1, 2], [0, 2, 3]] {
                text.push('f');
                for corner in triangle.map(|k| square[k]) {
                    let _ = match with {
                        With::UvsAndNormals => write!(text, " {corner}/{corner}/{corner}"),
                        _ => write!(text, " {corner}"),
                    };
                }
                text.push('\n');
            }
        }
    }
    text
}
