//! Removal of branches that a pipeline's constants exclude, before the driver compiles the shader.
//!
//! Drivers inline all functions of a shader before they drop branches that its constants exclude. `resolve` of the summed techniques has
//! 950 statements, and 14 000 once inlined, most of which its constants exclude. Software Mesa 25 takes 1.3 s for such a pipeline, and
//! 0.15 s where the branches are gone (`leaning-plank`, `overlap` and `lantern-wall` at 256 × 144, with the driver's disk cache warm). The
//! branches are cut from the text; the program stays the same.
//!
//! The text is WGSL as the linker writes it: valid, and without comments except its first line.

use std::borrow::Cow;
use std::collections::HashMap;

/// Returns a shader without the branches that its constants exclude. `constants` are values of overridable constants by their names in
/// the text; the others have their defaults.
pub(super) fn without_excluded<'t>(wgsl: &'t str, constants: &[(impl AsRef<str>, f64)]) -> Cow<'t, str> {
    let mut known = Known::of(wgsl);
    known.0.extend(constants.iter().filter_map(|(name, value)| Some((name_in(wgsl, name.as_ref())?, *value))));
    // Fractions are rounded to single precision in the shader, and so may compare differently there.
    known.0.retain(|_, value| value.fract() == 0.0);
    let mut text = String::with_capacity(wgsl.len());
    let is_cut = copy(wgsl, &known, &mut text);
    if is_cut { text.into() } else { wgsl.into() }
}

/// Values of a shader's constants: numbers, and 0 or 1 for booleans.
struct Known<'t>(HashMap<&'t str, f64>);

impl<'t> Known<'t> {
    /// Returns the constants that are declared as literals.
    fn of(wgsl: &'t str) -> Self {
        let declared = |line: &'t str| {
            let declaration = line.strip_prefix("override ").or_else(|| line.strip_prefix("const "))?;
            let (left, right) = declaration.split_once('=')?;
            let name = left.split(':').next()?.trim();
            Some((name, literal(right.trim().strip_suffix(';')?.trim())?))
        };
        Self(wgsl.lines().filter_map(declared).collect())
    }

    /// Returns the value of a name or a literal, if known.
    fn value(&self, term: &str) -> Option<f64> {
        self.0.get(term).copied().or_else(|| literal(term))
    }

    /// Whether a condition holds; `None` if only the running shader knows.
    fn holds(&self, condition: &str) -> Option<bool> {
        let condition = without_parentheses(condition.trim());
        let alternatives = split(condition, "||");
        if alternatives.len() > 1 {
            return self.first_of(&alternatives, true);
        }
        let terms = split(condition, "&&");
        if terms.len() > 1 {
            return self.first_of(&terms, false);
        }
        if let Some(negated) = condition.strip_prefix('!') {
            let is_whole = is_name(negated) || without_parentheses(negated) != negated;
            return if is_whole { self.holds(negated).map(|holds| !holds) } else { None };
        }
        for operator in ["==", "!=", "<=", ">=", "<", ">"] {
            let Some((left, right)) = condition.split_once(operator) else { continue };
            let (left, right) = (self.value(left.trim())?, self.value(right.trim())?);
            return Some(match operator {
                "==" => left == right,
                "!=" => left != right,
                "<=" => left <= right,
                ">=" => left >= right,
                "<" => left < right,
                _ => left > right,
            });
        }
        self.value(condition).map(|value| value != 0.0)
    }

    /// Returns the value of terms joined by `||` or `&&`. A single term with the value `decisive` decides: true for `||`, false for `&&`.
    /// A term that calls a function may have side effects, so it and the terms after it are kept.
    fn first_of(&self, terms: &[&str], decisive: bool) -> Option<bool> {
        let mut all = Some(!decisive);
        for term in terms {
            match self.holds(term) {
                Some(holds) if holds == decisive => return Some(decisive),
                Some(_) => {}
                None if term.contains('(') => return None,
                None => all = None,
            }
        }
        all
    }
}

/// Returns a constant's name as a slice of the text.
fn name_in<'t>(wgsl: &'t str, name: &str) -> Option<&'t str> {
    let start = wgsl.find(&format!("override {name}"))? + "override ".len();
    wgsl.get(start..start + name.len())
}

/// Returns the value of a literal.
fn literal(text: &str) -> Option<f64> {
    match text {
        "true" => Some(1.0),
        "false" => Some(0.0),
        _ if text.starts_with(|c: char| c.is_ascii_digit()) => text.trim_end_matches(['u', 'i', 'f']).parse().ok(),
        _ => None,
    }
}

