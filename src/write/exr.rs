//! The OpenEXR writer: linear floats, unclamped, with metadata as an attribute.

use std::io;
use std::path::Path;

use exr::meta::attribute::AttributeValue;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, LineOrder, Text,
    Vec2, WritableImage, f16,
};

use crate::error::Result;
use crate::film::{Film, View};
use crate::write::{Settings, write_atomically};

/// The name of the attribute with the metadata, one entry per line.
const METADATA: &str = "envers";

/// Writes a tiled EXR, losslessly compressed, with the view's channels, and A if the film has alpha, by
/// which OpenEXR, too, wants colours premultiplied. Values of views other than
/// beauty always have 32 bits, whatever `settings.half` says, since depths and ids do not fit in 16.
/// Radiance beyond 65504, which does not fit either, is clamped to it.
pub fn write(film: &Film, path: &Path, settings: &Settings) -> Result<()> {
    // The channels, in 16 or 32 bits.
    let half = settings.half && film.view == View::Beauty;
    let channel = |name: &str, values: Vec<f32>| {
        let samples = if half {
            // Clamped, since what is beyond the greatest 16-bit float would become infinite.
            let limit = f32::from(f16::MAX);
            let to_half = |x: f32| f16::from_f32(x.clamp(-limit, limit));
            FlatSamples::F16(values.into_iter().map(to_half).collect())
        } else {
            FlatSamples::F32(values)
        };
        AnyChannel::new(name, samples)
    };
    let of_view = film.view.channels().iter().enumerate();
    let of_view =
        of_view.map(|(i, name)| channel(name, film.pixels.iter().map(|p| p[i]).collect()));
    let channels = of_view.chain(film.alpha.iter().map(|alpha| channel("A", alpha.clone())));
    // The metadata in a single attribute: the crate writes several in a random order, and so never the
    // same bytes.
    let mut attributes =
        LayerAttributes { software_name: Some(Text::from("envers")), ..Default::default() };
    if !settings.metadata.is_empty() {
        let lines: Vec<String> =
            settings.metadata.iter().map(|(name, value)| format!("{name}: {value}")).collect();
        let text = AttributeValue::Text(Text::from(lines.join("\n").as_str()));
        attributes.other.insert(Text::from(METADATA), text);
    }
    // The tiles, in a fixed order whatever the order in which they were compressed.
    let encoding = Encoding { line_order: LineOrder::Increasing, ..Encoding::FAST_LOSSLESS };
    let layer = Layer::new(
        Vec2(film.size[0] as usize, film.size[1] as usize),
        attributes,
        encoding,
        AnyChannels::sort(channels.collect()),
    );
    let image = Image::from_layer(layer);
    write_atomically(path, |out| image.write().to_buffered(out).map_err(io::Error::other))
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{ReadChannels, ReadLayers, read};

    fn written(film: &Film, settings: &Settings) -> Image<Layer<AnyChannels<FlatSamples>>> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        write(film, &path, settings).unwrap();
        read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(path)
            .unwrap()
    }

    #[test]
    fn values_come_back_unclamped_and_exact() {
        let pixels = vec![[1e6, -0.25, 0.1], [0.0, 65536.5, 3e-8]];
        let film = Film { size: [2, 1], view: View::Beauty, pixels, alpha: None };
        let image = written(&film, &Settings::default());
        let red = &image.layer_data.channel_data.list.iter().find(|c| c.name.eq("R")).unwrap();
        assert_eq!(red.sample_data.values_as_f32().collect::<Vec<_>>(), [1e6, 0.0]);
    }

    #[test]
    fn the_same_film_is_the_same_bytes() {
        let pixels = (0..640 * 480).map(|i| [i as f32, (i as f32).sin(), 0.5]).collect();
        let film = Film { size: [640, 480], view: View::Beauty, pixels, alpha: None };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let bytes = || {
            write(&film, &path, &Settings::default()).unwrap();
            std::fs::read(&path).unwrap()
        };
        let first = bytes();
        assert!((0..5).all(|_| bytes() == first));
    }

    #[test]
    fn half_stores_sixteen_bits() {
        let film = Film { size: [1, 1], view: View::Beauty, pixels: vec![[1.0; 3]], alpha: None };
        let image = written(&film, &Settings { half: true, ..Settings::default() });
        let first = &image.layer_data.channel_data.list[0].sample_data;
        assert!(matches!(first, FlatSamples::F16(_)));
    }

    #[test]
    fn half_stores_what_is_beyond_it_as_its_greatest_number() {
        let film = Film { size: [1, 1], view: View::Beauty, pixels: vec![[1e6; 3]], alpha: None };
        let image = written(&film, &Settings { half: true, ..Settings::default() });
        let first = &image.layer_data.channel_data.list[0].sample_data;
        assert_eq!(first.values_as_f32().collect::<Vec<_>>(), [65504.0]);
    }

    #[test]
    fn depth_has_the_one_channel_z() {
        let film =
            Film { size: [1, 1], view: View::Depth, pixels: vec![[f32::INFINITY; 3]], alpha: None };
        let list = written(&film, &Settings::default()).layer_data.channel_data.list;
        let names: Vec<String> = list.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(names, ["Z"]);
    }

    #[test]
    fn alpha_is_a_channel_beside_the_premultiplied_colours() {
        let (pixels, alpha) = (vec![[0.25, 0.5, 0.125]], Some(vec![0.5]));
        let film = Film { size: [1, 1], view: View::Beauty, pixels, alpha };
        let list = written(&film, &Settings::default()).layer_data.channel_data.list;
        let value = |c: &AnyChannel<FlatSamples>| c.sample_data.value_by_flat_index(0).to_f32();
        let channels: Vec<_> = list.iter().map(|c| (c.name.to_string(), value(c))).collect();
        let expected = [("A", 0.5), ("B", 0.125), ("G", 0.5), ("R", 0.25)];
        assert_eq!(channels, expected.map(|(name, value)| (name.to_owned(), value)));
    }

    #[test]
    fn metadata_stands_in_the_file() {
        let film = Film { size: [1, 1], view: View::Beauty, pixels: vec![[0.0; 3]], alpha: None };
        let entry = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        let metadata = vec![entry("spp", "16"), entry("view", "beauty")];
        let image = written(&film, &Settings { metadata, ..Settings::default() });
        let value = image.layer_data.attributes.other.get(&Text::from(METADATA));
        let expected = AttributeValue::Text(Text::from("spp: 16\nview: beauty"));
        assert_eq!(value, Some(&expected));
    }
}
