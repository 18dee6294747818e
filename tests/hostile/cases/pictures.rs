//! Pictures whose headers lie, and small ones that are huge once they are decoded.

use super::encode::{bmp, chunk, exr, flat_png, jpeg, png_of, shorts, tga, webp, whole_chunk};
use super::{Case, Expect, Warning};
use envers_testing::png;

const OBJ: &str = "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";

pub fn cases() -> Vec<Case> {
    let refused = Warning("a magenta checker takes its place");
    let case = |ending: &str, name: &str, bytes: Vec<u8>, expect: Expect| {
        let file = format!("hostile.{ending}");
        Case::new(format!("{ending} {name}"), "a.obj", OBJ, expect)
            .with("a.mtl", format!("newmtl a\nmap_Kd {file}\n"))
            .with(&file, bytes)
    };
    let end = whole_chunk(b"IEND", &[]);
    let data = |bytes: &[u8]| [whole_chunk(b"IDAT", bytes), end.clone()].concat();
    let palette = [whole_chunk(b"PLTE", &[]), data(&[])].concat();
    let small = png(&[[9, 9, 9, 255]]);
    let mut cases = vec![
        case("png", "of no bytes", vec![], refused),
        case("png", "of its signature", small[..8].to_vec(), refused),
        case("png", "of half a header", small[..20].to_vec(), refused),
        case("png", "without data", png_of(8, 8, 8, 2, &end), refused),
        case("png", "of 0 × 0", png_of(0, 0, 8, 2, &data(&[])), refused),
        case("png", "of 2^31 × 2^31", png_of(1 << 31, 1 << 31, 8, 6, &data(&[])), refused),
        case("png", "of 2^32 - 1 × 1", png_of(u32::MAX, 1, 8, 6, &data(&[])), refused),
        case("png", "of 32769 × 1", flat_png(32769, 1), refused),
        case("png", "of 32768 × 1", flat_png(32768, 1), Expect::Loads),
        case(
            "png",
            "of 32768 × 32768 that has no data",
            png_of(1 << 15, 1 << 15, 16, 6, &data(&[])),
            refused,
        ),
        case(
            "png",
            "bomb of 32768 × 32768",
            flat_png(1 << 15, 1 << 15),
            Warning("raise the limit `pixels` to "),
        ),
        case(
            "png",
            "bomb of 16384 × 16384",
            flat_png(1 << 14, 1 << 14),
            Warning("raise the limit `pixels` to "),
        ),
        case("png", "of 8192 × 8192 of one colour", flat_png(1 << 13, 1 << 13), Expect::Loads),
        case("png", "of depth 3", png_of(1, 1, 3, 0, &data(&[])), refused),
        case("png", "of colour type 7", png_of(1, 1, 8, 7, &data(&[])), refused),
        case("png", "of a palette without colours", png_of(1, 1, 8, 3, &palette), refused),
        case(
            "png",
            "of data that is no zlib",
            png_of(1, 1, 8, 2, &data(b"no zlib at all")),
            refused,
        ),
        case(
            "png",
            "chunk of 2^31 bytes",
            png_of(1, 1, 8, 2, &chunk(b"IDAT", &[], 1 << 31)),
            refused,
        ),
        case(
            "png",
            "text of 2^31 bytes",
            png_of(1, 1, 8, 2, &chunk(b"iTXt", &[], 1 << 31)),
            refused,
        ),
        case(
            "png",
            "100000 chunks of nothing",
            png_of(1, 1, 8, 2, &whole_chunk(b"xxXx", &[]).repeat(100_000)),
            refused,
        ),
        case(
            "png",
            "compressed text bomb",
            {
                let image = flat_png(1 << 15, 1 << 13);
                let start = image.windows(4).position(|w| w == b"IDAT").unwrap() + 4;
                let bomb = [b"Comment\0\0", &image[start..]].concat();
                [&small[..33], &whole_chunk(b"zTXt", &bomb), &small[33..]].concat()
            },
            Expect::Any,
        ),
        case(
            "png",
            "compressed profile bomb",
            {
                let image = flat_png(1 << 15, 1 << 13);
                let start = image.windows(4).position(|w| w == b"IDAT").unwrap() + 4;
                let bomb = [b"Profile\0\0", &image[start..]].concat();
                [&small[..33], &whole_chunk(b"iCCP", &bomb), &small[33..]].concat()
            },
            Expect::Any,
        ),
        case(
            "png",
            "animation of 2^31 frames",
            {
                let frames = [0x80, 0, 0, 0, 0, 0, 0, 0];
                [&small[..33], &whole_chunk(b"acTL", &frames), &small[33..]].concat()
            },
            Expect::Any,
        ),
        case(
            "png",
            "with a wrong checksum",
            {
                let mut b = small.clone();
                b[29] ^= 1;
                b
            },
            refused,
        ),
        case("jpg", "of its first bytes", vec![0xFF, 0xD8, 0xFF], refused),
        case("jpg", "of 65535 × 65535 without data", jpeg(65535, 65535, 3, &[0xFF, 0xD9]), refused),
        case("jpg", "of 0 × 0", jpeg(0, 0, 3, &[0xFF, 0xD9]), refused),
        case("jpg", "of 0 components", jpeg(8, 8, 0, &[0xFF, 0xD9]), refused),
        case("jpg", "of 80 components", jpeg(8, 8, 80, &[0xFF, 0xD9]), refused),
        case(
            "jpg",
            "scan before its tables",
            jpeg(8, 8, 1, &[0xFF, 0xDA, 0, 8, 1, 1, 0, 0, 63, 0, 0xFF, 0xD9]),
            Expect::Any,
        ),
        case("jpg", "segment of 0 bytes", vec![0xFF, 0xD8, 0xFF, 0xE0, 0, 0, 0, 0], refused),
        case(
            "jpg",
            "a million fill bytes",
            [vec![0xFF, 0xD8], vec![0xFF; 1 << 20]].concat(),
            refused,
        ),
        case(
            "jpg",
            "100000 comments",
            [vec![0xFF, 0xD8], [0xFF, 0xFE, 0, 2].repeat(100_000)].concat(),
            refused,
        ),
        case("webp", "of its first bytes", b"RIFF\0\0\0\0WEBP".to_vec(), refused),
        case(
            "webp",
            "lossless of 16384 × 16384 without data",
            webp(b"VP8L", &[0x2F, 0xFF, 0xFF, 0xFF, 0x0F, 0, 0, 0], 8),
            refused,
        ),
        case(
            "webp",
            "lossy of 16383 × 16383 without data",
            webp(b"VP8 ", &[0x10, 0, 0, 0x9D, 1, 0x2A, 0xFF, 0x3F, 0xFF, 0x3F], 10),
            refused,
        ),
        case(
            "webp",
            "chunk of 2^32 - 1 bytes",
            webp(b"VP8L", &[0x2F, 0, 0, 0, 0], u32::MAX),
            refused,
        ),
        case(
            "webp",
            "canvas of 2^24 × 2^24",
            webp(b"VP8X", &[2, 0, 0, 0, 255, 255, 255, 255, 255, 255], 10),
            refused,
        ),
        case("webp", "unknown chunks alone", webp(b"XXXX", &[0; 64], 64), refused),
        case("tga", "of 65535 × 65535 without data", tga(2, 65535, 65535, 32, &[]), refused),
        case("tga", "of 0 × 0", tga(2, 0, 0, 24, &[]), refused),
        case("tga", "of an unknown kind", tga(77, 4, 4, 24, &[0; 48]), refused),
        case("tga", "of 7 bits", tga(2, 4, 4, 7, &[0; 48]), refused),
        case(
            "tga",
            "runs that go past its end",
            tga(10, 4, 4, 24, &[0xFF, 1, 2, 3].repeat(64)),
            Expect::Any,
        ),
        case(
            "tga",
            "bomb of runs of 16384 × 16384",
            tga(10, 1 << 14, 1 << 14, 8, &[0xFF, 0].repeat(1 << 21)),
            Expect::Any,
        ),
        case(
            "tga",
            "palette that is cut short",
            [&[0, 1, 1, 0, 0, 255, 255, 24, 0, 0, 0, 0][..], &shorts(&[4, 4]), &[8, 0]].concat(),
            refused,
        ),
        case("bmp", "of its first bytes", b"BM".to_vec(), refused),
        case("bmp", "of 2^31 - 1 × 2^31 - 1", bmp(i32::MAX, i32::MAX, 24, 0), refused),
        case("bmp", "of -2^31 rows", bmp(1, i32::MIN, 24, 0), refused),
        case("bmp", "of -1 columns", bmp(-1, 1, 24, 0), refused),
        case("bmp", "of 30000 × 30000 without data", bmp(30_000, 30_000, 24, 0), refused),
        case("bmp", "of runs of 30000 × 30000", bmp(30_000, 30_000, 8, 1), refused),
        case("bmp", "of 999 bits", bmp(1, 1, 999, 0), refused),
        case("bmp", "of an unknown compression", bmp(1, 1, 24, 77), refused),
        case("hdr", "of its signature", b"#?RADIANCE\n".to_vec(), refused),
        case(
            "hdr",
            "of 10^9 × 10^9",
            b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000000 +X 1000000000\n".to_vec(),
            refused,
        ),
        case(
            "hdr",
            "of -5 × 7",
            b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y -5 +X 7\n".to_vec(),
            refused,
        ),
        case(
            "hdr",
            "of 20000 × 20000 without data",
            b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 20000 +X 20000\n".to_vec(),
            refused,
        ),
        case(
            "hdr",
            "of runs of no length",
            [b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 8\n", &[2, 2, 0, 8][..], &[0; 4096]]
                .concat(),
            Expect::Any,
        ),
        case(
            "hdr",
            "header of a megabyte",
            [b"#?RADIANCE\n", &b"x".repeat(1 << 20)[..]].concat(),
            refused,
        ),
        case("exr", "of its signature", vec![0x76, 0x2F, 0x31, 0x01], refused),
        case("exr", "of 2^31 pixels a side", exr([0, 0, i32::MAX, i32::MAX], 0, &[]), refused),
        case(
            "exr",
            "window from end to end of all numbers",
            exr([i32::MIN, i32::MIN, i32::MAX, i32::MAX], 0, &[]),
            refused,
        ),
        case("exr", "window turned around", exr([10, 10, 0, 0], 0, &[]), refused),
        case("exr", "of 30000 × 30000 without data", exr([0, 0, 29_999, 29_999], 0, &[]), refused),
        case(
            "exr",
            "of 30000 × 30000, its offsets all 0",
            exr([0, 0, 29_999, 29_999], 3, &[0; 16 * 30_000]),
            refused,
        ),
        case("exr", "of an unknown compression", exr([0, 0, 3, 3], 99, &[0; 64]), refused),
        case(
            "exr",
            "of blocks of 2^31 bytes",
            exr(
                [0, 0, 0, 0],
                3,
                &[&[1u8, 1, 0, 0, 0, 0, 0, 0][..], &[0; 4], &[255, 255, 255, 127]].concat(),
            ),
            refused,
        ),
        case(
            "exr",
            "attribute of 2^31 bytes",
            [&[0x76, 0x2F, 0x31, 0x01, 2, 0, 0, 0][..], b"a\0string\0", &[255, 255, 255, 127]]
                .concat(),
            refused,
        ),
    ];
    let kinds = ["png", "jpg", "webp", "tga", "bmp", "hdr", "exr"];
    cases.extend(kinds.map(|kind| case(kind, "that is text", b"<svg/>".to_vec(), refused)));
    cases.extend(kinds.map(|kind| {
        case(kind, "that is the script of a shell", b"#!/bin/sh\nrm -rf /\n".repeat(99), refused)
    }));
    cases
}
