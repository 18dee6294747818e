//! The suggestions for misspelt names: "did you mean …?"

/// The names of keys and values, each with the words that people write for it. Of several names for a
/// word the first counts that is possible there.
const SYNONYMS: &[(&str, &str)] = &[
    ("absorption", "attenuation extinction"),
    ("aces", "filmic"),
    ("agx", "blender"),
    ("khronos-pbr-neutral", "neutral pbrneutral khronos"),
    ("alpha_mode", "blend"),
    ("casts_shadow", "shadow shadows castshadow"),
    ("color", "color colour"),
    ("cutoff", "cutoff"),
    ("alpha_cutoff", "cutoff"),
    ("diffuse", "albedo basecolor color colour kd"),
    ("background", "bg color colour"),
    ("colors", "color colour colours"),
    ("emission", "ambient emissive ke"),
    ("exposure", "ev"),
    ("file", "path source src url"),
    ("film", "image render"),
    ("diffuse_map", "image texture"),
    ("filter", "mipmaps"),
    ("focal_px", "focal focallength"),
    ("fps", "framerate rate"),
    ("frames", "duration"),
    ("intensity", "brightness power"),
    ("interpolation", "easing"),
    ("inverse_square", "quadratic"),
    ("ior", "refraction refractionindex refractiveindex indexofrefraction eta n"),
    ("kind", "mode type"),
    ("linear", "bilinear"),
    ("look_at", "at lookingat target to"),
    ("max_depth", "depth bounces maxbounces"),
    ("mipmap", "mipmaps trilinear"),
    ("model", "mesh object"),
    ("name", "id"),
    ("none", "linear"),
    ("normal", "normal"),
    ("normal_map", "bump bumpmap normal"),
    ("object", "target"),
    ("outer_angle", "angle"),
    ("fov_y", "angle fov"),
    ("period", "duration"),
    ("plane", "floor ground"),
    ("position", "eye from location origin point pos"),
    ("camera", "eye view"),
    ("center", "centre location origin point pos position"),
    ("direction", "dir forward view"),
    ("directional", "dir distance distant sun"),
    ("point", "omni origin pos position"),
    ("radius", "r size"),
    ("reflect", "metal metallic mirror reflection reflective reflectivity"),
    ("rotate", "rotation"),
    ("scale", "size"),
    ("shadow", "shadow shadows castsshadow castshadow"),
    ("shininess", "alpha exponent ns roughness"),
    ("size", "dimensions height resolution width"),
    ("ortho_height", "height orthographic"),
    ("specular", "ks"),
    ("spp", "antialiasing samples"),
    ("times", "keytimes"),
    ("tone", "curve tonemap tonemapping"),
    ("track", "keyframe keyframes"),
    ("transfer", "gamma"),
    ("translate", "location pos position translation"),
    ("transmit", "transparency transparent transmission transmittance glass opacity"),
];

/// Returns the one of `candidates` that `found` was probably meant to be.
pub fn closest<'a>(found: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let folded = fold(found);
    // A word that means one of them.
    let means = |words: &str| words.split(' ').any(|word| word == folded);
    let mut meant = SYNONYMS.iter().filter(|(_, words)| means(words));
    if let Some(name) = meant.find_map(|(name, _)| candidates.iter().find(|c| *c == name)) {
        return Some(name);
    }
    // The nearest by typing errors, if these are few.
    let distance = |candidate: &str| strsim::damerau_levenshtein(&folded, &fold(candidate));
    let (nearest, distance) =
        candidates.iter().map(|c| (*c, distance(c))).min_by_key(|(_, distance)| *distance)?;
    (distance <= (folded.chars().count() / 3).max(1) && distance < fold(nearest).chars().count())
        .then_some(nearest)
}

/// Returns "did you mean `x`?", or the names to choose from.
pub fn advice(found: &str, candidates: &[&str], kind: &str) -> String {
    match closest(found, candidates) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => format!("{kind} {}", list(candidates)),
    }
}

/// Returns the names to choose from, and before them "did you mean `x`?", where that is likely: for
/// names that somebody gave.
pub fn choice(found: &str, candidates: &[&str], kinds: &str) -> String {
    let all = list(candidates);
    match closest(found, candidates) {
        Some(meant) => format!("did you mean `{meant}`? The {kinds} are {all}"),
        None => format!("the {kinds} are {all}"),
    }
}

/// Returns "`a`, `b` and `c`"; of many names the first.
pub fn list(names: &[&str]) -> String {
    const MAX_NAMES: usize = 20;
    let quoted: Vec<String> = names.iter().take(MAX_NAMES).map(|n| format!("`{n}`")).collect();
    match &quoted[..] {
        [] => String::new(),
        [only] => only.clone(),
        all if names.len() > MAX_NAMES => format!("{} …", all.join(", ")),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// Folds a name: without case and separators, by which most misspellings differ.
fn fold(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, '_' | '-' | ' ')).flat_map(char::to_lowercase).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn case_and_separators_do_not_count() {
        for found in ["lookat", "lookAt", "Look-At", "LOOK_AT"] {
            assert_eq!(closest(found, &["position", "look_at"]), Some("look_at"), "{found}");
        }
    }

    #[test]
    fn a_synonym_means_what_can_stand_there() {
        assert_eq!(closest("colour", &["kind", "color"]), Some("color"));
        assert_eq!(closest("colour", &["name", "diffuse"]), Some("diffuse"));
    }

    #[test]
    fn a_typing_error_finds_its_key() {
        assert_eq!(closest("raduis", &["center", "radius"]), Some("radius"));
    }

    #[test]
    fn nothing_alike_is_no_suggestion() {
        assert_eq!(closest("wavelength", &["center", "radius", "up"]), None);
        assert_eq!(closest("x", &["up"]), None);
    }

    #[test]
    fn synonyms_are_folded() {
        for word in SYNONYMS.iter().flat_map(|(_, words)| words.split(' ')) {
            assert_eq!(word, fold(word));
        }
    }
}
