//! The scene file's format: the tables and values that may be written, and the JSON Schema of them.

pub mod animation_tables;
pub mod color;
pub mod json_schema;
pub mod light_tables;
pub mod material_table;
pub mod spanned;
pub mod tables;
pub mod values;
