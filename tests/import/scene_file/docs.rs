//! The schema, the documentation and the parser say the same.

use envers::Loaded;
use envers::internals::schema;
use std::collections::BTreeMap;

use serde_json::Value;

use super::{docs_folder, scene};

/// The properties of a key in the schema.
#[derive(Debug)]
struct Key {
    required: bool,
    default: Option<Value>,
}

/// The heading of the keys that are in no table.
pub const TOP: &str = "At the top of the file";

/// Returns the keys by table, nested ones with a dot.
fn keys() -> BTreeMap<String, BTreeMap<String, Key>> {
    let schema = schema().to_value();
    let tables = schema["properties"].as_object().unwrap();
    let mut all = BTreeMap::new();
    let mut open: Vec<(String, &Value)> = tables.iter().map(|(n, t)| (n.clone(), t)).collect();
    while let Some((name, table)) = open.pop() {
        let table = [table.get("items"), table.pointer("/anyOf/0"), Some(table)];
        let table = table.into_iter().flatten().next().unwrap();
        let mut keys = BTreeMap::new();
        if table.get("properties").is_none() {
            let key = Key { required: false, default: table.get("default").cloned() };
            all.entry(TOP.to_owned()).or_insert_with(BTreeMap::new).insert(name, key);
            continue;
        }
        collect(table, "", &mut keys);
        // A list of tables is a table of its own, such as `animation.orbit`.
        for (key, value) in table["properties"].as_object().unwrap() {
            if value.pointer("/items/properties").is_some() {
                keys.remove(key);
                open.push((format!("{name}.{key}"), value));
            }
        }
        all.insert(name, keys);
    }
    all
}

fn collect(table: &Value, prefix: &str, keys: &mut BTreeMap<String, Key>) {
    let required = table["required"].as_array().cloned().unwrap_or_default();
    for (name, value) in table["properties"].as_object().unwrap() {
        let required = required.iter().any(|r| r == name);
        let key = Key { required, default: value.get("default").cloned() };
        keys.insert(format!("{prefix}{name}"), key);
        if value.get("properties").is_some() {
            collect(value, &format!("{prefix}{name}."), keys);
        }
    }
}

/// The rows of `docs/scene.md`: table, key, default.
fn table_rows() -> Vec<(String, String, String)> {
    let text = std::fs::read_to_string(docs_folder().join("scene.md")).unwrap();
    let mut table = String::new();
    let mut rows = Vec::new();
    for line in text.lines() {
        if let Some((_, heading)) = line.split_once("## ").filter(|_| line.starts_with("##")) {
            table = heading.trim_matches(|c| "`[]".contains(c)).to_owned();
        } else if let Some(row) = line.strip_prefix("| `")
            && !table.is_empty()
        {
            let mut cells = row.split(" | ");
            let key = cells.next().unwrap().trim_end_matches('`').to_owned();
            let default = cells.nth(1).unwrap_or_default().to_owned();
            rows.push((table.clone(), key, default));
        }
    }
    rows
}

#[test]
fn the_committed_schema_is_that_of_the_types() {
    let path = docs_folder().join("scene.schema.json");
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    // Compared as values: which order the keys are printed in depends on features of serde_json.
    let same =
        serde_json::from_str(&committed).is_ok_and(|value: Value| value == *schema().as_value());
    if !same && std::env::var_os("ENVERS_BLESS").is_some() {
        let text = serde_json::to_string_pretty(&schema()).unwrap() + "\n";
        std::fs::write(&path, text).unwrap();
        panic!("{} has been rewritten: look at the change and run again", path.display());
    }
    assert!(
        same,
        "{} is not what the types say; `ENVERS_BLESS=1 cargo test --test import scene_file` rewrites it",
        path.display()
    );
}

#[test]
fn every_key_is_documented_with_its_default() {
    let rows = table_rows();
    for (table, keys) in keys() {
        for (key, meaning) in keys {
            let row = rows.iter().find(|(t, k, _)| *t == table && *k == key);
            let (.., default) =
                row.unwrap_or_else(|| panic!("docs/scene.md: no row for `{key}` of `{table}`"));
            let expected = match &meaning.default {
                _ if meaning.required => "required".to_owned(),
                Some(default) => format!("`{}`", default.to_string().replace(',', ", ")),
                // In words, such as "none".
                None => default.clone(),
            };
            assert_eq!(*default, expected, "docs/scene.md: the default of `{table}.{key}`");
            assert!(!default.is_empty(), "docs/scene.md: `{table}.{key}` has no default");
        }
    }
}