fn is_of_name(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

fn is_name(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(is_of_name)
}

/// Returns the position at which the bracket that opens at `start` closes.
fn close_of(text: &str, start: usize) -> usize {
    let bytes = text.as_bytes();
    let (open, close) = if bytes[start] == b'{' { (b'{', b'}') } else { (b'(', b')') };
    let mut depth = 0;
    for (i, byte) in bytes.iter().enumerate().skip(start) {
        if *byte == open {
            depth += 1;
        } else if *byte == close {
            depth -= 1;
            if depth == 0 {
                return i;
            }
        }
    }
    panic!("a bracket that does not close")
}

/// Removes the parentheses around a whole term.
fn without_parentheses(text: &str) -> &str {
    if text.starts_with('(') && close_of(text, 0) == text.len() - 1 {
        return without_parentheses(text[1..text.len() - 1].trim());
    }
    text
}

/// Splits a condition at an operator of two characters, outside of brackets.
fn split<'t>(text: &'t str, operator: &str) -> Vec<&'t str> {
    let (mut terms, mut start, mut depth) = (Vec::new(), 0, 0);
    for (i, byte) in text.bytes().enumerate() {
        match byte {
            b'(' | b'[' => depth += 1,
            b')' | b']' => depth -= 1,
            _ if depth == 0 && i >= start && text[i..].starts_with(operator) => {
                terms.push(&text[start..i]);
                start = i + operator.len();
            }
            _ => {}
        }
    }
    terms.push(&text[start..]);
    terms
}

/// Branch: condition and block.
struct Arm<'t> {
    condition: &'t str,
    block: &'t str,
}

/// Branches of one `if` statement, with its `else` block.
struct Branches<'t> {
    arms: Vec<Arm<'t>>,
    otherwise: Option<&'t str>,
    /// Length of the statement in the text, bytes.
    length: usize,
}

impl<'t> Branches<'t> {
    /// Parses the statement at the start of a text that begins with `if`.
    fn of(text: &'t str) -> Self {
        let (mut arms, mut otherwise, mut at) = (Vec::new(), None, 0);
        loop {
            let condition = at + "if".len();
            let open = condition + text[condition..].find('{').expect("a block behind a condition");
            let close = close_of(text, open);
            arms.push(Arm { condition: &text[condition..open], block: &text[open + 1..close] });
            at = close + 1;
            let rest = text[at..].trim_start();
            let Some(behind) = rest
                .strip_prefix("else")
                .filter(|behind| !behind.starts_with(|c: char| c == '_' || c.is_alphanumeric()))
            else {
                break;
            };
            let behind = behind.trim_start();
            at = text.len() - behind.len();
            if !behind.starts_with("if") {
                let close = close_of(text, at);
                otherwise = Some(&text[at + 1..close]);
                at = close + 1;
                break;
            }
        }
        Self { arms, otherwise, length: at }
    }
}

/// Copies a text without the excluded branches. Returns whether there were any.
fn copy(text: &str, known: &Known<'_>, out: &mut String) -> bool {
    let bytes = text.as_bytes();
    let (mut copied, mut at, mut is_cut) = (0, 0, false);
    while let Some(found) = text[at..].find("if") {
        let start = at + found;
        at = start + "if".len();
        let is_word =
            (start == 0 || !is_of_name(bytes[start - 1])) && bytes.get(at).is_some_and(|next| !is_of_name(*next));
        // `break if` has no block.
        if !is_word || text[..start].trim_end().ends_with("break") {
            continue;
        }
        out.push_str(&text[copied..start]);
        let branches = Branches::of(&text[start..]);
        copied = start + branches.length;
        at = copied;
        is_cut |= copy_branches(branches, known, out);
    }
    out.push_str(&text[copied..]);
    is_cut
}

