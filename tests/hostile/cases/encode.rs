//! Headers of pictures, which say what they are told to.

/// A PNG of one colour: of one bit for each pixel, and a thousandth of that in bytes.
pub fn flat_png(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::One);
    let mut writer = encoder.write_header().unwrap();
    let row = (width as usize).div_ceil(8);
    writer.write_image_data(&vec![0; row * height as usize]).unwrap();
    writer.finish().unwrap();
    bytes
}

/// The checksum of PNG's chunks (ISO 3309).
pub fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg())
        })
    })
}

/// A chunk of a PNG that says that it has so many bytes.
pub fn chunk(kind: &[u8; 4], data: &[u8], length: u32) -> Vec<u8> {
    let body = [kind, data].concat();
    [&length.to_be_bytes()[..], &body, &crc(&body).to_be_bytes()].concat()
}

pub fn whole_chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    chunk(kind, data, data.len() as u32)
}

/// A PNG with a header of this size, bit depth and colour type, before other chunks.
pub fn png_of(width: u32, height: u32, depth: u8, color: u8, rest: &[u8]) -> Vec<u8> {
    let header =
        [&width.to_be_bytes()[..], &height.to_be_bytes(), &[depth, color, 0, 0, 0]].concat();
    [b"\x89PNG\r\n\x1a\n", &whole_chunk(b"IHDR", &header)[..], rest].concat()
}

pub fn shorts(bytes: &[u16]) -> Vec<u8> {
    bytes.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// A TGA header of this kind and size, before other bytes.
pub fn tga(kind: u8, width: u16, height: u16, depth: u8, rest: &[u8]) -> Vec<u8> {
    [&[0, 0, kind, 0, 0, 0, 0, 0, 0, 0, 0, 0][..], &shorts(&[width, height]), &[depth, 0], rest]
        .concat()
}

/// A BMP whose header gives this size, depth and compression.
pub fn bmp(width: i32, height: i32, depth: u16, compression: u32) -> Vec<u8> {
    let words = |x: &[u32]| x.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let size = words(&[40, width as u32, height as u32]);
    [
        b"BM",
        &words(&[70, 0, 54])[..],
        &size,
        &shorts(&[1, depth]),
        &words(&[compression, 0, 0, 0, 0, 0]),
        &[0; 16],
    ]
    .concat()
}

/// A JPEG frame header of this size, with so many components, before other bytes.
pub fn jpeg(width: u16, height: u16, components: u8, rest: &[u8]) -> Vec<u8> {
    let length = 8 + 3 * u16::from(components);
    let mut bytes = vec![0xFF, 0xD8, 0xFF, 0xC0];
    bytes.extend(length.to_be_bytes());
    bytes.push(8);
    bytes.extend(height.to_be_bytes());
    bytes.extend(width.to_be_bytes());
    bytes.push(components);
    (0..components).for_each(|i| bytes.extend([i + 1, 0x11, 0]));
    [&bytes, rest].concat()
}

/// A WebP container of one chunk that says that it has so many bytes.
pub fn webp(kind: &[u8; 4], data: &[u8], length: u32) -> Vec<u8> {
    let size = (data.len() as u32 + 12).to_le_bytes();
    [b"RIFF", &size[..], b"WEBP", kind, &length.to_le_bytes(), data].concat()
}

/// An OpenEXR header of scan lines of one channel with this data window.
pub fn exr(window: [i32; 4], compression: u8, rest: &[u8]) -> Vec<u8> {
    exr_of(window, window, compression, &["R"], None, rest)
}

/// An OpenEXR header with a data and a display window, and tiles of a size or lines.
pub fn exr_of(
    data: [i32; 4],
    display: [i32; 4],
    compression: u8,
    channels: &[&str],
    tiles: Option<[u32; 2]>,
    rest: &[u8],
) -> Vec<u8> {
    let flags = if tiles.is_some() { 2 } else { 0 };
    let mut bytes = vec![0x76, 0x2F, 0x31, 0x01, 2, flags, 0, 0];
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        bytes.extend(name.bytes().chain([0]).chain(kind.bytes()).chain([0]));
        bytes.extend((value.len() as i32).to_le_bytes());
        bytes.extend(value);
    };
    let words = |numbers: &[i32]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    // Floats, with one sample for each pixel.
    let channel = |name: &&str| [name.as_bytes(), &[0], &words(&[2, 0, 1, 1])].concat();
    let list = channels.iter().flat_map(channel).chain([0]).collect::<Vec<u8>>();
    attribute("channels", "chlist", &list);
    attribute("compression", "compression", &[compression]);
    attribute("dataWindow", "box2i", &words(&data));
    attribute("displayWindow", "box2i", &words(&display));
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1f32.to_le_bytes());
    if let Some([width, height]) = tiles {
        let size = [&width.to_le_bytes()[..], &height.to_le_bytes(), &[0]].concat();
        attribute("tiles", "tiledesc", &size);
    }
    bytes.push(0);
    [&bytes, rest].concat()
}
