//! Words and punctuation of Rust and WESL, without comments and string literals, each with its line.

/// Token: a word, `::`, or one other character.
#[derive(Debug, Clone, PartialEq)]
pub struct Token {
    pub text: String,
    pub line: usize,
}

impl Token {
    pub fn is_word(&self) -> bool {
        self.text.starts_with(|first: char| first.is_alphabetic() || first == '_')
    }
}

/// Returns the tokens of a file.
pub fn tokens(source: &str) -> Vec<Token> {
    let chars: Vec<char> = source.chars().collect();
    let (mut found, mut at, mut line) = (Vec::new(), 0, 1);
    while let Some(&first) = chars.get(at) {
        let end = end_of(&chars, at);
        let text: String = chars[at..end].iter().collect();
        let is_comment = text.starts_with("//") || text.starts_with("/*");
        let is_text = end - at > 1 && (text.ends_with(['"', '#', '\'']) || first == '"');
        if !first.is_whitespace() && !is_comment && !is_text {
            found.push(Token { text: text.clone(), line });
        }
        line += text.matches('\n').count();
        at = end;
    }
    found
}

/// Returns the end of the token, comment or literal that starts at `at`.
fn end_of(chars: &[char], at: usize) -> usize {
    let next = |offset: usize| chars.get(at + offset).copied().unwrap_or('\0');
    match (chars[at], next(1)) {
        ('/', '/') => chars[at..].iter().position(|&c| c == '\n').map_or(chars.len(), |length| at + length),
        ('/', '*') => end_of_block(chars, at),
        ('"', _) => end_of_text(chars, at + 1, '"'),
        ('r', '"' | '#') | ('b', '"' | 'r') if let Some(end) = end_of_raw(chars, at) => end,
        ('\'', '\\') => end_of_text(chars, at + 1, '\''),
        ('\'', _) if next(2) == '\'' => at + 3,
        (':', ':') => at + 2,
        (first, _) if first.is_alphanumeric() || first == '_' => {
            let length = chars[at..].iter().position(|c| !c.is_alphanumeric() && *c != '_');
            length.map_or(chars.len(), |length| at + length)
        }
        _ => at + 1,
    }
}

fn end_of_block(chars: &[char], start: usize) -> usize {
    let (mut depth, mut at) = (1, start + 2);
    while depth > 0 && at < chars.len() {
        match (chars[at], chars.get(at + 1)) {
            ('/', Some('*')) => (depth, at) = (depth + 1, at + 2),
            ('*', Some('/')) => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
    }
    at
}

/// Returns the position after the closing quote of a literal whose content starts at `at`.
fn end_of_text(chars: &[char], mut at: usize, quote: char) -> usize {
    while at < chars.len() && chars[at] != quote {
        at += if chars[at] == '\\' { 2 } else { 1 };
    }
    (at + 1).min(chars.len())
}

/// Returns the position after a literal with a prefix: `r"…"`, `r#"…"#`, `b"…"`; `None` for words.
fn end_of_raw(chars: &[char], start: usize) -> Option<usize> {
    let mut at = start;
    while matches!(chars.get(at), Some('r' | 'b')) {
        at += 1;
    }
    let is_raw = chars[start..at].contains(&'r');
    let hashes = chars[at..].iter().take_while(|&&c| c == '#').count();
    at += hashes;
    if chars.get(at) != Some(&'"') {
        return None;
    }
    if !is_raw {
        return Some(end_of_text(chars, at + 1, '"'));
    }
    let end: Vec<char> = std::iter::once('"').chain(std::iter::repeat_n('#', hashes)).collect();
    let length = chars[at + 1..].windows(end.len()).position(|window| window == end)?;
    Some(at + 1 + length + end.len())
}