#[test]
fn nothing_is_documented_that_is_no_key() {
    let keys = keys();
    for (table, key, _) in table_rows() {
        assert!(
            keys.get(&table).is_some_and(|keys| keys.contains_key(&key)),
            "docs/scene.md: `{table}` has no key `{key}`"
        );
    }
}

#[test]
fn every_key_and_table_has_a_comment_in_the_schema() {
    fn walk(table: &Value, path: &str) {
        assert!(table.get("description").is_some(), "{path} has no description");
        for (key, value) in table.get("properties").and_then(Value::as_object).into_iter().flatten()
        {
            walk(value, &format!("{path}.{key}"));
        }
        if let Some(items) = table.get("items").filter(|items| items.get("properties").is_some()) {
            walk(items, &format!("{path}[]"));
        }
    }
    walk(&schema().to_value(), "scene");
}

/// A table with what it needs, alone and with all its defaults written out.
pub fn written_out(header: &str, table: &str, needed: &str) -> [String; 2] {
    let mut text = format!("{header}\n{needed}\n");
    let bare = text.clone();
    for (key, meaning) in &keys()[table] {
        if let Some(default) = &meaning.default {
            text += &format!("{key} = {default}\n");
        }
    }
    [bare, text]
}

/// Both texts mean the same scene.
fn assert_same([bare, full]: [String; 2], frame: &str) {
    let [bare, full] = [bare, full].map(|text| format!("{:?}", scene(&(text + frame))));
    assert_eq!(bare, full);
}

#[test]
fn defaults_in_the_schema_are_what_missing_keys_mean() {
    let camera = "[camera]\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\n";
    assert_same(written_out("[film]", "film", ""), camera);
    let needed = "position = [0, 0, 5]\nlook_at = [0, 0, 0]";
    assert_same(written_out("[camera]", "camera", needed), "");
    assert_same(written_out("[[material]]", "material", "name = \"m\""), camera);
    let needed = "center = [0, 0, 0]\nradius = 1";
    assert_same(written_out("[[sphere]]", "sphere", needed), camera);
    let needed = "point = [0, 0, 0]\nnormal = [0, 1, 0]\nchecker.colors = [0, 1]";
    assert_same(written_out("[[plane]]", "plane", needed), camera);
    let ball = format!("{camera}[[sphere]]\nname = \"b\"\ncenter = [1, 0, 0]\nradius = 1\n");
    assert_same(written_out("[animation]", "animation", "frames = 3"), &ball);
    let ball = format!("[animation]\nframes = 3\n{ball}");
    let needed = "object = \"b\"\naround = [0, 0, 0]\nperiod = 1";
    assert_same(written_out("[[animation.orbit]]", "animation.orbit", needed), &ball);
    let needed = "object = \"b\"\ntimes = [0, 1]\nradius = [1, 2]";
    assert_same(written_out("[[animation.track]]", "animation.track", needed), &ball);
    let needed = "kind = \"spot\"\nposition = [0, 0, 0]\ndirection = [0, 1, 0]";
    assert_same(written_out("[[light]]", "light", needed), camera);
}

#[test]
fn the_examples_in_the_documents_load_without_a_warning() {
    let text = std::fs::read_to_string(docs_folder().join("scene.md")).unwrap();
    let examples: Vec<&str> = text.split("```toml\n").skip(1).collect();
    assert_eq!(examples.len(), 6);
    for example in examples {
        let mut example = example.split("```").next().unwrap().to_owned();
        // Parts of a file: what they are about comes before them.
        if example.starts_with("[[material]]") || example.starts_with("[environment]") {
            example = format!("{}{example}", super::CAMERA);
        } else if example.starts_with("[[animation.track]]") {
            let lamp = "[[light]]\nname = \"lamp\"\nkind = \"ambient\"\n";
            let frames = "[animation]\nframes = 60\n";
            example = format!("{}{frames}{lamp}{example}", super::CAMERA);
        }
        let file = super::File::new(&example);
        std::fs::write(file.beside("room.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        let Loaded { report, .. } = file.load().unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(report.warnings, Vec::<String>::new());
    }
}
