//! The numbers that an accessor's elements are made of.

use gltf::json::accessor::ComponentType;

/// A number within a buffer: what it is and how it reads.
#[derive(Clone, Copy)]
pub struct Number {
    /// What it is.
    pub kind: ComponentType,
    /// Whether an integer stands for a share of its range.
    pub normalized: bool,
}

impl Number {
    /// The value as a float. Normalised integers map as the standard's part 3.6.2.2 says.
    pub fn float(self, bytes: &[u8]) -> f32 {
        let scale = |value: f32, greatest: f32| {
            if self.normalized { (value / greatest).max(-1.0) } else { value }
        };
        match *bytes {
            [a] if self.kind == ComponentType::I8 => scale(f32::from(a as i8), 127.0),
            [a] => scale(f32::from(a), 255.0),
            [a, b] if self.kind == ComponentType::I16 => {
                scale(f32::from(i16::from_le_bytes([a, b])), 32767.0)
            }
            [a, b] => scale(f32::from(u16::from_le_bytes([a, b])), 65535.0),
            [a, b, c, d] if self.kind == ComponentType::F32 => f32::from_le_bytes([a, b, c, d]),
            [a, b, c, d] => scale(u32::from_le_bytes([a, b, c, d]) as f32, u32::MAX as f32),
            _ => 0.0,
        }
    }

    /// The value as an unsigned integer.
    pub fn integer(self, bytes: &[u8]) -> u32 {
        match *bytes {
            [a] => u32::from(a),
            [a, b] => u32::from(u16::from_le_bytes([a, b])),
            [a, b, c, d] => u32::from_le_bytes([a, b, c, d]),
            _ => 0,
        }
    }
}
