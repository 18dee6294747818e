//! OBJ files.

use super::{Case, Error, Expect, Loads, Warning};

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// Lines after three corners, and what comes of them.
const LINES: &[(&str, Expect)] = &[
    ("f", Warning("fewer than three")),
    ("f 1", Warning("fewer than three")),
    ("f 1 2", Warning("fewer than three")),
    ("f 0 1 2", Warning("")),
    ("f 1 2 4", Warning("")),
    ("f -1 -2 -4", Warning("")),
    ("f 1 2 2147483648", Warning("")),
    ("f 1 2 4294967297", Warning("")),
    ("f 1 2 18446744073709551617", Expect::Any),
    ("f -9223372036854775808 1 2", Expect::Any),
    ("f 1 2 99999999999999999999999999999", Expect::Any),
    ("f 1.5 2 3", Expect::Any),
    ("f 1e0 2 3", Expect::Any),
    ("f x y z", Expect::Any),
    ("f 1/ 2/ 3/", Expect::Any),
    ("f 1// 2// 3//", Expect::Any),
    ("f 1/1/1/1 2/2/2/2 3/3/3/3", Expect::Any),
    ("f 1/9 2/9 3/9", Warning("")),
    ("f 1//9 2//9 3//9", Warning("")),
    ("f 1/-9/-9 2/-9/-9 3/-9/-9", Warning("")),
    ("f 1 2 3 1 2 3", Expect::Any),
    ("f 1 1 1", Expect::Any),
    ("f / / /", Expect::Any),
    ("f -0 1 2", Expect::Any),
    ("f +1 +2 +3", Expect::Any),
    ("f １ ２ ３", Expect::Any),
    ("v", Error("hostile.obj:4")),
    ("v 1 2", Error("hostile.obj:4")),
    ("v a b c", Error("hostile.obj:4")),
    ("v nan nan nan\nf 1 2 4", Expect::Any),
    ("v inf 0 0\nf 1 2 4", Expect::Any),
    ("v 1e400 0 0\nf 1 2 4", Expect::Any),
    ("v 3e38 3e38 3e38\nf 1 2 4", Error("")),
    ("v 1e-400 0 0\nf 1 2 4", Expect::Any),
    ("v 0x10 0 0", Warning("broken, not finite or beyond")),
    ("v 1,5 0 0", Error("hostile.obj:4")),
    ("v 1 2 3 0\nf 1 2 4", Expect::Any),
    ("v 1 2 3 nan\nf 1 2 4", Expect::Any),
    ("v 1 2 3 1e38 -1 nan\nf 1 2 4", Expect::Any),
    ("v 1 2 3 4 5 6 7 8 9\nf 1 2 4", Expect::Any),
    ("vt\nf 1/1 2/1 3/1", Expect::Any),
    ("vt nan inf\nf 1/1 2/1 3/1", Expect::Any),
    ("vn 0 0 0\nf 1//1 2//1 3//1", Expect::Any),
    ("vn nan nan nan\nf 1//1 2//1 3//1", Expect::Any),
    ("vn 1e38 1e38 1e38\nf 1//1 2//1 3//1", Expect::Any),
    ("s 99999999999999999999\nf 1 2 3", Expect::Any),
    ("s -1\nf 1 2 3", Expect::Any),
    ("g\nf 1 2 3", Loads),
    ("o \nf 1 2 3", Loads),
    ("usemtl\nf 1 2 3", Expect::Any),
    ("usemtl ../../etc/passwd\nf 1 2 3", Warning("in no MTL file")),
    ("usemtl \u{1b}[31m\nf 1 2 3", Warning("in no MTL file")),
    ("mtllib\nf 1 2 3", Expect::Any),
    ("mtllib gone.mtl\nf 1 2 3", Warning("missing")),
    ("mtllib .\nf 1 2 3", Warning("a folder")),
    ("mtllib hostile.obj\nf 1 2 3", Expect::Any),
    ("mtllib ../hostile.mtl\nf 1 2 3", Warning("missing")),
    ("mtllib /dev/zero\nf 1 2 3", Warning("missing")),
    ("mtllib \0\nf 1 2 3", Error("binary file")),
    ("mtllib a.mtl b.mtl c.mtl\nf 1 2 3", Warning("missing")),
    ("call ../../../etc/passwd\nf 1 2 3", Expect::Any),
    ("csh rm -rf /\nf 1 2 3", Expect::Any),
    ("shadow_obj /dev/zero\nf 1 2 3", Expect::Any),
    ("deg 99999999999\ncurv 0 1 1 2 3\nf 1 2 3", Expect::Any),
    ("\\\n\\\n\\\nf 1 2 3", Loads),
    ("f 1 \\\n2 \\\n3", Loads),
    ("f 1 2 3 \\", Expect::Any),
    ("\u{feff}f 1 2 3", Expect::Any),
    ("f 1 2 3\0", Expect::Any),
    ("F 1 2 3", Expect::Any),
    ("l 1 2 3 4 5\nf 1 2 3", Warning("")),
    ("p 1 99\nf 1 2 3", Warning("")),
];

