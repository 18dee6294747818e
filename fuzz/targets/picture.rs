#![no_main]

mod common;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    // A TGA file is told by its name alone.
    common::write("a.mtl", b"newmtl a\nKd 1 0 0\nmap_Kd input.tga\n");
    common::load("input.tga", bytes, "a.obj");
});
