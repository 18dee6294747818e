//! The suggestions for misspelt names: "did you mean …?"

/// Words that people write, and the names that they may mean; the first name that can stand there is
/// meant.
const SYNONYMS: &[(&str, &[&str])] = &[
    ("albedo", &["diffuse"]),
    ("alpha", &["shininess"]),
    ("ambient", &["emission"]),
    ("angle", &["outer_angle", "fov_y"]),
    ("antialiasing", &["spp"]),
    ("at", &["look_at"]),
    ("basecolor", &["diffuse"]),
    ("bg", &["background"]),
    ("brightness", &["intensity"]),
    ("color", &["color", "diffuse", "background", "colors"]),
    ("colour", &["color", "diffuse", "background", "colors"]),
    ("colours", &["colors"]),
    ("centre", &["center"]),
    ("curve", &["tone"]),
    ("dimensions", &["size"]),
    ("dir", &["direction", "directional"]),
    ("distance", &["directional"]),
    ("distant", &["directional"]),
    ("emissive", &["emission"]),
    ("eye", &["position", "camera"]),
    ("filmic", &["aces"]),
    ("ev", &["exposure"]),
    ("exponent", &["shininess"]),
    ("floor", &["plane"]),
    ("fov", &["fov_y"]),
    ("focal", &["focal_px"]),
    ("focallength", &["focal_px"]),
    ("forward", &["direction"]),
    ("from", &["position"]),
    ("gamma", &["transfer"]),
    ("ground", &["plane"]),
    ("height", &["size", "ortho_height"]),
    ("image", &["film", "diffuse_map"]),
    ("kd", &["diffuse"]),
    ("ke", &["emission"]),
    ("transparency", &["transmit"]),
    ("transparent", &["transmit"]),
    ("transmission", &["transmit"]),
    ("transmittance", &["transmit"]),
    ("glass", &["transmit"]),
    ("opacity", &["transmit"]),
    ("refraction", &["ior"]),
    ("refractionindex", &["ior"]),
    ("refractiveindex", &["ior"]),
    ("indexofrefraction", &["ior"]),
    ("eta", &["ior"]),
    ("n", &["ior"]),
    ("attenuation", &["absorption"]),
    ("extinction", &["absorption"]),
    ("metal", &["reflect"]),
    ("metallic", &["reflect"]),
    ("mirror", &["reflect"]),
    ("reflection", &["reflect"]),
    ("reflective", &["reflect"]),
    ("reflectivity", &["reflect"]),
    ("depth", &["max_depth"]),
    ("bounces", &["max_depth"]),
    ("maxbounces", &["max_depth"]),
    ("keyframe", &["track"]),
    ("keyframes", &["track"]),
    ("framerate", &["fps"]),
    ("rate", &["fps"]),
    ("duration", &["frames", "period"]),
    ("easing", &["interpolation"]),
    ("keytimes", &["times"]),
    ("id", &["name"]),
    ("ks", &["specular"]),
    ("linear", &["none"]),
    ("location", &["position", "center", "translate"]),
    ("lookingat", &["look_at"]),
    ("mesh", &["model"]),
    ("mode", &["kind"]),
    ("ns", &["shininess"]),
    ("object", &["model"]),
    ("omni", &["point"]),
    ("origin", &["position", "center", "point"]),
    ("orthographic", &["ortho_height"]),
    ("path", &["file"]),
    ("point", &["position", "center"]),
    ("pos", &["position", "center", "point", "translate"]),
    ("position", &["center", "point", "translate"]),
    ("power", &["intensity"]),
    ("quadratic", &["inverse_square"]),
    ("r", &["radius"]),
    ("render", &["film"]),
    ("resolution", &["size"]),
    ("rotation", &["rotate"]),
    ("roughness", &["shininess"]),
    ("samples", &["spp"]),
    ("shadow", &["casts_shadow", "shadow"]),
    ("shadows", &["casts_shadow", "shadow"]),
    ("castsshadow", &["shadow"]),
    ("castshadow", &["casts_shadow", "shadow"]),
    ("size", &["radius", "scale"]),
    ("source", &["file"]),
    ("src", &["file"]),
    ("sun", &["directional"]),
    ("target", &["look_at", "object"]),
    ("texture", &["diffuse_map"]),
    ("bump", &["normal_map"]),
    ("bumpmap", &["normal_map"]),
    ("normal", &["normal", "normal_map"]),
    ("blend", &["alpha_mode"]),
    ("cutoff", &["cutoff", "alpha_cutoff"]),
    ("mipmaps", &["filter", "mipmap"]),
    ("trilinear", &["mipmap"]),
    ("bilinear", &["linear"]),
    ("to", &["look_at"]),
    ("tonemap", &["tone"]),
    ("tonemapping", &["tone"]),
    ("translation", &["translate"]),
    ("type", &["kind"]),
    ("url", &["file"]),
    ("view", &["camera", "direction"]),
    ("width", &["size"]),
];

/// Returns the one of `candidates` that `found` was probably meant to be.
pub fn closest<'a>(found: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let folded = fold(found);
    // A word that means one of them.
    if let Some((_, names)) = SYNONYMS.iter().find(|(word, _)| *word == folded)
        && let Some(name) = names.iter().find_map(|name| candidates.iter().find(|c| *c == name))
    {
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

/// Returns the names to choose from, and before them "did you mean `x`?", where that is likely: for names
/// that somebody gave.
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
        for (word, _) in SYNONYMS {
            assert_eq!(*word, fold(word));
        }
    }
}