pub fn cases() -> Vec<Case> {
    let line = |&(lines, expect): &(&str, Expect)| {
        let name = format!("obj {lines:?}");
        Case::new(name, "hostile.obj", format!("{CORNERS}{lines}\n"), expect)
    };
    let mut cases: Vec<Case> = LINES.iter().map(line).collect();
    let mut case = |name: &str, text: Vec<u8>, expect| {
        cases.push(Case::new(format!("obj {name}"), "hostile.obj", text, expect));
    };
    let after = |rest: String| format!("{CORNERS}{rest}").into_bytes();
    case("of no bytes", vec![], Warning("no face"));
    case("of zeros", vec![0; 1 << 20], Expect::Any);
    case("of a megabyte without a line break", vec![b'x'; 1 << 20], Expect::Any);
    case("of a million line breaks", vec![b'\n'; 1 << 20], Warning("no face"));
    case("of a million continuations", b"\\\n".repeat(1 << 20), Expect::Any);
    case("of bytes that are no text", (0..=255).collect::<Vec<u8>>().repeat(100), Expect::Any);
    case("in UTF-16 cut short", b"\xFF\xFEv\0 ".to_vec(), Expect::Any);
    case("in UTF-16 of half surrogates", b"\xFE\xFF\xD8\x00".repeat(1000), Expect::Any);
    let polygon = |n: usize, of: &str| after(format!("f {}\n", of.repeat(n)));
    case("polygon of 100000 times the same corner", polygon(100_000, "1 "), Expect::Any);
    case("polygon of 100000 times the same triangle", polygon(33_333, "1 2 3 "), Expect::Any);
    case(
        "polygon of 20000 corners that cross",
        {
            let star = |i: usize| {
                let angle = (i * 7919) as f64;
                format!("v {} {} 0\n", angle.cos(), angle.sin())
            };
            let corners: String = (0..20_000).map(star).collect();
            let face: String = (4..20_004).map(|i| format!(" {i}")).collect();
            after(format!("{corners}f{face}\n"))
        },
        Expect::Any,
    );
    case(
        "200 polygons of 5000 corners that cross",
        {
            let star = |i: usize| {
                let angle = (i * 7919) as f64;
                format!("v {} {} 0\n", angle.cos(), angle.sin())
            };
            let corners: String = (0..5_000).map(star).collect();
            let face: String = (4..5_004).map(|i| format!(" {i}")).collect();
            after(format!("{corners}{}", format!("f{face}\n").repeat(200)))
        },
        Expect::Any,
    );
    case(
        "100000 objects of one face",
        {
            let object = |i: usize| format!("o part{i}\nf 1 2 3\n");
            after((0..100_000).map(object).collect())
        },
        Warning("stand at the same place"),
    );
    case(
        "100000 materials that are in no file",
        {
            let object = |i: usize| format!("usemtl m{i}\nf 1 2 3\n");
            after((0..100_000).map(object).collect())
        },
        Warning("in no MTL file"),
    );
    case("100000 broken faces", after("f 1 2 99\n".repeat(100_000)), Warning("100000"));
    case(
        "20000 libraries that are missing",
        {
            after(
                (0..20_000).map(|i| format!("mtllib m{i}.mtl\n")).collect::<String>() + "f 1 2 3\n",
            )
        },
        Warning("missing"),
    );
    case(
        "one library line of 100000 names",
        after(format!("mtllib{}\nf 1 2 3\n", " a.mtl".repeat(100_000))),
        Warning("missing"),
    );
    case(
        "names of a megabyte",
        {
            let long = "x".repeat(1 << 20);
            after(format!("o {long}\ng {long}\nusemtl {long}\nmtllib {long}\nf 1 2 3\n"))
        },
        Expect::Any,
    );
    case(
        "number of a megabyte",
        after(format!("v {} 0 0\nf 1 2 4\n", "9".repeat(1 << 20))),
        Expect::Any,
    );
    case(
        "same library named 50000 times",
        {
            let same = |i: usize| format!("mtllib {}a.mtl\n", "./".repeat(i % 40));
            after((0..50_000).map(same).collect::<String>() + "usemtl a\nf 1 2 3\n")
        },
        Expect::Any,
    );
    let last = cases.last_mut().unwrap();
    last.files.push(("a.mtl".to_owned(), b"newmtl a\nKd 1 0 0\n".repeat(20_000)));
    cases
}
