//! Placing a model's scene within another one.
