#![no_main]

mod common;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| common::load("input.gltf", bytes, "input.gltf"));
