//! The JSON Schema of the scene file, for editors that complete and check TOML.

use schemars::Schema;
use schemars::generate::SchemaSettings;
use schemars::transform::transform_subschemas;

use super::tables::SceneTable;

/// Returns the JSON Schema (draft 7) of the scene file.
pub fn schema() -> Schema {
    SchemaSettings::draft07()
        // Editors show a key's comment and default only where they stand beside its type.
        .with(|settings| settings.inline_subschemas = true)
        .with_transform(remove_null)
        .into_generator()
        .into_root_schema_for::<SceneTable>()
}

/// Removes null from a schema: keys that may be left out are an `Option` in the types, but TOML has no
/// null.
fn remove_null(schema: &mut Schema) {
    if let Some(types) = schema.get_mut("type").and_then(|t| t.as_array_mut()) {
        types.retain(|t| t != "null");
        if let [only] = &types[..] {
            let only = only.clone();
            schema.insert("type".to_owned(), only);
        }
    }
    if let Some(values) = schema.get_mut("enum").and_then(|v| v.as_array_mut()) {
        values.retain(|v| !v.is_null());
    }
    if let Some(choices) = schema.get_mut("anyOf").and_then(|c| c.as_array_mut()) {
        choices.retain(|choice| choice.get("type").is_none_or(|t| t != "null"));
        if let [only] = &choices[..] {
            let only = only.as_object().cloned().unwrap_or_default();
            schema.remove("anyOf");
            for (key, value) in only {
                if schema.get(&key).is_none() {
                    schema.insert(key, value);
                }
            }
        }
    }
    transform_subschemas(&mut remove_null, schema);
}
