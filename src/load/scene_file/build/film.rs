//! The settings of the film.

use crate::error::Result;
use crate::load::scene_file::schema::spanned::Spanned;
use crate::load::scene_file::schema::tables::FilmTable;
use crate::load::scene_file::schema::values::SampleRange;
use crate::load::scene_file::source::Source;
use crate::scene::check;
use crate::scene::{AdaptiveSampling, FilmSettings};

/// Returns the settings that a table describes.
///
/// # Errors
/// When its numbers do not fit each other.
pub fn film_settings(source: &Source<'_>, table: &FilmTable) -> Result<FilmSettings> {
    let default = FilmSettings::default();
    if let Some(Spanned { span, value }) = &table.size {
        check::check_size(value.0).map_err(|e| source.locate(span, e))?;
    }
    let transfer = table.transfer.unwrap_or(default.transfer);
    let (spp, adaptive) = samples_per_pixel(source, table)?;
    Ok(FilmSettings {
        size: table.size.as_ref().map_or(default.size, |size| size.value.0),
        integrator: table.integrator.unwrap_or(default.integrator),
        seed: table.seed.unwrap_or(default.seed),
        spp,
        adaptive,
        transfer,
        exposure: table.exposure.map_or(default.exposure, |ev| ev.0),
        tone: table.tone.unwrap_or(default.tone),
        background: table.background.map_or(default.background, |c| c.to_linear(transfer)),
        transparent: table.transparent.unwrap_or(default.transparent),
        sample_position: table.sample_position.unwrap_or(default.sample_position),
        max_depth: table.max_depth.map_or(default.max_depth, |depth| depth.0),
        ambient_occlusion: table.ambient_occlusion.map_or(0, |rays| rays.0),
        cutoff: table.cutoff.map_or(default.cutoff, |share| share.0),
        soft_terminator: table.soft_terminator.unwrap_or(default.soft_terminator),
    })
}

/// Returns the samples of every pixel, and the settings of adaptive sampling, if it is asked for.
fn samples_per_pixel(
    source: &Source<'_>,
    table: &FilmTable,
) -> Result<(u32, Option<AdaptiveSampling>)> {
    let threshold = table.threshold.as_ref();
    let Some(Spanned { span, value: SampleRange([min, max]) }) = &table.adaptive else {
        return match threshold {
            None => Ok((table.spp.map_or(FilmSettings::default().spp, |spp| spp.0), None)),
            Some(Spanned { span, .. }) => Err(source
                .error(span, "`threshold` is about adaptive samples, and there are none")
                .help("add `adaptive = [1, 25]`, or leave `threshold` out")),
        };
    };
    if table.spp.is_some() {
        return Err(source
            .error(span, "`spp` and `adaptive` both say how many samples a pixel has")
            .help("leave one of them out"));
    }
    check::check_samples(*min, *max).map_err(|e| source.locate(span, e))?;
    let threshold = threshold.map_or(AdaptiveSampling::THRESHOLD, |share| share.value.0 as f32);
    Ok((*min, Some(AdaptiveSampling { max: *max, threshold })))
}