fn copy_branches(branches: Branches<'_>, known: &Known<'_>, out: &mut String) -> bool {
    let (mut is_cut, mut is_first, mut otherwise) = (false, true, branches.otherwise);
    for Arm { condition, block } in branches.arms {
        let holds = known.holds(condition);
        is_cut |= holds.is_some();
        match holds {
            Some(false) => continue,
            Some(true) => {
                otherwise = Some(block);
                break;
            }
            None => {}
        }
        out.push_str(if is_first { "if" } else { " else if" });
        is_first = false;
        out.push_str(condition);
        out.push('{');
        is_cut |= copy(block, known, out);
        out.push('}');
    }
    if let Some(block) = otherwise {
        if !is_first {
            out.push_str(" else ");
        }
        out.push('{');
        is_cut |= copy(block, known, out);
        out.push('}');
    }
    is_cut
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHADER: &str =
        "override HAS_A: bool = true;\noverride COUNT: u32;\noverride HALF: f32 = 0.5;\nconst LARGE = 4u;\n";

    /// Returns the statements that remain if `COUNT` is 3.
    fn cut(statements: &str) -> String {
        let wgsl = format!("{SHADER}{statements}");
        let text = without_excluded(&wgsl, &[("COUNT", 3.0)]);
        text.strip_prefix(SHADER).expect("declarations stay").split_whitespace().collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn excluded_branches_are_cut() {
        for (statements, expected) in [
            ("if HAS_A { a(); }", "{ a(); }"),
            ("if !HAS_A { a(); } b();", "b();"),
            ("if !HAS_A { a(); } else { b(); }", "{ b(); }"),
            ("if COUNT > LARGE { a(); } else if COUNT == 3u { b(); } else { c(); }", "{ b(); }"),
            ("if x { a(); } else if COUNT != 3u { b(); } else { c(); }", "if x { a(); } else { c(); }"),
            ("if x { a(); } else if HAS_A { b(); } else { c(); }", "if x { a(); } else { b(); }"),
            ("if x { a(); } else if !HAS_A { b(); }", "if x { a(); }"),
            ("if !HAS_A && f(x) { a(); }", ""),
            ("if x > 1 && !HAS_A { a(); }", ""),
            ("if (COUNT >= LARGE || (HAS_A)) { a(); }", "{ a(); }"),
            ("if !(COUNT <= 2 || !HAS_A) { a(); }", "{ a(); }"),
            ("if x { if HAS_A { a(); } else { b(); } }", "if x { { a(); } }"),
            ("loop { if COUNT < 3 { a(); } continuing { break if x; } }", "loop { continuing { break if x; } }"),
        ] {
            assert_eq!(cut(statements), expected, "{statements}");
        }
    }

    #[test]
    fn what_is_known_only_when_the_shader_runs_stays() {
        for statements in [
            "if x { a(); } else { b(); }",
            "if HAS_A && x { a(); }",
            "if f(x) && !HAS_A { a(); }",
            "if x.HAS_A { a(); }",
            "if x[COUNT] == 3 { a(); }",
            "if COUNT + 1 == 3 { a(); }",
            "if any(x < y) || COUNT & 1 == 3 { a(); }",
            "if HALF == 0.5 { a(); }",
            "if !x == HAS_A { a(); }",
            "let iffy = if_HAS_A;",
        ] {
            assert_eq!(cut(statements), statements);
        }
    }

    /// Every shader is valid with default constants and with each constant changed. No local variable has the name of a
    /// constant, which would be mistaken for it.
    #[test]
    fn shaders_without_excluded_branches_are_valid() {
        use naga::valid::{Capabilities, ValidationFlags, Validator};
        let mut cut = 0;
        for (path, wgsl) in crate::shaders::ALL {
            let wgsl = crate::shaders::text_of(wgsl);
            let overrides: Vec<&str> = wgsl.lines().filter_map(|line| line.strip_prefix("override ")).collect();
            let names: Vec<&str> = overrides.iter().filter_map(|line| line.split([':', ' ', ';']).next()).collect();
            for name in Known::of(&wgsl).0.keys().chain(&names) {
                for local in ["let", "var"] {
                    let declaration = format!(" {local} {name}");
                    let mut ends = wgsl.match_indices(&declaration).map(|(at, found)| at + found.len());
                    let is_declared = ends.any(|end| !is_of_name(wgsl.as_bytes()[end]));
                    assert!(!is_declared, "{path}: a local variable {name}");
                }
            }
            for changed in std::iter::once(None).chain(names.iter().map(Some)) {
                for value in [0.0, 1.0, 2.0, 4.0] {
                    let constants: Vec<(&str, f64)> = changed.iter().map(|name| (**name, value)).collect();
                    let text = without_excluded(&wgsl, &constants);
                    if let Cow::Borrowed(_) = text {
                        continue;
                    }
                    cut += 1;
                    let module = naga::front::wgsl::parse_str(&text)
                        .unwrap_or_else(|error| panic!("{path}, {constants:?}: {}", error.emit_to_string(&text)));
                    let core = Capabilities::SHADER_FLOAT16_IN_FLOAT32;
                    let validated = Validator::new(ValidationFlags::all(), core).validate(&module);
                    assert!(validated.is_ok(), "{path}, {constants:?}: {:?}", validated.err());
                    if changed.is_none() {
                        break;
                    }
                }
            }
        }
        assert!(cut > 300, "{cut}");
    }
}
