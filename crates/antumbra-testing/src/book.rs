//! Parser of the documentation for tools and tests: pages, code blocks, commands.

use std::path::{Path, PathBuf};

/// A page of Markdown.
#[derive(Clone, Debug)]
pub struct Page {
    /// Path relative to the repository's root, with `/`.
    pub path: String,
    /// Markdown text.
    pub text: String,
}

/// A fenced block of code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block<'a> {
    /// Language after the fence: `sh`, `rust`.
    pub language: &'a str,
    /// Lines with their numbers, from 1.
    pub lines: Vec<(usize, &'a str)>,
}

/// A command in a page's `sh` block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Command {
    /// Page and line, for messages.
    pub place: String,
    /// Words, split as by a shell.
    pub words: Vec<String>,
}

/// The repository's root.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Returns the pages of the book, the files of `docs`, sorted by name.
///
/// # Panics
/// Panics if they cannot be read.
pub fn book_pages() -> Vec<Page> {
    let mut names: Vec<String> = std::fs::read_dir(root().join("docs"))
        .expect("the folder docs")
        .map(|entry| entry.expect("an entry of docs").file_name().to_string_lossy().into_owned())
        .filter(|name| name.ends_with(".md"))
        .collect();
    names.sort();
    names.iter().map(|name| page(&format!("docs/{name}"))).collect()
}

/// Returns a page by its path from the root.
///
/// # Panics
/// Panics if it cannot be read.
pub fn page(path: &str) -> Page {
    let text = std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"));
    Page { path: path.into(), text }
}

/// Returns the fenced blocks of a page.
pub fn blocks(text: &str) -> Vec<Block<'_>> {
    let (mut blocks, mut open) = (Vec::new(), None::<Block<'_>>);
    for (index, line) in text.lines().enumerate() {
        match (line.trim_start().strip_prefix("```"), &mut open) {
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some(language), None) => open = Some(Block { language: language.trim(), lines: Vec::new() }),
            (None, Some(block)) => block.lines.push((index + 1, line)),
            (None, None) => {}
        }
    }
    blocks
}

/// Returns the commands in a page's `sh` blocks, in order, without comments. A `\` at the end of a line continues it.
pub fn commands(page: &Page) -> Vec<Command> {
    let mut commands = Vec::new();
    for block in blocks(&page.text).iter().filter(|block| block.language == "sh") {
        let mut begun: Option<(usize, String)> = None;
        for (number, line) in &block.lines {
            let (first, mut text) = begun.take().unwrap_or((*number, String::new()));
            text.push_str(line);
            if let Some(begin) = text.strip_suffix('\\') {
                begun = Some((first, begin.to_owned()));
                continue;
            }
            let words = words(&text);
            if !words.is_empty() {
                commands.push(Command { place: format!("{}:{first}", page.path), words });
            }
        }
    }
    commands
}

/// Returns the text of a page without its blocks.
pub fn prose(text: &str) -> String {
    let mut is_code = false;
    let lines = text.lines().filter(|line| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Returns the code spans within sentences, each joined to one line.
pub fn spans(text: &str) -> Vec<String> {
    let prose = prose(text);
    // A span may continue on the next line, but not in the next paragraph.
    let spans = prose.split("\n\n").flat_map(|paragraph| paragraph.split('`').skip(1).step_by(2));
    spans.map(|span| span.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
}

/// Splits a line into words, up to a comment. Text in double or single quotes is one word.
pub fn words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for character in line.chars() {
        match (character, quote) {
            (_, Some(open)) if character == open => quote = None,
            (_, Some(_)) => word.get_or_insert_default().push(character),
            ('"' | '\'', None) => {
                quote = Some(character);
                word.get_or_insert_default();
            }
            ('#', None) if word.is_none() => break,
            (character, None) if character.is_whitespace() => words.extend(word.take()),
            (character, None) => word.get_or_insert_default().push(character),
        }
    }
    words.extend(word);
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_read_off_a_page() {
        let text =
            "a\n```sh\n# why\nx --y 'a b'   # what\nx \\\n  -z \"$i/4\"\n```\n```\nno\n```\n```rust\nlet x;\n```\n";
        let page = Page { path: "p.md".into(), text: text.into() };
        let found = commands(&page);
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].place.as_str(), found[0].words.join("|")), ("p.md:4", "x|--y|a b".into()));
        assert_eq!((found[1].place.as_str(), found[1].words.join("|")), ("p.md:5", "x|-z|$i/4".into()));
        assert_eq!(spans("a `b\nc` d\n```sh\n`e`\n```\nf\n\n`g`"), ["b c", "g"]);
        assert_eq!(blocks(text).iter().map(|block| block.language).collect::<Vec<_>>(), ["sh", "", "rust"]);
    }

    #[test]
    fn the_book_has_pages_with_commands() {
        let pages = book_pages();
        assert!(pages.len() >= 10, "{}", pages.len());
        assert!(pages.iter().map(|page| commands(page).len()).sum::<usize>() >= 20);
    }
}
