//! The chapters, taken apart.

use std::fs;
use std::path::{Path, PathBuf};

pub const LANGUAGES: [&str; 2] = ["fr", "en"];

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

pub fn tutorial() -> PathBuf {
    root().join("docs/tutorial")
}

/// A block between two fences.
pub struct Block {
    /// What follows the opening fence.
    pub language: String,
    /// The comment on the line before it, without its marks.
    pub comment: String,
    pub text: String,
}

/// One file.
pub struct Chapter {
    pub path: PathBuf,
    /// The text without its blocks.
    pub prose: String,
    pub blocks: Vec<Block>,
}

impl Chapter {
    fn read(path: PathBuf) -> Self {
        let text = fs::read_to_string(&path).expect("a chapter can be read");
        let (mut prose, mut blocks, mut comment) = (String::new(), Vec::new(), String::new());
        let mut lines = text.lines();
        while let Some(line) = lines.next() {
            if let Some(language) = line.strip_prefix("```") {
                let inside: Vec<_> = lines.by_ref().take_while(|line| *line != "```").collect();
                let (language, text) = (language.to_owned(), inside.join("\n"));
                blocks.push(Block { language, comment: std::mem::take(&mut comment), text });
                continue;
            }
            comment = line
                .strip_prefix("<!-- ")
                .and_then(|line| line.strip_suffix(" -->"))
                .unwrap_or_default()
                .to_owned();
            prose += line;
            prose.push('\n');
        }
        Self { path, prose, blocks }
    }

    /// Returns its file's name.
    pub fn name(&self) -> String {
        self.path.file_name().expect("ok: it is a file").display().to_string()
    }

    /// Returns its language and file, to say where something is wrong.
    pub fn place(&self) -> String {
        self.path.strip_prefix(root()).expect("ok: it is within").display().to_string()
    }

    /// The lines of its `sh` blocks.
    pub fn commands(&self) -> Vec<String> {
        let blocks = self.blocks.iter().filter(|block| block.language == "sh");
        blocks.flat_map(|block| block.text.lines()).map(str::to_owned).collect()
    }

    /// Returns the targets of its links and pictures, as written.
    pub fn links(&self) -> Vec<&str> {
        links(&self.prose)
    }

    /// The pictures among the links: names of files in `images/`.
    pub fn pictures(&self) -> Vec<&str> {
        self.links().into_iter().filter_map(|link| link.strip_prefix("../images/")).collect()
    }
}

/// The targets of the links in a text of Markdown.
pub fn links(text: &str) -> Vec<&str> {
    let targets = text.split("](").skip(1);
    targets.map(|rest| rest.split(')').next().expect("ok: split gives one at least")).collect()
}

/// The chapters of a language, in order.
pub fn chapters(language: &str) -> Vec<Chapter> {
    let folder = tutorial().join(language);
    let entries = fs::read_dir(folder).expect("the language's folder is there");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("it can be read").path()).collect();
    paths.sort();
    paths.into_iter().map(Chapter::read).collect()
}

/// Returns the chapters of both languages.
pub fn all() -> Vec<Chapter> {
    LANGUAGES.iter().flat_map(|language| chapters(language)).collect()
}
