//! MTL files, and the pictures that they name.

use super::{Case, Expect, Loads, Warning};

const OBJ: &str =
    "mtllib hostile.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";

/// Lines of the material `a`, and what comes of them.
const LINES: &[(&str, Expect)] = &[
    ("Kd", Expect::Any),
    ("Kd 1", Loads),
    ("Kd 1 2", Warning("wants")),
    ("Kd x y z", Warning("wants")),
    ("Kd nan nan nan", Warning("wants")),
    ("Kd inf 0 0", Warning("wants")),
    ("Kd -1 -1 -1", Warning("wants")),
    ("Kd 1e39 0 0", Warning("wants")),
    ("Kd 3e38 3e38 3e38", Expect::Any),
    ("Kd spectral ../../secret.rfl 1", Expect::Any),
    ("Kd xyz 1 1 1", Expect::Any),
    ("Ks 1e38 1e38 1e38", Expect::Any),
    ("Ke 1e38 1e38 1e38", Expect::Any),
    ("Ns -1", Warning("wants")),
    ("Ns 1e38", Expect::Any),
    ("Ns nan", Warning("wants")),
    ("Ni 0", Expect::Any),
    ("Ni -1", Warning("wants")),
    ("Ni 1e38\nillum 7\nd 0.5", Expect::Any),
    ("Ni 0\nillum 7\nd 0.5", Expect::Any),
    ("d", Expect::Any),
    ("d -halo", Expect::Any),
    ("d 7", Expect::Any),
    ("d -7", Warning("wants")),
    ("d 0", Expect::Any),
    ("Tr 2", Expect::Any),
    ("Tf 1e38 1e38 1e38\nillum 7", Expect::Any),
    ("illum 99999999999", Warning("wants")),
    ("illum -1", Warning("wants")),
    ("illum nan", Warning("wants")),
    ("Pr nan\nPm inf", Expect::Any),
    ("map_Kd", Expect::Any),
    ("map_Kd .", Warning("magenta")),
    ("map_Kd gone.png", Warning("magenta")),
    ("map_Kd hostile.mtl", Warning("magenta")),
    ("map_Kd /dev/zero", Warning("magenta")),
    ("map_Kd ../../../../../../etc/passwd", Warning("magenta")),
    ("map_Kd http://127.0.0.1:1/a.png", Warning("magenta")),
    ("map_Kd \0.png", Warning("binary file")),
    ("map_Kd -s", Expect::Any),
    ("map_Kd -s nan nan nan a.png", Warning("magenta")),
    ("map_Kd -o 1e39 0 0 -s 0 0 0 a.png", Warning("magenta")),
    ("map_Kd -mm 1 a.png", Expect::Any),
    ("map_Kd -clamp", Expect::Any),
    ("map_Kd \"", Expect::Any),
    ("map_Kd \"\"", Expect::Any),
    ("map_Bump -bm 1e39 gone.png", Expect::Any),
    ("norm gone.png", Expect::Any),
    ("map_d gone.png", Expect::Any),
    ("map_Ke gone.png", Warning("magenta")),
    ("map_aat on\nrefl -type sphere gone.png", Expect::Any),
    ("disp gone.png\ndecal gone.png", Expect::Any),
    ("newmtl a\nnewmtl a\nKd 1 0 0", Expect::Any),
    ("newmtl", Expect::Any),
    ("newmtl \u{1b}[2J", Expect::Any),
];

pub fn cases() -> Vec<Case> {
    let mtl = |name: String, text: Vec<u8>, expect| {
        Case::new(format!("mtl {name}"), "hostile.obj", OBJ, expect).with("hostile.mtl", text)
    };
    let line = |&(lines, expect): &(&str, Expect)| {
        mtl(format!("{lines:?}"), format!("newmtl a\n{lines}\n").into_bytes(), expect)
    };
    let mut cases: Vec<Case> = LINES.iter().map(line).collect();
    let mut case = |name: &str, text: Vec<u8>, expect| {
        cases.push(mtl(name.to_owned(), text, expect));
    };
    case("of no bytes", vec![], Warning("in no MTL file"));
    case("of zeros", vec![0; 1 << 20], Warning("in no MTL file"));
    case("of a megabyte without a line break", vec![b'K'; 1 << 20], Warning("in no MTL file"));
    case("of bytes that are no text", (0..=255).collect::<Vec<u8>>().repeat(100), Expect::Any);
    case("of a statement before any material", b"Kd 1 0 0\nnewmtl a\n".to_vec(), Expect::Any);
    case(
        "of 100000 materials",
        (0..100_000).map(|i| format!("newmtl m{i}\n")).collect::<String>().into_bytes(),
        Warning("in no MTL file"),
    );
    case(
        "of 100000 lines that are not understood",
        ["newmtl a\n".to_owned(), "Kd x\n".repeat(100_000)].concat().into_bytes(),
        Warning("100000 lines are ignored"),
    );
    case(
        "of 100000 maps of which the last counts",
        {
            let map = |i: usize| format!("map_Kd {i}.png\n");
            ("newmtl a\n".to_owned() + &(0..100_000).map(map).collect::<String>()).into_bytes()
        },
        Warning("magenta"),
    );
    let many = |i: usize| format!("newmtl m{i}\nmap_Kd {i}.png\n");
    let uses = |i: usize| format!("usemtl m{i}\nf 1/1 2/1 3/1\n");
    let obj = OBJ.to_owned() + &(0..20_000).map(uses).collect::<String>();
    let all: String = (0..20_000).map(many).collect();
    let missing = Case::new(
        "mtl 20000 pictures that are missing",
        "hostile.obj",
        obj.clone(),
        Warning("magenta"),
    );
    cases.push(missing.with("hostile.mtl", all));
    let same = |i: usize| format!("newmtl m{i}\nmap_Kd {}bomb.png\n", "./".repeat(i % 50));
    let all: String = (0..20_000).map(same).collect();
    let bombs = Case::new("mtl 20000 names of one bomb", "hostile.obj", obj, Expect::Any);
    let bomb = super::encode::flat_png(4096, 4096);
    cases.push(bombs.with("hostile.mtl", all).with("bomb.png", bomb));
    cases
}
